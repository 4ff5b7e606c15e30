#include "cleave/report/write.hpp"

#include <algorithm>
#include <string>
#include <system_error>
#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/report/cells.hpp"
#include "cleave/report/exports.hpp"
#include "cleave/report/html.hpp"
#include "cleave/report/key_blocks.hpp"
#include "cleave/report/summary.hpp"
#include "cleave/report/text.hpp"
#include "cleave/report/vtu.hpp"

namespace cleave::report {
namespace {

namespace fs = std::filesystem;

const stability::Analysis* analysis_of(const scene::RunResult& result) {
  return result.analysis ? &*result.analysis : nullptr;
}

const topology::BlockComplex* complex_of(const scene::RunResult& result) {
  return result.complex ? &result.complex->complex() : nullptr;
}

Summary summarize(const scene::RunResult& result) {
  Summary summary;
  summary.title = result.title;
  summary.seed = result.seed;
  summary.scene_sha256 = result.scene_sha256;
  for (const scene::PlannedStage& stage : result.plan.stages) {
    summary.plan.push_back({.stage = std::string{scene::name_of(stage.stage)}, .run = stage.run, .why = stage.why});
  }
  summary.cost = {.wall_s = result.cost.wall_s,
                  .cpu_s = result.cost.cpu_s,
                  .peak_rss_mb = result.cost.peak_rss_mb,
                  .threads = result.cost.threads,
                  .stages = {}};
  for (const scene::StageCost& cost : result.cost.stages) {
    summary.cost.stages.push_back({.stage = std::string{scene::name_of(cost.stage)},
                                   .wall_s = cost.wall_s,
                                   .cpu_s = cost.cpu_s,
                                   .peak_rss_mb = cost.peak_rss_mb});
  }
  summary.input.joints = result.joints.size();
  if (const auto* complex = complex_of(result)) {
    const topology::CutReport& report = complex->report();
    summary.input.lattice_pitch_m = report.lattice_pitch_m;
    summary.input.largest_snap_m = report.largest_snap_m;
    summary.input.merged_planes = report.merged_planes;
    summary.blocks = count_blocks(*complex, result.block_hash);
    summary.certificate = result.complex->certificate();
  } else {
    summary.certificate = result.complex.error();
  }
  if (const auto* analysis = analysis_of(result)) {
    summary.key_blocks = count_key_blocks(*analysis);
    summary.key_blocks->hash = result.key_block_hash;
  }
  if (result.window) {
    const scene::WindowInfo& w = *result.window;
    summary.window = WindowFigures{.min = {w.min.x, w.min.y, w.min.z},
                                   .max = {w.max.x, w.max.y, w.max.z},
                                   .rounds = w.rounds,
                                   .truncated = w.truncated};
  }
  return summary;
}

std::string loads_of(const scene::RunResult& result) {
  const scene::StabilitySettings& s = *result.stability;
  const auto vector = [](geometry::Vec3 v) {
    return "(" + display(v.x) + ", " + display(v.y) + ", " + display(v.z) + ")";
  };
  std::string out = "rock of " + display(result.rock.density.si()) + " kg/m³, gravity " + vector(s.gravity) + " m/s²";
  if (norm(s.seismic) > 0) out += ", seismic force / weight " + vector(s.seismic);
  return out;
}

Page page_of(const scene::RunResult& result) {
  Page page;
  page.summary = summarize(result);
  page.scene_file = result.scene_file;
  for (const scene::InputFile& file : result.files) {
    page.files.push_back({.name = file.name, .sha256 = file.sha256, .bytes = file.bytes});
  }
  page.notes = result.notes;
  page.north = result.north;
  for (const scene::SetInfo& set : result.sets) page.sets.push_back({.name = set.name, .joints = set.joints});
  for (const scene::JointInfo& joint : result.joints) {
    page.joints.push_back({.normal = joint.normal, .set = joint.set.value()});
  }
  for (const scene::ExcavationInfo& excavation : result.excavations) page.excavations.push_back(excavation.name);
  if (result.stability) page.loads = loads_of(result);
  page.complex = complex_of(result);
  page.analysis = analysis_of(result);
  return page;
}

}  // namespace

std::expected<void, WriteError> write_blocks_vtu(const scene::RunResult& result, const fs::path& folder) {
  const auto* complex = complex_of(result);
  if (!result.output.vtu || complex == nullptr) return {};
  return write_file(folder / "blocks.vtu", blocks_vtu(make_cells(*complex), analysis_of(result),
                                                      {.title = result.title, .scene_file = result.scene_file}));
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
  return write_file(folder / "key_blocks.csv", key_blocks_csv(*complex, *result.analysis));
}

std::expected<void, WriteError> write_report_html(const scene::RunResult& result, const fs::path& folder) {
  if (!result.output.report) return {};
  return write_file(folder / "report.html", report_html(page_of(result)));
}

std::expected<void, WriteError> write_summary_json(const scene::RunResult& result, const fs::path& folder) {
  return write_file(folder / "summary.json", summary_json(summarize(result)));
}

std::expected<void, WriteError> write_all(const scene::RunResult& result, const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return std::unexpected(CannotCreate{folder, error.message()});
  CLEAVE_CHECK(write_blocks_vtu(result, folder));
  CLEAVE_CHECK(write_exports(result, folder));
  CLEAVE_CHECK(write_key_blocks_csv(result, folder));
  CLEAVE_CHECK(write_report_html(result, folder));
  return write_summary_json(result, folder);
}

}  // namespace cleave::report
