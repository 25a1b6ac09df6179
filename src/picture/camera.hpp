// SPDX-License-Identifier: MIT
// The camera and what it sees: for each sample the nearest triangle, and in front of it the nearest glass triangle.
#pragma once

#include <cstdint>
#include <vector>

#include "picture/model.hpp"

namespace flotilla::picture {

struct Camera {
    Float3 eye, right, up, forward; ///< model coordinates; orthonormal
    float focal = 1;                ///< samples per unit of x / depth
    int width = 0, height = 0;      ///< samples

    /// The ray of a sample centre, scaled so that eye + depth * ray lies at that depth.
    [[nodiscard]] Float3 ray(int x, int y) const {
        const float u = (static_cast<float>(x) + 0.5F - 0.5F * static_cast<float>(width)) / focal;
        const float v = (0.5F * static_cast<float>(height) - static_cast<float>(y) - 0.5F) / focal;
        return forward + (u * right + v * up);
    }
};

/// Fits the camera to everything in focus.
[[nodiscard]] Camera make_camera(const Model& model, const PictureOptions& options);

constexpr std::uint32_t kNothing = 0xffffffffU;

/// One entry per sample, row by row.
struct VisibleLayer {
    std::vector<float> inverse_depth; ///< 0 where nothing is seen
    std::vector<std::uint32_t> body;  ///< kNothing where nothing is seen
    std::vector<std::uint32_t> triangle;
};

enum class Surfaces : std::uint8_t { opaque, glass };

/// The nearest surfaces of one kind; empty arrays if the model has none of that kind.
[[nodiscard]] VisibleLayer find_visible(const Model& model, const Camera& camera, Surfaces kind);

} // namespace flotilla::picture
