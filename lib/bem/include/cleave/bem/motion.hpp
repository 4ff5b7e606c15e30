#pragma once

#include <complex>
#include <cstddef>
#include <expected>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "cleave/bem/block.hpp"

namespace cleave::bem {

// ---- Time schemes ---------------------------------------------------------------------------------------------------

/// Newmark (1959). (1/2, 1) is the thesis's and DDA's choice: first order, rings for ever at large steps.
struct Newmark {
  double beta = 0.25;
  double gamma = 0.5;
};
/// Houbolt (1950).
struct Houbolt {};
/// Chung and Hulbert (1993): second order, damps what the step cannot follow; rho in [0, 1] is the spectral radius at
/// infinite frequency.
struct GeneralizedAlpha {
  double rho = 0.8;
};
/// First order, damps all: to reach a state of rest.
struct BackwardEuler {};
using Scheme = std::variant<Newmark, Houbolt, GeneralizedAlpha, BackwardEuler>;

[[nodiscard]] std::string name_of(const Scheme& scheme);

/// Largest factor by which one step multiplies a free motion u'' = -lambda u, for z = lambda dt^2; complex lambda
/// belong to unsymmetric operators. Above 1 the motion grows.
[[nodiscard]] double spectral_radius(const Scheme& scheme, std::complex<double> z);

/// The four numbers Newmark and generalized-alpha have in common.
struct AlphaNumbers {
  double am = 0, af = 0, beta = 0.25, gamma = 0.5;
};
[[nodiscard]] AlphaNumbers numbers_of(const Scheme& scheme);

// ---- Points inside --------------------------------------------------------------------------------------------------

// Points inside bodies that are followed by their block operator. Nothing of it is built or kept unless asked for.

/// A material point: where it was in the first shape and where in the shape of the newest operator, body's frame.
struct InnerPoint {
  Vec2 reference;
  Vec2 at;
};

struct InnerState {
  Vec2 displacement;  ///< m
  Sym2 stress;        ///< Pa, body's frame, tension positive
};

/// Field of these freedoms at a point inside: static extension of the boundary's values (accurate up to the boundary,
/// as of `Solution::stress`) and the bubbles. O(elements) once the tractions are known, O(freedoms^2) for them.
[[nodiscard]] InnerState inner_state(const BlockOperator& block, const InnerPoint& point,
                                     const std::vector<double>& freedoms);

// ---- New shapes -----------------------------------------------------------------------------------------------------

// Bodies that deform so much that the operator of their first shape is no longer theirs.

/// Largest change of the boundary's tangent, |du/ds| (no unit): stretch of the boundary and local turn against the
/// body's frame together. What says whether an operator is still good.
[[nodiscard]] double steepest(const BlockOperator& block, const std::vector<double>& freedoms);

/// The stress that a body carries from one shape to the next, without cells. Every build starts a linear step about the
/// deformed outline (updated Lagrangian description; Bathe 1996, section 6.2). At points of the boundary stress is kept
/// as Cauchy stress: it turns with the material (polar decomposition of the boundary's displacement gradient) and
/// grows by Hooke's law of the logarithmic strain since the last build. In the new shape it is represented by the
/// boundary displacement whose stress is closest to it (least squares), so that its nodal forces are K times that.
/// Exact for uniform stress; elsewhere an error of second order in the strain between two builds.
class CarriedStress final {
 public:
  explicit CarriedStress(const BlockOperator& block);

  /// Operator of the shape that `freedoms` (since `now` was built) give, with the stress taken over. Mass stays with
  /// the material: mass matrix and bubbles are those of the first build, so momentum is kept.
  [[nodiscard]] std::expected<BlockOperator, BlockError> advance(const BlockOperator& now,
                                                                 const std::vector<double>& freedoms,
                                                                 const BlockOptions& options);
  /// Freedoms whose linear field on the newest operator carries the stress of the newest shape.
  [[nodiscard]] const std::vector<double>& strained() const noexcept { return strained_; }

 private:
  std::vector<Sym2> stress_;  // points of the boundary, body's frame
  std::vector<double> strained_;
};

// ---- Motion ---------------------------------------------------------------------------------------------------------

/// Nodal forces times a function of time; world axes unless `follows`, then they turn with the body.
struct TimedLoad {
  std::vector<double> forces;            ///< of BlockOperator::forces_of and its like
  std::function<double(double)> factor;  ///< of the time in s
  bool follows = false;
  /// Forces on a rebuilt operator; empty: they stay as they are (a dead load keeps its size).
  std::function<std::vector<double>(const BlockOperator&)> again = {};
};

/// Operators turn with their body and are kept until `steepest` of what happened since they were built exceeds
/// `gradient`; then the body goes on in its deformed shape with the stress it carries.
struct Rebuilding {
  double gradient;
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
  std::optional<Rebuilding> rule_;
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
    double step = 1e-3;                     ///< s
    std::optional<std::size_t> modes = 12;  ///< elastic modes kept, none of them: rigid; empty: all
    Vec2 gravity = {};                      ///< m/s2
    Damping damping = {};
    std::vector<TimedLoad> loads = {};
    std::vector<Pin> pins = {};
    Vec2 velocity = {};
    double spin = 0;  ///< rad/s
    std::optional<Rebuilding> rebuilding = {};
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
