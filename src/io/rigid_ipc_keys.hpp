// SPDX-License-Identifier: MIT
// The keys of Rigid-IPC's scene files. Others are ignored there, and named by us.
#pragma once

#include <array>
#include <string_view>

namespace flotilla::io::rigid_ipc {

using std::string_view_literals::operator""sv;

inline constexpr std::string_view kProblem = "rigid_body_problem", kBodies = "rigid_bodies";
inline constexpr std::array kSceneKeys{"scene_type"sv,
                                       "solver"sv,
                                       "timestep"sv,
                                       "max_time"sv,
                                       "max_iterations"sv,
                                       "distance_barrier_constraint"sv,
                                       "newton_solver"sv,
                                       "ipc_solver"sv,
                                       "friction_constraints"sv,
                                       kProblem,
                                       "homotopy_solver"sv,
                                       "ncp_solver"sv,
                                       "volume_constraint"sv,
                                       "viewport_bbox"sv};
inline constexpr std::array kProblemKeys{"gravity"sv,      "coefficient_friction"sv,  "coefficient_restitution"sv,
                                         "time_stepper"sv, "do_intersection_check"sv, "collision_eps"sv,
                                         kBodies};
inline constexpr std::array kBodyKeys{"mesh"sv,
                                      "vertices"sv,
                                      "edges"sv,
                                      "faces"sv,
                                      "type"sv,
                                      "is_dof_fixed"sv,
                                      "position"sv,
                                      "rotation"sv,
                                      "scale"sv,
                                      "dimensions"sv,
                                      "linear_velocity"sv,
                                      "angular_velocity"sv,
                                      "force"sv,
                                      "torque"sv,
                                      "density"sv,
                                      "group_id"sv,
                                      "kinematic_max_time"sv,
                                      "kinematic_poses"sv,
                                      "split_components"sv,
                                      "enabled"sv,
                                      "oriented"sv};

} // namespace flotilla::io::rigid_ipc
