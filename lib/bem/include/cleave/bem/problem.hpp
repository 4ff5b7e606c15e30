#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "cleave/bem/material.hpp"
#include "cleave/bem/mesh.hpp"
#include "cleave/bem/outline.hpp"
#include "cleave/bem/vec2.hpp"

namespace cleave::bem {

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
