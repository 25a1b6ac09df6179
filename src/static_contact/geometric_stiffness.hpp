// SPDX-License-Identifier: MIT
// Light bodies under tension.
//
// A contact's normal is that of the poses at hand, and what it does to the turn of a body it does once a step. A force
// f that pulls at an arm r, as on the link of a chain, turns back what turns: its torque r x f changes by -K with the
// angle, K = (r . f) 1 - r f^T (the geometric stiffness; Tournier, Nesme, Gilles and Faure 2015). Forces kept from step
// to step do that explicitly, which is stable up to w dt = 2 alone, w^2 = K / I. Four links of 0.1 kg with a lamp of 5
// kg, 1/60 s, are beyond: they shook until stage 5 slowed all of it down in every step, and the lamp hung in the air.
//
// So K dt^2 is added to such a body's inertia in the solve, by as much as takes w dt down to one (Andrews, Teichmann
// and Kovecses 2017 damp it likewise). Oscillations that a step resolves are left alone. Impulses and momenta of others
// stay what they are; that of the body changes by less than the torque on it, which would have turned back within the
// step.
#pragma once

#include <span>
#include <vector>

#include "parallel/team.hpp"
#include "state/contact.hpp"
#include "state/model.hpp"
#include "static_contact/velocity_arrays.hpp"

namespace flotilla {

class GeometricStiffness {
  public:
    /// Adds to the inertia of active bodies what the `carried` impulses of contacts (N s, on b, of `time` s) ask for.
    void stiffen(Team* team, const Model& model, std::span<const Contact> contacts, std::span<const Vec3> carried,
                 double time, VelocityArrays& velocities);
    /// Gives them their own inertia back. Also before bodies are loaded: a step may have been cut off.
    void relax(VelocityArrays& velocities);

  private:
    /// Forces on a body.
    struct Pulls {
        double outward = 0; ///< N m, sum of r . f
        double size = 0;    ///< N, sum of |f|
        Mat3 along{};       ///< N, sum of f f^T / |f|
    };
    struct Stiffened {
        std::int32_t body;
        Mat3 inverse_inertia; ///< 1/(kg m^2), its own
    };
    /// Bodies that a force pulls at, and contacts of such.
    bool find_pulled(Team* team, const Model& model, std::span<const Contact> contacts, std::span<const Vec3> carried,
                     double time, const VelocityArrays& velocities);

    std::vector<std::uint8_t> pulled_; ///< by body
    std::vector<Pulls> pulls_;         ///< likewise
    std::vector<Stiffened> stiffened_;
};

} // namespace flotilla
