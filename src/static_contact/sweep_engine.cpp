// SPDX-License-Identifier: MIT
#include "static_contact/sweep_engine.hpp"

#include <cmath>

#include "base/index.hpp"

namespace flotilla {

void SweepEngine::prepare_shares() {
    shares_.reserve();
    for_phases(SweepShares::kPreparations, [&](std::size_t phase, int share) {
        timed(share, evaluation_group(), [&] { shares_.prepare(phase, share); });
    });
}

void SweepEngine::move_on(int share, double m) {
    for_bodies(share, [&](std::span<const std::int32_t> bodies, ContactScratch::Turns&) {
        for (const std::int32_t body : bodies) {
            BodyVelocity &v = s_.velocity[at(body)], &before = s_.before_sweep[at(body)];
            const BodyVelocity x = v;
            if (m != 0) { // else nothing may be known of the sweep before
                v.linear = x.linear + m * (x.linear - before.linear);
                v.angular = x.angular + m * (x.angular - before.angular);
            }
            before = x;
            s_.sweep_start[at(body)] = v;
        }
    });
}

void SweepEngine::add_up(int share) {
    for_bodies(share, [&](std::span<const std::int32_t> bodies, ContactScratch::Turns& sum) {
        ContactScratch::Turns parts;
        for (const std::int32_t body : bodies) {
            const BodyVelocity &x = s_.velocity[at(body)], &y = s_.sweep_start[at(body)],
                               &before = s_.before_sweep[at(body)];
            const ContactScratch::Weight& w = s_.weight[at(body)];
            const BodyVelocity step{.linear = x.linear - before.linear, .angular = x.angular - before.angular};
            parts.back +=
                w.linear * dot(y.linear - x.linear, step.linear) + w.angular * dot(y.angular - x.angular, step.angular);
            parts.over += w.linear * dot(y.linear - before.linear, step.linear) +
                          w.angular * dot(y.angular - before.angular, step.angular);
        }
        sum = parts;
    });
}

ContactScratch::Turns SweepEngine::added_up() const {
    ContactScratch::Turns sum;
    for (const ContactScratch::Turns& part : set_.sums) {
        sum.back += part.back;
        sum.over += part.over;
    }
    return sum;
}

SweepView SweepEngine::view(std::span<const ContactPacket> packets, double momentum) const {
    SweepView view = set_.view;
    view.packets = packets.data();
    view.num_packets = static_cast<std::int64_t>(packets.size());
    view.momentum = momentum;
    view.repeat_above = repeat_above_;
    view.most_visits = options_.tuning.most_visits;
    return view;
}

double SweepEngine::sweep_divided(double m) {
    if (set_.momentum) move_on(0, m);
    double worst = 0;
    std::int64_t ns = 0;
    for (std::size_t c = 0; c < divided_->num_colors(); ++c) {
        const std::int64_t begin = divided_->clock();
        for (const auto& packets : divided_->own(c))
            worst = std::max(worst, flotilla::sweep(cone_, view(packets, m), options_.isa));
        ns += divided_->clock() - begin;
        divided_->hand_on(c);
    }
    divided_->add_sweep(ns);
    worst = divided_->share_velocities(worst);
    if (set_.momentum) add_up(0);
    return worst;
}

double SweepEngine::sweep(double m) {
    if (divided_ != nullptr) return sweep_divided(m);
    const std::size_t before = set_.momentum ? 1 : 0;
    const PhaseChain chain = shares_.chain(before);
    const auto work = [&](std::size_t phase, int share) {
        double worst = 0;
        if (phase < before) {
            move_on(share, m);
        } else if (phase - before == num_groups()) {
            add_up(share);
        } else {
            timed(share, phase - before, [&] {
                worst = flotilla::sweep(cone_, view(shares_.packets(phase - before, share), m), options_.isa);
            });
        }
        return worst;
    };
    return largest(num_groups() + 2 * before, work, &chain);
}

void SweepEngine::apply_impulses() {
    if (divided_ != nullptr) {
        for (std::size_t c = 0; c < divided_->num_colors(); ++c) {
            for (const auto& packets : divided_->own(c)) flotilla::apply_impulses(cone_, view(packets), options_.isa);
            divided_->hand_on(c);
        }
        divided_->share_velocities(0);
        return;
    }
    const PhaseChain chain = shares_.chain(0);
    const auto work = [&](std::size_t g, int share) {
        timed(share, g, [&] { flotilla::apply_impulses(cone_, view(shares_.packets(g, share)), options_.isa); });
    };
    for_phases(num_groups(), work, &chain);
}

} // namespace flotilla
