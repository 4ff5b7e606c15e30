#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/bem/problem.hpp"
#include "cleave/core/cost.hpp"
#include "cleave/core/progress.hpp"
#include "cleave/core/quantity.hpp"
#include "cleave/dbem/solver.hpp"
#include "cleave/scene/output.hpp"
#include "cleave/scene/plan.hpp"
#include "cleave/scene/problem.hpp"
#include "cleave/scene2d/bodies.hpp"

/// Scenes of bodies that touch: [[body]] with [contact]. The plane as for other bodies: x to the right, y up, metres;
/// masses and forces per metre of thickness.
namespace cleave::scene {

/// Pa/m, which is N/m3.
using JointStiffness = UnitWeight;

/// Strength of a contact between two sides; [joints.NAME] of the scene.
struct ContactJoint {
  std::string name;
  double friction = 30;  ///< degrees
  /// Degrees, where a contact has slipped or opened, and of contacts made later; empty: as `friction`.
  std::optional<double> residual_friction = {};
  double cohesion = 0;                                                        ///< Pa, until the contact breaks
  Stress residual_cohesion{};                                                 ///< where it slipped and stays closed
  double tension = 0;                                                         ///< Pa, likewise
  std::optional<JointStiffness> normal_stiffness = {}, shear_stiffness = {};  ///< empty: rigid
  /// Degrees, part of `friction`: by which faces that were closed at the start ride up when they slip.
  double dilation = 0;
  Length dilation_slip{};                  ///< beyond which they rise no further
  Stress water_pressure{};                 ///< on both faces that were closed at the start
  std::optional<Length> water_table = {};  ///< height of still water, scene; empty: none
};

/// A load on one body of a scene of contact; times are those of the run.
struct ContactLoad {
  std::uint32_t line = 1;
  std::optional<std::size_t> side;  ///< of `ContactBody::corners`; none: a point force
  bem::Vec2 at, force;              ///< point force, N/m
  double pressure = 0;              ///< Pa
  bem::Vec2 traction;               ///< Pa
  TimeFunction time;
  bool timed = false;    ///< it changes with time
  bool follows = false;  ///< turns with the body
};

/// Motion of the ground, which is what is fixed: an acceleration (m/s2) over time.
using GroundMotion = TimeCourse<bem::Vec2>;
/// Motion of one fixed body: a velocity over time, or an acceleration from rest.
struct SupportMotion {
  GroundMotion course;
  bool is_velocity = false;
  [[nodiscard]] bem::Vec2 velocity(Time at) const;  ///< m/s
};

struct ContactBody {
  std::string name;
  std::uint32_t line = 1;
  std::vector<bem::Vec2> corners;  ///< counter-clockwise; side k runs from corner k to the next
  std::vector<std::size_t> joint;  ///< of each side, into ContactScene::joints
  std::optional<double> young, poisson;
  double density = 2700;
  bool fixed = false;                   ///< never moves but by `motion`
  std::optional<SupportMotion> motion;  ///< of a fixed one
  std::vector<bool> held;               ///< sides of an elastic body that are clamped; empty: none
  bem::Vec2 velocity;
  double spin = 0;  ///< rad/s
  std::vector<ContactLoad> loads;
  [[nodiscard]] bool clamped() const noexcept { return !held.empty(); }
};

/// What holds a bolt along its length; as in [support] of scenes of blocks.
enum class BarKind : std::uint8_t {
  grouted,     ///< gripped all along
  friction,    ///< the same, by a tube that slips
  cable,       ///< free behind the head, gripped beyond
  mechanical,  ///< held at its end alone, and by its plate
};
/// A bolt in the plane: what one of many carries, `spacing` apart out of the plane.
struct ContactBolt {
  std::string name;
  std::uint32_t line = 1;
  bem::Vec2 head, toe;  ///< at the start
  BarKind kind = BarKind::grouted;
  Length spacing{};
  Force tendon{}, plate{}, anchor{};
  ForcePerLength bond{};  ///< of gripped length
  Length free_length{}, anchorage{};
  Length diameter{};
  Stress young{};    ///< of the steel
  Length stretch{};  ///< of a gripped bar that lengthens where a joint opens
  Length ductility{};
  Force pretension{};
  Time installed{};
};

/// Which motions a body has.
enum class Rigidity : std::uint8_t {
  automatic,  ///< elastic when strains are worth it, see `rigidity_of`
  rigid,      ///< three freedoms a body
  elastic,
};

/// Mohr and Coulomb's with a tension cut-off; of the rock of elastic bodies.
struct RockStrength {
  double cohesion = 0;  ///< Pa
  double friction = 0;  ///< degrees
  double tension = 0;   ///< Pa
};

struct ContactSettings {
  bem::Vec2 gravity{0, -9.81};
  std::optional<GroundMotion> ground;
  bool to_rest = false;  ///< static: relaxation
  double duration = 0;   ///< s; of a run to rest: the longest it may take
  double step = 0;       ///< s, the first one
  double max_step = 0;   ///< s
  dbem::Method solver = dbem::Method::cascade;
  double restitution = 0;
  Rigidity rigidity = Rigidity::automatic;
  bem::PlaneState plane = bem::PlaneState::strain;
  std::optional<double> element;     ///< m, longest element; empty: a quarter of the body
  std::optional<std::size_t> modes;  ///< of an elastic body; empty: all
  double damping = 0;                ///< share of critical damping of elastic vibrations
  Rate mass_damping{};               ///< of all motion
  double largest_move = 0.05;        ///< of the scene's extent, in one step
  std::size_t frames = 120;
  std::optional<RockStrength> strength;
  std::optional<bem::InSitu> in_situ;  ///< locked in elastic bodies at the start, in each that at its centroid
  bool estimate = false;               ///< of the error of the steps, by three more runs with longer ones
  double work = std::numeric_limits<double>::infinity();  ///< operations the run may take
};

struct ContactScene : SceneHead {
  std::vector<ContactBody> bodies;
  std::vector<ContactJoint> joints;  ///< [0] is the default
  std::vector<PointSpec> points;
  std::vector<ContactBolt> bolts;
  ContactSettings settings;
};

/// Which two-dimensional scene a text is: [contact], or [[body]] alone; empty for any other, which may be no TOML.
enum class Kind2d : std::uint8_t { elastic, contact };
[[nodiscard]] std::optional<Kind2d> kind2d_of(std::string_view text);
[[nodiscard]] std::expected<ContactScene, std::vector<Problem>> parse_contact(std::string_view text,
                                                                              const std::string& shown);

/// Whether bodies deform in a run, and the reason in words.
struct RigidityChoice {
  bool elastic = false;
  std::string why;
  std::optional<double> strain = {};  ///< estimate of the largest one; empty: no body has a modulus
};
[[nodiscard]] RigidityChoice rigidity_of(const ContactScene& scene);

[[nodiscard]] const KeyTable& contact_scene_keys();
[[nodiscard]] Plan make_plan(const ContactScene& scene);

/// Two bodies that lie in each other at the start.
struct Overlap {
  std::size_t first, second;
  double depth;  ///< m
  bem::Vec2 at;
};
/// Pairs of simple polygons that overlap deeper than `tolerance` (m). O(n log n) in bodies that lie apart.
[[nodiscard]] std::vector<Overlap> overlaps_of(const std::vector<std::vector<bem::Vec2>>& polygons, double tolerance);

// ---------------------------------------------------------------------------------------------------- results

struct ContactPlacement {
  bem::Vec2 centroid;
  double rotation = 0;  ///< radians, turns counted
};
enum class ContactMarkState : std::uint8_t { stick, slip };
/// One closed contact of a frame.
struct ContactMark {
  bem::Vec2 at;
  bem::Vec2 force;  ///< N/m, on the first body
  std::uint32_t first = 0, second = 0;
  ContactMarkState state = ContactMarkState::stick;
};
/// Stress at a corner (or node) of a body that deforms: scene's axes, tension positive, Pa.
struct NodeStress {
  bem::Sym2 stress;
  double out_of_plane = 0;
  double von_mises = 0;
  std::optional<double> safety;  ///< strength over stress, at most `most_safety`; empty where no strength is stated
};
constexpr double most_safety = 1000;
struct ContactFrame {
  double time = 0;  ///< s
  std::vector<ContactPlacement> places;
  std::vector<std::vector<bem::Vec2>> corners;  ///< of bodies that deform, as drawn; empty ones are rigid
  std::vector<std::vector<NodeStress>> stress;  ///< of the same corners
  std::vector<ContactMark> contacts;
  std::vector<bem::Vec2> points;  ///< displacements
};
/// What is written of one step; J/m.
struct ContactHistory {
  double time = 0, step = 0;  ///< s
  double kinetic = 0, elastic = 0;
  double gravity = 0;             ///< potential, 0 at the start
  double work = 0;                ///< of loads, since the start
  double friction = 0, lost = 0;  ///< dissipated by slip; by impacts, damping and the time scheme
  double bolts = 0;               ///< dissipated by bolts that yield and break
  double residual = 0;
  std::uint64_t contacts = 0, sticking = 0, slipping = 0, iterations = 0;
  std::vector<bem::Vec2> points;  ///< displacements
};
/// What became of a bolt at one joint.
enum class BoltState : std::uint8_t {
  absent,  ///< not installed yet
  slack,
  holds,
  yields,
  broken,
};
/// A bolt where it crosses from one body to the next; forces are those of one bolt.
struct ContactBoltResult {
  std::string name;
  std::string first, second;  ///< bodies, from the head on
  BoltState state = BoltState::absent;
  Force force{}, largest{}, capacity{};
  Length lengthened{};  ///< for good
  std::optional<Time> broken_at;
};
template <class V>
void fields(V& v, const ContactBoltResult& x) {
  v("name", x.name);
  v("first", x.first, "body on the side of the head");
  v("second", x.second, "body on the side of the toe");
  v("state", one_of(x.state), "at the end; absent: not installed yet");
  v("force_n", x.force, "tension of one bolt at the end");
  v("largest_force_n", x.largest, "in any step; of one that broke no less than its capacity");
  v("capacity_n", x.capacity, "of one bolt at this joint");
  v("lengthened_m", x.lengthened, "for good");
  v("broken_at_s", x.broken_at);
}

/// Groups of contacts that a solver found the answer of.
struct SolverShare {
  std::string name;
  std::uint64_t groups = 0;
  std::uint64_t iterations = 0;
};
template <class V>
void fields(V& v, const SolverShare& x) {
  v("name", x.name);
  v("groups", x.groups, "groups of contacts whose answer it found");
  v("iterations", x.iterations, "linear solves and pivots for those groups, other tries included");
}
struct ContactBodyResult {
  std::string name;
  bool fixed = false, elastic = false;
  std::size_t freedoms = 0;
  bem::Vec2 start, centroid;       ///< at the start and at the end
  bem::Vec2 carried;               ///< how far its supports took it along, by the end
  double rotation = 0;             ///< radians, turns counted
  double largest = 0;              ///< m, displacement of its corners, in any step
  std::vector<bem::Vec2> outline;  ///< at the start, as drawn
  bem::Vec2 force;                 ///< N/m: sum of the contact forces on it at the end
  // Of all steps, whatever is drawn of them; see `note_step`.
  Length size{};                 ///< between the two corners farthest apart
  std::optional<Time> moved_at;  ///< end of the first step that left it farther from where it lay than 1 % of that
  bool touched = false;          ///< something, at the end of that step
  double turned = 0;             ///< the most of its rotation, to either side
  /// At the end of a run in time: how fast it still goes on, see docs/contact.md (m/s). Empty: it does not.
  std::optional<double> goes_on;
};
struct ContactResult : Scene2dResult {
  std::uint64_t cut_steps = 0;
  double end_time = 0;
  double largest_penetration = 0;
  bool elastic = false;
  std::size_t operators = 0;  ///< elastic ones that were built: bodies alike share one
  bool to_rest = false;
  double drift_momentum = 0, drift_angular = 0;  ///< relative, see docs/contact.md
  /// Of the places of all corners at the end, relative to the largest displacement, from runs with steps up to 6.5
  /// times as long. Empty: there is none, and why.
  std::optional<double> error;
  std::string no_estimate;
  double energy_gain = 0;  ///< J/m beyond the work done; 0 when it never grew
  std::vector<ContactBodyResult> bodies;
  std::vector<PointSpec> points;
  std::vector<ContactFrame> frames;
  std::vector<ContactHistory> history;
  std::vector<SolverShare> solvers;
  std::vector<ContactBoltResult> bolts;
  std::uint64_t iterations = 0;
  double work = 0;           ///< operations
  bool interrupted = false;  ///< `ContactRun::stop` said so
  std::string state;         ///< what a later run goes on from, see SavedRun
};

/// Between the two corners farthest apart.
[[nodiscard]] Length size_of(const std::vector<bem::Vec2>& outline);
/// Takes a step into what is known of a body's motion: where it lies after it, less what its supports took it along,
/// and whether it touches anything then.
void note_step(ContactBodyResult& body, Time time, const ContactPlacement& place, bool touches);

/// What became of the bodies. One has moved that lay farther from its place at the start than `moves_from` of its size
/// after some step, its turn counted at half its size. That place goes along with a support that moves.
enum class BodyMotion : std::uint8_t {
  slides,
  topples,  ///< turned by more than 5 degrees, or its way is mostly one of turning
  falls,    ///< touched nothing after the first step in which it had moved
};
struct ContactVerdict {
  bool known = true;                      ///< false: the run stopped before anything moved
  std::array<std::uint64_t, 3> bodies{};  ///< how many moved, by BodyMotion
  std::uint64_t going_on = 0;             ///< have not moved so far, but go on moving at the end
  /// Of the body that moved first; of several in one step the one that went farthest for its size. Empty: none moved.
  std::optional<BodyMotion> motion;
  std::optional<Time> since;  ///< end of the step in which it had
  std::uint32_t first = 0;    ///< that body, where `since` says so
  [[nodiscard]] std::uint64_t moved() const { return bodies[0] + bodies[1] + bodies[2]; }
};
inline constexpr std::string_view name_of(const ContactVerdict& verdict) {
  if (verdict.motion) return enum_name(*verdict.motion);
  return !verdict.known ? "not known" : verdict.going_on > 0 ? "still moving" : "stands";
}
/// "2 slid, 1 toppled".
[[nodiscard]] std::string counts_of(const ContactVerdict& verdict);
/// Which bodies have not moved so far but go on moving, how fast, and what to do; empty: none.
[[nodiscard]] std::string note_of_going_on(const ContactResult& result);
/// By all steps of the run; of a run that stopped, up to where it came.
[[nodiscard]] ContactVerdict verdict_of(const ContactResult& result);

/// Section `contact`.
template <class V>
void scene2d_fields(V& v, const ContactResult& x) {
  const ContactHistory last = x.history.empty() ? ContactHistory{} : x.history.back();
  const ContactVerdict verdict = verdict_of(x);
  const std::string name_of_first = verdict.since ? x.bodies[verdict.first].name : std::string{};
  v("contact", group([&](auto& w) {
      status_fields(w, x);
      w("verdict", one_of(name_of(verdict), {"stands", "slides", "topples", "falls", "still moving", "not known"}),
        "of the body that moved first; stands: none moved by more than 1 % of its size, and none goes on moving; still "
        "moving: one goes on; not known: the run stopped before one moved");
      w("bodies_slid", verdict.bodies[0]);
      w("bodies_toppled", verdict.bodies[1], "turned by more than 5 degrees, or more than they went along");
      w("bodies_fell", verdict.bodies[2], "touched nothing when they had moved");
      w("bodies_still_moving", verdict.going_on, "have not moved so far, but go on at the end");
      w("moved_since_s", verdict.since, "end of the first step after which a body had moved");
      w("moved_first", when(verdict.since.has_value(), name_of_first), "which body that is");
      w("steps", x.steps);
      w("residual", x.residual, "of the contact law, relative; the worst of all steps");
      w("max_displacement_m", x.largest_displacement, "of a corner, after any step");
      w("estimated_error", when(x.error.has_value(), x.error.value_or(0)),
        "of the places of all corners at the end, over the largest displacement, from runs with longer steps");
      w("no_estimate", when(!x.error && !x.no_estimate.empty(), x.no_estimate), "why there is no estimate");
      w("bodies", each(x.bodies, [](auto& b, const ContactBodyResult& body) {
          b("name", body.name);
          b("centroid", body.centroid, "at the end, m");
          b("rotation", body.rotation * 180 / std::numbers::pi,
            "since the start, degrees counter-clockwise, whole turns counted");
          b("fixed", body.fixed);
          b("max_displacement_m", body.largest);
          b("goes_on_m_s", body.goes_on, "still moving at the end: how fast, over the last tenth of the time");
          b("contact_force", body.force, "sum of the contact forces on it in the last step, N/m");
        }));
      w("points", each(x.points, [&](auto& p, const PointSpec& point, std::size_t at) {
          p("name", point.name);
          p("displacement", at < last.points.size() ? last.points[at] : bem::Vec2{}, "at the end, m");
        }));
      w("mode", one_of(x.elastic ? "elastic" : "rigid", {"rigid", "elastic"}));
      w("end_time_s", x.end_time);
      w("cut_steps", x.cut_steps, "times a step was shortened because it failed");
      w("largest_penetration_m", x.largest_penetration, "after a step");
      w("energy", group([&](auto& e) {
          e("kinetic_j", last.kinetic);
          e("elastic_j", last.elastic);
          e("gravity_j", last.gravity);
          e("work_j", last.work);
          e("friction_j", last.friction);
          e("lost_j", last.lost);
          e("bolts_j", when(!x.bolts.empty(), last.bolts));
          e("largest_gain_j", x.energy_gain);
        }),
        "J/m at the end; gravity (potential) from 0 at the start, work of loads, friction and other losses since the "
        "start; largest_gain_j is the largest rise of kinetic + elastic + gravity - work in the run");
      w("drift", group([&](auto& d) {
          d("momentum", x.drift_momentum);
          d("angular_momentum", x.drift_angular);
        }),
        "largest departure of momentum from what weight and supports give, relative (0 in scenes with loads or at "
        "rest); of angular momentum where nothing acts from outside");
      w("bolts", when_any(x.bolts), "bolts, a row for each joint they cross");
      w("solvers", x.solvers);
      w("iterations", x.iterations, "linear solves and pivots in all");
      w("work", x.work * 1e-9, "10^9 operations of the contact law, counted; some 0.4 s each");
    }),
    "Scenes of bodies in contact only (then there are no `blocks`).");
}
template <class V>
void fields(V& v, const ContactResult& x) {
  v("input", InputFigures{});
  scene2d_fields(v, x);
}

/// Where the corners of a body are drawn in a frame.
[[nodiscard]] std::vector<bem::Vec2> corners_at(const ContactResult& result, std::size_t frame, std::size_t body);

/// File of a result that holds its `state`.
inline constexpr std::string_view contact_state_name = "contact.state";
using ContactRun = MovingRun;

[[nodiscard]] std::expected<ContactResult, std::vector<Problem>> run(const ContactScene& scene, unsigned threads,
                                                                     StageTimer& timer, Progress& progress,
                                                                     const ContactRun& how = {});

}  // namespace cleave::scene
