/// Bullet (Coumans; libbullet-dev) in double precision, the -float64 libraries of Debian.
///
/// As it comes: sequential impulses with warm starting, split impulse, implicit gyroscopic term, no damping, no
/// sleeping, no continuous collision detection (nothing moves by a tenth of its size in a step). Boxes are btBoxShape,
/// whose margin lies inside; hulls have features for contact by clipping and a margin of 0.1 mm.

#include <memory>
#include <utility>

#include "engines.hpp"

#ifdef CLEAVE_HAS_BULLET
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wold-style-cast"
#endif
#include <BulletDynamics/ConstraintSolver/btNNCGConstraintSolver.h>
#include <BulletDynamics/MLCPSolvers/btDantzigSolver.h>
#include <BulletDynamics/MLCPSolvers/btMLCPSolver.h>
#include <btBulletDynamicsCommon.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif
#endif

namespace cleave::study::engines {
namespace {

#ifdef CLEAVE_HAS_BULLET

btVector3 to_bullet(Vec3 v) { return {v.x, v.y, v.z}; }
btQuaternion to_bullet(Turn t) { return {t.x, t.y, t.z, t.w}; }
Vec3 from_bullet(const btVector3& v) { return {v.x(), v.y(), v.z()}; }
Turn from_bullet(const btQuaternion& q) { return {.w = q.w(), .x = q.x(), .y = q.y(), .z = q.z()}; }

btScalar least_friction(const btCollisionObject* a, const btCollisionObject* b) {
  return btMin(a->getFriction(), b->getFriction());
}
btScalar least_restitution(const btCollisionObject* a, const btCollisionObject* b) {
  return btMin(a->getRestitution(), b->getRestitution());
}

/// `dantzig`: the direct solver on the pyramid. `nncg`: nonlinear conjugate gradients. `2dir`: two directions of
/// friction. `nosplit`: overlaps are pushed out through the velocities. Else sequential impulses.
class BulletWorld {
 public:
  BulletWorld(const Scene& scene, const Setting& setting) : gravity_{scene.gravity}, step_{setting.step} {
    gCalculateCombinedFrictionCallback = least_friction;
    gCalculateCombinedRestitutionCallback = least_restitution;
    if (setting.way.contains("dantzig")) {
      direct_ = std::make_unique<btDantzigSolver>();
      solver_ = std::make_unique<btMLCPSolver>(direct_.get());
    } else if (setting.way.contains("nncg")) {
      solver_ = std::make_unique<btNNCGConstraintSolver>();
    } else {
      solver_ = std::make_unique<btSequentialImpulseConstraintSolver>();
    }
    world_ = std::make_unique<btDiscreteDynamicsWorld>(&dispatcher_, &broadphase_, solver_.get(), &collisions_);
    world_->setGravity(to_bullet(scene.gravity));
    btContactSolverInfo& info = world_->getSolverInfo();
    if (setting.iterations > 0) info.m_numIterations = setting.iterations;
    if (setting.way.contains("dantzig")) info.m_minimumSolverBatchSize = 1;
    if (setting.way.contains("2dir")) info.m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS;
    if (setting.way.contains("nosplit")) info.m_splitImpulse = 0;
    for (const Floor& f : scene.floors) {
      auto rock = std::make_unique<btBoxShape>(btVector3(100, 100, 0.5));
      rock->initializePolyhedralFeatures();
      shapes_.push_back(std::move(rock));
      add(0, {0, 0, 0}, btTransform(to_bullet(f.turn), to_bullet(f.turn * Vec3{0, 0, -0.5})), f.friction,
          scene.restitution);
    }
    for (const Body& b : scene.bodies) add(b, scene.restitution);
  }
  ~BulletWorld() {
    for (const auto& b : bodies_) world_->removeRigidBody(b.get());
  }
  BulletWorld(const BulletWorld&) = delete;
  BulletWorld& operator=(const BulletWorld&) = delete;
  BulletWorld(BulletWorld&&) = delete;
  BulletWorld& operator=(BulletWorld&&) = delete;

