// SPDX-License-Identifier: MIT
#include "static_contact/momentum.hpp"

#include <algorithm>
#include <cmath>

namespace flotilla {
namespace {

constexpr double kMostMomentum = 0.9;

std::size_t index(std::int32_t i) { return static_cast<std::size_t>(i); }

} // namespace

double Momentum::next(bool restart) {
    const double next = (1 + std::sqrt(1 + 4 * theta_ * theta_)) / 2;
    const double m = restart ? 0.0 : std::min(kMostMomentum, (theta_ - 1) / next);
    theta_ = restart ? 1.0 : next;
    return m;
}

void extrapolate(std::span<const std::int32_t> bodies, double m, ContactScratch& s) {
    for (const std::int32_t body : bodies) {
        BodyVelocity &v = s.velocity[index(body)], &before = s.before_sweep[index(body)];
        const BodyVelocity x = v;
        v.linear = x.linear + m * (x.linear - before.linear);
        v.angular = x.angular + m * (x.angular - before.angular);
        before = x;
        s.sweep_start[index(body)] = v;
    }
}

double turned_back(std::span<const std::int32_t> bodies, const ContactScratch& s) {
    double sum = 0;
    for (const std::int32_t body : bodies) {
        const BodyVelocity &x = s.velocity[index(body)], &y = s.sweep_start[index(body)],
                           &before = s.before_sweep[index(body)];
        const ContactScratch::Weight& w = s.weight[index(body)];
        sum += w.linear * dot(y.linear - x.linear, x.linear - before.linear) +
               w.angular * dot(y.angular - x.angular, x.angular - before.angular);
    }
    return sum;
}

} // namespace flotilla
