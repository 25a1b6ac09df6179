// SPDX-License-Identifier: MIT
#include "static_contact/thin_bodies.hpp"

#include <algorithm>

#include "base/index.hpp"
#include "state/feature_pair.hpp"

namespace flotilla {

bool is_thin_pair(const Model& model, std::int32_t a, std::int32_t b, double friction, double rest) {
    const auto thin = [&](std::int32_t body) {
        const RigidShape& shape = model.shape_of(at(body));
        const Vec3& moments = shape.principal.moments;
        return model.bodies[at(body)].dynamic() &&
               std::min({moments.x, moments.y, moments.z}) < shape.mass * (rest * rest);
    };
    return friction > 0 && (thin(a) || thin(b));
}

Contact with_two_points(Contact contact) {
    contact.across = contact.distance * contact.normal;
    if (features_of(contact.feature_key).kind == FeatureKind::face_vertex)
        contact.point -= contact.across; // that was the vertex of b
    return contact;
}

} // namespace flotilla
