// SPDX-License-Identifier: MIT
#include "picture/light.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>

#include "base/rotation.hpp"
#include "picture/raster.hpp"

namespace flotilla::picture {
namespace {

using Index = std::size_t;

constexpr Float3 kSunColour{2.05F, 1.90F, 1.66F};
constexpr Float3 kZenithColour{0.74F, 0.86F, 1.06F};
constexpr Float3 kHorizonColour{0.98F, 0.98F, 0.98F};
constexpr double kSunElevation = 52; // degrees
constexpr double kSunBeside = 62;    // degrees to the left of the camera, so that shadows fall to the right and away
constexpr double kSunRadius = 1.6;   // degrees: wider than the real 0.27, for soft edges
constexpr int kSunMap = 2048, kSkyMap = 1024;
constexpr Index kGlassEvery = 2; // a body cut open is in every second shadow map: it takes half of the light

struct Light {
    Float3 direction; ///< unit, towards the light
    Float3 radiance;  ///< times the cosine gives irradiance
};

/// Points of a sunflower: the k-th of n, evenly over the unit disc.
struct DiscPoint {
    double x, y;
};
DiscPoint sunflower(int k, int n) {
    const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
    const double radius = std::sqrt((k + 0.5) / n);
    const SinCos angle = sin_cos(golden * k);
    return {radius * angle.cos, radius * angle.sin};
}

std::vector<Light> sun_lights(const Camera& camera, int count) {
    constexpr double degree = std::numbers::pi / 180;
    const SinCos tilt = sin_cos(kSunElevation * degree), aside = sin_cos(kSunBeside * degree);
    // Horizontal directions from the scene to the camera and to its left.
    const Float3 left = -camera.right, towards = normalized(cross(camera.right, Float3{0, 0, 1}));
    const Float3 back = dot(towards, camera.forward) > 0 ? -towards : towards;
    const Float3 flat = static_cast<float>(aside.cos) * back + static_cast<float>(aside.sin) * left;
    const Float3 middle = static_cast<float>(tilt.cos) * flat + Float3{0, 0, static_cast<float>(tilt.sin)};
    const Float3 u = normalized(cross(middle, {0, 0, 1})), v = cross(middle, u);
    std::vector<Light> lights;
    for (int k = 0; k < count; ++k) {
        const DiscPoint p = sunflower(k, count);
        const auto spread = static_cast<float>(kSunRadius * degree);
        const Float3 d = middle + spread * (static_cast<float>(p.x) * u + static_cast<float>(p.y) * v);
        lights.push_back({normalized(d), (1 / static_cast<float>(count)) * kSunColour});
    }
    return lights;
}

/// Directions over the upper hemisphere with density proportional to the cosine from the zenith (the disc lifted onto
/// the sphere). A light's radiance is divided by that density, so that a level surface in the open receives the mean
/// sky colour, and limited near the horizon where the density vanishes.
std::vector<Light> sky_lights(int count) {
    std::vector<Light> lights;
    for (int k = 0; k < count; ++k) {
        const DiscPoint p = sunflower(k, count);
        const double z = std::sqrt(std::max(0.0, 1 - p.x * p.x - p.y * p.y));
        const auto height = static_cast<float>(std::max(z, 0.2));
        const Float3 colour = mix(kHorizonColour, kZenithColour, height);
        lights.push_back({to_float({p.x, p.y, z}), (1 / (height * static_cast<float>(count))) * colour});
    }
    return lights;
}

/// 256 points of the unit disc in an order without pattern, for jitter.
class Jitter {
  public:
    Jitter() {
        for (int k = 0; k < 256; ++k) {
            const DiscPoint p = sunflower((k * 149 + 71) % 256, 256);
            points_[static_cast<Index>(k)] = {static_cast<float>(p.x), static_cast<float>(p.y)};
        }
    }
    struct Point {
        float x, y;
    };
    [[nodiscard]] Point operator()(std::uint32_t surfel, std::uint32_t light) const {
        std::uint32_t h = surfel * 2654435769U + light * 2246822519U;
        h ^= h >> 15U;
        h *= 3266489917U;
        return points_[h >> 24U];
    }

  private:
    std::array<Point, 256> points_{};
};

/// Heights towards the light of the nearest casters, over the rectangle that everything in focus covers.
class ShadowMap {
  public:
    /// `spread`: half the angle to the neighbouring lights, radians. A light stands for the cone of that width: lookups
    /// are scattered over its footprint, so that the shadows of single lights melt into each other.
    ShadowMap(const Model& model, const std::vector<std::uint8_t>& casts, int size, float spread)
        : model_(model),
          casts_(casts),
          size_(size),
          spread_(spread),
          projected_(model.vertices.size()),
          height_(static_cast<Index>(size) * static_cast<Index>(size)),
          highest_(static_cast<Index>(size / kTile) * static_cast<Index>(size / kTile)) {}

