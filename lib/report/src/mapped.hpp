#pragma once

#include <string>

#include "cleave/realize/run_result.hpp"

namespace cleave::report {

/// mapped_joints.csv: one row a joint that was mapped.
[[nodiscard]] std::string mapped_joints_csv(const scene::MappedResult& mapped);
/// Of report.html.
[[nodiscard]] std::string mapped_section(const scene::MappedResult& mapped);

}  // namespace cleave::report
