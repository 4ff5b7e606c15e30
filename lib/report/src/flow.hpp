#pragma once

#include <string>

#include "cleave/realize/flow_result.hpp"
#include "cleave/realize/run_result.hpp"

namespace cleave::report {

/// flow_joints.csv: one row a joint in the rock.
[[nodiscard]] std::string flow_joints_csv(const scene::FlowResult& flow);
/// flow.vtu: the joints in triangles, cut along each other; with heads and rates where water flows.
[[nodiscard]] std::string flow_vtu(const scene::RunResult& result);
/// Of report.html.
[[nodiscard]] std::string flow_section(const scene::FlowResult& flow);

}  // namespace cleave::report
