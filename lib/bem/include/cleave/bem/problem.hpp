#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "cleave/core/quantity.hpp"
#include "cleave/core/vec2.hpp"

namespace cleave::bem {

// ---- Outlines
// --------------------------------------------------------------------------------------------------------

// Small values of the plane. x to the right, y up; metres, newtons per metre, pascals, as the user of them says.

using cleave::Vec2;

/// A 2x2 matrix by rows.
struct Mat2 {
  double xx = 0, xy = 0, yx = 0, yy = 0;

  friend constexpr Mat2 operator+(Mat2 a, Mat2 b) noexcept {
    return {a.xx + b.xx, a.xy + b.xy, a.yx + b.yx, a.yy + b.yy};
  }
  friend constexpr Mat2 operator-(Mat2 a, Mat2 b) noexcept {
    return {a.xx - b.xx, a.xy - b.xy, a.yx - b.yx, a.yy - b.yy};
  }
  friend constexpr Mat2 operator*(double s, Mat2 a) noexcept { return {s * a.xx, s * a.xy, s * a.yx, s * a.yy}; }
  constexpr Mat2& operator+=(Mat2 b) noexcept { return *this = *this + b; }
  friend constexpr Vec2 operator*(Mat2 a, Vec2 v) noexcept {
    return {a.xx * v.x + a.xy * v.y, a.yx * v.x + a.yy * v.y};
  }
};

/// In-plane stress or strain, tension positive; the part out of the plane follows from the plane state.
struct Sym2 {
  double xx = 0, xy = 0, yy = 0;

