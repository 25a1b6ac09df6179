// SPDX-License-Identifier: MIT
// flotilla_ode: a scene simulated by the Open Dynamics Engine (ode.org), its quick step (solver "sweeps") or its exact
// one ("pivots"). Friction is a pyramid; with "-sliding" it acts against the sliding alone once that is faster than
// what gravity adds in a step.
//  - trimesh: triangle mesh against triangle mesh. Meshes have no thickness there: contacts are where triangles
//    intersect already.
//  - primitives: what meshes stand for (primitives.hpp): boxes, spheres, cylinders, planes, convex solids; thin boxes
//    of the panels' thickness for movable plates.
// --gap is ignored.
#include <ode/ode.h>

#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "base/rotation.hpp"
#include "base/vec3.hpp"
#include "engine.hpp"

namespace {

using namespace flotilla;
using namespace flotilla::baseline;

/// ODE keeps pointers into these arrays.
struct MeshData {
    std::vector<double> vertices;
    std::vector<std::uint32_t> indices;
    dTriMeshDataID data = nullptr;
};

/// The same of dCreateConvex.
struct ConvexData {
    std::vector<dReal> planes, points;
    std::vector<unsigned> polygons;
    unsigned faces = 0;
};

/// What a contact needs to know of a geometry's body.
struct Surface {
    double friction = 0, restitution = 0;
};

dReal real(double value) { return static_cast<dReal>(value); }
Vec3 vector(const dReal* v) { return {v[0], v[1], v[2]}; }

class Ode final : public Engine {
  public:
    Ode(const EngineScene& scene, const EngineArguments& arguments)
        : scene_(scene),
          exact_(arguments.solver.starts_with("pivots")),
          along_sliding_(arguments.solver.ends_with("-sliding")),
          dt_(arguments.dt),
          thickness_(arguments.panel_thickness),
          primitives_(arguments.shape == kPrimitives) {
        dInitODE2(0);
        world_ = dWorldCreate();
        space_ = dHashSpaceCreate(nullptr);
        contacts_ = dJointGroupCreate(0);
        const Vec3& g = scene.description.gravity;
        dWorldSetGravity(world_, real(g.x), real(g.y), real(g.z));
        if (arguments.iterations > 0) dWorldSetQuickStepNumIterations(world_, arguments.iterations);
        make_meshes();
        surfaces_.resize(scene.description.bodies.size());
        for (std::size_t i = 0; i < surfaces_.size(); ++i) add(i);
    }
    ~Ode() override {
        dJointGroupDestroy(contacts_);
        dSpaceDestroy(space_);
        dWorldDestroy(world_);
        for (const auto& mesh : meshes_) dGeomTriMeshDataDestroy(mesh->data);
        dCloseODE();
    }

    void step(double dt) override {
        dSpaceCollide(space_, this, &Ode::near);
        if (exact_)
            dWorldStep(world_, real(dt));
        else
            dWorldQuickStep(world_, real(dt));
        dJointGroupEmpty(contacts_);
    }

    [[nodiscard]] std::vector<PoseRow> rows() const override {
        std::vector<PoseRow> out;
        for (std::size_t i = 0; i < geoms_.size(); ++i) {
            const auto shape = static_cast<std::size_t>(scene_.description.bodies[i].shape);
            if (dGeomGetClass(geoms_[i]) == dPlaneClass) { // has no pose
                const BodyDescription& plane = scene_.description.bodies[i];
                out.push_back({plane.position, plane.rotation, {}, {}});
                continue;
            }
            dQuaternion q;
            dGeomGetQuaternion(geoms_[i], q);
            const Frame frame =
                mesh_frame({vector(dGeomGetPosition(geoms_[i])), {q[0], q[1], q[2], q[3]}}, scene_.masses[shape]);
            const dBodyID body = dGeomGetBody(geoms_[i]);
            out.push_back({frame.position, frame.rotation, body != nullptr ? vector(dBodyGetLinearVel(body)) : Vec3{},
                           body != nullptr ? vector(dBodyGetAngularVel(body)) : Vec3{}});
        }
        return out;
    }

