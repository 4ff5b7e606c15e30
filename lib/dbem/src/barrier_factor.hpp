#pragma once

#include <vector>

#include "cleave/linear/fronts.hpp"
#include "natural_map.hpp"

namespace cleave::dbem {

using linear::FrontalFactor;

/// What the barrier of a contact adds to W: `normal` along n, `ahead` along (mu, 1), `back` along (mu, -1).
struct Barrier {
  double normal = 0, ahead = 0, back = 0;
};

/// Solves T^T (W + B) T z = y, as interior points need it: in the freedoms of the bodies where those are rigid and
/// fewer (Woodbury 1950), else in those of the contacts. Conjugate gradients give the digits back that a raised
/// compliance takes.
///
/// z = (n, r), r the room left before slip in the nearer sense: t = sense (mu n - r). Where a contact slips, B holds r
/// with 10^10 times what W has, and n hardly at all: in n and t the difference would be lost.
class BarrierFactor final {
 public:
  BarrierFactor(const ContactProblem& problem, Work& work);
  /// False when a pivot vanishes.
  [[nodiscard]] bool compute(std::vector<Barrier> barrier);
  /// False when rounding keeps `z` from six digits.
  [[nodiscard]] bool solve(const std::vector<Vec2>& y, std::vector<Vec2>& z) const;
  /// Of t where room is least.
  [[nodiscard]] double sense(std::size_t contact) const { return sense_[contact]; }

 private:
  [[nodiscard]] bool compute_in_bodies();
  [[nodiscard]] bool compute_in_contacts();
  void precondition(const std::vector<Vec2>& y, std::vector<Vec2>& z) const;
  /// T and its transpose.
  [[nodiscard]] Vec2 impulse(std::size_t contact, Vec2 z) const;
  [[nodiscard]] Vec2 turned(std::size_t contact, Vec2 y) const;

  const ContactProblem* problem_;
  Work* work_;
  bool bodies_;
  FrontalFactor factor_;
  std::vector<double> sense_;
  std::vector<bem::Mat2> barrier_;   // T^T B T
  std::vector<bem::Mat2> yielding_;  // (T^T (E + B) T)^-1, where W = J M^-1 J^T + E
};

}  // namespace cleave::dbem
