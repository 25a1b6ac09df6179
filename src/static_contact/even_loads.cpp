// SPDX-License-Identifier: MIT
#include "static_contact/even_loads.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "static_contact/tangents.hpp"

namespace flotilla {
namespace {

constexpr std::size_t kGrain = 256; // contacts of a task
/// Three points share a load in one way.
constexpr std::size_t kFewest = 4;
/// Patches looked for in a pair, the sides of a box: a look is at most as many times the contacts long.
constexpr std::size_t kMostPatches = 6;
/// 1 - cosine between normals of one plane: 4e-5 rad, more than what is at rest turns by within its tolerance.
constexpr double kOneNormal = 1e-9;
/// Sine of the angle by which the line between two points may leave their plane.
constexpr double kOnePlane = 1e-4;
/// Of the square of both moments' sum: a patch less than a millionth as wide as long is a line.
constexpr double kLine = 1e-12;
/// Of the mean load, within which it is even: rounding.
constexpr double kEven = 1e-12;
/// Of the mean load: less is none, and does not say who slides.
constexpr double kUnloaded = 1e-9;
/// Of mu l_n, beyond which a contact has all its friction.
constexpr double kAllFriction = 1 - 1e-6;

double square(double x) { return x * x; }

bool touches(const Contact& c, const Vec3& impulse) { return dot(impulse, c.normal) > 0 || c.target >= -c.tolerance; }

bool in_one_plane(const Contact& first, const Contact& c) {
    if (!(dot(c.normal, first.normal) > 1 - kOneNormal)) return false;
    const Vec3 apart = c.point - first.point;
    return square(dot(apart, first.normal)) <= square(kOnePlane) * dot(apart, apart);
}

bool in_any(std::span<const Contact> pair, std::span<const std::size_t> leaders, std::size_t i) {
    return std::ranges::any_of(leaders, [&](std::size_t k) { return in_one_plane(pair[k], pair[i]); });
}

/// The largest part of the way at which what goes from `begin` to `end` is not below zero.
double part_above_zero(double begin, double end) { return end < 0 ? std::clamp(begin / (begin - end), 0.0, 1.0) : 1; }

class Patch {
  public:
    /// The contacts in the plane of `first` but for those of other patches, which `leaders` begin.
    Patch(std::span<const Contact> pair, std::size_t first, std::span<const std::size_t> leaders,
          std::span<Vec3> impulses, std::vector<SharedLoad>& loads)
        : pair_(pair),
          impulses_(impulses),
          loads_(loads),
          normal_(pair[first].normal),
          tangents_(any_tangents(normal_)) {
        loads.clear();
        for (std::size_t i = 0; i < pair.size(); ++i)
            if (touches(pair[i], impulses[i]) && in_one_plane(pair[first], pair[i]) && !in_any(pair, leaders, i))
                add(i, pair[first].point);
    }

    void share() {
        if (loads_.size() < kFewest) return;
        centre();
        fit();
        if (is_even()) return;
        const double part = part_of_way();
        for (const SharedLoad& l : loads_) {
            const double n = l.normal + part * (normal_at(l) - l.normal);
            const double x = l.along_x + part * (x_at(l) - l.along_x);
            const double y = l.along_y + part * (y_at(l) - l.along_y);
            impulses_[l.contact] = n * normal_ + x * tangents_.t1 + y * tangents_.t2;
        }
    }