  private:
    void make_meshes() {
        for (std::size_t s = 0; s < scene_.description.shapes.size(); ++s) {
            auto mesh = std::make_unique<MeshData>();
            for (const Vec3& v : vertices_about_mass(scene_.description.shapes[s], scene_.masses[s]))
                mesh->vertices.insert(mesh->vertices.end(), {v.x, v.y, v.z});
            for (const Triangle& t : scene_.description.shapes[s].triangles)
                for (const std::int32_t v : t) mesh->indices.push_back(static_cast<std::uint32_t>(v));
            mesh->data = dGeomTriMeshDataCreate();
            dGeomTriMeshDataBuildDouble(mesh->data, mesh->vertices.data(), 3 * sizeof(double),
                                        static_cast<int>(mesh->vertices.size() / 3), mesh->indices.data(),
                                        static_cast<int>(mesh->indices.size()), 3 * sizeof(std::uint32_t));
            meshes_.push_back(std::move(mesh));
        }
    }

    dGeomID make_convex(std::size_t shape) {
        auto data = std::make_unique<ConvexData>();
        const ShapeDescription& description = scene_.description.shapes[shape];
        const std::vector<Vec3> vertices = vertices_about_mass(description, scene_.masses[shape]);
        for (const Vec3& v : vertices) data->points.insert(data->points.end(), {real(v.x), real(v.y), real(v.z)});
        for (const Face& face : convex_faces(vertices, description.triangles)) {
            const Vec3 &n = face.normal, &on = vertices[static_cast<std::size_t>(face.corners[0])];
            data->planes.insert(data->planes.end(), {real(n.x), real(n.y), real(n.z), real(dot(n, on))});
            data->polygons.push_back(static_cast<unsigned>(face.corners.size()));
            for (const std::int32_t c : face.corners) data->polygons.push_back(static_cast<unsigned>(c));
            ++data->faces;
        }
        convex_.push_back(std::move(data));
        ConvexData& d = *convex_.back();
        return dCreateConvex(space_, d.planes.data(), d.faces, d.points.data(), static_cast<unsigned>(vertices.size()),
                             d.polygons.data());
    }

    dGeomID make_geom(const BodyDescription& body) {
        const auto shape = static_cast<std::size_t>(body.shape);
        const Primitive& p = scene_.primitives[shape];
        const Vec3& s = p.size;
        const bool movable = body.type == BodyType::dynamic;
        switch (p.kind) {
        case Primitive::Kind::plate: {
            if (movable) return dCreateBox(space_, real(s.x), real(s.y), real(thickness_));
            const Vec3 up = rotate(body.rotation, {0, 0, 1});
            return dCreatePlane(space_, real(up.x), real(up.y), real(up.z), real(dot(up, body.position)));
        }
        case Primitive::Kind::box: return dCreateBox(space_, real(s.x), real(s.y), real(s.z));
        case Primitive::Kind::sphere: return dCreateSphere(space_, real(s.x / 2));
        case Primitive::Kind::cylinder: return dCreateCylinder(space_, real(s.x / 2), real(s.z));
        case Primitive::Kind::convex: return make_convex(shape);
        case Primitive::Kind::mesh: break;
        }
        return dCreateTriMesh(space_, meshes_[shape]->data, nullptr, nullptr, nullptr);
    }

