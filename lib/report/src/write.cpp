#include "cleave/report/write.hpp"

#include <algorithm>
#include <string>
#include <system_error>
#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/report/cells.hpp"
#include "cleave/report/exports.hpp"
<<<<<<< Updated upstream
=======
#include "cleave/report/html.hpp"
#include "cleave/report/key_blocks.hpp"
#include "cleave/report/key_groups.hpp"
#include "cleave/report/summary.hpp"
#include "cleave/report/text.hpp"
>>>>>>> Stashed changes
#include "cleave/report/vtu.hpp"
#include "dangling.hpp"
#include "html.hpp"
#include "key_blocks.hpp"
#include "summary.hpp"

namespace cleave::report {
namespace {

namespace fs = std::filesystem;

const stability::Analysis* analysis_of(const scene::RunResult& result) {
  return result.analysis ? &*result.analysis : nullptr;
}

const topology::BlockComplex* complex_of(const scene::RunResult& result) {
  return result.complex ? &result.complex->complex() : nullptr;
}

<<<<<<< Updated upstream
=======
SequenceFigures figures_of(const scene::SequenceResult& sequence) {
  SequenceFigures figures{.fallen = sequence.fallen == scene::Fallen::stay_out ? "stay_out" : "put_back",
                          .stages = {},
                          .orders = {},
                          .best = sequence.best};
  for (const scene::StageResult& stage : sequence.stages) {
    StageFigures row;
    row.stage = stage.stage;
    row.excavations = stage.excavations;
    row.hash = stage.block_hash;
    row.new_count = stage.new_key_blocks;
    row.new_volume_m3 = stage.new_key_volume.si();
    if (stage.complex && !*stage.complex) row.passed = false;
    if (stage.complex && *stage.complex) {
      const BlockFigures blocks = count_blocks((*stage.complex)->complex(), {});
      row.blocks = blocks.count;
      row.volume_m3 = blocks.volume_m3;
    }
    if (stage.analysis) row.key_blocks = count_key_blocks(*stage.analysis);
    figures.stages.push_back(std::move(row));
  }
  for (const scene::OrderResult& order : sequence.orders) {
    OrderFigures row{.stages = order.stages,
                     .new_count = order.new_key_blocks,
                     .new_volume_m3 = {},
                     .count = order.key_blocks,
                     .volume_m3 = order.key_volume.si()};
    for (const Volume volume : order.new_key_volume) row.new_volume_m3.push_back(volume.si());
    figures.orders.push_back(std::move(row));
  }
  return figures;
}

Summary summarize(const scene::RunResult& result) {
  Summary summary = head_of(result.title, result.seed, result.scene_sha256, result.plan, result.cost);
  summary.input.joints = result.joints.size();
  if (const auto* complex = complex_of(result)) {
    const topology::CutReport& report = complex->report();
    summary.input.lattice_pitch_m = report.lattice_pitch_m;
    summary.input.largest_snap_m = report.largest_snap_m;
    summary.input.merged_planes = report.merged_planes;
    for (const topology::SnappedJoint& snapped : report.snapped) {
      summary.input.snapped.push_back({.joint = snapped.joint.value(),
                                       .moved_m = snapped.moved.si(),
                                       .plane_merged = snapped.plane_merged,
                                       .edges_adopted = snapped.adopted_edges});
    }
    summary.blocks = count_blocks(*complex, result.block_hash);
    summary.certificate = result.complex->certificate();
    if (result.micro_blocks.policy != scene::MicroBlockPolicy::keep) {
      MicroBlockFigures figures;
      figures.policy = result.micro_blocks.policy == scene::MicroBlockPolicy::report ? "report" : "exclude";
      for (const topology::BlockId id : scene::micro_blocks(*complex, result.micro_blocks)) {
        const topology::Block& block = complex->blocks()[id];
        figures.thinnest_m =
            figures.count == 0 ? block.thickness.si() : std::min(figures.thinnest_m, block.thickness.si());
        figures.volume_m3 += block.volume.si();
        ++figures.count;
      }
      summary.micro_blocks = std::move(figures);
    }
    if (const auto& dangling = complex->data().dangling) {
      summary.dangling = {.pieces = dangling->pieces.size(),
                          .area_m2 = dangling->area.si(),
                          .free_edges = dangling->free_edges,
                          .free_edge_length_m = dangling->free_edge_length.si(),
                          .joints = dangling->joints,
                          .isolated_joints = dangling->isolated_joints};
    }
  } else {
    summary.certificate = result.complex.error();
  }
  std::optional<TargetFactors> target;
  if (result.stability && result.stability->target) {
    target = {result.stability->target->falling, result.stability->target->sliding};
  }
  if (const auto* analysis = analysis_of(result)) {
    summary.key_blocks = count_key_blocks(*analysis, target);
    summary.key_blocks->hash = result.key_block_hash;
    if (result.key_groups) summary.key_groups = count_key_groups(*result.key_groups);
  }
  for (const scene::CaseResult& load : result.load_cases) {
    summary.load_cases.push_back({.name = load.name, .figures = count_key_blocks(load.analysis, target)});
  }
  if (result.window) {
    const scene::WindowInfo& w = *result.window;
    summary.window = WindowFigures{.min = {w.min.x, w.min.y, w.min.z},
                                   .max = {w.max.x, w.max.y, w.max.z},
                                   .rounds = w.rounds,
                                   .truncated = w.truncated};
  }
  if (result.field_stress) {
    const scene::FieldStressResult& f = *result.field_stress;
    FieldStressFigures figures{.tunnel = f.tunnel,
                               .elements = f.elements,
                               .error = f.error,
                               .condition = f.condition,
                               .residual = f.residual,
                               .blocks = f.blocks.size(),
                               .held = f.held};
    for (const scene::ClampedBlock& block : f.blocks) {
      figures.lowest_factor_of_safety = std::min(figures.lowest_factor_of_safety, block.factor_of_safety);
    }
    summary.field_stress = figures;
  }
  if (result.sequence) summary.sequence = figures_of(*result.sequence);
  if (result.support) {
    summary.support = count_support(*result.support);
    if (result.tunnel_length > 0) {
      summary.support->required_force_n_per_metre = summary.support->required_force_n / result.tunnel_length;
    }
    for (const scene::DesignResult& d : result.designs) {
      summary.support->designs.push_back({d.length, d.found, d.scale, d.bolts, d.cost});
    }
    for (const scene::CaseSupport& load : result.support_cases) {
      const SupportFigures f = count_support(load.support);
      summary.support->cases.push_back({load.name, f.passes, f.blocks, f.not_held, f.combined, f.combined_failing});
    }
  }
  if (!result.maximum_blocks.empty()) {
    MaximumFigures figures;
    for (const scene::MaximumRow& row : result.maximum_blocks) {
      ++figures.count;
      figures.largest_volume_m3 = std::max(figures.largest_volume_m3, row.block.block.volume);
      figures.lowest_factor_of_safety = std::min(figures.lowest_factor_of_safety, row.block.factor_of_safety);
      figures.largest_required_pressure_pa =
          std::max(figures.largest_required_pressure_pa, row.block.required_pressure);
    }
    summary.maximum_blocks = figures;
  }
  return summary;
}

std::vector<MaximumBlockRow> maximum_rows(const scene::RunResult& result) {
  std::vector<MaximumBlockRow> rows;
  for (const scene::MaximumRow& row : result.maximum_blocks) rows.push_back({row.sets, row.where, row.block});
  return rows;
}

std::string loads_of(const scene::RunResult& result) {
  const scene::StabilitySettings& s = *result.stability;
  const auto vector = [](geometry::Vec3 v) {
    return "(" + display(v.x) + ", " + display(v.y) + ", " + display(v.z) + ")";
  };
  std::string out = "rock of " + display(result.rock.density.si()) + " kg/m³, gravity " + vector(s.gravity) + " m/s²";
  if (norm(s.seismic) > 0) out += ", seismic force / weight " + vector(s.seismic);
  if (s.loads.water) out += ", water table at " + display(s.loads.water->level) + " m";
  if (!s.loads.pressures.empty()) out += ", water pressure by joint set";
  const auto count = [&](std::size_t n, std::string_view what) {
    if (n > 0) out += ", " + std::to_string(n) + " " + std::string{what} + (n == 1 ? "" : "s");
  };
  count(s.loads.surcharges.size(), "surcharge");
  count(s.loads.points.size(), "point force");
  count(s.loads.lines.size(), "line force");
  count(s.cases.size(), "more load case");
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
  if (result.stability) {
    page.loads = loads_of(result);
    page.gravity = result.stability->gravity;
  }
  page.complex = complex_of(result);
  page.analysis = analysis_of(result);
  page.key_groups = result.key_groups ? &*result.key_groups : nullptr;
  page.support = result.support ? &*result.support : nullptr;
  page.field_stress = result.field_stress ? &*result.field_stress : nullptr;
  for (const scene::CaseSupport& load : result.support_cases) {
    page.support_cases.push_back({load.name, &load.support});
  }
  page.maximum_blocks = maximum_rows(result);
  page.sensitivity = result.sensitivity;
  for (const topology::JointId joint : result.joints.ids()) {
    page.tan_friction.push_back(std::tan(result.joints[joint].strength.friction.radians()));
  }
  return page;
}

>>>>>>> Stashed changes
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
    const std::vector<std::int32_t> number(state.blocks().size(), static_cast<std::int32_t>(stage.stage));
    text.stage_of_block = number;
    CLEAVE_CHECK(write_file(folder / ("blocks_stage_" + std::to_string(stage.stage) + ".vtu"),
                            blocks_vtu(make_cells(state), stage.analysis ? &*stage.analysis : nullptr, text)));
  }
  return {};
}

