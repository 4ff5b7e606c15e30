#pragma once

#include <array>
#include <vector>

#include "cleave/stability/analyse.hpp"

namespace cleave::stability {

/// Factor of safety of one block when one input is `share` lower and higher, all else as it is.
struct Sensitivity {
  topology::BlockId block;
  double share = 0;
  double base = 0;
  std::array<double, 2> friction{};  ///< tan(friction) lower, higher
  std::array<double, 2> cohesion{};
  std::array<double, 2> water{};  ///< pressures
};

/// Of the blocks of the first batch, each in the state after excavation without forces of later batches.
[[nodiscard]] std::vector<Sensitivity> sensitivity(const topology::AuditedComplex& complex, const Settings& settings,
                                                   const Analysis& analysis, double share = 0.2);

}  // namespace cleave::stability
