#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <span>
#include <vector>

#include "newton.hpp"

namespace cleave::motion {

/// Coulomb's law on the cone by interior points (Kojima, Mizuno and Yoshise 1989; scaling of Nesterov and Todd 1997;
/// for friction Acary, Armand, Nguyen and Shpakovych 2023): forces x inside the cone and velocities inside its dual,
/// opened by mu |slip|, with products that fall to zero along a path. The slip is part of the linearised system.
/// A weight about given forces keeps those near them that the law leaves open.
class Interior final {
 public:
  explicit Interior(const Scaled& scaled);
  Interior(const Scaled&&) = delete;

  struct Options {
    double weight = 1e-8;   ///< of x - centre
    double goal = 1e-13;    ///< of the mean product
    double start = 1e3;     ///< how far inside the cone forces begin, of what moves a body by 1
    bool coupled = true;    ///< slip in the linearised system, else renewed from step to step
    std::size_t most = 60;  ///< factors
    /// Slip of each point, as if it were known: one convex programme. Empty: it is found.
    std::span<const double> given = {};
  };
  /// Forces near the end of the path; the products left. `x`: the centre, then the answer.
  double solve(std::vector<Eigen::Vector3d>& x, const Options& options);
  [[nodiscard]] std::size_t factors() const noexcept { return system_.factors(); }

 private:
  /// Of one contact: scaled force and velocity, and what the linearised system needs.
  struct Cone {
    Eigen::Vector3d force = Eigen::Vector3d::Zero(), speed = Eigen::Vector3d::Zero();
    Eigen::Vector3d unit = Eigen::Vector3d::Zero();  ///< of a force of the cone: impulse by component
    Eigen::Matrix3d scaling = Eigen::Matrix3d::Zero(), back = Eigen::Matrix3d::Zero();
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    Eigen::Matrix3d compliance = Eigen::Matrix3d::Zero(), turn = Eigen::Matrix3d::Identity();
    Eigen::Vector3d off = Eigen::Vector3d::Zero();
    Eigen::Vector3d d_force = Eigen::Vector3d::Zero(), d_speed = Eigen::Vector3d::Zero();
    /// `scaling` P and `back` P^-1 such that P speed = P^-1 force, which is `middle`.
    void scale();
  };
  /// Forces inside their cones, and not nearer to the skin than `start`.
  void begin(std::vector<Eigen::Vector3d>& x, const Options& options);
  /// Of the cones, after a share of the step.
  [[nodiscard]] double mean_product(double share) const;
  /// The largest lack of balance; slips below `blunt` are smoothed.
  double linearise(const std::vector<Eigen::Vector3d>& x, const std::vector<Eigen::Vector3d>& centre, double blunt,
                   const Options& options);
  [[nodiscard]] bool factor(bool symmetric);
  /// The step to products of `target`, `corrected` by that of the step before. Returns the share that stays inside.
  double direct(double target, bool corrected, double weight);
  void step(double share, std::vector<Eigen::Vector3d>& x);

  const Scaled* scaled_;
  linear::BlockSystem system_;
  std::vector<Cone> cones_;
  Eigen::VectorXd v_, off_v_, dv_;  ///< velocities of the bodies, their lack of balance, the step
};

}  // namespace cleave::motion