std::expected<void, WriteError> write_dangling(const scene::RunResult& result, const fs::path& folder) {
  const auto* complex = complex_of(result);
  if (complex == nullptr || !complex->data().dangling) return {};
  if (result.output.vtu) CLEAVE_CHECK(write_file(folder / "dangling.vtu", dangling_vtu(*complex, result.title)));
  return write_file(folder / "dangling.obj", dangling_obj(*complex, result.title));
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
<<<<<<< Updated upstream
  if (result.support) {
    CLEAVE_CHECK(write_file(folder / "bolts.csv", bolts_csv(result)));
    CLEAVE_CHECK(write_file(folder / "support_blocks.csv", support_blocks_csv(result)));
    CLEAVE_CHECK(write_file(folder / "combined_blocks.csv", combined_blocks_csv(result)));
=======
  if (result.key_groups) {
    CLEAVE_CHECK(write_file(folder / "key_groups.csv", key_groups_csv(*result.key_groups)));
  }
  const stability::SupportResult* support = result.support ? &*result.support : nullptr;
  if (support != nullptr) {
    CLEAVE_CHECK(write_file(folder / "bolts.csv", bolts_csv(*support, result.bolt_groups)));
    std::vector<NamedSupport> cases{{"base", support}};
    for (const scene::CaseSupport& load : result.support_cases) cases.push_back({load.name, &load.support});
    CLEAVE_CHECK(write_file(folder / "support_blocks.csv", support_blocks_csv(cases)));
    CLEAVE_CHECK(write_file(folder / "combined_blocks.csv", combined_blocks_csv(cases)));
>>>>>>> Stashed changes
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
  CLEAVE_CHECK(write_exports(result, folder));
  CLEAVE_CHECK(write_sections(result, folder));
  CLEAVE_CHECK(write_key_blocks_csv(result, folder));
  CLEAVE_CHECK(write_report_html(result, folder));
  return write_summary_json(result, folder);
}

}  // namespace cleave::report
