#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/core/quantity.hpp"
#include "cleave/core/sha256.hpp"
#include "cleave/geometry/vec3.hpp"

/// Rigid polyhedral blocks in three dimensions with contacts on Coulomb's cone. SI units.
namespace cleave::motion {

using geometry::Vec3;

/// A flat side of a polyhedron: loops of vertex numbers, [0] outer, counter-clockwise seen from outside, then holes,
/// clockwise. Sides of a cavity look into the cavity.
struct Facet {
  std::vector<std::vector<std::uint32_t>> loops;
  std::uint32_t surface = 0;  ///< whose friction it has, an index into `Laws::surfaces`
};

/// A closed polyhedron, convex or not, with holes and cavities.
struct Polyhedron {
  std::vector<Vec3> vertices;  ///< m
  std::vector<Facet> facets;
};

/// A symmetric matrix.
struct Symmetric {
  double xx = 0, yy = 0, zz = 0, xy = 0, yz = 0, zx = 0;
  [[nodiscard]] constexpr Vec3 operator*(Vec3 v) const noexcept {
    return {xx * v.x + xy * v.y + zx * v.z, xy * v.x + yy * v.y + yz * v.z, zx * v.x + yz * v.y + zz * v.z};
  }
};

struct BadPolyhedron {
  std::string reason;
};

/// Volume, centroid and inertia of unit density about the centroid.
struct MassProperties {
  double volume = 0;
  Vec3 centroid;
  Symmetric inertia;
};
/// By signed tetrahedra about a vertex of the polyhedron (Mirtich 1996): as good far from the origin as near it, up to
/// the rounding of the vertices themselves. Refused: numbers that are not finite, loops of fewer than three corners or
/// of vertices that are not there, no volume.
[[nodiscard]] std::expected<MassProperties, BadPolyhedron> mass_properties(const Polyhedron& polyhedron);

/// A unit quaternion: from body axes to the scene's.
struct Turn {
  double w = 1, x = 0, y = 0, z = 0;
  [[nodiscard]] Vec3 operator*(Vec3 v) const noexcept;  ///< turned
  [[nodiscard]] Vec3 back(Vec3 v) const noexcept;       ///< turned by the inverse
  friend Turn operator*(Turn a, Turn b) noexcept;       ///< first b, then a
  friend bool operator==(const Turn&, const Turn&) = default;
};
/// Cayley map of a rotation vector: angle 2 atan(|u| / 2).
[[nodiscard]] Turn cayley(Vec3 u) noexcept;
/// By the length of the vector, about it.
[[nodiscard]] Turn turn_by(Vec3 rotation) noexcept;
[[nodiscard]] Turn normalized(Turn turn) noexcept;
/// Angle between the body axes and the scene's, 0 to pi.
[[nodiscard]] double angle_of(Turn turn) noexcept;

/// How a free body turns: attitude, and angular momentum in body axes.
struct Spinning {
  Turn turn;
  Vec3 momentum;
};
/// The same after `h` without torque: momentum in space and energy are kept to rounding for every h; order 2 (Simo and
/// Wong 1991; Lewis and Simo 1994).
[[nodiscard]] Spinning drift(const Symmetric& inertia, const Spinning& start, double h) noexcept;
/// Spin in body axes: the inverse of the inertia times the momentum.
[[nodiscard]] Vec3 solve(const Symmetric& inertia, Vec3 momentum) noexcept;

// ---- what a scene holds

/// Strength between two sides that touch: the lesser of their two values counts.
struct Surface {
  double friction = 0;     ///< tangent of the angle
  double restitution = 0;  ///< 0 to 1, of the speed of approach
};

struct BodySpec {
  Polyhedron shape;  ///< where it stands at the start
  Density density = kilograms_per_cubic_metre(1);
  bool fixed = false;  ///< never moves: a wall
  Vec3 velocity = {};  ///< of the centroid
  Vec3 spin = {};      ///< 1/s, scene axes
};

/// Rock bridge or cement between two bodies, until it gives.
///
/// Pull is brittle: stress is linear over the patch, and where its largest pull reaches the tension (at most the apex
/// cohesion / friction of the line of Mohr and Coulomb) the whole patch has none any more, in the same step. A square
/// of side b that hangs from a point e off its middle bears 1 / (1 + 6 e / b) of its tension. Until then nothing else
/// presses there: pressure acts within the core of the patch. Cohesion is shared out over the points of `shares`,
/// beside friction, and is gone after the step in which one of them slips or opens.
struct Bond {
  struct Share {
    Vec3 point;
    double area = 0;
  };
  std::uint32_t body = 0, other = 0;
  Vec3 normal;  ///< unit, from `other` into `body`
  std::vector<Share> shares;
  double cohesion = 0, tension = 0;  ///< per area
  double friction = 0;               ///< tangent of the angle
  /// Points whose hull is that of the patch and whose areas have its moments, up to the second, about its plane: those
  /// of `add_triangle` do. Empty: `shares`.
  std::vector<Share> patch = {};
};
/// Shares of a triangle: corners 1/12 each, centroid 3/4 (the wrench of a linear pressure is exact).
void add_triangle(Vec3 a, Vec3 b, Vec3 c, std::vector<Bond::Share>& shares);

/// Bolt or cable that two bodies hang on by its ends. It pulls along the straight line between them, wherever they have
/// come to, and does not push; it is rigid up to its capacity and lengthens under that force. What several ties share
/// out between them is whatever their capacities allow, as in limit analysis. No mass, no shear.
struct Tie {
  std::uint32_t body = 0, other = 0;
  Vec3 end, other_end;  ///< where it is fixed to each, at the start; apart
  Force capacity = {};
  Length ductility = {};  ///< that it lengthens at its capacity; gone after the step in which it comes to more
};
/// What became of a tie.
struct TieState {
  Force force = {};        ///< in the last step; none of what is broken
  Length lengthened = {};  ///< at its capacity
  bool broken = false;
};

/// A force on a body beside its weight. It acts at a point of it, whatever way that goes, for as long as `opens` and
/// `slides` say. Between two bodies, as the pressure of water in the joint of both, it acts on each, the other way
/// round, halfway between where the point has come to with the one and with the other, and turns with `other`. On one
/// body alone it keeps its direction.
struct Load {
  std::uint32_t body = 0;
  std::optional<std::uint32_t> other = {};
  Vec3 at = {};     ///< m, at the start
  Vec3 force = {};  ///< N, on `body`, at the start
  /// Gone after the step in which its two points (of one body alone, the point and where it was) are farther apart
  /// along the force than `opens`, or across it than `slides`.
  Length opens = metres(std::numeric_limits<double>::infinity());
  Length slides = metres(std::numeric_limits<double>::infinity());
};

/// Water at rest about all bodies: each is lifted by what its part below the level displaces, wherever it is.
struct StillWater {
  Length level = {};  ///< up.x of its surface
  Vec3 up = {0, 0, 1};
  UnitWeight unit_weight = newtons_per_cubic_metre(9810);
};

struct SceneSpec {
  std::vector<BodySpec> bodies;
  std::vector<Surface> surfaces = {{}};
  std::vector<Bond> bonds = {};
  std::vector<Tie> ties = {};
  std::vector<Load> loads = {};
  std::optional<StillWater> water = {};
};

struct BadScene {
  std::string which;  ///< "body 3"; empty: the whole
  std::string reason;
  std::vector<std::uint32_t> bodies = {};  ///< that it is about
};
[[nodiscard]] std::string describe(const BadScene& error);

// ---- solver

enum class Method : std::uint8_t {
  none,      ///< nothing pressed
  newton,    ///< semismooth, from the last forces or from none
  proximal,  ///< along falling proximal weights
  sweeps,    ///< semismooth, from sweeps over the points
  convex,    ///< convex programmes with slip or bounds of friction renewed
  interior,  ///< interior points, then semismooth
};
inline constexpr std::size_t method_count = 6;
[[nodiscard]] std::string_view name_of(Method method) noexcept;

struct SolverOptions {
  double accept = 1e-8;  ///< residual above which an answer is never called converged
  double tolerate = 0;   ///< residual up to which the best answer may be used where none converges; it is called rough
  /// Whether forces that only lock bodies between one another may hold them: what moves they would stop at once.
  bool locking = true;
  /// Whether an answer in which bodies stand is looked at again from motion, and gives way to one that moves.
  bool prefer_motion = true;
  std::size_t patience = 4000;  ///< linear solves after which nothing more is tried
};

/// What a solver says of its answer.
struct SolveReport {
  enum class Status : std::uint8_t {
    converged,
    open,           ///< no contact carries anything
    rough,          ///< the best answer found, not accepted but tolerated
    not_converged,  ///< the best answer found; never to be used as if it were right
  };
  Status status = Status::open;
  double residual = 0;      ///< of the natural map, recomputed at the answer
  double missed_speed = 0;  ///< largest velocity by which a contact misses the law
  Method method = Method::none;
  std::size_t iterations = 0;  ///< linear solves, of all tries
  std::size_t stick = 0, slip = 0, opened = 0;
  double max_penetration = 0;  ///< largest closing velocity left
  /// Another answer holds bodies that move in this one, or none that moves was found or ruled out.
  bool may_be_locked = false;
};

// ---- motion

/// Motion of the ground, which is all that is fixed. Bodies feel the opposite acceleration; what a world says of them
/// is relative to the ground.
struct GroundMotion {
  std::function<Vec3(double from, double to)> mean = {};        ///< acceleration, mean of that time; empty: at rest
  Acceleration peak = {};                                       ///< no less than any acceleration
  Time end = seconds(std::numeric_limits<double>::infinity());  ///< no acceleration after it; nothing sleeps before
  [[nodiscard]] bool moves_at(double time) const noexcept { return mean && time < end.si(); }
  [[nodiscard]] Vec3 over(double from, double to) const { return moves_at(from) ? mean(from, to) : Vec3{}; }
};

struct WorldOptions {
  Vec3 gravity = {0, 0, -9.81};
  double step = 0.01;          ///< the longest
  double theta = 0.5;          ///< share of the step before the kick is 1 - theta; groups that would gain energy take 1
  double displacement = 0.05;  ///< largest displacement of a point in a step over the extent of the bodies that move
  double rotation = 0.05;      ///< largest rotation in a step, radians
  std::size_t cuts = 6;        ///< thirds a failed step is cut into before the run stops
  double overlap = 1e-6;       ///< overlap allowed over the smaller body's size
  bool sleep = true;           ///< groups at rest are left alone until something touches them
  double sleep_speed = 1e-7;
  bool quasi_static = false;  ///< every step starts from rest
  SolverOptions solver = {};
  GroundMotion ground = {};
  unsigned threads = 1;  ///< at least one; whatever it is, every bit is the same
};

/// The step was cut as often as allowed and still failed; the world is as it was before.
struct StepFailed {
  double time = 0, step = 0, residual = 0;
  std::string reason;
  std::vector<std::uint32_t> bodies = {};  ///< that it is about; empty: not known
};
[[nodiscard]] std::string describe(const StepFailed& error);

/// One contact point after a step. The force is that on `body`.
struct Contact {
  std::uint32_t body = 0, other = 0;
  Vec3 point, normal;  ///< normal out of `other`
  double gap = 0;      ///< at the kick
  Vec3 force;
  double slip = 0;  ///< speed
  bool bonded = false;
};

/// All of a run so far: kinetic + potential = start - friction - lost - carried + projected + ground + loads.
struct Energy {
  double start = 0, kinetic = 0, potential = 0;
  double friction = 0;       ///< dissipated by slip
  double lost = 0;           ///< by impacts, ties that yield and the scheme, counted on their own
  double projected = 0;      ///< brought in by parting bodies that overlap and by drawing ties to their length
  double carried = 0;        ///< kinetic, of bodies as `set_fixed` held them: out of the books
  double ground = 0;         ///< work of the ground's acceleration on all bodies, relative to it
  double loads = 0;          ///< work of loads and of still water
  double closing_error = 0;  ///< of the balance, over its largest term
  double largest_gain = 0;   ///< in a step, without what parting brought in
};

struct StepReport {
  double time = 0, step = 0;  ///< after the step; its length
  std::size_t cuts = 0, retries = 0, contacts = 0, islands = 0, asleep = 0;
  std::size_t broken = 0;  ///< bonds and ties, in this step
  std::size_t stick = 0, slip = 0, iterations = 0;
  std::size_t may_be_locked = 0;  ///< bodies in groups of which another answer moves or stands, or may
  std::size_t rough = 0;          ///< bodies in groups whose answer is tolerated only
  double missed_speed = 0;        ///< largest velocity by which a contact misses the law
  double residual = 0;            ///< the worst of the groups
  double max_penetration = 0;     ///< deepest overlap before bodies were parted
  double overlap = 0;             ///< deepest overlap left, looked for apart from the contacts
  double max_speed = 0;           ///< of a point
  double unbalanced = 0;          ///< largest gain of velocity over that of free fall
};

/// Blocks in motion. A copy is a saved state, and `saved` is one as bytes.
///
/// A step drifts, kicks and drifts: bodies turn freely by the Cayley map, impulses act at one common point of both
/// bodies, so momentum and angular momentum hold to rounding. Contacts are solved by connected groups; every answer is
/// judged by its residual. After every step bodies are looked at for overlaps by other means than contacts are found
/// by. A step that fails either is cut, and at last refused.
class World final {
 public:
  [[nodiscard]] static std::expected<World, BadScene> make(SceneSpec scene, WorldOptions options);
  World(const World& other);
  World(World&& other) noexcept;
  World& operator=(const World& other);
  World& operator=(World&& other) noexcept;
  ~World();