  friend constexpr Sym2 operator+(Sym2 a, Sym2 b) noexcept { return {a.xx + b.xx, a.xy + b.xy, a.yy + b.yy}; }
  friend constexpr Sym2 operator-(Sym2 a, Sym2 b) noexcept { return {a.xx - b.xx, a.xy - b.xy, a.yy - b.yy}; }
  friend constexpr Sym2 operator*(double s, Sym2 a) noexcept { return {s * a.xx, s * a.xy, s * a.yy}; }
  constexpr Sym2& operator+=(Sym2 b) noexcept { return *this = *this + b; }
  /// Traction on the face of unit normal n.
  friend constexpr Vec2 operator*(Sym2 a, Vec2 n) noexcept {
    return {a.xx * n.x + a.xy * n.y, a.xy * n.x + a.yy * n.y};
  }
  friend constexpr bool operator==(Sym2, Sym2) noexcept = default;
};

/// One side of a loop: from `start` to the start of the next side (the last one closes the loop), straight or on the
/// arc of a circle through `through`.
struct Side {
  Vec2 start;  ///< m
  std::optional<Vec2> through = {};
  std::size_t condition = 0;                 ///< index into Region::conditions
  std::optional<std::size_t> elements = {};  ///< empty: from the element size of the problem
  /// 1: even lengths; larger: element ends at (k/n)^grade from that end, which makes elements near it shorter.
  double grade_start = 1;
  double grade_end = 1;
  friend bool operator==(const Side&, const Side&) = default;
};

/// A closed curve. The material lies on its left: the outer loop of a body runs counter-clockwise, holes clockwise.
using Loop = std::vector<Side>;

/// A full circle as two arcs; clockwise for a hole or an opening.
[[nodiscard]] Loop circle(Vec2 centre, double radius, bool clockwise, std::size_t condition = 0,
                          std::optional<std::size_t> elements = {});
/// A polygon with one condition on all sides.
[[nodiscard]] Loop polygon(const std::vector<Vec2>& corners, std::size_t condition = 0,
                           std::optional<std::size_t> elements = {});
[[nodiscard]] Loop reversed(const Loop& loop);

/// Loops and sides count from 0.
struct TooFewSides {
  std::size_t loop;
};
struct NotFinite {
  std::size_t loop, side;
};
struct SideWithoutLength {
  std::size_t loop, side;
};
struct SidesCross {
  std::size_t loop_a, side_a, loop_b, side_b;
  Vec2 at;
};
struct HoleOutside {
  std::size_t loop;
};
using OutlineError = std::variant<TooFewSides, NotFinite, SideWithoutLength, SidesCross, HoleOutside>;
[[nodiscard]] std::string describe(const OutlineError& error);

struct CheckedLoops {
  std::vector<Loop> loops;
  std::vector<std::size_t> turned;  ///< loops that ran the wrong way and were reversed
};

/// Checks that loops are simple, do not touch each other and nest; turns those that run the wrong way. The first loop
/// is the outer one unless `exterior` (then all loops are openings in an infinite region). O(n log n) is not needed at
/// the sizes of boundary elements: O(n^2) in the number of chords (an arc counts as 16).
[[nodiscard]] std::expected<CheckedLoops, OutlineError> check_loops(std::vector<Loop> loops, bool exterior);

/// Area (m2), centroid and second moment about the centroid (m4) enclosed by the loops, arcs exact to 1e-12.
struct AreaMoments {
  double area = 0;
  Vec2 centroid;
  double polar = 0;
};
[[nodiscard]] AreaMoments area_moments(const std::vector<Loop>& loops);

/// Point and derivative on a side at t in [0, 1].
struct SidePoint {
  Vec2 x;
  Vec2 derivative;
};
[[nodiscard]] SidePoint point_on(const Loop& loop, std::size_t side, double t);
[[nodiscard]] double length_of(const Loop& loop, std::size_t side);
/// Signed angle swept by an arc, 0 for a straight side.
[[nodiscard]] double sweep_of(const Loop& loop, std::size_t side);
/// Whether the point lies inside (winding number of the chords and arcs together).
[[nodiscard]] bool inside(const std::vector<Loop>& loops, Vec2 point);

// ---- Material -------------------------------------------------------------------------------------------------------

enum class PlaneState : std::uint8_t { strain, stress };

struct BadModulus {
  double young_pa;
};
struct BadPoisson {
  double poisson;
};
struct BadDensity {
  double density;
};
using MaterialError = std::variant<BadModulus, BadPoisson, BadDensity>;
[[nodiscard]] std::string describe(const MaterialError& error);

/// Isotropic and linear. Plane stress is plane strain with another Poisson ratio: nu' = nu / (1 + nu), same shear
/// modulus (Timoshenko and Goodier 1951, section 15), so every formula of this module is written for plane strain.
class Material final {
 public:
  /// Needs young > 0 (finite), -1 < poisson < 0.5 (plane strain; in plane stress 0.5 itself too), density >= 0.
  [[nodiscard]] static std::expected<Material, MaterialError> make(Stress young, double poisson, Density density,
                                                                   PlaneState state = PlaneState::strain);

  [[nodiscard]] double young() const noexcept { return young_; }                      ///< Pa
  [[nodiscard]] double poisson() const noexcept { return poisson_; }                  ///< as given
  [[nodiscard]] double density() const noexcept { return density_; }                  ///< kg/m3
  [[nodiscard]] double mu() const noexcept { return young_ / (2 * (1 + poisson_)); }  ///< Pa
  [[nodiscard]] double nu() const noexcept {
    return state_ == PlaneState::strain ? poisson_ : poisson_ / (1 + poisson_);
  }
  [[nodiscard]] double lambda() const noexcept { return 2 * mu() * nu() / (1 - 2 * nu()); }  ///< Pa, in-plane
  [[nodiscard]] PlaneState state() const noexcept { return state_; }
  /// Stress normal to the plane, Pa.
  [[nodiscard]] double out_of_plane(Sym2 stress) const noexcept {
    return state_ == PlaneState::strain ? poisson_ * (stress.xx + stress.yy) : 0.0;
  }
  /// In-plane stress of an in-plane strain.
  [[nodiscard]] Sym2 stress(Sym2 strain) const noexcept {
    const double l = lambda() * (strain.xx + strain.yy);
    return {l + 2 * mu() * strain.xx, 2 * mu() * strain.xy, l + 2 * mu() * strain.yy};
  }
  [[nodiscard]] Sym2 strain(Sym2 s) const noexcept {
    const double t = nu() * (s.xx + s.yy);
    return {(s.xx - t) / (2 * mu()), s.xy / (2 * mu()), (s.yy - t) / (2 * mu())};
  }

