// SPDX-License-Identifier: MIT
// Light from many parallel lights, each with a shadow map.
#pragma once

#include <cstdint>
#include <vector>

#include "picture/camera.hpp"

namespace flotilla::picture {

/// A visible piece of surface. Samples of a pixel that show nearly the same surface share one.
struct Surfel {
    Float3 position;
    Float3 face_normal;   ///< unit, of the side that the camera sees
    Float3 smooth_normal; ///< unit, same side
    std::uint32_t body = 0;
    bool inner = false; ///< the side that looks towards the body's middle, as far as the winding is consistent
};

/// Light that reaches a surfel per unit of albedo.
struct Irradiance {
    Float3 sun, sky;
};

[[nodiscard]] std::vector<Irradiance> light_surfels(const Model& model, const Camera& camera,
                                                    const std::vector<Surfel>& surfels, const PictureOptions& options);

} // namespace flotilla::picture
