/// ODE (Smith; libode-dev, built in double precision by Debian).
///
/// As it comes: error reduction 0.2, constraint force mixing 1e-10, no damping, no sleeping. Friction is a pyramid over
/// the force that presses (dContactApprox1). Floors are planes, hulls are meshes of triangles.

#include <cmath>
#include <memory>
#include <utility>

#include "engines.hpp"

#ifdef CLEAVE_HAS_ODE
#include <ode/ode.h>
#endif

namespace cleave::study::engines {
namespace {

#ifdef CLEAVE_HAS_ODE

#ifdef __clang__
#pragma clang unsafe_buffer_usage begin  // ODE hands out pointers to three numbers
#endif

/// `exact`: Dantzig's method on all contacts (dWorldStep), else sweeps (dWorldQuickStep). `fdir`: the first axis of the
/// pyramid lies along the slip, as the manual has it, not as the contact comes. `slip`: the same, and what slips has no
/// friction across its slip. `layer`: contacts may sink by 1 mm, as the manual advises against jitter.
class OdeWorld {
 public:
  OdeWorld(const Scene& scene, const Setting& setting)
      : gravity_{scene.gravity},
        step_{setting.step},
        restitution_{scene.restitution},
        exact_{setting.way.contains("exact")},
        along_slip_{setting.way.contains("fdir") || setting.way.contains("slip")},
        alone_{setting.way.contains("slip")} {
    world_ = dWorldCreate();
    space_ = dHashSpaceCreate(nullptr);
    dHashSpaceSetLevels(space_, -3, 3);
    joints_ = dJointGroupCreate(0);
    dWorldSetGravity(world_, gravity_.x, gravity_.y, gravity_.z);
    if (setting.iterations > 0) dWorldSetQuickStepNumIterations(world_, setting.iterations);
    if (setting.way.contains("layer")) dWorldSetContactSurfaceLayer(world_, 1e-3);
    for (const Floor& f : scene.floors) {
      const Vec3 n = f.turn * Vec3{0, 0, 1};
      frictions_.push_back(f.friction);
      tag(dCreatePlane(space_, n.x, n.y, n.z, 0), frictions_.size());
    }
    meshes_.reserve(scene.bodies.size());
    for (const Body& b : scene.bodies) add(b);
  }
  ~OdeWorld() {
    dJointGroupDestroy(joints_);
    dSpaceDestroy(space_);
    dWorldDestroy(world_);
    for (const auto& mesh : meshes_) dGeomTriMeshDataDestroy(mesh->data);
  }
  OdeWorld(const OdeWorld&) = delete;
  OdeWorld& operator=(const OdeWorld&) = delete;
  OdeWorld(OdeWorld&&) = delete;
  OdeWorld& operator=(OdeWorld&&) = delete;

  bool advance() {
    dJointGroupEmpty(joints_);
    feedback_.clear();
    dSpaceCollide(space_, this, [](void* self, dGeomID a, dGeomID b) { static_cast<OdeWorld*>(self)->touch(a, b); });
    return (exact_ ? dWorldStep(world_, step_) : dWorldQuickStep(world_, step_)) != 0;
  }
  [[nodiscard]] std::vector<Pose> poses() const {
    const auto vector = [](const dReal* v) { return Vec3{v[0], v[1], v[2]}; };
    std::vector<Pose> out;
    for (const dBodyID b : bodies_) {
      const dReal* q = dBodyGetQuaternion(b);
      out.push_back({.at = vector(dBodyGetPosition(b)),
                     .turn = {.w = q[0], .x = q[1], .y = q[2], .z = q[3]},
                     .velocity = vector(dBodyGetLinearVel(b)),
                     .spin = vector(dBodyGetAngularVel(b))});
    }
    return out;
  }
  /// Of what is fixed, against gravity.
  [[nodiscard]] double reaction() const {
    Vec3 sum;
    for (const auto& f : feedback_) sum += Vec3{f->f1[0], f->f1[1], f->f1[2]};
    return -dot(sum, gravity_) / norm(gravity_);
  }

