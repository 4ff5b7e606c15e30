#include "cleave/report/write.hpp"

#include <algorithm>
#include <string>
#include <system_error>
#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/exchange/dangling.hpp"
#include "cleave/exchange/exports.hpp"
#include "cleave/exchange/vtu_writer.hpp"
#include "cleave/report/key_blocks.hpp"
#include "cleave/report/summary.hpp"
#include "flow.hpp"
#include "html.hpp"
#include "key_groups.hpp"
#include "mapped.hpp"
#include "motion.hpp"

namespace cleave::report {
namespace {

namespace fs = std::filesystem;

const stability::Analysis* analysis_of(const scene::RunResult& result) {
  return result.analysis ? &*result.analysis : nullptr;
}

const topology::BlockComplex* complex_of(const scene::RunResult& result) {
  return result.complex ? &result.complex->complex() : nullptr;
}

}  // namespace

std::expected<void, WriteError> write_blocks_vtu(const scene::RunResult& result, const fs::path& folder) {
  const auto* complex = complex_of(result);
  if (!result.output.vtu || complex == nullptr) return {};
  VtuText text{.title = result.title, .scene_file = result.scene_file, .stage_of_block = {}};
  if (result.sequence) text.stage_of_block = result.sequence->stage_of_block;
  CLEAVE_CHECK(write_file(folder / "blocks.vtu", blocks_vtu(make_cells(*complex), analysis_of(result), text)));
  if (!result.sequence) return {};
  for (const scene::StageResult& stage : result.sequence->stages) {
    if (!stage.complex || !*stage.complex) continue;
    const topology::BlockComplex& state = (*stage.complex)->complex();
    const std::vector<std::optional<std::uint32_t>> number(state.blocks().size(), stage.stage);
    text.stage_of_block = number;
    CLEAVE_CHECK(write_file(folder / ("blocks_stage_" + std::to_string(stage.stage) + ".vtu"),
                            blocks_vtu(make_cells(state), stage.analysis ? &*stage.analysis : nullptr, text)));
  }
  return {};
}

std::expected<void, WriteError> write_motion(const scene::RunResult& result, const fs::path& folder) {
  if (!result.motion || complex_of(result) == nullptr) return {};
  if (!result.motion->state.empty()) {
    CLEAVE_CHECK(write_file(folder / scene::motion_state_name, result.motion->state));
  }
  if (result.output.csv) CLEAVE_CHECK(write_file(folder / "motion.csv", motion_csv(*result.motion)));
  if (!result.output.vtu) return {};
  const std::vector<scene::MotionFrame>& frames = result.motion->frames;
  return write_frames(
      folder, "motion", frames.size(), [&](std::size_t f) { return frames[f].time.si(); },
      [&](std::size_t f) { return motion_vtu(result, f); });
}

std::expected<void, WriteError> write_dangling(const scene::RunResult& result, const fs::path& folder) {
  const auto* complex = complex_of(result);
  if (complex == nullptr || !complex->dangling()) return {};
  if (result.output.vtu) CLEAVE_CHECK(write_file(folder / "dangling.vtu", dangling_vtu(*complex, result.title)));
  return write_file(folder / "dangling.obj", dangling_obj(*complex, result.title));
}

std::expected<void, WriteError> write_mapped(const scene::RunResult& result, const fs::path& folder) {
  if (!result.mapped || !result.output.csv) return {};
  return write_file(folder / "mapped_joints.csv", mapped_joints_csv(*result.mapped));
}

std::expected<void, WriteError> write_flow(const scene::RunResult& result, const fs::path& folder) {
  if (!result.flow || complex_of(result) == nullptr) return {};
  if (result.output.csv) CLEAVE_CHECK(write_file(folder / "flow_joints.csv", flow_joints_csv(*result.flow)));
  if (result.flow->mesh) CLEAVE_CHECK(write_flow_mesh(*result.flow, folder));
  return result.output.vtu ? write_file(folder / "flow.vtu", flow_vtu(result)) : std::expected<void, WriteError>{};
}

std::expected<std::vector<std::string>, WriteError> write_exports(const scene::RunResult& result,
                                                                  const fs::path& folder) {
  std::vector<std::string> notes;
  const auto* complex = complex_of(result);
  if (result.output.exports.empty() || complex == nullptr) return notes;
  const Cells cells = make_cells(*complex);
  for (const ExportName& name : export_names()) {
    if (std::ranges::find(result.output.exports, name.name) == result.output.exports.end()) continue;
    const std::string file = "blocks" + std::string{name.ending};
    const Exported exported = export_blocks(cells, name.format, result.title);
    CLEAVE_CHECK(write_file(folder / file, exported.bytes));
    for (const std::string& note : exported.notes) notes.push_back(file + ": " + note);
  }
  return notes;
}

std::expected<void, WriteError> write_key_blocks_csv(const scene::RunResult& result, const fs::path& folder) {
  const auto* complex = complex_of(result);
  if (!result.output.csv || complex == nullptr || !result.analysis) return {};
  if (result.key_groups) {
    CLEAVE_CHECK(write_file(folder / "key_groups.csv", key_groups_csv(result, complex)));
  }
  if (result.support) {
    CLEAVE_CHECK(write_file(folder / "bolts.csv", bolts_csv(result)));
    CLEAVE_CHECK(write_file(folder / "support_blocks.csv", support_blocks_csv(result)));
    CLEAVE_CHECK(write_file(folder / "combined_blocks.csv", combined_blocks_csv(result)));
    if (judged_with_support(result)) {
      CLEAVE_CHECK(write_file(folder / "supported_groups.csv", supported_groups_csv(result, complex)));
    }
  }
  const bool held = result.domain_held && !result.domain_held->blocks.empty();
  if (held || std::ranges::any_of(result.load_cases, [](const scene::CaseResult& load) {
        return load.domain_held && !load.domain_held->blocks.empty();
      })) {
    CLEAVE_CHECK(write_file(folder / "border_blocks.csv", border_blocks_csv(*complex, result)));
  }
  if (!result.load_cases.empty()) {
    CLEAVE_CHECK(write_file(folder / "load_cases.csv", load_cases_csv(*complex, result)));
  }
  if (!result.maximum_blocks.empty()) {
    CLEAVE_CHECK(write_file(folder / "maximum_blocks.csv", maximum_blocks_csv(result)));
  }
  return write_file(folder / "key_blocks.csv", key_blocks_csv(*complex, result));
}

std::expected<void, WriteError> write_report_html(const scene::RunResult& result, const fs::path& folder) {
  if (!result.output.report) return {};
  return write_file(folder / "report.html", report_html({result, complex_of(result)}));
}

std::expected<void, WriteError> write_summary_json(const scene::RunResult& result, const fs::path& folder) {
  return write_file(folder / "summary.json", summary_json(result));
}

std::expected<void, WriteError> write_all(const scene::RunResult& result, const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return std::unexpected(CannotCreate{folder, error.message()});
  CLEAVE_CHECK(write_blocks_vtu(result, folder));
  CLEAVE_CHECK(write_dangling(result, folder));
  CLEAVE_CHECK(write_motion(result, folder));
  CLEAVE_CHECK(write_mapped(result, folder));
  CLEAVE_CHECK(write_flow(result, folder));
  CLEAVE_CHECK(write_exports(result, folder));
  CLEAVE_CHECK(write_sections(result, folder));
  CLEAVE_CHECK(write_key_blocks_csv(result, folder));
  CLEAVE_CHECK(write_report_html(result, folder));
  return write_summary_json(result, folder);
}

}  // namespace cleave::report
