#pragma once

#include <string>

#include "cleave/realize/run_result.hpp"

namespace cleave::report {

/// key_groups.csv: a row a group, in order; numbers of blocks parted by spaces; empty where there is no such number
/// (factors of a group that is too large for them), `inf` where a factor has no end. Load cases and stages follow the
/// base case after the last stage. `complex`: of the last stage, says where groups are.
[[nodiscard]] std::string key_groups_csv(const scene::RunResult& result,
                                         const topology::BlockComplex* complex = nullptr);

/// Whether groups were judged with the support, in the base case or a load case.
[[nodiscard]] bool judged_with_support(const scene::RunResult& result);

/// supported_groups.csv: groups below their target and what the support leaves of them, of the base case, then of the
/// load cases.
[[nodiscard]] std::string supported_groups_csv(const scene::RunResult& result,
                                               const topology::BlockComplex* complex = nullptr);

/// The same as a table of the report; empty without any.
[[nodiscard]] std::string supported_groups_table(const scene::RunResult& result,
                                                 const topology::BlockComplex* complex = nullptr);

/// key_groups.csv as a table of the report; empty without groups.
[[nodiscard]] std::string key_groups_section(const scene::RunResult& result,
                                             const topology::BlockComplex* complex = nullptr);

}  // namespace cleave::report
