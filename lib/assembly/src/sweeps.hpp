#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "newton.hpp"

namespace cleave::assembly {

/// The Coulomb problem from rest contact by contact (nonlinear Gauss-Seidel of contact dynamics, Jean 1999; conjugate
/// directions by Silcowitz, Niebe and Erleben 2010): cheap sweeps and memory by contact. It starts from free fall, so
/// that no self-stress enters. Bodies that have come to rest
/// are left alone until a neighbour pushes them.
class Sweeps final {
 public:
  /// Bodies slower than `asleep` of their own free fall are left alone.
  Sweeps(const Elements& elements, double divisor, double asleep);
  Sweeps(const Elements&&, double, double) = delete;

  /// Up to so many sweeps; ends when all is at rest or nothing changes any more.
  void run(int most);
  /// Goes on with other strengths.
  void strength_over(double divisor) { divisor_ = divisor; }
  [[nodiscard]] const State& state() const noexcept { return state_; }
  /// Goes on from another state of the forces; rates follow from them.
  void take(const std::vector<Eigen::Vector3d>& forces);
  /// Bodies faster than `still` of their own free fall.
  [[nodiscard]] std::vector<std::uint8_t> moving(double still) const;

 private:
  template <int width>
  double sweep(bool forwards);
  template <int width>
  void extrapolate(double share);
  void choose();
  [[nodiscard]] double speed_over_own(std::size_t body) const;

  const Elements* elements_;
  double divisor_, asleep_;
  State state_;
  std::vector<double> weight_;                   ///< by element: largest response to a unit force
  std::vector<Eigen::Matrix3d> stiff_;           ///< by element: force that stops a unit rate
  std::vector<double> own_;                      ///< by body: rate of free fall
  std::vector<std::uint32_t> active_;            ///< elements beside a body that is not at rest
  std::vector<Eigen::Vector3d> before_, along_;  ///< by element; of what is at rest the force and zero
  bool bonds_ = false;
};

}  // namespace cleave::assembly
