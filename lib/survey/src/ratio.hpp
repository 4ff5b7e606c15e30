#pragma once

#include <cstddef>
#include <string>

#include "cleave/survey/traces.hpp"

namespace cleave::survey::detail {

/// A ratio of sums over `count` traces, each independent: Student's t on the logarithm, `variance` its squared
/// coefficient of variation by the delta method. Without an interval, and with a note, for one trace or for traces all
/// alike, which say nothing of how others scatter.
[[nodiscard]] Estimate ratio_of_sums(std::string name, double value, double variance, std::size_t count,
                                     double confidence, std::string method);

}  // namespace cleave::survey::detail
