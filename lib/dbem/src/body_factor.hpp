#pragma once

#include <Eigen/Dense>
#include <vector>

#include "fronts.hpp"
#include "natural_map.hpp"

namespace cleave::dbem {

/// Inverse of a reduced contact system in the freedoms of rigid bodies: with W = J M^-1 J^T + E, unknowns z = S^T p of
/// closed and stuck contacts and equations R,
///   (E + R^T J M^-1 J^T S)^-1 = E^-1 - E^-1 R^T J (M + J^T S E^-1 R^T J)^-1 J^T S E^-1   (Woodbury 1950).
/// E is raised to a share of diag W where it is smaller: an approximation to iterate with, exact where forces are
/// unique.
class BodyFactor final {
 public:
  explicit BodyFactor(const ContactProblem& problem);
  /// False when a pivot vanishes.
  [[nodiscard]] bool compute(const ContactProblem& problem, double soft, const Pattern& pattern);
  [[nodiscard]] bool holds(double soft, const Pattern& pattern) const { return soft == soft_ && pattern == pattern_; }
  /// Residual (n, t) of each contact, 0 where there is no equation, to unknowns.
  void apply(const ContactProblem& problem, const std::vector<Vec2>& residual, std::vector<Vec2>& z) const;

 private:
  FrontalFactor factor_;
  double soft_ = -1;
  Pattern pattern_;
  std::vector<Vec2> softness_;  // E
};

}  // namespace cleave::dbem
