// SPDX-License-Identifier: MIT
// An overlay in pixels.
#pragma once

#include "picture/camera.hpp"
#include "picture/image.hpp"
#include "picture/overlay.hpp"

namespace flotilla::picture {

/// Over the picture that the camera's samples gave, `supersampling` of them a pixel and axis.
void draw_overlay(Image& image, const Model& model, const Camera& camera, const VisibleLayer& opaque, int supersampling,
                  const Overlay& overlay);

} // namespace flotilla::picture