    void add(std::size_t index) {
        const BodyDescription& description = scene_.description.bodies[index];
        const auto shape = static_cast<std::size_t>(description.shape);
        const auto& mass = scene_.masses[shape];
        const dGeomID geom = make_geom(description);
        surfaces_[index] = {description.friction, description.restitution};
        dGeomSetData(geom, &surfaces_[index]);
        if (description.type == BodyType::dynamic) {
            const dBodyID body = dBodyCreate(world_);
            const Vec3& i = mass->principal_inertia;
            dMass m;
            dMassSetParameters(&m, real(mass->mass), 0, 0, 0, real(i.x), real(i.y), real(i.z), 0, 0, 0);
            dBodySetMass(body, &m);
            if (primitives_) dBodySetFiniteRotationMode(body, 1);
            dGeomSetBody(geom, body);
            const Vec3 &v = description.velocity, &w = description.angular_velocity;
            dBodySetLinearVel(body, real(v.x), real(v.y), real(v.z));
            dBodySetAngularVel(body, real(w.x), real(w.y), real(w.z));
        }
        geoms_.push_back(geom);
        if (dGeomGetClass(geom) == dPlaneClass) return;
        const Frame frame = mass_frame(description, mass);
        const dQuaternion q = {real(frame.rotation.w), real(frame.rotation.x), real(frame.rotation.y),
                               real(frame.rotation.z)};
        dGeomSetPosition(geom, real(frame.position.x), real(frame.position.y), real(frame.position.z));
        dGeomSetQuaternion(geom, q);
    }

    static void near(void* self, dGeomID a, dGeomID b) { static_cast<Ode*>(self)->collide(a, b); }

    void collide(dGeomID a, dGeomID b) {
        if (dGeomGetBody(a) == nullptr && dGeomGetBody(b) == nullptr) return;
        constexpr int kMostContacts = 64;
        std::array<dContact, kMostContacts> found; // NOLINT: filled by dCollide
        const int count = dCollide(a, b, kMostContacts, &found[0].geom, sizeof(dContact));
        const auto& p = *static_cast<const Surface*>(dGeomGetData(a));
        const auto& q = *static_cast<const Surface*>(dGeomGetData(b));
        for (int k = 0; k < count; ++k) {
            dContact& contact = found[static_cast<std::size_t>(k)];
            contact.surface = {};
            contact.surface.mode = dContactBounce | dContactApprox1;
            contact.surface.mu = real(std::sqrt(p.friction * q.friction));
            contact.surface.bounce = real(std::sqrt(p.restitution * q.restitution));
            if (along_sliding_) turn_to_sliding(a, b, contact);
            dJointAttach(dJointCreateContact(world_, contacts_, &contact), dGeomGetBody(a), dGeomGetBody(b));
        }
    }

    /// What still may stick keeps its pyramid.
    void turn_to_sliding(dGeomID a, dGeomID b, dContact& contact) const {
        const Vec3 at = vector(contact.geom.pos), normal = vector(contact.geom.normal);
        Vec3 slide;
        for (const double sign : {1.0, -1.0}) {
            const dBodyID body = dGeomGetBody(sign > 0 ? a : b);
            if (body == nullptr) continue;
            const Vec3 arm = at - vector(dBodyGetPosition(body));
            slide += sign * (vector(dBodyGetLinearVel(body)) + cross(vector(dBodyGetAngularVel(body)), arm));
        }
        slide -= dot(slide, normal) * normal;
        const double speed = length(slide);
        if (!(speed > length(scene_.description.gravity) * dt_)) return;
        contact.surface.mode |= dContactFDir1 | dContactMu2;
        contact.surface.mu2 = 0;
        contact.fdir1[0] = real(slide.x / speed), contact.fdir1[1] = real(slide.y / speed),
        contact.fdir1[2] = real(slide.z / speed);
    }

    const EngineScene& scene_;
    bool exact_, along_sliding_;
    double dt_;        ///< s
    double thickness_; ///< m
    bool primitives_;
    dWorldID world_ = nullptr;
    dSpaceID space_ = nullptr;
    dJointGroupID contacts_ = nullptr;
    std::vector<std::unique_ptr<MeshData>> meshes_;
    std::vector<std::unique_ptr<ConvexData>> convex_;
    std::vector<Surface> surfaces_;
    std::vector<dGeomID> geoms_;
};

} // namespace

int main(int argc, char** argv) {
    return run_engine(argc, argv, "flotilla_ode", {"trimesh", kPrimitives},
                      {"sweeps", "sweeps-sliding", "pivots", "pivots-sliding"},
                      [](const auto& scene, const auto& arguments) { return std::make_unique<Ode>(scene, arguments); });
}