  void advance() { world_->stepSimulation(step_, 0); }
  [[nodiscard]] std::vector<Pose> poses() const {
    std::vector<Pose> out;
    for (std::size_t k = 0; k < principal_.size(); ++k) {
      const btRigidBody& b = *bodies_[bodies_.size() - principal_.size() + k];
      const btTransform& t = b.getWorldTransform();
      out.push_back({.at = from_bullet(t.getOrigin()),
                     .turn = from_bullet(t.getRotation() * principal_[k].inverse()),
                     .velocity = from_bullet(b.getLinearVelocity()),
                     .spin = from_bullet(b.getAngularVelocity())});
    }
    return out;
  }
  /// Of what is fixed, against gravity.
  [[nodiscard]] double reaction() {
    btVector3 sum(0, 0, 0);
    for (int m = 0; m < dispatcher_.getNumManifolds(); ++m) {
      const btPersistentManifold& manifold = *dispatcher_.getManifoldByIndexInternal(m);
      const bool first = manifold.getBody0()->isStaticObject(), second = manifold.getBody1()->isStaticObject();
      if (!first && !second) continue;
      for (int p = 0; p < manifold.getNumContacts(); ++p) {
        const btManifoldPoint& c = manifold.getContactPoint(p);
        const btVector3 on_first = c.m_appliedImpulse * c.m_normalWorldOnB +
                                   c.m_appliedImpulseLateral1 * c.m_lateralFrictionDir1 +
                                   c.m_appliedImpulseLateral2 * c.m_lateralFrictionDir2;
        sum += second ? on_first : -on_first;
      }
    }
    return -dot(from_bullet(sum), gravity_) / norm(gravity_) / step_;
  }

 private:
  void add(double mass, const btVector3& inertia, const btTransform& at, double friction, double restitution) {
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, shapes_.back().get(), inertia);
    info.m_startWorldTransform = at;
    info.m_friction = friction;
    info.m_restitution = restitution;
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    bodies_.back()->setActivationState(DISABLE_DEACTIVATION);
    world_->addRigidBody(bodies_.back().get());
  }
  void add(const Body& b, double restitution) {
    const MassOf m = mass_of(b);
    const motion::Symmetric& j = m.inertia;
    btMatrix3x3 inertia(j.xx, j.xy, j.zx, j.xy, j.yy, j.yz, j.zx, j.yz, j.zz), axes;
    axes.setIdentity();
    if (!b.sides) inertia.diagonalize(axes, 1e-14, 100);
    btQuaternion principal;
    axes.getRotation(principal);
    if (b.sides) {
      shapes_.push_back(std::make_unique<btBoxShape>(to_bullet(0.5 * *b.sides)));
    } else {
      auto hull = std::make_unique<btConvexHullShape>();
      hull->setMargin(1e-4);
      for (const Vec3 v : b.shape.vertices) hull->addPoint(quatRotate(principal.inverse(), to_bullet(v)), false);
      hull->recalcLocalAabb();
      hull->initializePolyhedralFeatures();
      shapes_.push_back(std::move(hull));
    }
    principal_.push_back(principal);
    add(m.mass, {inertia.getRow(0).x(), inertia.getRow(1).y(), inertia.getRow(2).z()},
        btTransform(to_bullet(b.turn) * principal, to_bullet(b.at)), b.friction, restitution);
    bodies_.back()->setLinearVelocity(to_bullet(b.velocity));
    bodies_.back()->setAngularVelocity(to_bullet(b.spin));
  }

  Vec3 gravity_;
  double step_;
  btDefaultCollisionConfiguration collisions_;
  btCollisionDispatcher dispatcher_{&collisions_};
  btDbvtBroadphase broadphase_;
  std::unique_ptr<btMLCPSolverInterface> direct_;
  std::unique_ptr<btConstraintSolver> solver_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
  std::vector<btQuaternion> principal_;  ///< from principal axes to those of the body
  std::unique_ptr<btDiscreteDynamicsWorld> world_;
};

#endif

class Bullet final : public Engine {
 public:
  [[nodiscard]] std::string name() const override { return "bullet"; }
#ifdef CLEAVE_HAS_BULLET
  [[nodiscard]] bool present() const override { return true; }
  [[nodiscard]] Outcome run(const Scene& scene, const Setting& setting, const std::vector<double>& times) override {
    BulletWorld world{scene, setting};
    Outcome out = follow(
        times, setting.step,
        [&] {
          world.advance();
          return true;
        },
        [&] { return world.poses(); });
    if (norm(scene.gravity) > 0) out.reaction = world.reaction();
    return out;
  }
#else
  [[nodiscard]] bool present() const override { return false; }
  [[nodiscard]] Outcome run(const Scene&, const Setting&, const std::vector<double>&) override { return {}; }
#endif
};

}  // namespace

Engine& bullet_engine() {
  static Bullet engine;
  return engine;
}

}  // namespace cleave::study::engines
