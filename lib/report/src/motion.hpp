#pragma once

#include <string>

#include "cleave/realize/run_result.hpp"

namespace cleave::report {

/// motion.csv: one row a block that was let go.
[[nodiscard]] std::string motion_csv(const scene::MotionResult& motion);
/// motion_NNNN.vtu: the blocks that were let go, where they are at one time.
[[nodiscard]] std::string motion_vtu(const scene::RunResult& result, std::size_t frame);
/// Of report.html.
[[nodiscard]] std::string motion_section(const scene::MotionResult& motion);

}  // namespace cleave::report