 private:
  Material(double young, double poisson, double density, PlaneState state)
      : young_{young}, poisson_{poisson}, density_{density}, state_{state} {}
  double young_, poisson_, density_;
  PlaneState state_;
};

// ---- Mesh -----------------------------------------------------------------------------------------------------------

/// Polynomial order of displacement and traction on an element.
enum class Order : std::uint8_t { constant = 0, linear = 1, quadratic = 2 };
[[nodiscard]] constexpr std::size_t nodes_of(Order order) noexcept { return static_cast<std::size_t>(order) + 1; }

/// x(s) = c0 + c1 s + c2 s^2, s in [-1, 1]; straight sides are exactly straight (c2 = 0), arcs quadratic.
struct Element {
  Vec2 c0, c1, c2;
  bool curved = false;
  std::array<std::uint32_t, 3> node{};  ///< displacement nodes, nodes_of(order) of them
  std::uint32_t loop = 0;
  std::uint32_t side = 0;

  [[nodiscard]] Vec2 at(double s) const noexcept { return c0 + s * (c1 + s * c2); }
  [[nodiscard]] Vec2 derivative(double s) const noexcept { return c1 + (2 * s) * c2; }
  [[nodiscard]] Vec2 normal(double s) const noexcept {
    const Vec2 t = derivative(s);
    return turned_right(t) / norm(t);
  }
};

/// Values of the shape functions at s, and their derivatives; unused places are 0.
[[nodiscard]] constexpr std::array<double, 3> shape(Order order, double s) noexcept {
  switch (order) {
    case Order::constant: return {1, 0, 0};
    case Order::linear: return {(1 - s) / 2, (1 + s) / 2, 0};
    case Order::quadratic: return {s * (s - 1) / 2, 1 - s * s, s * (s + 1) / 2};
  }
  return {};
}
[[nodiscard]] constexpr std::array<double, 3> shape_slope(Order order, double s) noexcept {
  switch (order) {
    case Order::constant: return {0, 0, 0};
    case Order::linear: return {-0.5, 0.5, 0};
    case Order::quadratic: return {s - 0.5, -2 * s, s + 0.5};
  }
  return {};
}
/// Second derivatives (constant).
[[nodiscard]] constexpr std::array<double, 3> shape_curve(Order order) noexcept {
  return order == Order::quadratic ? std::array<double, 3>{1, -2, 1} : std::array<double, 3>{0, 0, 0};
}
/// Local coordinates of the nodes.
[[nodiscard]] std::span<const double> local_nodes(Order order) noexcept;

/// One element of which a node is part.
struct Use {
  std::uint32_t element;
  std::uint32_t local;
};

struct Node {
  Vec2 x;
  std::vector<Use> uses;  ///< the element that ends here first, then the one that starts
  bool corner = false;    ///< the outline turns here (by more than 1e-7 rad), or the condition changes
};

/// Elements and nodes of one region's boundary.
struct Mesh {
  Order order = Order::quadratic;
  std::vector<Element> elements;
  std::vector<Node> nodes;

