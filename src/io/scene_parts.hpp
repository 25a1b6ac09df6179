// SPDX-License-Identifier: MIT
// Shapes and bodies of scene files, one by one.
#pragma once

#include <filesystem>
#include <string>

#include <flotilla/scene.hpp>

#include "io/json_document.hpp"

namespace flotilla::io {

/// Reads a shape; problems go to `errors`.
[[nodiscard]] ShapeDescription read_shape(const Json& value, const JsonPlace& at, const std::filesystem::path& folder,
                                          ErrorList& errors);
/// Reads a body. `scene` tells the names of shapes, and what friction and restitution bodies have that give none.
[[nodiscard]] BodyDescription read_body(const Json& value, const JsonPlace& at, const SceneDescription& scene,
                                        ErrorList& errors);
[[nodiscard]] std::string shape_json(const ShapeDescription& shape);
[[nodiscard]] std::string body_json(const BodyDescription& body, const SceneDescription& scene);

} // namespace flotilla::io
