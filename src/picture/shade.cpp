// SPDX-License-Identifier: MIT
#include "picture/shade.hpp"

#include <algorithm>
#include <array>

#include "base/rotation.hpp"

namespace flotilla::picture {
namespace {

using Index = std::size_t;

struct Corners {
    Float3 a, b, c;
};

Corners corners(const Model& model, std::uint32_t body, std::uint32_t triangle) {
    const std::span<const Float3> v = model.vertices_of(model.bodies[body]);
    const Triangle& t = model.mesh(model.bodies[body]).triangles[triangle];
    return {v[static_cast<Index>(t[0])], v[static_cast<Index>(t[1])], v[static_cast<Index>(t[2])]};
}

/// The interpolated corner normals at p, in world axes.
Float3 smooth_normal(const Model& model, std::uint32_t body, std::uint32_t triangle, const Corners& k, Float3 p) {
    const Float3 e = k.b - k.a, f = k.c - k.a, n = cross(e, f);
    const float area = dot(n, n);
    const float s = area > 0 ? dot(cross(p - k.a, f), n) / area : 0;
    const float t = area > 0 ? dot(cross(e, p - k.a), n) / area : 0;
    const BodyData& b = model.bodies[body];
    const Float3* corner = &model.meshes[b.mesh].corner_normals[3 * static_cast<Index>(triangle)];
    const Float3 local = (1 - s - t) * corner[0] + (s * corner[1] + t * corner[2]);
    return normalized(to_float(rotate(b.rotation, Vec3{local.x, local.y, local.z})));
}

Surfel surfel_at(const Model& model, std::uint32_t body, std::uint32_t triangle, Float3 ray, Float3 position) {
    const Corners k = corners(model, body, triangle);
    Float3 n = normalized(cross(k.b - k.a, k.c - k.a));
    Surfel s{.position = position, .face_normal = n, .smooth_normal = {}, .body = body, .inner = false};
    const bool back = dot(n, ray) > 0;
    s.inner = back != model.meshes[model.bodies[body].mesh].inside_out;
    if (back) s.face_normal = n = -n;
    s.smooth_normal = smooth_normal(model, body, triangle, k, position);
    if (dot(s.smooth_normal, n) < 0) s.smooth_normal = -s.smooth_normal;
    return s;
}

bool nearly_same(const Surfel& a, const Surfel& b) {
    return a.body == b.body && a.inner == b.inner && dot(a.smooth_normal, b.smooth_normal) > 0.95F;
}

constexpr Float3 kBackdropTop{0.56F, 0.63F, 0.71F}, kBackdropBottom{0.86F, 0.88F, 0.89F};
constexpr Float3 kGlassColour{0.80F, 0.86F, 0.90F}, kLineColour{0.02F, 0.02F, 0.03F};
constexpr float kLinePixels = 45; // bodies that look smaller than this get fainter lines: they would be all line

/// Keeps hues of bright colours: linear up to the knee, then a curve that reaches 1 at infinity.
float soft_shoulder(float x) {
    constexpr float knee = 0.75F, rest = 1 - knee;
    return x <= knee ? x : knee + rest * (1 - std::exp(-(x - knee) / rest));
}

class Composer {
  public:
    Composer(const Model& model, const Camera& camera, const VisibleLayer& opaque, const VisibleLayer& glass,
             const Surface& surface, const std::vector<Irradiance>& light, const PictureOptions& options)
        : model_(model),
          camera_(camera),
          opaque_(opaque),
          glass_(glass),
          surface_(surface),
          light_(light),
          options_(options) {
        colours_.reserve(surface.surfels.size());
        for (Index i = 0; i < surface.surfels.size(); ++i) colours_.push_back(shade(surface.surfels[i], light[i]));
    }

