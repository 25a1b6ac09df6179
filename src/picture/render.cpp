// SPDX-License-Identifier: MIT
#include "picture/render.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <flotilla/error.hpp>

#include "base/rotation.hpp"
#include "picture/camera.hpp"
#include "picture/draw_overlay.hpp"
#include "picture/light.hpp"
#include "picture/model.hpp"
#include "picture/shade.hpp"

namespace flotilla {
namespace {

class Problems {
  public:
    void add(bool wrong, const std::string& text) {
        if (!wrong) return;
        if (!text_.empty()) text_ += '\n';
        text_ += "picture: ";
        text_ += text;
    }
    template <class T>
    void range(const char* name, T value, T low, T high) {
        add(!(value >= low && value <= high), std::string(name) + " is " + std::to_string(value) + ", must be " +
                                                  std::to_string(low) + " to " + std::to_string(high));
    }
    void raise() const {
        if (!text_.empty()) throw InputError(text_);
    }

  private:
    std::string text_;
};

void check_options(Problems& problems, const PictureOptions& o) {
    problems.range("width", o.width, 16, 16384);
    problems.range("height", o.height, 16, 16384);
    problems.range("supersampling", o.supersampling, 1, 4);
    problems.range("azimuth", o.azimuth, -3600.0, 3600.0);
    problems.range("elevation", o.elevation, -89.9, 89.9);
    problems.range("field of view", o.field_of_view, 1.0, 120.0);
    problems.range("zoom", o.zoom, 1e-3, 1e3);
    problems.range("sun samples", o.sun_samples, 1, 64);
    problems.range("sky samples", o.sky_samples, 1, 256);
    problems.range("outlines", o.outlines, 0.0, 1.0);
    problems.add(o.target && !is_finite(*o.target), "the target is not finite");
}

/// Coordinates above this overflow when the scene's size is squared.
constexpr double kLargest = 1e120;

bool usable(const Vec3& v) { return max_component(abs(v)) <= kLargest && is_finite(v); }

bool valid(const TriangleMesh& mesh) {
    const auto count = static_cast<std::int64_t>(mesh.vertices.size());
    return std::ranges::all_of(mesh.vertices, usable) && std::ranges::all_of(mesh.triangles, [&](const Triangle& t) {
               return std::ranges::all_of(t, [&](std::int32_t i) { return i >= 0 && i < count; });
           });
}

void check_bodies(Problems& problems, std::span<const PictureBody> bodies) {
    const TriangleMesh* last_good = nullptr; // bodies of one mesh usually follow each other
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const PictureBody& b = bodies[i];
        const std::string name = "body " + std::to_string(i);
        problems.add(!usable(b.position), name + ": its position is not finite, or too far away");
        const double n = norm(b.rotation);
        problems.add(!(n > 0 && std::isfinite(n)), name + ": its rotation is not finite, or zero");
        problems.add(b.mesh == nullptr, name + " has no mesh");
        if (b.mesh == nullptr || b.mesh == last_good) continue;
        const bool good = valid(*b.mesh);
        problems.add(!good, name + ": its mesh has vertices that are not finite or triangles without vertices");
        if (good) last_good = b.mesh;
    }
}

void check(std::span<const PictureBody> bodies, std::span<const PictureBody> seen, const PictureOptions& options) {
    Problems problems;
    check_options(problems, options);
    check_bodies(problems, bodies);
    if (seen.data() != bodies.data()) check_bodies(problems, seen);
    problems.raise();
}

/// The camera that fits `seen`, as `model` sees it.
picture::Camera fitted_to(std::span<const PictureBody> seen, picture::Model& model, const PictureOptions& options) {
    const picture::Model other = picture::build_model(seen);
    picture::Camera camera = picture::make_camera(other, options);
    const Vec3 eye{camera.eye.x, camera.eye.y, camera.eye.z};
    const Vec3 offset = (other.origin - model.origin) / model.scale;
    // The colour of what does not move depends on what the picture is about, too.
    for (std::size_t i = 0; i < std::min(model.bodies.size(), seen.size()); ++i)
        model.bodies[i].colour = other.bodies[i].colour;
    camera.eye = picture::to_float((other.scale / model.scale) * eye + offset);
    return camera;
}

Image draw(picture::Model& model, const picture::Camera& camera, const PictureOptions& options,
           const Overlay* overlay = nullptr) {
    picture::cut_open(model, camera.eye);
    const picture::VisibleLayer opaque = find_visible(model, camera, picture::Surfaces::opaque);
    const picture::VisibleLayer glass = find_visible(model, camera, picture::Surfaces::glass);
    const picture::Surface surface = find_surface(model, camera, opaque, options.supersampling);
    const std::vector<picture::Irradiance> light = light_surfels(model, camera, surface.surfels, options);
    Image image = compose(model, camera, opaque, glass, surface, light, options);
    if (overlay != nullptr) draw_overlay(image, model, camera, opaque, options.supersampling, *overlay);
    return image;
}

} // namespace

Image render(std::span<const PictureBody> bodies, const PictureOptions& options) {
    return render(bodies, bodies, options);
}

Image render(std::span<const PictureBody> bodies, std::span<const PictureBody> seen, const PictureOptions& options) {
    check(bodies, seen, options);
    picture::Model model = picture::build_model(bodies);
    const bool same = seen.data() == bodies.data();
    return draw(model, same ? picture::make_camera(model, options) : fitted_to(seen, model, options), options);
}

Image render(std::span<const PictureBody> bodies, const PictureOptions& options, const Overlay& overlay) {
    check(bodies, bodies, options);
    picture::Model model = picture::build_model(bodies);
    return draw(model, picture::make_camera(model, options), options, &overlay);
}

} // namespace flotilla
