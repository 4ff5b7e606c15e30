#pragma once

#include <cstdint>
#include <expected>
#include <string>
#include <variant>

#include "cleave/bem/vec2.hpp"
#include "cleave/core/quantity.hpp"

namespace cleave::bem {

enum class PlaneState : std::uint8_t { strain, stress };

struct BadModulus {
  double young_pa;
};
struct BadPoisson {
  double poisson;
};
struct BadDensity {
  double density;
};
using MaterialError = std::variant<BadModulus, BadPoisson, BadDensity>;
[[nodiscard]] std::string describe(const MaterialError& error);

/// Isotropic and linear. Plane stress is plane strain with another Poisson ratio: nu' = nu / (1 + nu), same shear
/// modulus (Timoshenko and Goodier 1951, section 15), so every formula of this module is written for plane strain.
class Material final {
 public:
  /// Needs young > 0 (finite), -1 < poisson < 0.5 (plane strain; in plane stress 0.5 itself too), density >= 0.
  [[nodiscard]] static std::expected<Material, MaterialError> make(Stress young, double poisson, Density density,
                                                                   PlaneState state = PlaneState::strain);

  [[nodiscard]] double young() const noexcept { return young_; }                      ///< Pa
  [[nodiscard]] double poisson() const noexcept { return poisson_; }                  ///< as given
  [[nodiscard]] double density() const noexcept { return density_; }                  ///< kg/m3
  [[nodiscard]] double mu() const noexcept { return young_ / (2 * (1 + poisson_)); }  ///< Pa
  [[nodiscard]] double nu() const noexcept {
    return state_ == PlaneState::strain ? poisson_ : poisson_ / (1 + poisson_);
  }
  [[nodiscard]] double lambda() const noexcept { return 2 * mu() * nu() / (1 - 2 * nu()); }  ///< Pa, in-plane
  [[nodiscard]] PlaneState state() const noexcept { return state_; }
  /// Stress normal to the plane, Pa.
  [[nodiscard]] double out_of_plane(Sym2 stress) const noexcept {
    return state_ == PlaneState::strain ? poisson_ * (stress.xx + stress.yy) : 0.0;
  }
  /// In-plane stress of an in-plane strain.
  [[nodiscard]] Sym2 stress(Sym2 strain) const noexcept {
    const double l = lambda() * (strain.xx + strain.yy);
    return {l + 2 * mu() * strain.xx, 2 * mu() * strain.xy, l + 2 * mu() * strain.yy};
  }
  [[nodiscard]] Sym2 strain(Sym2 s) const noexcept {
    const double t = nu() * (s.xx + s.yy);
    return {(s.xx - t) / (2 * mu()), s.xy / (2 * mu()), (s.yy - t) / (2 * mu())};
  }

 private:
  Material(double young, double poisson, double density, PlaneState state)
      : young_{young}, poisson_{poisson}, density_{density}, state_{state} {}
  double young_, poisson_, density_;
  PlaneState state_;
};

}  // namespace cleave::bem