    [[nodiscard]] Float3 sample(int x, int y) const {
        const Index i = index(x, y);
        const Float3 behind = backdrop(y);
        Float3 colour = behind;
        if (opaque_.body[i] != kNothing) {
            colour = colours_[surface_.of_sample[i]];
            const BodyData& body = model_.bodies[opaque_.body[i]];
            if (body.fixed && !body.in_focus)
                colour = mix(colour, behind, haze(x, y, i));
            else
                colour = mix(colour, kLineColour, line(x, y, i));
        }
        if (!glass_.body.empty() && glass_.inverse_depth[i] > opaque_.inverse_depth[i])
            colour = through_glass(x, y, i, colour);
        return colour;
    }

  private:
    [[nodiscard]] Index index(int x, int y) const {
        return static_cast<Index>(y) * static_cast<Index>(camera_.width) + static_cast<Index>(x);
    }
    [[nodiscard]] Float3 position(int x, int y, Index i) const {
        return camera_.eye + (1 / opaque_.inverse_depth[i]) * camera_.ray(x, y);
    }
    [[nodiscard]] Float3 backdrop(int y) const {
        return mix(kBackdropTop, kBackdropBottom, static_cast<float>(y) / static_cast<float>(camera_.height));
    }

    [[nodiscard]] Float3 shade(const Surfel& s, const Irradiance& e) const {
        Float3 albedo = model_.bodies[s.body].colour;
        // The inside of a hull: towards wood, so that both sides of a thin surface differ.
        if (s.inner && !model_.bodies[s.body].fixed) albedo = mix(albedo, Float3{0.60F, 0.45F, 0.29F}, 0.4F);
        // Light that bounced once from the floor and the neighbours: follows the sky that the place sees.
        const float bounce = 0.10F + 0.12F * (1 - s.smooth_normal.z) * 0.5F;
        const Float3 total =
            e.sun + (e.sky + (0.35F + dot(e.sky, {0.33F, 0.34F, 0.33F})) * (bounce * Float3{1.0F, 0.95F, 0.88F}));
        const Float3 c = 0.66F * (albedo * total);
        return {soft_shoulder(c.x), soft_shoulder(c.y), soft_shoulder(c.z)};
    }

    /// The endless floor fades into the backdrop.
    [[nodiscard]] float haze(int x, int y, Index i) const {
        const Float3 p = position(x, y, i);
        return smoothstep(1.3F, 4.5F, std::sqrt(p.x * p.x + p.y * p.y) / model_.focus_radius);
    }