 private:
  struct Mesh {
    std::vector<double> points;
    std::vector<dTriIndex> corners;
    dTriMeshDataID data = nullptr;
  };
  void tag(dGeomID geometry, std::size_t number) {
    dGeomSetData(geometry, reinterpret_cast<void*>(number));  // NOLINT(performance-no-int-to-ptr)
  }
  [[nodiscard]] double friction_of(dGeomID geometry) const {
    return frictions_.at(reinterpret_cast<std::size_t>(dGeomGetData(geometry)) - 1);
  }
  void add(const Body& b) {
    const MassOf m = mass_of(b);
    const motion::Symmetric& j = m.inertia;
    dBodyID body = dBodyCreate(world_);
    dMass mass;
    dMassSetParameters(&mass, m.mass, 0, 0, 0, j.xx, j.yy, j.zz, j.xy, j.zx, j.yz);
    dBodySetMass(body, &mass);
    dGeomID geometry = b.sides ? dCreateBox(space_, b.sides->x, b.sides->y, b.sides->z) : mesh_of(b);
    dGeomSetBody(geometry, body);
    frictions_.push_back(b.friction);
    tag(geometry, frictions_.size());
    dBodySetPosition(body, b.at.x, b.at.y, b.at.z);
    const dQuaternion q{b.turn.w, b.turn.x, b.turn.y, b.turn.z};
    dBodySetQuaternion(body, q);
    dBodySetLinearVel(body, b.velocity.x, b.velocity.y, b.velocity.z);
    dBodySetAngularVel(body, b.spin.x, b.spin.y, b.spin.z);
    dBodySetGyroscopicMode(body, 1);
    bodies_.push_back(body);
  }
  dGeomID mesh_of(const Body& b) {
    Mesh& mesh = *meshes_.emplace_back(std::make_unique<Mesh>());
    for (const Vec3 v : b.shape.vertices) mesh.points.insert(mesh.points.end(), {v.x, v.y, v.z});
    for (const motion::Facet& f : b.shape.facets) {
      const auto& loop = f.loops[0];
      for (std::size_t k = 2; k < loop.size(); ++k) {
        for (const std::uint32_t v : {loop[0], loop[k - 1], loop[k]}) mesh.corners.push_back(v);
      }
    }
    mesh.data = dGeomTriMeshDataCreate();
    dGeomTriMeshDataBuildDouble(mesh.data, mesh.points.data(), 3 * sizeof(double),
                                static_cast<int>(mesh.points.size() / 3), mesh.corners.data(),
                                static_cast<int>(mesh.corners.size()), 3 * sizeof(dTriIndex));
    return dCreateTriMesh(space_, mesh.data, nullptr, nullptr, nullptr);
  }
  void touch(dGeomID a, dGeomID b) {
    constexpr int most = 16;
    dContactGeom found[most];  // NOLINT(modernize-avoid-c-arrays)
    const int count = dCollide(a, b, most, found, sizeof(dContactGeom));
    dBodyID on = dGeomGetBody(a), off = dGeomGetBody(b);
    for (int k = 0; k < count; ++k) {
      dContact contact{};
      contact.geom = found[k];
      contact.surface.mode = dContactApprox1;
      contact.surface.mu = std::min(friction_of(a), friction_of(b));
      if (restitution_ > 0) {
        contact.surface.mode |= dContactBounce;
        contact.surface.bounce = restitution_;
        contact.surface.bounce_vel = 0.2;
      }
      if (along_slip_) turn_to_slip(on, off, contact);
      dJointID joint = dJointCreateContact(world_, joints_, &contact);
      dJointAttach(joint, on, off);
      if (on != nullptr && off != nullptr) continue;
      feedback_.push_back(std::make_unique<dJointFeedback>());
      dJointSetFeedback(joint, feedback_.back().get());
    }
  }
  static Vec3 speed_at(dBodyID body, const dReal* at) {
    if (body == nullptr) return {};
    dVector3 v;
    dBodyGetPointVel(body, at[0], at[1], at[2], v);
    return {v[0], v[1], v[2]};
  }
  void turn_to_slip(dBodyID on, dBodyID off, dContact& contact) const {
    const dReal* n = contact.geom.normal;
    const Vec3 normal{n[0], n[1], n[2]};
    Vec3 slip = speed_at(on, contact.geom.pos) - speed_at(off, contact.geom.pos);
    slip -= dot(slip, normal) * normal;
    const double speed = norm(slip);
    if (speed < 1e-9) return;
    contact.surface.mode |= dContactFDir1;
    if (alone_ && speed > 1e-3) contact.surface.mode |= dContactMu2;  // mu2 is 0
    for (int k = 0; k < 3; ++k) contact.fdir1[k] = (k == 0 ? slip.x : k == 1 ? slip.y : slip.z) / speed;
  }

  Vec3 gravity_;
  double step_, restitution_;
  bool exact_, along_slip_, alone_;
  dWorldID world_ = nullptr;
  dSpaceID space_ = nullptr;
  dJointGroupID joints_ = nullptr;
  std::vector<dBodyID> bodies_;
  std::vector<double> frictions_;
  std::vector<std::unique_ptr<Mesh>> meshes_;
  std::vector<std::unique_ptr<dJointFeedback>> feedback_;
};

#ifdef __clang__
#pragma clang unsafe_buffer_usage end
#endif

#endif

class Ode final : public Engine {
 public:
  [[nodiscard]] std::string name() const override { return "ode"; }
#ifdef CLEAVE_HAS_ODE
  [[nodiscard]] bool present() const override { return true; }
  [[nodiscard]] Outcome run(const Scene& scene, const Setting& setting, const std::vector<double>& times) override {
    static const bool started = dInitODE2(0) != 0;
    if (!started) return {.frames = {}, .stopped = "ODE did not start"};
    OdeWorld world{scene, setting};
    Outcome out = follow(times, setting.step, [&] { return world.advance(); }, [&] { return world.poses(); });
    if (norm(scene.gravity) > 0) out.reaction = world.reaction();
    return out;
  }
#else
  [[nodiscard]] bool present() const override { return false; }
  [[nodiscard]] Outcome run(const Scene&, const Setting&, const std::vector<double>&) override { return {}; }
#endif
};

}  // namespace

Engine& ode_engine() {
  static Ode engine;
  return engine;
}

}  // namespace cleave::study::engines
