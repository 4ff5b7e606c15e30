#pragma once

#include <string>

#include "cleave/realize/run_result.hpp"

namespace cleave::report {

/// What acts on the rock, with its figures: a row of a table for the base case and for each [[load]]. Empty without
/// [stability].
[[nodiscard]] std::string load_rows(const scene::RunResult& result);

/// Of the case under which most moves, where that is not the base case; else empty.
[[nodiscard]] std::string governing_card(const scene::Figures& figures);

}  // namespace cleave::report
