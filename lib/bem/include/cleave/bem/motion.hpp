#pragma once

#include <cstddef>
#include <expected>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "cleave/bem/block.hpp"
#include "cleave/bem/inner_point.hpp"
#include "cleave/bem/reshape.hpp"
#include "cleave/bem/time_scheme.hpp"

namespace cleave::bem {

/// Nodal forces times a function of time; world axes unless `follows`, then they turn with the body.
struct TimedLoad {
  std::vector<double> forces;            ///< of BlockOperator::forces_of and its like
  std::function<double(double)> factor;  ///< of the time in s
  bool follows = false;
  /// Forces on a rebuilt operator; empty: they stay as they are (a dead load keeps its size).
  std::function<std::vector<double>(const BlockOperator&)> again = {};
};

/// Operators turn with their body and are kept until `steepest` of what happened since they were built exceeds
/// `gradient`; then the body goes on in its deformed shape with the stress it carries. 0: never.
struct Rebuilding {
  double gradient = 0;
  BlockOptions build = {};
};

/// C = alpha M + beta K, plus a share of critical damping in every mode.
struct Damping {
  double alpha = 0;  ///< 1/s
  double beta = 0;   ///< s
  double share = 0;
};

struct BadStep {
  double step_s;
};
struct NotConverged {
  double time_s;
  double residual;
};
struct RebuildFailed {
  double time_s;
  BlockError why;
};
using MotionError = std::variant<BadStep, NotConverged, RebuildFailed>;
[[nodiscard]] std::string describe(const MotionError& error);

/// Linear vibration of a supported body, in its modes: any scheme, any step, O(modes) a step.
class Vibration final {
 public:
  /// Precondition: step > 0.
  Vibration(const BlockOperator& block, Modes modes, Scheme scheme, double step, Damping damping,
            std::vector<TimedLoad> loads);

  /// Supports and springs of the modes, so that a rebuilt operator has the same.
  void rebuild_by(Rebuilding rule, std::vector<HeldFreedom> held, std::vector<NodeSpring> springs);

  /// Without a rule of rebuilding it cannot fail.
  std::expected<void, MotionError> advance();
  [[nodiscard]] double time() const noexcept { return static_cast<double>(steps_) * step_; }
  [[nodiscard]] std::vector<double> displacement() const;  ///< freedoms, since the start
  /// Newest operator, and the freedoms whose linear field on it carries the stress now.
  [[nodiscard]] const BlockOperator& block() const noexcept { return *block_; }
  [[nodiscard]] const Modes& modes() const noexcept { return modes_; }
  [[nodiscard]] std::vector<double> strained() const;
  /// Follows a point inside (first shape, body's frame: relative to the centroid) from now on; its number.
  std::size_t follow(Vec2 inside);
  /// Displacement since the start and stress of a followed point, both in the body's frame.
  [[nodiscard]] InnerState inner(std::size_t point) const;
  [[nodiscard]] std::size_t rebuilds() const noexcept { return rebuilds_; }
  /// Largest `steepest` since a build.
  [[nodiscard]] double steepest_seen() const noexcept { return seen_; }
  [[nodiscard]] std::vector<double> velocity() const;
  [[nodiscard]] Vec2 displacement_at(BoundaryPlace place) const;
  [[nodiscard]] double kinetic_energy() const;
  [[nodiscard]] double elastic_energy() const;
  void set_velocity(const std::vector<double>& freedoms);

