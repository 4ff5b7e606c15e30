#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "cleave/bem/problem.hpp"
#include "cleave/core/quantity.hpp"

/// Blocks in contact in the plane: the discrete boundary element method. SI units; everything is per metre of
/// thickness, so a mass is in kg/m and a force in N/m. x to the right, y up, angles counter-clockwise in radians.
namespace cleave::dbem {
using bem::Vec2;

/// Elastic shapes of a free body, mass-normalised (phi^T M phi = 1) and orthogonal to its rigid motions. The body then
/// lies at x = c + R(theta) (X + sum_k e_k phi_k(X)) with its centroid at c.
struct ModalBasis {
  std::vector<double> omega;  ///< circular frequencies, rad/s, ascending, all positive
  /// Row r = 2 * vertex + component (x, y in the body's axes), column = mode: entry r * omega.size() + mode, at the
  /// corners of Body::outline. Between corners a shape is linear along the edge.
  std::vector<double> shapes;
  double damping = 0;  ///< share of critical damping of every mode
  /// By mode: what the centrifugal load of a spin of 1 rad/s drives it with, the integral of density times phi . X over
  /// the body. Empty: none is felt.
  std::vector<double> stretch = {};
};

/// A force at a point that moves with the body, times a function of time (s).
struct PointForce {
  Vec2 at;     ///< in the coordinates of Body::outline
  Vec2 force;  ///< N/m; the world's axes unless `follows`
  std::function<double(double)> factor = [](double) { return 1.0; };
  bool follows = false;  ///< turns with the body
  /// Mean of `factor` from one time to another; empty: its value in the middle, which misses what is shorter.
  std::function<double(double, double)> mean = {};
};

/// Freedoms that keep the velocity they start with (0 unless given). All three: a fixed body, or, with modes, a clamped
/// one that still bends (modes of the supported body; gravity on them is up to the caller, as point forces).
struct Held {
  bool x = false, y = false, spin = false;
  [[nodiscard]] constexpr bool all() const noexcept { return x && y && spin; }
  friend constexpr bool operator==(Held, Held) noexcept = default;
};

/// One block as the caller states it.
struct Body {
  std::string name;
  /// Corners counter-clockwise, a simple polygon, convex or not, in coordinates of its own; `origin` says where those
  /// are in the scene. Corners stated near their own origin lose nothing when the scene lies 10^6 m away.
  std::vector<Vec2> outline;
  Vec2 origin = {};
  double density = 0;                  ///< kg/m3; mass and inertia follow from the outline unless they are given
  std::optional<double> mass = {};     ///< kg/m
  std::optional<double> inertia = {};  ///< kg m, about the centroid
  Held held = {};
  Vec2 velocity = {};  ///< of the centroid, m/s
  double spin = 0;     ///< rad/s
  /// Of a fixed body: its velocity (m/s) as a function of time, instead of `velocity`. It goes on by the mean of what
  /// it is at both ends of a step.
  std::function<Vec2(double)> moves = {};
  std::size_t property = 0;  ///< joint property of its faces, see Laws
  /// One an edge (from corner k to the next) instead of `property`; empty: all the same. A corner counts to the one of
  /// its two edges that lies more nearly along the edge it touches.
  std::vector<std::size_t> properties = {};
  /// Of each edge the share of its length that its first corner stands for under an even pressure, the second having
  /// the rest; empty: halves. Elements of second order want a third from an end to their middle.
  std::vector<double> shares = {};
  std::optional<ModalBasis> modes = {};
  std::vector<PointForce> forces = {};
};

/// What acts on a face between two bodies.
struct JointLaw {
  double friction = 0;  ///< tangent of the friction angle
  double cohesion = 0;  ///< Pa, on the length that is in contact at the start, until the bond breaks
  double tension = 0;   ///< Pa, likewise
  /// Pa, on the length of a bond that broke by slip, while its contact stays closed.
  double residual_cohesion = 0;
  std::optional<double> residual_friction = {};  ///< after the bond broke; empty: as `friction`
  /// Tangent of the dilation angle of faces that were closed at the start: away from where they fit they ride up by
  /// this for each unit of slip, to either side. At most friction, of which it is a part: what slides on is held by
  /// `friction`, what slides back by that much less.
  double dilation = 0;
  Length dilation_slip{};  ///< beyond which they rise no further; above 0 where there is dilation
  /// Of water between faces that are closed at the start: it pushes both apart on that length, along the joint as it
  /// lies then in either body, for the whole run, drained or not.
  Stress water_pressure{};
  /// Height of still water, scene: adds 9810 Pa for each metre below it; empty: none.
  std::optional<Length> water_table = {};
  double compliance = 0;  ///< m2/N of one contact point, normal and tangential; 0: rigid
  /// Pa/m of the joint, in place of `compliance`: a contact has that of the length it stands for. Empty: rigid.
  std::optional<double> normal_stiffness = {};
  std::optional<double> shear_stiffness = {};  ///< likewise
  double restitution = 0;                      ///< 0 .. 1, of the normal velocity
};

/// Law of the faces between bodies of properties a and b (either order).
struct PairLaw {
  std::size_t a, b;
  JointLaw law;
};

/// The law of a pair is the one stated for its two properties, else `otherwise`.
struct Laws {
  JointLaw otherwise;
  std::vector<PairLaw> pairs = {};
  [[nodiscard]] const JointLaw& of(std::size_t property_a, std::size_t property_b) const noexcept;
};

/// A bolt between two bodies: a bar that pulls and does not push, elastic up to its capacity, then plastic. Per metre
/// of thickness: what one bolt carries over the distance to the next, out of the plane.
struct Tie {
  std::string name;
  std::size_t first = 0, second = 0;  ///< bodies
  /// Its ends, in coordinates of Body::outline; in bodies that bend they move as the nearest place of the outline.
  Vec2 at_first, at_second;
  Stress stiffness{};  ///< force per metre of thickness over lengthening
  /// At which it yields; infinite: it does not.
  ForcePerLength capacity = ForcePerLength::from_si(std::numeric_limits<double>::infinity());
  Length ductility{};           ///< that it lengthens at its capacity before it breaks; 0: it breaks there
  ForcePerLength pretension{};  ///< when it is installed
  Time installed{};             ///< when it is there: with the step that begins then
};

/// Area, centroid and polar second moment about the centroid of a simple counter-clockwise polygon.
struct PolygonMoments {
  double area = 0;
  Vec2 centroid;
  double polar = 0;
};
[[nodiscard]] PolygonMoments polygon_moments(const std::vector<Vec2>& corners);

}  // namespace cleave::dbem
