// SPDX-License-Identifier: MIT
#include "state/locked_rotation.hpp"

#include <cmath>
#include <limits>

namespace flotilla {
namespace {

constexpr int kMaxCorrections = 40;
constexpr double kEnergyTolerance = 4 * std::numeric_limits<double>::epsilon(); // of the energy
constexpr double kMostCorrection = 0.5; // rad at a time: beyond, the slope says little

/// A body with two free axes and a constant momentum about them, by the rotation vector w from the start of the step.
class PlaneTurn {
  public:
    PlaneTurn(const WorldInertia& inertia, AxisMask locked, const Vec3& momentum)
        : inertia_(inertia), locked_(locked), momentum_(momentum) {}

    struct Energy {
        double value; ///< J
        Vec3 slope;   ///< J/rad, against w, in the plane
    };
    [[nodiscard]] Energy at(const Vec3& w) const {
        const Mat3 tensor = turned(inertia_.tensor, rotation_from_vector(w));
        const Vec3 omega = free_inverse(locked_, tensor) * momentum_;
        // A further turn by s changes the energy by s . (omega x I omega); a change of w turns further by the
        // exponential map's Jacobian.
        return {0.5 * dot(momentum_, omega), free_part(locked_, pulled_back(w, cross(omega, tensor * omega)))};
    }

  private:
    /// The transpose of the left Jacobian of the exponential map at w, times g.
    [[nodiscard]] static Vec3 pulled_back(const Vec3& w, const Vec3& g) {
        const double angle = length(w);
        if (angle < 1e-4) return g - 0.5 * cross(w, g); // to 1e-9 of g
        const Vec3 n = w / angle;
        const SinCos s = sin_cos(angle);
        const double along = s.sin / angle;
        return along * g + ((1 - along) * dot(n, g)) * n - ((1 - s.cos) / angle) * cross(n, g);
    }

    const WorldInertia& inertia_;
    AxisMask locked_;
    Vec3 momentum_;
};

/// The rotation vector nearest to w, down the slope, that keeps the energy; if none is found, one that came nearest to
/// it.
Vec3 keep_energy(const PlaneTurn& body, double energy, Vec3 w) {
    Vec3 best = w;
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < kMaxCorrections; ++i) {
        const PlaneTurn::Energy e = body.at(w);
        const double error = e.value - energy, slope_sq = length_sq(e.slope);
        if (std::abs(error) < least) {
            least = std::abs(error);
            best = w;
        }
        if (!(least > kEnergyTolerance * energy) || !(slope_sq > 0)) break;
        const Vec3 step = (-error / slope_sq) * e.slope;
        const double size = length(step);
        w += size > kMostCorrection ? (kMostCorrection / size) * step : step;
    }
    return best;
}

} // namespace

WorldInertia world_inertia(const RigidShape& shape, AxisMask locked, const Quat& rotation) {
    WorldInertia out = world_inertia(turned(shape.principal, rotation));
    if (locked != 0) out.inverse = free_inverse(locked, out.tensor);
    return out;
}

RotationStep rotate_locked(const WorldInertia& inertia, AxisMask locked, const Vec3& momentum, double dt) {
    const Vec3 omega = inertia.inverse * momentum;
    Vec3 w = dt * omega;
    if (num_free(locked) == 2) {
        w += (0.5 * dt * dt) * (inertia.inverse * cross(inertia.tensor * omega, omega));
        w = keep_energy(PlaneTurn(inertia, locked, momentum), 0.5 * dot(momentum, omega), w);
    }
    return {rotation_from_vector(w), w};
}

Quat allowed_rotation(AxisMask locked, const Quat& start, const Quat& rotation) {
    if (num_free(locked) > 1) return rotation;
    if (num_free(locked) == 0) return start;
    const Quat turn = rotation * conjugate(start);
    const auto along = [&](int axis, double part) { return is_locked(locked, axis) ? 0.0 : part; };
    return normalized(normalized(Quat{turn.w, along(0, turn.x), along(1, turn.y), along(2, turn.z)}) * start);
}

} // namespace flotilla
