#pragma once

/// What the study "engines" asks of every engine: the same bodies, laws and step, the poses at some times, and how long
/// that took.

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cleave/motion/world.hpp"

namespace cleave::study::engines {

using geometry::Vec3;
using motion::Turn;

/// A convex body, given about its centroid.
struct Body {
  motion::Polyhedron shape;
  std::optional<Vec3> sides = {};  ///< of a box along the body axes
  Vec3 at = {};
  Turn turn = {};
  Vec3 velocity = {}, spin = {};  ///< spin in scene axes
  double density = 1000;
  double friction = 0;  ///< tangent; of two bodies that touch the lesser counts
};
/// Rock below the plane z = 0 of turned axes through the origin; never moves.
struct Floor {
  Turn turn = {};
  double friction = 0;
};
struct Scene {
  std::vector<Body> bodies;
  std::vector<Floor> floors;
  Vec3 gravity = {0, 0, -9.81};
  double restitution = 0;
};

/// How an engine is asked.
struct Setting {
  double step = 0.01;    ///< s
  std::string way = {};  ///< words that the engine knows, separated by blanks
  int iterations = 0;    ///< 0: the engine decides
};

struct Pose {
  Vec3 at;
  Turn turn;  ///< from the body axes of `Body`
  Vec3 velocity, spin;
};
struct Outcome {
  std::vector<std::vector<Pose>> frames;  ///< at the times asked for, of all bodies
  std::optional<double> reaction = {};    ///< N, of the floors against gravity in the last step
  double wall_s = 0, cpu_s = 0;           ///< of the steps alone
  std::string stopped = {};               ///< why it gave up; empty when it did not
};

struct MassOf {
  double mass = 0;
  motion::Symmetric inertia;  ///< about the centroid, body axes
};
[[nodiscard]] MassOf mass_of(const Body& body);

/// Takes steps until the times asked for and writes down poses; `step` returns false to give up.
[[nodiscard]] Outcome follow(const std::vector<double>& times, double step, const std::function<bool()>& advance,
                             const std::function<std::vector<Pose>()>& poses);

class Engine {
 public:
  Engine() = default;
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;
  Engine(Engine&&) = delete;
  Engine& operator=(Engine&&) = delete;
  virtual ~Engine() = default;
  [[nodiscard]] virtual std::string name() const = 0;
  /// False: the engine was not there when this was built; the reason is `name` of a package.
  [[nodiscard]] virtual bool present() const = 0;
  /// The times are multiples of the step.
  [[nodiscard]] virtual Outcome run(const Scene& scene, const Setting& setting, const std::vector<double>& times) = 0;
};

[[nodiscard]] Engine& cleave_engine();
[[nodiscard]] Engine& bullet_engine();
[[nodiscard]] Engine& ode_engine();
[[nodiscard]] Engine& siconos_engine();

}  // namespace cleave::study::engines
