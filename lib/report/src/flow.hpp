#pragma once

#include <cstdint>
#include <expected>
#include <filesystem>
#include <string>
#include <string_view>

#include "cleave/core/fields.hpp"
#include "cleave/realize/flow_result.hpp"
#include "cleave/realize/run_result.hpp"
#include "cleave/report/write.hpp"

namespace cleave::report {

/// flow_joints.csv: one row a joint in the rock.
[[nodiscard]] std::string flow_joints_csv(const scene::FlowResult& flow);
/// flow.vtu: the joints in triangles, cut along each other; with heads and rates where water flows.
[[nodiscard]] std::string flow_vtu(const scene::RunResult& result);

/// A node of flow_mesh.uge whose head is given.
struct FlowMeshHead {
  std::uint32_t node = 0;
  std::string_view surface = {}, file = {};
  Length head = {}, pressure = {};
};
template <class V>
void fields(V& v, const FlowMeshHead& x) {
  v("node", x.node, "number from 1, as in `flow_mesh.uge`");
  v("surface", x.surface, "of several the first with standing water");
  v("file", x.file, "that has it");
  v("head_m", x.head, "z to which water stands, or of the node where it is drained");
  v("pressure_head_m", x.pressure, "head less z");
}
/// flow_mesh.inp, .uge, .in, _heads.csv and a file of connections a boundary: for PFLOTRAN and others of two-point
/// fluxes.
[[nodiscard]] std::expected<void, WriteError> write_flow_mesh(const scene::FlowResult& flow,
                                                              const std::filesystem::path& folder);
/// Of report.html.
[[nodiscard]] std::string flow_section(const scene::FlowResult& flow);

}  // namespace cleave::report