 private:
  [[nodiscard]] double force_at(std::size_t mode, double time) const;
  [[nodiscard]] double drag_of(std::size_t mode) const;
  void project();
  [[nodiscard]] std::expected<void, MotionError> rebuild();
  const BlockOperator* block_;
  std::unique_ptr<BlockOperator> own_;  // of a rebuilt shape
  Rebuilding rule_;
  std::vector<HeldFreedom> held_;
  std::vector<NodeSpring> springs_;
  std::optional<CarriedStress> carried_;
  std::vector<double> before_build_;  // freedoms up to the last build
  std::vector<double> internal_;      // modal forces of the stress carried
  std::vector<double> steep_;         // of each mode
  std::vector<InnerPoint> inner_;
  double seen_ = 0;
  std::size_t rebuilds_ = 0, since_build_ = 0;
  Modes modes_;
  Scheme scheme_;
  double step_;
  Damping damping_;
  std::vector<TimedLoad> loads_;
  std::vector<std::vector<double>> projected_;  // loads by modes
  std::vector<double> u_, v_, a_, before_, before2_;
  std::size_t steps_ = 0;
};

/// A point of the body held to a point of the world.
struct Pin {
  BoundaryPlace place;
  Vec2 anchor;
};

struct Energy {
  double kinetic = 0, elastic = 0, gravity = 0;
  [[nodiscard]] double total() const noexcept { return kinetic + elastic + gravity; }
};

/// Large motion of a free or pinned body by a floating frame: x = c + R(theta) (X + Phi e). Rotation comes from the
/// angle, never from summed increments, so a body neither grows nor twists; the elastic operator stays that of the
/// body's own frame and turns with it. Generalized-alpha or Newmark, Newton's method on each step. Left out between
/// builds: the change of inertia with e, of the order of the strain. A rebuild keeps place, momentum and angular
/// momentum.
class FreeMotion final {
 public:
  struct Setup {
    Scheme scheme = GeneralizedAlpha{};
    double step = 1e-3;      ///< s
    std::size_t modes = 12;  ///< elastic modes kept; 0: rigid
    Vec2 gravity = {};       ///< m/s2
    Damping damping = {};
    std::vector<TimedLoad> loads = {};
    std::vector<Pin> pins = {};
    Vec2 velocity = {};
    double spin = 0;  ///< rad/s
    Rebuilding rebuilding = {};
  };
  FreeMotion(const BlockOperator& block, Setup setup);

  [[nodiscard]] std::expected<void, MotionError> advance();
  [[nodiscard]] double time() const noexcept { return static_cast<double>(steps_) * setup_.step; }
  [[nodiscard]] Vec2 centroid() const noexcept;
  /// Radians since the start, whole turns counted.
  [[nodiscard]] double rotation() const noexcept { return q_[2]; }
  [[nodiscard]] Vec2 velocity() const noexcept { return {v_[0], v_[1]}; }
  [[nodiscard]] double spin() const noexcept { return v_[2]; }
  [[nodiscard]] Vec2 position(BoundaryPlace place) const;
  [[nodiscard]] const Modes& modes() const noexcept { return modes_; }
  [[nodiscard]] bool pinned() const noexcept { return !setup_.pins.empty(); }
  /// Elastic displacement in the body's frame, since the start.
  [[nodiscard]] std::vector<double> deformation() const;
  /// Largest elastic displacement over the body's size.
  [[nodiscard]] double relative_deformation() const;
  /// Newest operator, and the freedoms whose linear field on it carries the stress now.
  [[nodiscard]] const BlockOperator& block() const noexcept { return *block_; }
  [[nodiscard]] std::vector<double> strained() const;
  /// Follows a point inside (first shape, body's frame: relative to the centroid) from now on; its number.
  std::size_t follow(Vec2 inside);
  /// Displacement since the start and stress of a followed point, both in the body's frame.
  [[nodiscard]] InnerState inner(std::size_t point) const;
  [[nodiscard]] std::size_t rebuilds() const noexcept { return rebuilds_; }
  /// Largest `steepest` since a build.
  [[nodiscard]] double steepest_seen() const noexcept { return seen_; }
  [[nodiscard]] Energy energy() const;
  [[nodiscard]] Vec2 momentum() const noexcept;
  [[nodiscard]] double angular_momentum() const noexcept;  ///< about the origin of the world
  [[nodiscard]] std::size_t largest_iterations() const noexcept { return most_iterations_; }

 private:
  void adopt();
  void start();
  [[nodiscard]] std::expected<void, MotionError> rebuild();
  [[nodiscard]] std::vector<double> since_build() const;
  const BlockOperator* block_;
  std::unique_ptr<BlockOperator> own_;  // of a rebuilt shape
  Setup setup_;
  Modes modes_;
  std::optional<CarriedStress> carried_;
  std::vector<double> before_build_;  // freedoms up to the last build
  std::vector<double> internal_;      // modal forces of the stress carried
  std::vector<double> steep_;         // of each mode
  std::vector<InnerPoint> inner_;
  double seen_ = 0;
  std::size_t rebuilds_ = 0;
  std::vector<double> q_, v_, a_, pin_force_, pull_;
  std::vector<double> centrifugal_;
  std::vector<std::vector<double>> pin_shapes_;  // x row, y row a pin
  std::size_t steps_ = 0;
  std::size_t most_iterations_ = 0;
  [[nodiscard]] std::vector<double> loads_at(double time, const std::vector<double>& q, double spin) const;
};

}  // namespace cleave::bem