    void draw(Float3 direction, bool with_glass) {
        aim(direction);
        std::ranges::fill(height_, -std::numeric_limits<float>::infinity());
        for (Index i = 0; i < model_.bodies.size(); ++i)
            if (casts_[i] != 0 && (with_glass || model_.bodies[i].glass.empty())) draw_body(model_.bodies[i]);
        find_highest();
    }

    /// Share of the light that reaches a point. The point is lifted off its surface by 1.5 texels, which keeps a
    /// surface seen at any slant out of its own shadow: the farthest of the four texels looked at is 1.41 away.
    [[nodiscard]] float visibility(const Surfel& s, float cosine, Jitter::Point jitter) const {
        Float3 p = s.position + (1.5F * texel_) * s.face_normal;
        float x = (dot(p, u_) - low_u_) * inv_texel_ - 0.5F, y = (dot(p, v_) - low_v_) * inv_texel_ - 0.5F;
        if (!inside(x) || !inside(y)) return 1;
        float h = dot(p, direction_) + 0.5F * texel_;
        const float rise = highest_[tile(static_cast<int>(x), static_cast<int>(y))] - h;
        if (rise <= 0) return 1; // nothing above anywhere near
        // Scattered within the surface's own plane, or it would shade itself.
        const float radius = std::min(spread_ * rise, kWidestScatter * texel_);
        const float du = radius * jitter.x, dv = radius * jitter.y;
        x += du * inv_texel_;
        y += dv * inv_texel_;
        if (!inside(x) || !inside(y)) return 1;
        h +=
            kCurvature * radius - (du * dot(u_, s.face_normal) + dv * dot(v_, s.face_normal)) / std::max(cosine, 0.05F);
        return lit_share(x, y, h);
    }

  private:
    static constexpr int kTile = 32;               // texels
    static constexpr float kWidestScatter = 10.0F; // texels: below kTile, so that `highest_` covers it

    static constexpr float kCurvature = 0.15F; // how far a hollow surface may rise above its plane, per radius

    [[nodiscard]] bool inside(float x) const { return x >= 0 && x < static_cast<float>(size_ - 1); }
    [[nodiscard]] Index tile(int x, int y) const {
        return static_cast<Index>(y / kTile) * static_cast<Index>(size_ / kTile) + static_cast<Index>(x / kTile);
    }

    /// Of the four nearest texels, weighted by distance.
    [[nodiscard]] float lit_share(float x, float y, float h) const {
        const int column = static_cast<int>(x), row = static_cast<int>(y);
        const float fx = x - static_cast<float>(column), fy = y - static_cast<float>(row);
        const float* t =
            height_.data() + static_cast<Index>(row) * static_cast<Index>(size_) + static_cast<Index>(column);
        const auto lit = [h](float caster) { return caster <= h ? 1.0F : 0.0F; };
        const float lower = lit(t[0]) * (1 - fx) + lit(t[1]) * fx;
        const float upper = lit(t[size_]) * (1 - fx) + lit(t[size_ + 1]) * fx;
        return lower * (1 - fy) + upper * fy;
    }

    /// The largest height in each tile and its eight neighbours.
    void find_highest() {
        const int tiles = size_ / kTile;
        std::vector<float> own(highest_.size(), -std::numeric_limits<float>::infinity());
        for (int y = 0; y < size_; ++y)
            for (int x = 0; x < size_; ++x) {
                float& high = own[tile(x, y)];
                high =
                    std::max(high, height_[static_cast<Index>(y) * static_cast<Index>(size_) + static_cast<Index>(x)]);
            }
        for (int y = 0; y < tiles; ++y)
            for (int x = 0; x < tiles; ++x) {
                float high = -std::numeric_limits<float>::infinity();
                for (int ny = std::max(y - 1, 0); ny <= std::min(y + 1, tiles - 1); ++ny)
                    for (int nx = std::max(x - 1, 0); nx <= std::min(x + 1, tiles - 1); ++nx)
                        high = std::max(
                            high, own[static_cast<Index>(ny) * static_cast<Index>(tiles) + static_cast<Index>(nx)]);
                highest_[static_cast<Index>(y) * static_cast<Index>(tiles) + static_cast<Index>(x)] = high;
            }
    }

