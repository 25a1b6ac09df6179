// SPDX-License-Identifier: MIT
// From what each sample shows to colours.
#pragma once

#include <cstdint>
#include <vector>

#include "picture/light.hpp"

namespace flotilla::picture {

struct Surface {
    std::vector<Surfel> surfels;
    std::vector<std::uint32_t> of_sample; ///< index into surfels per sample, or kNothing
};

/// The visible pieces of surface, pixel by pixel.
[[nodiscard]] Surface find_surface(const Model& model, const Camera& camera, const VisibleLayer& opaque,
                                   int supersampling);

/// Colours, lines, glass and background, averaged over the samples of each pixel.
[[nodiscard]] Image compose(const Model& model, const Camera& camera, const VisibleLayer& opaque,
                            const VisibleLayer& glass, const Surface& surface, const std::vector<Irradiance>& light,
                            const PictureOptions& options);

} // namespace flotilla::picture
