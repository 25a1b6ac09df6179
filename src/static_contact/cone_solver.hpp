// SPDX-License-Identifier: MIT
// The solve of one problem, and its working memory. What it does and in which order is told in interior_point.cpp;
// method 1 is in cone_newton.cpp, method 2 in cone_path.cpp, contacts that yield in cone_yielding.cpp.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "static_contact/body_system.hpp"
#include "static_contact/interior_point.hpp"
#include "static_contact/lorentz_cone.hpp"

namespace flotilla {

struct ConeScratch::Storage {
    ConeProgram program; ///< of the bodies
    BodySystem system;
    std::vector<ConeDiagonal> w;
    std::vector<ConeMotion> motion;
    std::vector<Vec3> best;               ///< N s: the best impulses so far
    std::vector<Vec3> rigid;              ///< N s: those of contacts that do not yield
    std::vector<Vec3> before;             ///< N s: the best before begin_anew()
    std::vector<Vec3> r, u, c, du;        ///< present impulses and velocities, and the step dr = c - B du
    std::vector<Mat3> b;                  ///< B of body_system.hpp
    std::vector<Vec3> x, y, infeasible;   ///< iterate of the interior point; y(u) - y
    std::vector<Vec3> dx, dy, dx_0, dy_0; ///< its direction, and the path's tangent
    std::vector<NesterovTodd> scaling;

    void resize(std::size_t n) {
        for (auto* const v : {&r, &u, &c, &du, &x, &y, &infeasible, &dx, &dy, &dx_0, &dy_0}) v->assign(n, {});
        b.assign(n, {});
        scaling.assign(n, {});
    }
};

/// In x and y a friction mu stretches the normal direction by 1/mu. Below this the contact is solved without friction,
/// and what it lacks, mu r_n, is left to the Newton steps, for which any mu is the same.
inline constexpr double kLeastConeFriction = 1e-6;

/// Newton steps that a method begins with.
inline constexpr int kFirstNewtonSteps = 6;

/// From an estimate to impulses: run(), once.
class ConeSolver {
  public:
    ConeSolver(std::span<const ConeBody> bodies, std::span<const ConeContact> contacts, const ConeProgram& program,
               const ConeSolveOptions& options, ConeScratch::Storage& storage)
        : bodies_(bodies),
          contacts_(contacts),
          p_(program),
          options_(options),
          s_(storage),
          most_iterations_(options.max_iterations) {}

    ConeSolveStats run(std::span<Vec3> impulses);

  private:
    static constexpr double kInfinity = std::numeric_limits<double>::infinity();

    std::size_t size() const { return p_.contacts.size(); }
    double friction(std::size_t i) const { return p_.contacts[i].friction; }
    bool movable(std::size_t i) const { return s_.w[i].normal > 0; }
    /// N s, of friction that does not depend on the normal impulse.
    double given(std::size_t i) const { return p_.contacts[i].bound; }
    bool has_friction(std::size_t i) const { return (friction(i) > 0 || given(i) > 0) && s_.w[i].tangential > 0; }
    bool has_cone(std::size_t i) const { return friction(i) > kLeastConeFriction && s_.w[i].tangential > 0; }
    Vec3 yields(std::size_t i, const Vec3& r) const { // m/s
        if (!movable(i)) return {};
        return {compliance_ * r.x, slip_ * r.y, slip_ * r.z};
    }
    double limit() const { return std::max(options_.tolerance, stats_.rounding); }
    bool exhausted() const {
        const int iterations = stats_.iterations - before_;
        return iterations >= most_iterations_ ||
               (iterations >= options_.most_beyond && stats_.residual <= options_.enough);
    }
    bool done() const { return stats_.residual <= limit() || exhausted(); }

    bool finite_input() const;
    double largest_velocity() const;
    double least_diagonal() const;
    double largest_diagonal() const;
    double consider(double as_good = 0);
    double not_worth_more() const;
    bool factorise();
    bool solve();

    bool newton(int max_steps, double gain);
    void linearise(std::size_t i);
    void linearise_sliding(std::size_t i, const Vec3& z, double size);

    void interior(double inv_mass = 0);
    double least_inv_mass() const;
    void set_start(double inv_mass);
    double measure();
    bool stalled();
    bool step();
    bool step_down();
    bool step_along(int sign);
    void advance(double length);
    void prepare_blocks();
    bool direction(double target, double share, bool second_order);
    double step_length() const;
    double product_after(double length) const;
    double scaled_dot(const std::vector<Vec3>& dx, const std::vector<Vec3>& dy) const;
    Vec3 impulse(std::size_t i, const Vec3& x) const;
    Mat3 velocity_map(std::size_t i) const;

    void sweep(int count);
    void find();
    void begin_anew();
    bool pressed() const;
    bool loaded() const;
    bool yield(std::span<const Vec3> estimate, int most_iterations);
    void keep_rigid(const ConeSolveStats& rigid);
    bool yield_to_script(std::span<const Vec3> estimate);
    bool in_need() const {
        const bool more = stats_.residual > std::max(limit(), options_.enough);
        return more && options_.polish == 0 && std::isfinite(stats_.residual);
    }

    std::span<const ConeBody> bodies_;
    std::span<const ConeContact> contacts_;
    const ConeProgram& p_;
    ConeSolveOptions options_;
    ConeScratch::Storage& s_;
    ConeSolveStats stats_;

    double at_start_ = 0;   // m/s: residual of the estimate
    double rounding_ = 0;   // m/s: what rounding may do to the velocities of the present impulses
    double speed_ = 0;      // m/s: largest |q|
    double compliance_ = 0; // 1/kg: contacts yield so much to their normal impulses
    double slip_ = 0;       // 1/kg: and so much to friction
    int before_ = 0;        // factorisations of contacts that did not
    int most_iterations_;

    // of method 2
    double product_ = 0;       // J: sum of x . y
    double first_product_ = 0; // J: at the start
    double target_ = 0;        // J: the central path's for each contact
    double best_progress_ = 0; // smallest so far
    int without_progress_ = 0; // iterations
    int first_sign_ = 0;       // of the determinant where the path begins
};

} // namespace flotilla
