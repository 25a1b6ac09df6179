// SPDX-License-Identifier: MIT
// flotilla_bullet: a scene simulated by Bullet (bulletphysics.org), single precision as Debian builds it.
//  - panels: movable meshes as compounds of thin convex hulls (panels.hpp), each with a margin of half the gap around
//    it.
//  - primitives: what meshes stand for (primitives.hpp): boxes, spheres, cylinders, planes; thin boxes of the panels'
//    thickness for movable plates, hulls with a margin of half the gap for convex solids.
//  - gimpact: movable meshes as btGImpactMeshShape, which Bullet's author calls deprecated, with the same margin.
// Static meshes are triangle meshes in the other two. Friction and restitution of a pair are products in Bullet; bodies
// get the square roots of theirs, so that pairs have the geometric mean, as in flotilla. Nothing sleeps.
#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <BulletDynamics/ConstraintSolver/btNNCGConstraintSolver.h>
#include <BulletDynamics/MLCPSolvers/btDantzigSolver.h>
#include <BulletDynamics/MLCPSolvers/btMLCPSolver.h>
#include <btBulletDynamicsCommon.h>

#include <cmath>
#include <iostream>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "base/vec3.hpp"
#include "engine.hpp"
#include "panels.hpp"

namespace {

using namespace flotilla;
using namespace flotilla::baseline;

btVector3 vector(const Vec3& v) {
    return {static_cast<btScalar>(v.x), static_cast<btScalar>(v.y), static_cast<btScalar>(v.z)};
}
Vec3 vector(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

btTransform transform(const Frame& frame) {
    const Quat& q = frame.rotation;
    return btTransform({static_cast<btScalar>(q.x), static_cast<btScalar>(q.y), static_cast<btScalar>(q.z),
                        static_cast<btScalar>(q.w)},
                       vector(frame.position));
}
Frame frame_of(const btTransform& t) {
    const btQuaternion q = t.getRotation();
    return {vector(t.getOrigin()), {q.w(), q.x(), q.y(), q.z()}};
}

std::unique_ptr<btConstraintSolver> make_solver(const std::string& name, btMLCPSolverInterface& pivots) {
    if (name.starts_with("nncg")) return std::make_unique<btNNCGConstraintSolver>();
    if (name.starts_with("dantzig")) return std::make_unique<btMLCPSolver>(&pivots);
    return std::make_unique<btSequentialImpulseConstraintSolver>();
}

class Bullet final : public Engine {
  public:
    Bullet(const EngineScene& scene, const EngineArguments& arguments)
        : scene_(scene),
          dispatcher_(&configuration_),
          solver_(make_solver(arguments.solver, pivots_)),
          world_(&dispatcher_, &broadphase_, solver_.get(), &configuration_) {
        if (arguments.shape == kPrimitives) {
            world_.getSolverInfo().m_restitutionVelocityThreshold = 0; // a rebound of any speed is one
        }
        btGImpactCollisionAlgorithm::registerAlgorithm(&dispatcher_);
        world_.setGravity(vector(scene.description.gravity));
        if (arguments.solver.ends_with("-2")) world_.getSolverInfo().m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS;
        if (arguments.iterations > 0) world_.getSolverInfo().m_numIterations = arguments.iterations;
        for (const BodyDescription& body : scene.description.bodies) add(body, arguments);
    }
    ~Bullet() override {
        for (const auto& body : bodies_) world_.removeRigidBody(body.get());
    }

    void step(double dt) override { world_.stepSimulation(static_cast<btScalar>(dt), 0); }

    [[nodiscard]] std::vector<PoseRow> rows() const override {
        std::vector<PoseRow> out;
        for (std::size_t i = 0; i < bodies_.size(); ++i) {
            const btRigidBody& body = *bodies_[i];
            const auto shape = static_cast<std::size_t>(scene_.description.bodies[i].shape);
            const Frame frame = mesh_frame(frame_of(body.getWorldTransform()), scene_.masses[shape]);
            out.push_back(
                {frame.position, frame.rotation, vector(body.getLinearVelocity()), vector(body.getAngularVelocity())});
        }
        return out;
    }

  private:
    using Key = std::pair<std::int32_t, bool>; ///< shape, movable

    btCollisionShape* shape_of(const BodyDescription& body, const EngineArguments& arguments) {
        const bool movable = body.type == BodyType::dynamic;
        btCollisionShape*& shape = of_key_[{body.shape, movable}];
        if (shape == nullptr) shape = make_shape(static_cast<std::size_t>(body.shape), movable, arguments);
        return shape;
    }

    btCollisionShape* make_shape(std::size_t index, bool movable, const EngineArguments& arguments) {
        const ShapeDescription& shape = scene_.description.shapes[index];
        const auto margin = static_cast<btScalar>(arguments.gap / 2);
        if (auto solid = make_primitive(scene_.primitives[index], movable, arguments.panel_thickness)) {
            shapes_.push_back(std::move(solid));
            return shapes_.back().get();
        }
        const std::vector<Vec3> vertices = vertices_about_mass(shape, scene_.masses[index]);
        if (movable && scene_.primitives[index].kind == Primitive::Kind::convex) return make_hull(vertices, margin);
        if (movable && arguments.shape == "panels")
            return make_panels({vertices, shape.triangles}, {.thickness = arguments.panel_thickness}, margin);
        auto mesh = std::make_unique<btTriangleMesh>();
        for (const Triangle& t : shape.triangles)
            mesh->addTriangle(corner(vertices, t[0]), corner(vertices, t[1]), corner(vertices, t[2]));
        meshes_.push_back(std::move(mesh));
        if (!movable) return keep(std::make_unique<btBvhTriangleMeshShape>(meshes_.back().get(), true), margin);
        auto gimpact = std::make_unique<btGImpactMeshShape>(meshes_.back().get());
        gimpact->setMargin(margin);
        gimpact->updateBound();
        return keep(std::move(gimpact), margin);
    }

    /// Null where there is none; margins are Bullet's own, inside the solid.
    static std::unique_ptr<btCollisionShape> make_primitive(const Primitive& p, bool movable, double thickness) {
        const btVector3 half = vector(0.5 * p.size);
        switch (p.kind) {
        case Primitive::Kind::plate:
            if (!movable) return std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0));
            return std::make_unique<btBoxShape>(btVector3(half.x(), half.y(), static_cast<btScalar>(thickness / 2)));
        case Primitive::Kind::box: return std::make_unique<btBoxShape>(half);
        case Primitive::Kind::sphere: return std::make_unique<btSphereShape>(half.x());
        case Primitive::Kind::cylinder: return std::make_unique<btCylinderShapeZ>(half);
        default: return nullptr;
        }
    }

