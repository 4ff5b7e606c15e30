#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cleave/stochastic/moments.hpp"

namespace cleave::stochastic {

enum class StopRule : std::uint8_t {
  fixed_looks,   ///< looks at 100, 150, 225, ... realizations only; z SE <= h |mean|
  always_valid,  ///< the same looks with an asymptotic confidence sequence (Waudby-Smith et al. 2024), rho = 0.1
};

/// Stop when the interval of `quantity` is narrow enough, or at `max`.
struct Stop {
  std::string quantity = "key_block_volume_m3";
  double relative_half_width = 0.05;
  double confidence = 0.95;
  std::uint64_t max = 10000;
  StopRule rule = StopRule::fixed_looks;
};

/// The numbers of realizations at which a run may stop: ceil(100 * 1.5^j) below `max`, then `max` itself.
[[nodiscard]] std::vector<std::uint64_t> looks(std::uint64_t max);
/// Half width of the interval that the rule goes by, absolute.
[[nodiscard]] double half_width(const Moments& moments, const Stop& stop);
/// Whether the run may stop after what `moments` has seen. Laws with a skewness above 2 are not judged before 300
/// realizations; a mean of 0 never.
[[nodiscard]] bool narrow_enough(const Moments& moments, const Stop& stop);

}  // namespace cleave::stochastic
