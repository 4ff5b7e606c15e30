#pragma once

#include <vector>

#include "cleave/scene/problem.hpp"
#include "exit_code.hpp"

namespace cleave::cli {

/// One line each on stderr; wrong_input.
[[nodiscard]] ExitCode report_problems(const std::vector<scene::Problem>& problems);

}  // namespace cleave::cli
