// SPDX-License-Identifier: MIT
// What the drivers of other engines share: the command line, the scene with its masses, the clock, the trajectory.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <flotilla/scene.hpp>

#include "mesh/mass_properties.hpp"
#include "poses_file.hpp"
#include "primitives.hpp"

namespace flotilla::baseline {

struct EngineArguments {
    std::string scene, output, shape; ///< `shape`: how the engine takes the meshes, its own words
    double dt = 1.0 / 24;             ///< s
    double gap = 0.01;                ///< m, kept between surfaces where the engine can
    double panel_thickness = 0;       ///< m, of convex panels that meshes are cut into; 0: a panel for each triangle
    int steps = 0;
    int iterations = 0;  ///< of the engine's solver; 0: its default
    std::string solver;  ///< of those that the engine has, its own words
    int frame_every = 1; ///< steps
    double limit = 0;    ///< CPU s of the steps after which the run is given up; 0: none
};

inline const std::string kPrimitives = "primitives"; ///< a shape(): what meshes stand for (primitives.hpp)

/// The scene, and for each shape its mass: the same numbers as flotilla's, but for round primitives.
struct EngineScene {
    SceneDescription description;
    std::vector<std::optional<MassProperties>> masses;
    std::vector<Primitive> primitives; ///< of each shape; meshes unless they were asked for
};

/// A shape's vertices in the frame of its mass (centre and principal axes) where it has one, else in mesh coordinates,
/// m.
[[nodiscard]] std::vector<Vec3> vertices_about_mass(const ShapeDescription& shape,
                                                    const std::optional<MassProperties>& mass);
/// The world pose of that frame for a body, and back to that of the mesh's own origin.
struct Frame {
    Vec3 position;
    Quat rotation;
};
[[nodiscard]] Frame mass_frame(const BodyDescription& body, const std::optional<MassProperties>& mass);
[[nodiscard]] Frame mesh_frame(const Frame& frame, const std::optional<MassProperties>& mass);

/// An engine with the scene in it.
class Engine {
  public:
    virtual ~Engine() = default;
    virtual void step(double dt) = 0; ///< s
    [[nodiscard]] virtual std::vector<PoseRow> rows() const = 0;
};

using MakeEngine = std::function<std::unique_ptr<Engine>(const EngineScene&, const EngineArguments&)>;

/// Parses, runs, writes frames, prints the CPU seconds of the steps alone. Returns the exit code: 2 for bad input, 6
/// where the run was given up.
int run_engine(int argc, char** argv, const std::string& name, const std::vector<std::string>& shapes,
               const std::vector<std::string>& solvers, const MakeEngine& make);

} // namespace flotilla::baseline
