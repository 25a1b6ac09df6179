// SPDX-License-Identifier: MIT
// The hits of one pair in one operation of Algorithm 1, resolved together.
//
// A crate that lands flat touches with four corners at one time. Resolved one by one, the first corner's impulse turns
// it, the next one's turns it back too late, and with restitution a fifth of its energy ends in spin, at any time step.
// So an operation forgets no hit: when another one is found that belongs to the same time, the impulses of all hits so
// far are solved again, each for the rebound from the approach that its point had before the first, with friction, by
// projected Gauss-Seidel. One hit alone is resolved as in section 3.2.
//
// A hit that comes later meets the velocities that the former ones left, and the list begins anew: where one corner of
// a plate lies on the floor and another one falls on it, that tips the plate, and the slip of the first corner turns
// round. A cube that falls plastically on its corners stops corner by corner, the others moving on, and mostly rises in
// the end (97 of 100); with all of them solved at once it comes to rest.
#pragma once

#include <span>
#include <vector>

#include "response/impulse.hpp"

namespace flotilla {

class PairManifold {
  public:
    /// Begins with bodies of these velocities; the first hit is `gap` (m) away at the start of the step.
    void start(const Impulsive& a, const Impulsive& b, double gap);
    void clear() { hits_.clear(); }
    [[nodiscard]] bool empty() const { return hits_.empty(); }
    /// Whether the point, `gap` (m) away at the start of the step, meets at the time of the first hit if nothing hits:
    /// so nearly that the faster of the two goes no farther than `reach` (m) in between. `point` has the velocities
    /// after all impulses so far.
    [[nodiscard]] bool simultaneous(const ContactPoint& point, double gap, double reach) const;
    /// A hit that is resolved by `impulse` (N s, on b) alone; `point` has the velocities before that.
    void add(const ContactPoint& point, double restitution, const Vec3& impulse);

    struct Change {
        ContactPoint point; ///< as the hit was added
        Vec3 impulse;       ///< on b, N s, on top of what was applied before
    };
    /// More hits, at one time, with the velocities after all impulses so far. Fills `changes` with what the impulses of
    /// all hits change by. False, and nothing is changed, where none of the new ones gets an impulse. That the first
    /// gets none is no fault: of a bar that lands flat across a rail the edge next to its centre throws it off the
    /// other one. `within`: the first is in the middle of a flat side whose corners are the others: it follows from
    /// these, which carry the body at rest as well and brake its spin. Swept as the others are it took all of the load
    /// of a disc that fell flat, which lost no spin.
    [[nodiscard]] bool resolve(std::span<const ContactPoint> points, double restitution, bool within,
                               std::vector<Change>& changes);

  private:
    struct Hit {
        ContactPoint point{};                     ///< relative velocity: before all impulses
        double target = 0;                        ///< m/s, normal velocity wanted
        Vec3 impulse{};                           ///< N s, on b, applied
        Vec3 next{}, last{};                      ///< the same, as solved; before the last sweep
        double mass_normal = 0, mass_tangent = 0; ///< 1/kg, of the point: along the normal, and no less than any other
        Mat3 own{};                               ///< 1/kg, what an impulse changes of its relative velocity
        Mat3 turn_a{}, turn_b{};                  ///< 1/(kg m), what one changes of the angular velocities
        bool within = false;                      ///< swept once the others are solved
    };
    /// What impulses change.
    struct Velocities {
        Vec3 linear_a, angular_a, linear_b, angular_b;
    };
    void push(const Hit& hit, const Vec3& impulse, Velocities& v) const;
    /// The effect of what is applied.
    [[nodiscard]] Velocities applied() const;
    [[nodiscard]] Hit make_hit(const ContactPoint& point, double restitution, const Velocities& applied) const;
    /// What of the velocities changes at the point, b against a, m/s.
    [[nodiscard]] static Vec3 change(const ContactPoint& point, const Velocities& v);
    [[nodiscard]] static Vec3 relative(const Hit& hit, const Velocities& v);
    void set_effects(Hit& hit) const;
    [[nodiscard]] double sweep(bool all, Velocities& v);
    void carry_on(double share, Velocities& v);
    void solve(Velocities& v);
    void sweep_on(bool all, double fastest, Velocities& v);
    [[nodiscard]] double energy_share() const;

    Impulsive a_, b_;
    double gap_ = 0; ///< m, of the first hit at the start of the step
    std::vector<Hit> hits_;
};

} // namespace flotilla
