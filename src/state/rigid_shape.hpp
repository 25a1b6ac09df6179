// SPDX-License-Identifier: MIT
// A shape as the solver uses it: mesh, features, hierarchy and mass, shared by all bodies that have it.
#pragma once

#include "geometry/support.hpp"
#include "mesh/bvh.hpp"
#include "mesh/topology.hpp"
#include "state/rotation_step.hpp"

namespace flotilla {

struct RigidShape {
    TriangleMesh mesh; ///< vertices in the mesh's own coordinates, m
    Topology topology;
    Bvh bvh;
    Box box;                    ///< of the mesh, in its own coordinates, m
    Vec3 center_of_mass;        ///< mesh coordinates
    double mass = 0;            ///< kg; 0 where the shape has none (static and scripted bodies only)
    Mat3 inertia;               ///< about the centre of mass, mesh axes, kg m^2
    PrincipalInertia principal; ///< of `inertia`
    Vec3 line;                  ///< MassProperties::line
    SupportPoints outline;      ///< of the vertices, mesh coordinates
    bool convex = false;        ///< and of few vertices (is_convex())
    double size = 0;            ///< m, diameter of the bounding sphere
    double extent = 0;          ///< m, which the lengths of its pairs go by (Shape::extent)
    double longest_edge = 0;    ///< m, of a triangle
    double radius = 0;          ///< m, largest distance of a vertex from the centre of mass, rounded up
};

} // namespace flotilla
