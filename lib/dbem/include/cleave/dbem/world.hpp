#pragma once

#include <array>
#include <cstddef>
#include <expected>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "cleave/core/sha256.hpp"
#include "cleave/dbem/body.hpp"
#include "cleave/dbem/solver.hpp"

namespace cleave::dbem {

// ---- what can be wrong with a scene

struct BadOutline {
  std::string body;
  std::string reason;
};
struct NoMass {
  std::string body;
};
struct BadModes {
  std::string body;
  std::string reason;
};
struct BadForce {
  std::string body;
  std::string reason;
};
struct BadLaw {
  std::string reason;
};
struct BadOption {
  std::string reason;
};
struct BodiesOverlap {
  std::string a, b;
  double depth;  ///< m
  Vec2 at;       ///< scene
};
struct BadTie {
  std::string tie;
  std::string reason;
};
using WorldError = std::variant<BadOutline, NoMass, BadModes, BadForce, BadLaw, BadOption, BodiesOverlap, BadTie>;
[[nodiscard]] std::string describe(const WorldError& error);

// ---- what can go wrong in a step

/// The step was cut as often as allowed and still failed, or no time was asked for; the world is as it was before the
/// step.
struct StepFailed {
  double time;      ///< s
  double step;      ///< the shortest one tried, s
  double residual;  ///< the best found
  std::string reason;
};
using StepError = std::variant<StepFailed>;
[[nodiscard]] std::string describe(const StepError& error);

// ---- what a world cannot go on from

using cleave::describe;
using cleave::SavedFault;

struct WorldOptions {
  Vec2 gravity = {0, -9.81};
  /// Acceleration of the ground (m/s2) as a function of time: every body feels the opposite. Fixed bodies are the
  /// ground.
  std::function<Vec2(double)> ground = {};
  /// Mean of `ground` from one time to another; empty: its value in the middle, which misses what is shorter.
  std::function<Vec2(double, double)> ground_mean = {};
  double step = 1e-3;                       ///< s, the first one
  std::optional<double> longest_step = {};  ///< s; empty: `step`
  bool adaptive = false;                    ///< lengthens steps while little moves, see `displacement`
  double displacement = 0.05;               ///< largest displacement of a corner in a step over the height of the scene
  double rotation = 0.05;                   ///< largest rotation in a step, rad
  /// Error of position per step allowed, m, estimated from the change of velocity over the step; empty: not controlled.
  std::optional<double> position_error = {};
  std::size_t cuts = 6;            ///< thirds a failed step is cut into before the run stops
  double overlap = 1e-6;           ///< overlap allowed after a step over the smaller body's size
  double overlap_elastic = 1e-6;   ///< the same between two bodies of which one bends
  double overlap_at_start = 1e-6;  ///< of all at the start: what is more than after a step is parted in the first
  double regularisation = 1e-10;   ///< compliance on the diagonal of W, relative
  bool sleep = true;               ///< bodies at rest are left alone until something touches them
  double sleep_speed = 1e-7;       ///< m/s
  /// 1/s: every body is slowed by this times its mass and velocity (and likewise its spin and its vibrations). Speeds
  /// are exact between contacts, whatever the step.
  double mass_damping = 0;
  bool quasi_static = false;  ///< every step starts from rest and is fully implicit: for static answers
  /// Operations that a step with all its tries may take for each 100 bodies (at least as for 100); counted, not timed:
  /// some 2.5 x 10^9 take a second. What would need more is cut, and then refused.
  double step_work = 5e9;
  SolverOptions solver = {};
};

enum class ContactState : std::uint8_t { open, stick, slip };

/// One contact after a step.
struct Contact {
  std::uint32_t vertex_body, vertex, edge_body, edge;
  Vec2 point;               ///< scene, m
  Vec2 normal;              ///< out of edge_body
  double gap;               ///< m, before the step
  double normal_force;      ///< N/m on vertex_body along `normal`, compression positive
  double tangential_force;  ///< N/m on vertex_body along the normal turned left
  double slip_velocity;     ///< m/s of vertex_body along the normal turned left
  ContactState state;
  bool bonded;
};

/// A tie after a step.
struct TieState {
  ForcePerLength force{};  ///< tension
  Length plastic{};        ///< by which it was lengthened for good
  bool installed = false, yielding = false, broken = false;
};

/// All of a run so far; J/m. kinetic + potential + elastic = start + work - friction - yielded - lost + projected.
struct Energy {
  double kinetic = 0, potential = 0, elastic = 0;
  double work = 0;       ///< of point forces, the ground, held bodies that move, and of tightening ties
  double friction = 0;   ///< dissipated by slip
  double projected = 0;  ///< brought in by moving penetrating bodies apart
  double lost = 0;       ///< by impacts, damping, the scheme and sleep: what closes the balance
  double yielded = 0;    ///< dissipated by ties that yield and break
  [[nodiscard]] double total() const noexcept { return kinetic + potential + elastic; }
};

struct StepReport {
  double time = 0;            ///< after the step, s
  double step = 0;            ///< s
  std::size_t cuts = 0;       ///< times this step was shortened because it failed
  std::size_t shortened = 0;  ///< times it was shortened for displacement, rotation or gaps
  std::size_t slip_ends = 0;  ///< times it was shortened to end where slip does
  std::size_t retries = 0;    ///< times it was redone with contacts that came up during it
  std::size_t contacts = 0, islands = 0, asleep = 0;
  std::size_t stick = 0, slip = 0, opened = 0, broken = 0;
  double residual = 0;  ///< the worst of the islands
  std::size_t iterations = 0;
  double work = 0;                     ///< operations of all tries
  std::size_t parting = 0;             ///< linear solves that parted penetrating bodies
  PerMethod<std::size_t> solved_by{};  ///< islands
  PerMethod<std::size_t> solves_by{};  ///< iterations of those islands, by the method that ended them
  double max_penetration = 0;          ///< m, after the step
  double max_speed = 0;                ///< of a corner, m/s
  double max_displacement = 0;         ///< of a corner in this step, m
  double unbalanced = 0;  ///< largest force left over (mass times change of velocity over step) over the total weight
  bool impact = false;
  bool slip_turned = false;  ///< slip turned round within the step, which was not ended there: an error of first order
};

/// Blocks in motion. Value type: a copy is a saved state, and `saved` is one as bytes.
///
/// A step is a theta scheme in velocities and contact impulses (Moreau 1988; Jean 1999) on (centroid, angle, modal
/// amplitudes): theta = 1/2, or 1 in groups of bodies where something hits. Impulses act at one common point of both
/// bodies, so momentum and angular momentum hold to rounding. Contacts are solved by connected groups; every answer is
/// judged by its residual and a step that does not reach it is cut and at last refused.
class World final {
 public:
  [[nodiscard]] static std::expected<World, WorldError> make(std::vector<Body> bodies, Laws laws, WorldOptions options,
                                                             std::vector<Tie> ties = {});
  World(const World& other);
  World(World&& other) noexcept;
  World& operator=(const World& other);
  World& operator=(World&& other) noexcept;
  ~World();