    /// Strength of a dark line at a sample: it belongs to the surface in front of a jump in depth or of another body.
    [[nodiscard]] float line(int x, int y, Index i) const {
        const BodyData& body = model_.bodies[opaque_.body[i]];
        const float pixels =
            2 * body.radius * camera_.focal * opaque_.inverse_depth[i] / static_cast<float>(options_.supersampling);
        const float strength = static_cast<float>(options_.outlines) * std::min(1.0F, pixels / kLinePixels);
        constexpr std::array<std::array<int, 2>, 4> kAround{{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};
        for (const auto& [dx, dy] : kAround) {
            const int nx = x + dx, ny = y + dy;
            if (nx < 0 || ny < 0 || nx >= camera_.width || ny >= camera_.height) continue;
            const Index n = index(nx, ny);
            if (opaque_.body[n] != opaque_.body[i]) {
                if (opaque_.inverse_depth[n] < opaque_.inverse_depth[i]) return strength;
            } else if (surface_.of_sample[n] != surface_.of_sample[i] && jumps_behind(nx, ny, n, i, body)) {
                return 0.8F * strength;
            }
        }
        return 0;
    }

    /// Whether a neighbouring sample of the same body lies clearly behind this one's plane.
    [[nodiscard]] bool jumps_behind(int x, int y, Index neighbour, Index i, const BodyData& body) const {
        if (opaque_.inverse_depth[neighbour] >= opaque_.inverse_depth[i]) return false;
        const Surfel& s = surface_.surfels[surface_.of_sample[i]];
        const float gap = dot(s.position - position(x, y, neighbour), s.face_normal);
        const float behind = 1 / opaque_.inverse_depth[neighbour] - 1 / opaque_.inverse_depth[i];
        return gap > 0.04F * body.radius && behind > 0.08F * body.radius;
    }

    [[nodiscard]] Float3 through_glass(int x, int y, Index i, Float3 behind) const {
        const Corners k = corners(model_, glass_.body[i], glass_.triangle[i]);
        const Float3 ray = camera_.ray(x, y);
        const Float3 p = camera_.eye + (1 / glass_.inverse_depth[i]) * ray;
        const Float3 n = smooth_normal(model_, glass_.body[i], glass_.triangle[i], k, p);
        const float slant = 1 - std::min(1.0F, std::abs(dot(n, normalized(ray))));
        const float alpha = 0.10F + 0.45F * slant * slant * slant;
        const Float3 colour = mix(behind, kGlassColour, alpha);
        const bool rim = (x > 0 && glass_.body[i - 1] != glass_.body[i]) ||
                         (y > 0 && glass_.body[index(x, y - 1)] != glass_.body[i]) ||
                         (x + 1 < camera_.width && glass_.body[i + 1] != glass_.body[i]) ||
                         (y + 1 < camera_.height && glass_.body[index(x, y + 1)] != glass_.body[i]);
        return rim ? mix(colour, kLineColour, 0.7F * static_cast<float>(options_.outlines)) : colour;
    }

    const Model& model_;
    const Camera& camera_;
    const VisibleLayer& opaque_;
    const VisibleLayer& glass_;
    const Surface& surface_;
    const std::vector<Irradiance>& light_;
    const PictureOptions& options_;
    std::vector<Float3> colours_; ///< per surfel, linear, 0..1
};

std::uint8_t to_srgb(float linear) {
    const float c = std::clamp(linear, 0.0F, 1.0F);
    const float s = c <= 0.0031308F ? 12.92F * c : 1.055F * std::pow(c, 1 / 2.4F) - 0.055F;
    return static_cast<std::uint8_t>(s * 255 + 0.5F);
}

} // namespace

Surface find_surface(const Model& model, const Camera& camera, const VisibleLayer& opaque, int supersampling) {
    Surface surface;
    surface.of_sample.assign(opaque.body.size(), kNothing);
    for (int py = 0; py < camera.height; py += supersampling)
        for (int px = 0; px < camera.width; px += supersampling) {
            const Index first = surface.surfels.size();
            for (int y = py; y < py + supersampling; ++y)
                for (int x = px; x < px + supersampling; ++x) {
                    const Index i = static_cast<Index>(y) * static_cast<Index>(camera.width) + static_cast<Index>(x);
                    if (opaque.body[i] == kNothing) continue;
                    const Float3 ray = camera.ray(x, y);
                    const Float3 position = camera.eye + (1 / opaque.inverse_depth[i]) * ray;
                    const Surfel s = surfel_at(model, opaque.body[i], opaque.triangle[i], ray, position);
                    Index k = first;
                    while (k < surface.surfels.size() && !nearly_same(surface.surfels[k], s)) ++k;
                    if (k == surface.surfels.size()) surface.surfels.push_back(s);
                    surface.of_sample[i] = static_cast<std::uint32_t>(k);
                }
        }
    return surface;
}

Image compose(const Model& model, const Camera& camera, const VisibleLayer& opaque, const VisibleLayer& glass,
              const Surface& surface, const std::vector<Irradiance>& light, const PictureOptions& options) {
    const Composer composer(model, camera, opaque, glass, surface, light, options);
    Image image{.width = options.width, .height = options.height, .rgb = {}};
    image.rgb.reserve(3 * static_cast<Index>(options.width) * static_cast<Index>(options.height));
    const int n = options.supersampling;
    const float weight = 1 / static_cast<float>(n * n);
    for (int py = 0; py < options.height; ++py)
        for (int px = 0; px < options.width; ++px) {
            Float3 sum;
            for (int y = n * py; y < n * (py + 1); ++y)
                for (int x = n * px; x < n * (px + 1); ++x) sum += composer.sample(x, y);
            const Float3 c = weight * sum;
            image.rgb.insert(image.rgb.end(), {to_srgb(c.x), to_srgb(c.y), to_srgb(c.z)});
        }
    return image;
}

} // namespace flotilla::picture
