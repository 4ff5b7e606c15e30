#pragma once

#include <array>
#include <vector>

#include "barrier_factor.hpp"

namespace cleave::dbem {

/// Solves (W + D) T z = y for Newton's method on the contact law itself, D = [normal, 0; mu (ahead - back), ahead +
/// back]: not symmetric, for sliding opens nothing. In the freedoms of rigid bodies (Woodbury 1950); z = (n, r) as in
/// BarrierFactor.
class PathFactor final {
 public:
  /// The bodies of the problem must be rigid.
  PathFactor(const ContactProblem& problem, Work& work);
  /// False when a pivot vanishes.
  [[nodiscard]] bool compute(const std::vector<Barrier>& barrier);
  /// False when rounding keeps `z` from two digits.
  [[nodiscard]] bool solve(const std::vector<Vec2>& y, std::vector<Vec2>& z) const;
  /// T z.
  [[nodiscard]] Vec2 impulse(std::size_t contact, Vec2 z) const;
  /// Of t where room is least.
  [[nodiscard]] double sense(std::size_t contact) const { return sense_[contact]; }
  /// Sign of the determinant of W + D.
  [[nodiscard]] int sign() const { return factor_.sign(); }

 private:
  struct Own {  // lower triangle of (E + D) T of a contact, where W = J M^-1 J^T + E
    double nn, tn, tt;
  };
  [[nodiscard]] Vec2 without_bodies(std::size_t contact, Vec2 y) const;
  void nearly(const std::vector<Vec2>& y, std::vector<Vec2>& z) const;
  [[nodiscard]] std::vector<Vec2> missing(const std::vector<Vec2>& y, const std::vector<Vec2>& z) const;

  const ContactProblem* problem_;
  Work* work_;
  FrontalFactor factor_;
  std::vector<double> sense_;
  std::vector<Own> own_;
  std::vector<Own> barrier_;  // D T
};

}  // namespace cleave::dbem
