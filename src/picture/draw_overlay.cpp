// SPDX-License-Identifier: MIT
#include "picture/draw_overlay.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace flotilla::picture {
namespace {

using Index = std::size_t;
constexpr float kNear = 1e-3F;       // model units, as the camera's
constexpr float kHidden = 0.4F;      // of the strength, where a surface is in front
constexpr float kInFront = 1.002F;   // of the depth: a mark on a surface is not hidden by it
constexpr float kFarthest = 1e5F;    // pixels: beyond, a line's ends lose their place to rounding
constexpr float kArrowHead = 0.35F;  // of an arrow's length on the screen,
constexpr float kLargestHead = 9.0F; // and pixels at most

/// A point on the screen: pixels, and the inverse of the depth, which is linear along lines there.
struct ScreenPoint {
    float x, y, inverse_depth;
};

ScreenPoint between(const ScreenPoint& a, const ScreenPoint& b, float t) {
    return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), a.inverse_depth + t * (b.inverse_depth - a.inverse_depth)};
}

class Canvas {
  public:
    Canvas(Image& image, const Model& model, const Camera& camera, const VisibleLayer& opaque, int supersampling)
        : image_(image), model_(model), camera_(camera), opaque_(opaque), supersampling_(supersampling) {}

    void fade(float share) {
        for (std::uint8_t& c : image_.rgb) c = mixed(c, 255, share);
    }
    void draw(const OverlayLine& l) {
        if (const auto ends = project(model_point(l.from), model_point(l.to)))
            stroke(ends->first, ends->second, l.width, l.colour);
    }
    void draw(const OverlayArrow& a) {
        const Float3 from = model_point(a.at);
        const auto ends = project(from, from + a.length * to_float(a.direction));
        if (!ends) return;
        const auto& [tail, tip] = *ends;
        stroke(tail, tip, a.width, a.colour);
        const float dx = tip.x - tail.x, dy = tip.y - tail.y, length = std::hypot(dx, dy);
        if (!(length > 1)) return; // it points at the camera
        const float head = std::min(kArrowHead * length, kLargestHead) / length;
        for (const float side : {-0.5F, 0.5F})
            stroke(tip, {tip.x - head * (dx - side * dy), tip.y - head * (dy + side * dx), tip.inverse_depth}, a.width,
                   a.colour);
    }
    void draw(const OverlayDot& d) {
        const Float3 p = model_point(d.at);
        if (const auto ends = project(p, p)) stroke(ends->first, ends->first, 2 * d.radius, d.colour);
    }

  private:
    [[nodiscard]] Float3 model_point(const Vec3& world) const {
        return to_float((world - model_.origin) / model_.scale);
    }
    [[nodiscard]] ScreenPoint screen(Float3 p, float depth) const {
        const Float3 v = p - camera_.eye;
        const float u = dot(v, camera_.right) / depth, w = dot(v, camera_.up) / depth;
        const auto n = static_cast<float>(supersampling_);
        return {(0.5F * static_cast<float>(camera_.width) + camera_.focal * u) / n,
                (0.5F * static_cast<float>(camera_.height) - camera_.focal * w) / n, 1 / depth};
    }
    /// The part in front of the camera; nothing where there is none, or where it is far beside the picture.
    [[nodiscard]] std::optional<std::pair<ScreenPoint, ScreenPoint>> project(Float3 a, Float3 b) const {
        float depth_a = dot(a - camera_.eye, camera_.forward), depth_b = dot(b - camera_.eye, camera_.forward);
        if (!(std::max(depth_a, depth_b) > kNear)) return {};
        const auto cut = [](Float3& behind, float& depth, Float3 other, float other_depth) {
            if (depth >= kNear) return;
            behind = mix(behind, other, (kNear - depth) / (other_depth - depth));
            depth = kNear;
        };
        cut(a, depth_a, b, depth_b);
        cut(b, depth_b, a, depth_a);
        const ScreenPoint p = screen(a, depth_a), q = screen(b, depth_b);
        const bool there = std::max({std::abs(p.x), std::abs(p.y), std::abs(q.x), std::abs(q.y)}) < kFarthest;
        return there ? std::optional(std::pair(p, q)) : std::nullopt;
    }

    /// All points within half a width of the line from p to q.
    void stroke(const ScreenPoint& p, const ScreenPoint& q, float width, const OverlayColour& colour) {
        const float reach = 0.5F * width + 0.5F; // half a pixel of smooth edge
        const float dx = q.x - p.x, dy = q.y - p.y, length_sq = dx * dx + dy * dy;
        const auto [x0, x1] = pixels(p.x, q.x, reach, image_.width);
        const auto [y0, y1] = pixels(p.y, q.y, reach, image_.height);
        for (int y = y0; y <= y1; ++y)
            for (int x = x0; x <= x1; ++x) {
                const float cx = static_cast<float>(x) + 0.5F - p.x, cy = static_cast<float>(y) + 0.5F - p.y;
                const float t = length_sq > 0 ? std::clamp((cx * dx + cy * dy) / length_sq, 0.0F, 1.0F) : 0;
                const float coverage = reach - std::hypot(cx - t * dx, cy - t * dy);
                if (coverage > 0) blend(x, y, std::min(coverage, 1.0F), between(p, q, t).inverse_depth, colour);
            }
    }
    [[nodiscard]] static std::pair<int, int> pixels(float a, float b, float reach, int size) {
        return {std::max(0, static_cast<int>(std::floor(std::min(a, b) - reach))),
                std::min(size - 1, static_cast<int>(std::floor(std::max(a, b) + reach)))};
    }

    void blend(int x, int y, float coverage, float inverse_depth, const OverlayColour& colour) {
        const int sx = x * supersampling_ + supersampling_ / 2, sy = y * supersampling_ + supersampling_ / 2;
        const Index sample = static_cast<Index>(sy) * static_cast<Index>(camera_.width) + static_cast<Index>(sx);
        const bool hidden = !opaque_.inverse_depth.empty() && opaque_.inverse_depth[sample] > kInFront * inverse_depth;
        const Index pixel = 3 * (static_cast<Index>(y) * static_cast<Index>(image_.width) + static_cast<Index>(x));
        for (Index k = 0; k < 3; ++k)
            image_.rgb[pixel + k] = mixed(image_.rgb[pixel + k], colour[k], hidden ? kHidden * coverage : coverage);
    }
    [[nodiscard]] static std::uint8_t mixed(std::uint8_t from, std::uint8_t to, float share) {
        return static_cast<std::uint8_t>(static_cast<float>(from) +
                                         share * (static_cast<float>(to) - static_cast<float>(from)) + 0.5F);
    }

    Image& image_;
    const Model& model_;
    const Camera& camera_;
    const VisibleLayer& opaque_;
    int supersampling_;
};

} // namespace

void draw_overlay(Image& image, const Model& model, const Camera& camera, const VisibleLayer& opaque, int supersampling,
                  const Overlay& overlay) {
    Canvas canvas(image, model, camera, opaque, supersampling);
    if (overlay.fade > 0) canvas.fade(overlay.fade);
    for (const OverlayLine& line : overlay.lines) canvas.draw(line);
    for (const OverlayArrow& arrow : overlay.arrows) canvas.draw(arrow);
    for (const OverlayDot& dot : overlay.dots) canvas.draw(dot);
}

} // namespace flotilla::picture
