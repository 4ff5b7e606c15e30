#pragma once

#include <complex>
#include <expected>
#include <optional>
#include <vector>

#include "cleave/bem/problem.hpp"
#include "cleave/bem/statics.hpp"

namespace cleave::bem {

/// Shear along the axis of long openings in an infinite plane or half plane: the part of a plane-strain field that the
/// plane problem does not hold. The shear stress (tau_xz, tau_yz) is the gradient of a harmonic function without flux
/// through the openings (and the free surface); sources on straight panels (Hess and Smith 1967), which near the
/// openings are of first order in the panel's length.
class Antiplane final {
 public:
  /// `far`: tau_xz, tau_yz of the undisturbed rock, Pa. Precondition: far.y = 0 with a free surface.
  [[nodiscard]] static std::expected<Antiplane, SolveError> make(const std::vector<Loop>& openings,
                                                                 std::optional<double> surface, const MeshSize& size,
                                                                 Vec2 far);
  /// tau_xz, tau_yz in the rock, Pa.
  [[nodiscard]] Vec2 shear(Vec2 x) const;
  [[nodiscard]] std::size_t panels() const noexcept { return panels_.size(); }

 private:
  struct Panel {
    std::complex<double> from, to;
    double source = 0;
  };
  [[nodiscard]] static std::complex<double> of_unit(const Panel& panel, std::complex<double> z,
                                                    const std::optional<double>& surface);
  std::vector<Panel> panels_;
  std::optional<double> surface_;
  Vec2 far_;
};

}  // namespace cleave::bem
