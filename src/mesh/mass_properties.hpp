// SPDX-License-Identifier: MIT
// Mass, centre of mass and inertia of a triangle mesh, as a thin shell (surface integral), as a solid (volume
// integral), or, where it is a net of segments or a cloud of points, of those.
//
// A linear map sends the unit triangle (tetrahedron) to each triangle (tetrahedron with the reference point), so with
// corners a, b, c and s = a + b + c the moments are closed forms:
//   surface, A the area:        int x = A s / 3,     int x x^T = A/12  (a a^T + b b^T + c c^T + s s^T)
//   segment, L the length, s = a + b:  int x = L s / 2,  int x x^T = L/6  (a a^T + b b^T + s s^T)
//   volume, D = a . (b x c):    int 1 = D / 6,  int x = D s / 24,  int x x^T = D/120 (a a^T + b b^T + c c^T + s s^T)
// Coordinates are taken from the centre of the bounding box and everything is summed in double-double arithmetic (about
// 31 digits), so neither the distance from the origin, nor needles, nor the order of triangles costs digits: results
// are exact to a few units in the last place for the mesh as given.
#pragma once

#include <optional>
#include <string>

#include "mesh/triangle_mesh.hpp"

namespace flotilla {

struct MassProperties {
    double mass = 0;        ///< kg, > 0
    Vec3 center_of_mass;    ///< m, mesh coordinates
    Mat3 inertia;           ///< kg m^2, about the centre of mass, mesh axes; symmetric, positive definite
    Vec3 principal_inertia; ///< kg m^2, ascending, > 0; the first is 0 for a line
    Quat principal_axes;    ///< rotates principal axes into mesh axes: inertia = R diag(principal_inertia) R^T
    /// The direction of a straight line of segments or points, mesh axes; zero for anything else. It has no inertia
    /// about itself, and what pushes it has no lever there but rounding and the rest distance: the solver takes the
    /// inverse inertia about the other axes for that one too, so that numbers stay good and the line slides where it
    /// would roll on its contacts' distance, and drops the spin about the line at the end of every step.
    Vec3 line;
};

/// All of these throw an InputError naming the shape where the mass properties do not exist: a density or mass that is
/// not positive and finite, no area (length, volume), all in one place, or triangles so close to one line that the
/// smallest principal inertia is below kMinInertiaRatio of the largest.

/// A thin shell of `surface_density` kg/m^2. Zero-area triangles have no part in it.
[[nodiscard]] MassProperties shell_mass_properties(const TriangleMesh& mesh, double surface_density,
                                                   const std::string& name);
/// A net of segments of `line_density` kg/m. Refused where there are triangles as well.
[[nodiscard]] MassProperties line_mass_properties(const TriangleMesh& mesh, double line_density,
                                                  const std::string& name);
/// `mass` kg, spread evenly over the surface, or over the segments where nothing has more than a length, or over the
/// points where nothing has a length.
[[nodiscard]] MassProperties spread_mass_properties(const TriangleMesh& mesh, double mass, const std::string& name);
/// A solid of `density` kg/m^3. Refused unless the mesh is closed and consistently oriented (topology.hpp); all
/// triangles facing outwards and all facing inwards mean the same solid. A closed part facing the other way than the
/// rest is a cavity.
[[nodiscard]] MassProperties solid_mass_properties(const TriangleMesh& mesh, double density, const std::string& name);

/// Mass properties as given. `inertia` (about the centre of mass, mesh axes) must be symmetric to 1e-9 of its largest
/// entry, positive definite, and its principal values must obey the triangle inequality to 1e-6: no body has others.
[[nodiscard]] MassProperties given_mass_properties(double mass, const Vec3& center_of_mass, const Mat3& inertia,
                                                   const std::string& name);
/// `base` with the centre of mass, the inertia or both replaced. A new centre without a new inertia moves the inertia
/// there by the parallel axis theorem, m (|d|^2 1 - d d^T) more.
[[nodiscard]] MassProperties with_overrides(const MassProperties& base, const std::optional<Mat3>& inertia,
                                            const std::optional<Vec3>& center_of_mass, const std::string& name);

/// A body thinner than about 3e-7 of its length has a smallest principal inertia below 1e-13 of the largest: the
/// inverse of the inertia matrix would have lost its digits, so such meshes need an explicit inertia.
inline constexpr double kMinInertiaRatio = 1e-13;

} // namespace flotilla
