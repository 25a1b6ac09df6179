// SPDX-License-Identifier: MIT
// flotilla_ode: a scene simulated by the Open Dynamics Engine (ode.org), triangle mesh against triangle mesh, its quick step.
// Meshes have no thickness there: contacts are where triangles intersect already; --gap is ignored.
#include <ode/ode.h>

#include <cmath>
#include <memory>
#include <vector>

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

/// What a contact needs to know of a geometry's body.
struct Surface {
    double friction = 0, restitution = 0;
};

dReal real(double value) { return static_cast<dReal>(value); }
Vec3 vector(const dReal* v) { return {v[0], v[1], v[2]}; }

class Ode final : public Engine {
  public:
    Ode(const EngineScene& scene, const EngineArguments& arguments) : scene_(scene) {
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
        dWorldQuickStep(world_, real(dt));
        dJointGroupEmpty(contacts_);
    }

    [[nodiscard]] std::vector<PoseRow> rows() const override {
        std::vector<PoseRow> out;
        for (std::size_t i = 0; i < geoms_.size(); ++i) {
            const auto shape = static_cast<std::size_t>(scene_.description.bodies[i].shape);
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

    void add(std::size_t index) {
        const BodyDescription& description = scene_.description.bodies[index];
        const auto shape = static_cast<std::size_t>(description.shape);
        const auto& mass = scene_.masses[shape];
        const dGeomID geom = dCreateTriMesh(space_, meshes_[shape]->data, nullptr, nullptr, nullptr);
        surfaces_[index] = {description.friction, description.restitution};
        dGeomSetData(geom, &surfaces_[index]);
        if (description.type == BodyType::dynamic) {
            const dBodyID body = dBodyCreate(world_);
            const Vec3& i = mass->principal_inertia;
            dMass m;
            dMassSetParameters(&m, real(mass->mass), 0, 0, 0, real(i.x), real(i.y), real(i.z), 0, 0, 0);
            dBodySetMass(body, &m);
            dGeomSetBody(geom, body);
            const Vec3 &v = description.velocity, &w = description.angular_velocity;
            dBodySetLinearVel(body, real(v.x), real(v.y), real(v.z));
            dBodySetAngularVel(body, real(w.x), real(w.y), real(w.z));
        }
        const Frame frame = mass_frame(description, mass);
        const dQuaternion q = {real(frame.rotation.w), real(frame.rotation.x), real(frame.rotation.y),
                               real(frame.rotation.z)};
        dGeomSetPosition(geom, real(frame.position.x), real(frame.position.y), real(frame.position.z));
        dGeomSetQuaternion(geom, q);
        geoms_.push_back(geom);
    }

    static void near(void* self, dGeomID a, dGeomID b) { static_cast<Ode*>(self)->collide(a, b); }

    void collide(dGeomID a, dGeomID b) {
        if (dGeomGetBody(a) == nullptr && dGeomGetBody(b) == nullptr) return;
        constexpr int kMostContacts = 64;
        std::vector<dContact> found(kMostContacts);
        const int count = dCollide(a, b, kMostContacts, &found[0].geom, sizeof(dContact));
        const auto& p = *static_cast<const Surface*>(dGeomGetData(a));
        const auto& q = *static_cast<const Surface*>(dGeomGetData(b));
        for (int k = 0; k < count; ++k) {
            dContact& contact = found[static_cast<std::size_t>(k)];
            contact.surface = {};
            contact.surface.mode = dContactBounce | dContactApprox1;
            contact.surface.mu = real(std::sqrt(p.friction * q.friction));
            contact.surface.bounce = real(std::sqrt(p.restitution * q.restitution));
            dJointAttach(dJointCreateContact(world_, contacts_, &contact), dGeomGetBody(a), dGeomGetBody(b));
        }
    }

    const EngineScene& scene_;
    dWorldID world_ = nullptr;
    dSpaceID space_ = nullptr;
    dJointGroupID contacts_ = nullptr;
    std::vector<std::unique_ptr<MeshData>> meshes_;
    std::vector<Surface> surfaces_;
    std::vector<dGeomID> geoms_;
};

} // namespace

int main(int argc, char** argv) {
    return run_engine(argc, argv, "flotilla_ode", {"trimesh"},
                      [](const auto& scene, const auto& arguments) { return std::make_unique<Ode>(scene, arguments); });
}