  /// One accepted step no longer than `at_most` (s), or the world unchanged and the error. The step actually made is in
  /// the report: displacement, rotation, gaps or a failed contact solve may have shortened it.
  [[nodiscard]] std::expected<StepReport, StepError> step(double at_most = std::numeric_limits<double>::infinity());

  [[nodiscard]] double time() const noexcept;
  [[nodiscard]] std::size_t size() const noexcept;
  [[nodiscard]] const Body& body(std::size_t body) const;
  [[nodiscard]] Vec2 centroid(std::size_t body) const;  ///< scene
  /// Displacement of the centroid since the start: exact where positions far from the origin are rounded.
  [[nodiscard]] Vec2 displacement(std::size_t body) const;
  [[nodiscard]] double rotation(std::size_t body) const;  ///< since the start, whole turns counted
  [[nodiscard]] Vec2 velocity(std::size_t body) const;
  [[nodiscard]] double spin(std::size_t body) const;
  [[nodiscard]] double mass(std::size_t body) const;
  [[nodiscard]] double inertia(std::size_t body) const;
  [[nodiscard]] std::vector<double> modal_amplitudes(std::size_t body) const;
  [[nodiscard]] bool asleep(std::size_t body) const;
  /// Corners of the (deformed) body, scene.
  [[nodiscard]] std::vector<Vec2> outline(std::size_t body) const;
  /// Where a point of the undeformed body (coordinates of Body::outline) is now; elastic displacement is that of the
  /// nearest point of the outline.
  [[nodiscard]] Vec2 position(std::size_t body, Vec2 local) const;

  /// Contacts of the last step, in the order of (vertex body, vertex, edge body, edge).
  [[nodiscard]] const std::vector<Contact>& contacts() const noexcept;
  /// As they were given.
  [[nodiscard]] std::vector<TieState> ties() const;
  [[nodiscard]] const Energy& energy() const noexcept;
  [[nodiscard]] Vec2 momentum() const;            ///< of bodies that are not fixed
  [[nodiscard]] double angular_momentum() const;  ///< about the origin of the scene
  [[nodiscard]] const WorldOptions& options() const noexcept;

  /// The world is as it was when there is an error: no such body, or no finite velocity.
  [[nodiscard]] std::expected<void, WorldError> set_velocity(std::size_t body, Vec2 velocity, double spin);
  /// A step that is not positive and finite is an error.
  [[nodiscard]] std::expected<void, WorldError> set_step(double step);
  /// Every group of contacts the next step of this length would solve, as it stands (cold); none for a step that is
  /// not positive and finite.
  [[nodiscard]] std::vector<ContactProblem> problems(double step) const;

  /// All that this world carries from step to step, as bytes: the same on every machine and for every number of
  /// threads. Bodies, laws and options are not in it.
  [[nodiscard]] std::string saved() const;
  /// Goes on from there: every later step is that of the world that was saved, to the last bit. This world must have
  /// been made of the same bodies, laws, gravity, `quasi_static` and functions of time (which cannot be compared); its
  /// other options may differ. It is as it was when there is an error.
  [[nodiscard]] std::expected<void, SavedFault> restore(std::string_view saved);

  /// How a body would swing on the springs of the joints that it touches now, if its neighbours stayed.
  struct SpringSwings {
    Time shortest{}, longest{};  ///< periods, of all bodies to all sides
  };
  /// Nothing: no body lies on a joint with stiffness.
  [[nodiscard]] std::optional<SpringSwings> spring_swings() const;

  struct Impl;

 private:
  explicit World(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// ---- static answers

struct RelaxOptions {
  double step = 0.05;       ///< s; large against the first period
  double criterion = 1e-8;  ///< largest unbalanced force over the weight of the body it acts on
  std::size_t most = 2000;
};
struct Relaxed {
  bool at_rest = false;  ///< the criterion holds; otherwise bodies still move: there may be no equilibrium
  std::size_t steps = 0;
  double unbalanced = 0;
};
/// Static equilibrium under constant loads by dynamic relaxation: implicit steps, each from rest, until no body gains
/// more than `criterion` of the velocity its weight would give it in a step.
[[nodiscard]] std::expected<Relaxed, StepError> relax(World& world, const RelaxOptions& options);

}  // namespace cleave::dbem