    /// Chooses the map's axes and the smallest square around what is in focus.
    void aim(Float3 direction) {
        direction_ = direction;
        u_ = normalized(cross(std::abs(direction.z) > 0.9F ? Float3{0, 1, 0} : Float3{0, 0, 1}, direction));
        v_ = cross(direction, u_);
        constexpr float infinity = std::numeric_limits<float>::infinity();
        float high_u = -infinity, high_v = -infinity;
        low_u_ = low_v_ = infinity;
        for (const BodyData& body : model_.bodies) {
            if (!body.in_focus) continue;
            for (Float3 p : model_.vertices_of(body)) {
                const float a = dot(p, u_), b = dot(p, v_);
                low_u_ = std::min(low_u_, a), high_u = std::max(high_u, a);
                low_v_ = std::min(low_v_, b), high_v = std::max(high_v, b);
            }
        }
        if (!(low_u_ <= high_u)) low_u_ = low_v_ = -1, high_u = high_v = 1;
        texel_ = std::max({high_u - low_u_, high_v - low_v_, 1e-6F}) / static_cast<float>(size_ - 4);
        inv_texel_ = 1 / texel_;
        low_u_ -= 2 * texel_;
        low_v_ -= 2 * texel_;
    }

    void draw_body(const BodyData& body) {
        const std::span<const Float3> vertices = model_.vertices_of(body);
        for (Index i = 0; i < vertices.size(); ++i) {
            const Float3 p = vertices[i];
            projected_[i] = {(dot(p, u_) - low_u_) * inv_texel_, (dot(p, v_) - low_v_) * inv_texel_,
                             dot(p, direction_)};
        }
        const auto put = [this](int y, int x0, int x1, float height, float slope) {
            float* row = height_.data() + static_cast<Index>(y) * static_cast<Index>(size_);
            for (int x = x0; x <= x1; ++x) row[x] = std::max(row[x], height + slope * static_cast<float>(x - x0));
        };
        const TriangleMesh& mesh = model_.mesh(body);
        for (const Triangle& t : mesh.triangles)
            rasterize(projected_[static_cast<Index>(t[0])], projected_[static_cast<Index>(t[1])],
                      projected_[static_cast<Index>(t[2])], size_, size_, put);
    }

    const Model& model_;
    const std::vector<std::uint8_t>& casts_;
    int size_;
    float spread_;
    Float3 direction_, u_, v_;
    float low_u_ = 0, low_v_ = 0, texel_ = 1, inv_texel_ = 1;
    std::vector<ScreenVertex> projected_; ///< of one body
    std::vector<float> height_;
    std::vector<float> highest_; ///< per tile of kTile x kTile texels
};

/// All light comes from above: a floor below everything in focus shades nothing that matters.
std::vector<std::uint8_t> find_casters(const Model& model) {
    std::vector<std::uint8_t> casts;
    const float floor = model.floor + 1e-3F * model.focus_radius;
    for (const BodyData& body : model.bodies)
        casts.push_back(std::ranges::any_of(model.vertices_of(body), [&](Float3 p) { return p.z > floor; }) ? 1 : 0);
    return casts;
}

template <class Add>
void shine(ShadowMap& map, const std::vector<Light>& lights, const std::vector<Surfel>& surfels, Add&& add) {
    static const Jitter jitter;
    for (std::uint32_t k = 0; k < lights.size(); ++k) {
        map.draw(lights[k].direction, k % kGlassEvery == 0);
        for (std::uint32_t i = 0; i < surfels.size(); ++i) {
            const Surfel& s = surfels[i];
            const float cosine = dot(s.smooth_normal, lights[k].direction);
            const float face_cosine = dot(s.face_normal, lights[k].direction);
            if (cosine <= 0 || face_cosine <= 0) continue;
            const float visible = map.visibility(s, face_cosine, jitter(i, k));
            if (visible > 0) add(i, (visible * cosine) * lights[k].radiance);
        }
    }
}

} // namespace

std::vector<Irradiance> light_surfels(const Model& model, const Camera& camera, const std::vector<Surfel>& surfels,
                                      const PictureOptions& options) {
    std::vector<Irradiance> light(surfels.size());
    const std::vector<std::uint8_t> casts = find_casters(model);
    // Half the distance of neighbours when n lights share a disc (the sun) or a hemisphere (the sky).
    const auto sun_spread = static_cast<float>(kSunRadius * std::numbers::pi / 180 / std::sqrt(options.sun_samples));
    const auto sky_spread = static_cast<float>(std::sqrt(2.0 / options.sky_samples));
    ShadowMap sun(model, casts, kSunMap, sun_spread);
    shine(sun, sun_lights(camera, options.sun_samples), surfels, [&](Index i, Float3 e) { light[i].sun += e; });
    ShadowMap sky(model, casts, kSkyMap, sky_spread);
    shine(sky, sky_lights(options.sky_samples), surfels, [&](Index i, Float3 e) { light[i].sky += e; });
    return light;
}

} // namespace flotilla::picture