  private:
    [[nodiscard]] bool is_even() const {
        return std::ranges::all_of(loads_, [&](const SharedLoad& l) {
            return std::max({std::abs(normal_at(l) - l.normal), std::abs(x_at(l) - l.along_x),
                             std::abs(y_at(l) - l.along_y)}) <= kEven * mean_;
        });
    }
    /// How far to go: no contact pulls, and friction that holds stays within its cones.
    [[nodiscard]] double part_of_way() const {
        double part = 1;
        for (const SharedLoad& l : loads_) {
            part = std::min(part, part_above_zero(l.normal, normal_at(l)));
            if (!slides_)
                part = std::min(part, part_above_zero(friction(l) * l.normal - std::hypot(l.along_x, l.along_y),
                                                      friction(l) * normal_at(l) - std::hypot(x_at(l), y_at(l))));
        }
        return part;
    }
    void add(std::size_t i, const Vec3& origin) {
        const Vec3 place = pair_[i].point - origin, &l = impulses_[i];
        loads_.push_back({i, dot(place, tangents_.t1), dot(place, tangents_.t2), dot(l, normal_), dot(l, tangents_.t1),
                          dot(l, tangents_.t2)});
    }
    void centre() {
        double x = 0, y = 0;
        for (const SharedLoad& l : loads_) x += l.x, y += l.y;
        const auto n = static_cast<double>(loads_.size());
        for (SharedLoad& l : loads_) l.x -= x / n, l.y -= y / n;
    }
    [[nodiscard]] double friction(const SharedLoad& l) const { return pair_[l.contact].friction; }
    /// Force and torque, and the fields that have them: affine normal impulses, and friction as of a rigid body that
    /// moves, or where all of the patch slides in proportion to the normal impulses: what slid as it had to goes on so.
    void fit() {
        double xx = 0, xy = 0, yy = 0, by_x = 0, by_y = 0;
        for (const SharedLoad& l : loads_) {
            xx += l.x * l.x, xy += l.x * l.y, yy += l.y * l.y;
            by_x += l.x * l.normal, by_y += l.y * l.normal;
            mean_ += l.normal, mean_x_ += l.along_x, mean_y_ += l.along_y;
            turn_ += l.x * l.along_y - l.y * l.along_x;
        }
        const auto n = static_cast<double>(loads_.size());
        mean_ /= n, mean_x_ /= n, mean_y_ /= n;
        const double sum = xx + yy, product = xx * yy - xy * xy;
        if (!(sum > 0)) return; // one point over and over
        turn_ /= sum;
        const bool line = !(product > kLine * sum * sum);
        slope_x_ = line ? by_x / sum : (yy * by_x - xy * by_y) / product;
        slope_y_ = line ? by_y / sum : (xx * by_y - xy * by_x) / product;
        slides_ = std::ranges::all_of(loads_, [&](const SharedLoad& l) {
            return is_unloaded(l) ||
                   square(l.along_x) + square(l.along_y) > square(kAllFriction * friction(l) * l.normal);
        });
    }
    [[nodiscard]] double normal_at(const SharedLoad& l) const { return mean_ + slope_x_ * l.x + slope_y_ * l.y; }
    [[nodiscard]] double x_at(const SharedLoad& l) const {
        return slides_ ? sliding(l, l.along_x) : mean_x_ - turn_ * l.y;
    }
    [[nodiscard]] double y_at(const SharedLoad& l) const {
        return slides_ ? sliding(l, l.along_y) : mean_y_ + turn_ * l.x;
    }
    /// All the friction of its load, in the direction that it has. What was handed in may lie outside its cone, by any
    /// ratio: normals turn from step to step.
    [[nodiscard]] double sliding(const SharedLoad& l, double along) const {
        return is_unloaded(l) ? 0 : friction(l) * normal_at(l) * (along / std::hypot(l.along_x, l.along_y));
    }
    [[nodiscard]] bool is_unloaded(const SharedLoad& l) const { return !(l.normal > kUnloaded * mean_); }

    std::span<const Contact> pair_;
    std::span<Vec3> impulses_;
    std::vector<SharedLoad>& loads_;
    Vec3 normal_;
    TangentPair tangents_;
    double mean_ = 0, slope_x_ = 0, slope_y_ = 0; // N s, N s / m
    double mean_x_ = 0, mean_y_ = 0, turn_ = 0;
    bool slides_ = false; // all that carry have all their friction
};

void share_in_pair(std::span<const Contact> pair, std::span<Vec3> impulses, std::vector<SharedLoad>& loads) {
    std::array<std::size_t, kMostPatches> leaders{};
    std::size_t patches = 0;
    for (std::size_t i = 0; i < pair.size() && patches < kMostPatches; ++i) {
        const auto known = std::span(leaders).first(patches);
        if (!(dot(impulses[i], pair[i].normal) > 0) || in_any(pair, known, i)) continue;
        Patch(pair, i, known, impulses, loads).share();
        leaders[patches++] = i;
    }
}

} // namespace

void even_loads(Team* team, std::span<const Contact> contacts, std::span<const double> bounds, std::span<Vec3> impulses,
                std::vector<std::vector<SharedLoad>>& scratch) {
    scratch.resize(static_cast<std::size_t>(team->size()));
    const auto share_from = [&](std::size_t i, int thread) {
        if (!begins_pair(contacts, i)) return;
        std::size_t end = i + 1;
        while (end < contacts.size() && !begins_pair(contacts, end)) ++end;
        if (end - i < kFewest || (!bounds.empty() && bounds[i] >= 0)) return;
        share_in_pair(contacts.subspan(i, end - i), impulses.subspan(i, end - i),
                      scratch[static_cast<std::size_t>(thread)]);
    };
    if (contacts.size() > kGrain) return team->for_each("even loads", contacts.size(), kGrain, share_from);
    for (std::size_t i = 0; i < contacts.size(); ++i) share_from(i, 0);
}

} // namespace flotilla
