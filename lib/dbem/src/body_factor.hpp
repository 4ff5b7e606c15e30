#pragma once

#include <Eigen/Dense>
#include <vector>

#include "cleave/linear/fronts.hpp"
#include "compact_factor.hpp"
#include "natural_map.hpp"

namespace cleave::dbem {

using linear::FrontalFactor;

/// A contact's row of J on one body.
inline Eigen::RowVector3d row_of(const std::array<double, 3>& r) { return {r[0], r[1], r[2]}; }
/// Pairs of bodies that share a contact.
[[nodiscard]] std::vector<std::pair<std::uint32_t, std::uint32_t>> links_of_bodies(const RigidForm& form);
/// Of a freedom of a body; one that is held has a mass beyond all others.
[[nodiscard]] inline double mass_of(double inverse) { return inverse > 0 ? 1 / inverse : 1e30; }
/// M on the diagonal.
void add_masses(const RigidForm& form, FrontalFactor& factor);
/// E of one contact, `soft` * diag W included; at least `least` * diag W.
[[nodiscard]] Vec2 softness_of(const ContactProblem& problem, std::size_t contact, double soft, double least);

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
  [[nodiscard]] double factor_work() const { return few_ ? few_->factor_work() : many_->factor_work(); }
  [[nodiscard]] double solve_work() const { return few_ ? few_->solve_work() : many_->solve_work(); }

 private:
  // One of them, by the number of bodies.
  std::optional<CompactFactor> few_;
  std::optional<FrontalFactor> many_;
  std::optional<double> soft_;
  Pattern pattern_;
  std::vector<Vec2> softness_;  // E
};

}  // namespace cleave::dbem
