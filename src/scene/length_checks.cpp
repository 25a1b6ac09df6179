// SPDX-License-Identifier: MIT
#include "scene/length_checks.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/text.hpp"
#include "geometry/ccd.hpp"
#include "scene/description_checks.hpp"

namespace flotilla {
namespace {

/// Units of the last place of a coordinate that a rest distance must have: below, bodies cannot stop within it of each
/// other.
constexpr double kPlacesPerRest = 16;
/// Of continuous collision detection (ccd_floor): bodies rest at so many at least.
constexpr double kFloorsPerRest = 2;

class LengthChecks {
  public:
    LengthChecks(const Scene& scene, ErrorList& errors) : scene_(scene), errors_(errors) {
        for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
            if (scene.bodies[i].type != BodyType::dynamic) continue;
            if (!smallest_ || rest(i) < rest(*smallest_)) smallest_ = i;
            if (!largest_ || rest(i) > rest(*largest_)) largest_ = i;
            if (!least_size_ || size(i) < size(*least_size_)) least_size_ = i;
        }
    }

    void run() {
        if (!smallest_) return;
        check_separation();
        check_proximity();
        check_sizes();
        if (errors_.any_under("/settings")) return;
        check_places();
        check_triangles();
    }

  private:
    [[nodiscard]] const Shape& shape(std::size_t body) const {
        return scene_.shapes[static_cast<std::size_t>(scene_.bodies[body].shape)];
    }
    [[nodiscard]] double size(std::size_t body) const { return 2 * shape(body).sphere.radius; }
    [[nodiscard]] double rest(std::size_t body) const {
        return lengths_of_size(scene_.settings, shape(body).extent).rest;
    }
    [[nodiscard]] std::string name(std::size_t body) const { return "body " + in_quotes(scene_.bodies[body].name); }

    void check_separation() {
        const double s = scene_.settings.separation;
        if (s > 0 && !(s < rest(*smallest_)))
            errors_.add("/settings/separation", "must be below the rest distance of " + name(*smallest_) + ", " +
                                                    to_text(rest(*smallest_)) + " m, got " + to_text(s) + " m");
    }

    void check_proximity() {
        const double p = scene_.settings.proximity_distance;
        if (p > 0 && !(p > rest(*largest_)))
            errors_.add("/settings/proximity_distance", "must exceed the rest distance of " + name(*largest_) + ", " +
                                                            to_text(rest(*largest_)) + " m, got " + to_text(p) + " m");
    }

    /// A body within the proximity distance of itself would rest with its far side on what its near side rests on.
    void check_sizes() {
        const Settings& s = scene_.settings;
        const double least = size(*least_size_);
        const auto check = [&](const char* key, double value, double limit) {
            if (value > 0 && !(value < limit) && !errors_.any_under(std::string("/settings/") + key))
                errors_.add(std::string("/settings/") + key, "must be below " + to_text(limit) + " m, as " +
                                                                 name(*least_size_) + " is " + to_text(least) +
                                                                 " m large, got " + to_text(value) + " m");
        };
        check("proximity_distance", s.proximity_distance, least);
        if (!(s.proximity_distance > 0)) check("rest_distance", s.rest_distance, least / kProximityPerRest);
    }

    void too_fine(std::size_t body, double least, const std::string& reason) {
        const std::string text = "rest distance " + to_text(rest(body)) + " m of " + name(body) + " (" +
                                 to_text(size(body)) + " m large) is below " + to_text(least) +
                                 " m, what doubles resolve " + reason;
        errors_.add(scene_.settings.rest_distance > 0 ? "/settings/rest_distance" : element_path("bodies", body), text);
    }

    /// m, of a body's centre of mass in the first step, should nothing be in its way.
    [[nodiscard]] double first_way(std::size_t body) const {
        const double dt = scene_.settings.time_step;
        const BodyDescription& b = scene_.bodies[body];
        const double force = shape(body).mass ? length(b.force) / shape(body).mass->mass : 0.0;
        return dt * (length(b.velocity) + dt * (length(scene_.gravity) + force));
    }

    void check_places() {
        for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
            if (scene_.bodies[i].type != BodyType::dynamic) continue;
            const double place = max_component(abs(world_center(scene_, scene_.bodies[i]))) + shape(i).radius;
            const double reach = place + first_way(i);
            const double least = kPlacesPerRest * 0x1p-52 * reach;
            if (rest(i) < least)
                return too_fine(i, least,
                                "at coordinates of " + to_text(reach) + " m" +
                                    (reach > 2 * place ? ", where its first step may lead: make steps shorter"
                                                       : ": bring the scene nearer to its origin"));
        }
    }

    void check_triangles() {
        std::optional<std::size_t> largest;
        const auto edge = [&](std::size_t body) { return shape(body).longest_edge; };
        for (std::size_t i = 0; i < scene_.bodies.size(); ++i)
            if (!largest || edge(i) > edge(*largest)) largest = i;
        const double least = kFloorsPerRest * ccd_floor(edge(*largest));
        if (rest(*smallest_) < least)
            too_fine(*smallest_, least,
                     "beside the triangles of " + name(*largest) + ", " + to_text(edge(*largest)) +
                         " m large: cut them into smaller ones");
    }

    const Scene& scene_;
    ErrorList& errors_;
    std::optional<std::size_t> smallest_, largest_; ///< dynamic bodies, by their rest distance
    std::optional<std::size_t> least_size_;         ///< by their bounding sphere
};

} // namespace

void check_lengths(const Scene& scene, ErrorList& errors) { LengthChecks(scene, errors).run(); }

} // namespace flotilla