  /// One accepted step no longer than `at_most`.
  [[nodiscard]] std::expected<StepReport, StepFailed> step(double at_most = std::numeric_limits<double>::infinity());

  [[nodiscard]] double time() const noexcept;
  [[nodiscard]] std::size_t size() const noexcept;
  [[nodiscard]] bool fixed(std::size_t body) const;
  [[nodiscard]] Vec3 centroid(std::size_t body) const;
  /// Of the centroid since the start: exact where positions far from the origin are rounded.
  [[nodiscard]] Vec3 displacement(std::size_t body) const;
  [[nodiscard]] Turn turn(std::size_t body) const;  ///< since the start
  [[nodiscard]] Vec3 velocity(std::size_t body) const;
  [[nodiscard]] Vec3 spin(std::size_t body) const;  ///< scene axes
  [[nodiscard]] double mass(std::size_t body) const;
  [[nodiscard]] double volume(std::size_t body) const;
  [[nodiscard]] bool asleep(std::size_t body) const;
  /// Whether it is in a group that rests in one answer of the contact law and moves in another, or may; of a body that
  /// sleeps, as it fell asleep.
  [[nodiscard]] bool may_be_locked(std::size_t body) const;
  /// Where a point of the body as given in its shape is now.
  [[nodiscard]] Vec3 position(std::size_t body, Vec3 at_start) const;
  /// Lets a fixed body go, or holds one that moves.
  void set_fixed(std::size_t body, bool fixed);

  [[nodiscard]] const std::vector<Contact>& contacts() const noexcept;
  [[nodiscard]] TieState tie(std::size_t number) const;
  /// Whether a load acts no more.
  [[nodiscard]] bool load_gone(std::size_t number) const;
  /// Takes a tie away: it counts as broken from now on.
  void cut(std::size_t tie);
  [[nodiscard]] const Energy& energy() const noexcept;
  [[nodiscard]] Vec3 momentum() const;
  [[nodiscard]] Vec3 angular_momentum() const;  ///< about the origin
  /// What momentum should be by all forces so far, less what it is, over the largest so far.
  [[nodiscard]] double momentum_error() const noexcept;
  [[nodiscard]] const WorldOptions& options() const noexcept;

  /// All that this world carries from step to step, as bytes. Bodies, laws and options are not in it.
  [[nodiscard]] std::string saved() const;
  /// Goes on from there: every later step is that of the world that was saved, to the last bit. This world must have
  /// been made of the same bodies, laws, gravity, motion of the ground, `quasi_static` and `sleep`; its other options
  /// may differ. It is as it was when there is an error.
  [[nodiscard]] std::expected<void, SavedFault> restore(std::string_view saved);

  struct Impl;

 private:
  explicit World(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace cleave::motion