    btCollisionShape* make_hull(const std::vector<Vec3>& vertices, btScalar margin) {
        auto hull = std::make_unique<btConvexHullShape>();
        for (const Vec3& v : vertices) hull->addPoint(vector(v), false);
        hull->recalcLocalAabb();
        return keep(std::move(hull), margin);
    }

    btCollisionShape* make_panels(const TriangleMesh& mesh, const PanelLimits& limits, btScalar margin) {
        auto compound = std::make_unique<btCompoundShape>();
        const std::vector<Panel> panels = merge_into_panels(mesh, limits);
        for (const Panel& panel : panels) {
            auto hull = std::make_unique<btConvexHullShape>();
            for (const std::int32_t v : panel_vertices(mesh, panel)) hull->addPoint(corner(mesh.vertices, v), false);
            hull->recalcLocalAabb();
            compound->addChildShape(btTransform::getIdentity(), keep(std::move(hull), margin));
        }
        std::cout << "panels: " << panels.size() << " of " << mesh.triangles.size() << " triangles\n";
        return keep(std::move(compound), margin);
    }

    static btVector3 corner(const std::vector<Vec3>& vertices, std::int32_t i) {
        return vector(vertices[static_cast<std::size_t>(i)]);
    }

    btCollisionShape* keep(std::unique_ptr<btCollisionShape> shape, btScalar margin) {
        shape->setMargin(margin);
        shapes_.push_back(std::move(shape));
        return shapes_.back().get();
    }

    void add(const BodyDescription& description, const EngineArguments& arguments) {
        const auto& mass = scene_.masses[static_cast<std::size_t>(description.shape)];
        const bool movable = description.type == BodyType::dynamic;
        btRigidBody::btRigidBodyConstructionInfo info(movable ? static_cast<btScalar>(mass->mass) : 0, nullptr,
                                                      shape_of(description, arguments),
                                                      movable ? vector(mass->principal_inertia) : btVector3(0, 0, 0));
        info.m_startWorldTransform = transform(mass_frame(description, mass));
        info.m_friction = static_cast<btScalar>(std::sqrt(description.friction));
        info.m_restitution = static_cast<btScalar>(std::sqrt(description.restitution));
        auto body = std::make_unique<btRigidBody>(info);
        body->setLinearVelocity(vector(description.velocity));
        body->setAngularVelocity(vector(description.angular_velocity));
        body->setActivationState(DISABLE_DEACTIVATION);
        world_.addRigidBody(body.get());
        bodies_.push_back(std::move(body));
    }

    const EngineScene& scene_;
    btDefaultCollisionConfiguration configuration_;
    btCollisionDispatcher dispatcher_;
    btDbvtBroadphase broadphase_;
    btDantzigSolver pivots_;
    std::unique_ptr<btConstraintSolver> solver_;
    btDiscreteDynamicsWorld world_;
    std::map<Key, btCollisionShape*> of_key_;
    std::vector<std::unique_ptr<btTriangleMesh>> meshes_;
    std::vector<std::unique_ptr<btCollisionShape>> shapes_;
    std::vector<std::unique_ptr<btRigidBody>> bodies_;
};

} // namespace

int main(int argc, char** argv) {
    return run_engine(
        argc, argv, "flotilla_bullet", {"panels", "gimpact", kPrimitives},
        {"impulses", "impulses-2", "nncg", "nncg-2", "dantzig-2"},
        [](const auto& scene, const auto& arguments) { return std::make_unique<Bullet>(scene, arguments); });
}
