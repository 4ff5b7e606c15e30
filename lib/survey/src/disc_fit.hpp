#pragma once

#include <array>
#include <optional>
#include <span>

#include "cleave/survey/traces.hpp"

namespace cleave::survey::detail {

/// A law of the diameters of discs, and how wide a gamma law may be. Small joints leave few traces: towards laws with
/// many of them the likelihood falls more slowly than its curvature says.
struct DiscFit {
  Fit fit;
  /// Gamma: parameters (a, b) of the widest law that the likelihood allows at the confidence, at most a spread of four
  /// means.
  std::optional<std::array<double, 2>> widest = {};
  bool at_widest = false;  ///< gamma: the likelihood rises up to that spread; `fit` is the law there
};
/// As `fit_discs`, which is empty where the gamma law is at its widest.
[[nodiscard]] std::optional<DiscFit> fit_discs_to_edges(std::span<const SeenLength> lengths, const Meeting& meeting,
                                                        Family family, double confidence);

}  // namespace cleave::survey::detail