  [[nodiscard]] std::size_t per_element() const noexcept { return nodes_of(order); }
};

/// A point of an outline.
struct BoundaryPlace {
  std::size_t element = 0;
  double s = 0;  ///< -1..1 along it
};
/// The point of the outline that lies nearest.
[[nodiscard]] BoundaryPlace nearest_place(const Mesh& mesh, Vec2 x);

struct MeshSize {
  Order order = Order::quadratic;
  std::optional<double> element = {};  ///< longest element, m; empty: a sixteenth of the outline's larger extent
  double arc_degrees = 15;             ///< at most this much of an arc on one element
  std::size_t subdivide = 1;           ///< every element count is multiplied by this
};

/// Coordinates become (x - origin) / scale. Precondition: the loops have passed check_loops.
[[nodiscard]] Mesh make_mesh(const std::vector<Loop>& loops, const MeshSize& size, Vec2 origin = {}, double scale = 1);

// ---- Problem --------------------------------------------------------------------------------------------------------

/// A given value at a boundary point x (m) with outward unit normal n.
using Value = std::function<double(Vec2 x, Vec2 n)>;

enum class Given : std::uint8_t {
  traction,      ///< value in Pa
  displacement,  ///< value in m
  spring,        ///< traction = value (Pa) - stiffness (Pa/m) * displacement, along the component's direction
};

struct Component {
  Given given = Given::traction;
  Value value = {};  ///< empty: 0
  double stiffness = 0;
};

enum class Axes : std::uint8_t {
  fixed,   ///< first component along x turned by `turn`, second a quarter turn counter-clockwise of it
  normal,  ///< first along the outward normal, second along the boundary's direction (material on the left)
};

/// What is known on a side: one statement a component. Traction in one direction and displacement in the other is
/// a roller, along any direction.
struct Condition {
  Axes axes = Axes::fixed;
  double turn = 0;  ///< radians, counter-clockwise
  std::array<Component, 2> component = {};
  bool bonded = false;  ///< glued to a side of another region that runs the other way; `component` is not used
};

[[nodiscard]] Condition free_surface();
[[nodiscard]] Condition clamped();
/// No displacement across, no traction along: a roller; a line of symmetry.
[[nodiscard]] Condition roller();
/// Of a fluid: traction -p along the outward normal.
[[nodiscard]] Condition pressure(double pascals);
[[nodiscard]] Condition traction(Vec2 pascals);
[[nodiscard]] Condition traction(std::function<Vec2(Vec2 x, Vec2 n)> pascals);
[[nodiscard]] Condition displacement(std::function<Vec2(Vec2 x)> metres);
/// Distributed springs, Pa/m, along normal and boundary.
[[nodiscard]] Condition springs(double normal, double along);
[[nodiscard]] Condition bonded();

/// A force per metre of thickness (N/m) on the boundary; it becomes the traction of its element that has the same work
/// with every shape function, so that force and moment are kept to rounding.
struct PointForce {
  std::size_t region = 0;
  Vec2 at;
  Vec2 force;
};

/// Stress before loading (of the undisturbed rock, or locked in): linear in the height y.
struct InSitu {
  Sym2 stress;       ///< Pa at y = level; compression negative
  double level = 0;  ///< m
  Sym2 gradient;     ///< Pa/m, change with y upwards
};

/// Accelerations of the frame and of gravity. A body that turns with angular velocity `spin` about `centre` carries
/// the centrifugal load density spin^2 (x - centre).
struct BodyLoad {
  Vec2 gravity;                     ///< m/s2
  double spin = 0;                  ///< rad/s
  double angular_acceleration = 0;  ///< rad/s2: load -density alpha z cross (x - centre)
  Vec2 centre;
};

struct Region {
  std::string name = "body";
  Material material;
  std::vector<Loop> loops = {};
  std::vector<Condition> conditions = {};  ///< sides name them by index
};

enum class Extent : std::uint8_t {
  bounded,
  plane,       ///< openings in an infinite plane
  half_plane,  ///< openings below the free surface y = surface
};

/// A static problem. Regions touch only along bonded sides.
struct Problem {
  std::vector<Region> regions;
  Extent extent = Extent::bounded;
  double surface = 0;  ///< m; half_plane only
  std::vector<PointForce> forces = {};
  BodyLoad load = {};
  InSitu in_situ = {};
};

struct Options {
  MeshSize mesh;
  double integration = 1e-10;  ///< relative error target of the integrals
  unsigned threads = 1;
  /// A free body is held without reactions: loads that do not balance are met by the acceleration they cause
  /// (inertia relief), displacements are those without mean translation and rotation.
  bool restrain = false;
  double memory_limit_mb = 6000;  ///< of the dense system
};

}  // namespace cleave::bem
