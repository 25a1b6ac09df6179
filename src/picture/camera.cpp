// SPDX-License-Identifier: MIT
#include "picture/camera.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>

#include "base/rotation.hpp"
#include "picture/raster.hpp"

namespace flotilla::picture {
namespace {

using Index = std::size_t;
constexpr float kNear = 1e-3F; // model units; the focus has radius 1 and the camera stands outside it

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

/// Along one screen axis: how far the eye must stand back, and where, so that every point p with coordinates (p, depth)
/// has |p - eye| <= slope * (depth - eye_depth). Each point bounds two lines; their envelope is kept as two maxima.
struct AxisFit {
    double slope;
    double right = -std::numeric_limits<double>::infinity(), left = right;
    void add(double p, double depth) {
        right = std::max(right, p - slope * depth);
        left = std::max(left, -p - slope * depth);
    }
    [[nodiscard]] double middle() const { return 0.5 * (right - left); }
    [[nodiscard]] double depth_at(double p) const { return std::min(p - right, -p - left) / slope; }
};

void place_eye(Camera& camera, const Model& model, const PictureOptions& options, double half_width,
               double half_height) {
    constexpr double kMargin = 0.94; // of the picture is used
    AxisFit horizontal{.slope = kMargin * half_width}, vertical{.slope = kMargin * half_height};
    const auto add = [&](Float3 p) {
        horizontal.add(dot(p, camera.right), dot(p, camera.forward));
        vertical.add(dot(p, camera.up), dot(p, camera.forward));
    };
    bool any = false;
    for (const BodyData& body : model.bodies)
        if (body.in_focus)
            for (Float3 p : model.vertices_of(body)) add(p), any = true;
    if (!any) add({1, 1, 1}), add({-1, -1, -1});
    double x = horizontal.middle(), y = vertical.middle();
    if (options.target) {
        const Float3 target = to_float((*options.target - model.origin) / model.scale);
        x = dot(target, camera.right);
        y = dot(target, camera.up);
    }
    const double depth = std::min({horizontal.depth_at(x), vertical.depth_at(y), -10.0 * kNear});
    camera.eye = static_cast<float>(x) * camera.right +
                 (static_cast<float>(y) * camera.up + static_cast<float>(depth) * camera.forward);
}

struct CameraVertex {
    float x, y, depth;
};

CameraVertex between(const CameraVertex& a, const CameraVertex& b, float t) {
    return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), a.depth + t * (b.depth - a.depth)};
}

/// Cuts a triangle at the near plane; returns the number of corners left (0, 3 or 4).
int clip_near(const std::array<CameraVertex, 3>& in, std::array<CameraVertex, 4>& out) {
    int count = 0;
    for (Index i = 0; i < 3; ++i) {
        const CameraVertex &a = in[i], &b = in[(i + 1) % 3];
        const bool a_in = a.depth >= kNear, b_in = b.depth >= kNear;
        if (a_in) out[static_cast<Index>(count++)] = a;
        if (a_in != b_in) {
            out[static_cast<Index>(count)] = between(a, b, (kNear - a.depth) / (b.depth - a.depth));
            out[static_cast<Index>(count++)].depth = kNear;
        }
    }
    return count;
}

void draw_body(const Model& model, std::uint32_t id, const Camera& camera, Surfaces kind,
               std::vector<CameraVertex>& seen, VisibleLayer& layer) {
    const BodyData& body = model.bodies[id];
    seen.clear();
    for (Float3 p : model.vertices_of(body)) {
        const Float3 d = p - camera.eye;
        seen.push_back({dot(d, camera.right), dot(d, camera.up), dot(d, camera.forward)});
    }
    const auto project = [&](const CameraVertex& v) {
        const float inverse = 1 / v.depth;
        return ScreenVertex{0.5F * static_cast<float>(camera.width) + camera.focal * v.x * inverse,
                            0.5F * static_cast<float>(camera.height) - camera.focal * v.y * inverse, inverse};
    };
    const TriangleMesh& mesh = model.mesh(body);
    for (std::uint32_t k = 0; k < mesh.triangles.size(); ++k) {
        const bool is_glass = !body.glass.empty() && body.glass[k] != 0;
        if (is_glass != (kind == Surfaces::glass)) continue;
        const Triangle& t = mesh.triangles[k];
        std::array<CameraVertex, 4> corner;
        const int corners = clip_near(
            {seen[static_cast<Index>(t[0])], seen[static_cast<Index>(t[1])], seen[static_cast<Index>(t[2])]}, corner);
        const auto put = [&](int y, int x0, int x1, float inverse_depth, float slope) {
            Index i = static_cast<Index>(y) * static_cast<Index>(camera.width) + static_cast<Index>(x0);
            for (int x = x0; x <= x1; ++x, ++i) {
                const float value = inverse_depth + slope * static_cast<float>(x - x0);
                if (value <= layer.inverse_depth[i]) continue;
                layer.inverse_depth[i] = value;
                layer.body[i] = id;
                layer.triangle[i] = k;
            }
        };
        for (Index c = 2; c < static_cast<Index>(corners); ++c)
            rasterize(project(corner[0]), project(corner[c - 1]), project(corner[c]), camera.width, camera.height, put);
    }
}

} // namespace

Camera make_camera(const Model& model, const PictureOptions& options) {
    const SinCos azimuth = sin_cos(radians(options.azimuth)), elevation = sin_cos(radians(options.elevation));
    Camera camera;
    camera.width = options.width * options.supersampling;
    camera.height = options.height * options.supersampling;
    camera.forward = to_float({-azimuth.cos * elevation.cos, -azimuth.sin * elevation.cos, -elevation.sin});
    camera.right = to_float({-azimuth.sin, azimuth.cos, 0});
    camera.up = cross(camera.right, camera.forward);
    const SinCos half_angle = sin_cos(radians(0.5 * options.field_of_view));
    const double half = half_angle.sin / half_angle.cos;
    const double longer = std::max(camera.width, camera.height);
    place_eye(camera, model, options, half * camera.width / longer, half * camera.height / longer);
    camera.focal = static_cast<float>(options.zoom * 0.5 * longer / half);
    return camera;
}

VisibleLayer find_visible(const Model& model, const Camera& camera, Surfaces kind) {
    VisibleLayer layer;
    const bool any_glass = std::ranges::any_of(model.bodies, [](const BodyData& b) { return !b.glass.empty(); });
    if (kind == Surfaces::glass && !any_glass) return layer;
    const Index samples = static_cast<Index>(camera.width) * static_cast<Index>(camera.height);
    layer.inverse_depth.assign(samples, 0);
    layer.body.assign(samples, kNothing);
    layer.triangle.assign(samples, 0);
    std::vector<CameraVertex> seen;
    for (std::uint32_t id = 0; id < model.bodies.size(); ++id)
        if (kind == Surfaces::opaque || !model.bodies[id].glass.empty())
            draw_body(model, id, camera, kind, seen, layer);
    return layer;
}

} // namespace flotilla::picture
