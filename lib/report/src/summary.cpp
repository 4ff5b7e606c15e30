#include "cleave/report/summary.hpp"

#include <algorithm>
#include <numbers>
#include <tuple>
#include <utility>
#include <vector>

#include "cleave/report/json.hpp"
#include "cleave/report/modes.hpp"

namespace cleave::report {
namespace {

void write_plan(JsonWriter& json, const std::vector<PlanRow>& plan) {
  json.key("plan");
  json.begin_array();
  for (const PlanRow& row : plan) {
    json.begin_object();
    json.member("stage", row.stage);
    json.member("run", row.run);
    json.member("why", row.why);
    json.end_object();
  }
  json.end_array();
}

void write_cost(JsonWriter& json, const CostTable& cost) {
  json.key("cost");
  json.begin_object();
  json.member("wall_s", cost.wall_s);
  json.member("cpu_s", cost.cpu_s);
  json.member("peak_rss_mb", cost.peak_rss_mb);
  json.member("threads", cost.threads);
  json.key("stages");
  json.begin_array();
  for (const CostRow& row : cost.stages) {
    json.begin_object();
    json.member("stage", row.stage);
    json.member("wall_s", row.wall_s);
    json.member("cpu_s", row.cpu_s);
    json.member("peak_rss_mb", row.peak_rss_mb);
    json.end_object();
  }
  json.end_array();
  json.end_object();
}

void write_certificate(JsonWriter& json, const topology::Certificate& certificate) {
  json.key("certificate");
  json.begin_object();
  json.member("passed", certificate.passed);
  json.member("euler_violations", certificate.euler_violations);
  json.member("open_shells", certificate.open_shells);
  json.member("face_vector_max_relative", certificate.face_vector_max_relative);
  json.member("unpaired_patches", certificate.unpaired_patches);
  json.end_object();
}

void write_blocks(JsonWriter& json, const Summary& summary) {
  json.key("blocks");
  json.begin_object();
  const auto figure = [&](std::string_view name, auto BlockFigures::* member) {
    if (summary.blocks) {
      json.member(name, *summary.blocks.*member);
    } else {
      json.key(name);
      json.null();
    }
  };
  figure("count", &BlockFigures::count);
  json.member("volume_m3", summary.blocks ? summary.blocks->volume_m3 : summary.certificate.volume.si());
  figure("domain_volume_m3", &BlockFigures::domain_volume_m3);
  json.member("volume_relative_error", summary.certificate.volume_relative_error);
  figure("concave", &BlockFigures::concave);
  figure("with_holes", &BlockFigures::with_holes);
  figure("with_cavities", &BlockFigures::with_cavities);
  figure("slivers", &BlockFigures::slivers);
  figure("hash", &BlockFigures::hash);
  write_certificate(json, summary.certificate);
  figure("exact_share", &BlockFigures::exact_share);
  if (summary.window) {
    json.key("window");
    json.begin_object();
    const auto corner = [&](std::string_view name, const std::array<double, 3>& values) {
      json.key(name);
      json.begin_array();
      for (const double v : values) json.value(v);
      json.end_array();
    };
    corner("min", summary.window->min);
    corner("max", summary.window->max);
    json.member("rounds", summary.window->rounds);
    json.member("truncated", summary.window->truncated);
    json.end_object();
  }
  if (!summary.blocks) json.member("reason", "the certificate did not pass, so no block of this run is to be trusted");
  json.end_object();
}

void write_figures(JsonWriter& json, const KeyBlockFigures& figures) {
  json.member("count", figures.count);
  json.member("volume_m3", figures.volume_m3);
  json.key("batches");
  json.begin_array();
  for (const BatchFigures& batch : figures.batches) {
    json.begin_object();
    json.member("batch", batch.batch);
    json.member("count", batch.count);
    json.member("volume_m3", batch.volume_m3);
    json.key("modes");
    json.begin_object();
    for (std::size_t i = 0; i < batch.modes.size(); ++i) json.member(stability::name(all_modes[i]), batch.modes[i]);
    json.end_object();
    json.end_object();
  }
  json.end_array();
  json.member("stopped_at_max_batches", figures.stopped_at_max_batches);
  json.member("lowest_factor_of_safety", figures.lowest_factor_of_safety);  // null: no block has a finite one
  json.member("equilibrium_residual", figures.equilibrium_residual);
  if (figures.below_target) json.member("below_target", *figures.below_target);
  if (figures.turning) json.member("turning", *figures.turning);
}

void write_key_blocks(JsonWriter& json, const Summary& summary) {
  json.key("key_blocks");
  json.begin_object();
  write_figures(json, *summary.key_blocks);
  json.member("hash", summary.key_blocks->hash);
  if (!summary.load_cases.empty()) {
    json.key("load_cases");
    json.begin_array();
    for (const CaseFigures& load : summary.load_cases) {
      json.begin_object();
      json.member("name", load.name);
      write_figures(json, load.figures);
      json.end_object();
    }
    json.end_array();
  }
  json.end_object();
}

void write_support(JsonWriter& json, const SupportFigures& f) {
  json.key("support");
  json.begin_object();
  json.member("passes", f.passes);
  json.member("blocks", f.blocks);
  json.member("held_by_bolts", f.held_by_bolts);
  json.member("held_by_shotcrete", f.held_by_shotcrete);
  json.member("held_by_both", f.held_by_both);
  json.member("not_held", f.not_held);
  json.member("bolts", f.bolts);
  json.member("spot_bolts", f.spot_bolts);
  json.member("bolts_used", f.bolts_used);
  json.member("bolts_redundant", f.bolts_redundant);
  json.member("bolts_too_short", f.bolts_too_short);
  json.member("combined_blocks", f.combined);
  json.member("combined_failing", f.combined_failing);
  json.member("required_force_n", f.required_force_n);
  if (f.required_force_n_per_metre) json.member("required_force_n_per_metre", *f.required_force_n_per_metre);
  json.member("largest_required_pressure_pa", f.largest_required_pressure_pa);
  json.member("missing_force_n", f.missing_force_n);
  json.key("pressures");
  json.begin_array();
  for (const PressureFigures& p : f.pressures) {
    json.begin_object();
    json.member("where", p.where);
    json.member("blocks", p.blocks);
    json.member("free_area_m2", p.free_area_m2);
    json.member("median_pa", p.median_pa);
    json.member("p90_pa", p.p90_pa);
    json.member("largest_pa", p.largest_pa);
    json.end_object();
  }
  json.end_array();
  json.member("small_blocks", f.small_blocks);
  json.member("small_not_held", f.small_not_held);
  json.member("small_required_force_n", f.small_required_force_n);
  if (!f.designs.empty()) {
    json.key("designs");
    json.begin_array();
    for (const DesignFigures& d : f.designs) {
      json.begin_object();
      json.member("length_m", d.length_m);
      json.member("found", d.found);
      json.member("spacing_scale", d.scale);
      json.member("bolts", d.bolts);
      json.member("cost", d.cost);
      json.key("spacing_m");
      json.begin_array();
      for (const double spacing : d.spacing_m) json.value(spacing);
      json.end_array();
      json.member("rings", d.rings);
      json.member("offsets", d.offsets);
      json.member("offsets_failing", d.failing);
      json.member("failing_share_low", d.failing_share[0]);
      json.member("failing_share_high", d.failing_share[1]);
      if (d.governing) json.member("governing_block", *d.governing);
      json.end_object();
    }
    json.end_array();
  }
  if (!f.cases.empty()) {
    json.key("load_cases");
    json.begin_array();
    for (const SupportCaseFigures& c : f.cases) {
      json.begin_object();
      json.member("name", c.name);
      json.member("passes", c.passes);
      json.member("blocks", c.blocks);
      json.member("not_held", c.not_held);
      json.member("combined_blocks", c.combined);
      json.member("combined_failing", c.combined_failing);
      json.end_object();
    }
    json.end_array();
  }
  json.end_object();
}

void write_order(JsonWriter& json, const OrderFigures& order) {
  json.begin_object();
  json.key("stages");
  json.begin_array();
  for (const std::uint32_t stage : order.stages) json.value(stage);
  json.end_array();
  json.member("key_block_count", order.count);
  json.member("key_block_volume_m3", order.volume_m3);
  json.key("new_count");
  json.begin_array();
  for (const std::uint64_t count : order.new_count) json.value(count);
  json.end_array();
  json.key("new_volume_m3");
  json.begin_array();
  for (const double volume : order.new_volume_m3) json.value(volume);
  json.end_array();
  json.end_object();
}

void write_sequence(JsonWriter& json, const SequenceFigures& sequence) {
  json.key("sequence");
  json.begin_object();
  json.member("fallen", sequence.fallen);
  json.key("stages");
  json.begin_array();
  for (const StageFigures& stage : sequence.stages) {
    json.begin_object();
    json.member("stage", stage.stage);
    json.key("excavations");
    json.begin_array();
    for (const std::string& name : stage.excavations) json.value(name);
    json.end_array();
    json.member("certificate_passed", stage.passed);
    json.member("block_count", stage.blocks);
    json.member("block_volume_m3", stage.volume_m3);
    json.member("hash", stage.hash);
    json.key("key_blocks");
    json.begin_object();
    write_figures(json, stage.key_blocks);
    json.member("hash", stage.key_blocks.hash);
    json.end_object();
    json.member("new_key_block_count", stage.new_count);
    json.member("new_key_block_volume_m3", stage.new_volume_m3);
    json.end_object();
  }
  json.end_array();
  json.key("orders");
  json.begin_array();
  for (const OrderFigures& order : sequence.orders) write_order(json, order);
  json.end_array();
  json.member("best_order", std::uint64_t{sequence.best});
  json.end_object();
}

void write_micro_blocks(JsonWriter& json, const MicroBlockFigures& micro) {
  json.key("micro_blocks");
  json.begin_object();
  json.member("policy", micro.policy);
  json.member("count", micro.count);
  json.member("volume_m3", micro.volume_m3);
  json.member("thinnest_m", micro.thinnest_m);
  json.end_object();
}

void write_dangling(JsonWriter& json, const DanglingFigures& dangling) {
  json.key("dangling");
  json.begin_object();
  json.member("pieces", dangling.pieces);
  json.member("area_m2", dangling.area_m2);
  json.member("free_edges", dangling.free_edges);
  json.member("free_edge_length_m", dangling.free_edge_length_m);
  json.member("joints", dangling.joints);
  json.member("isolated_joints", dangling.isolated_joints);
  json.end_object();
}

}  // namespace

BlockFigures count_blocks(const topology::BlockComplex& complex, std::string hash) {
  BlockFigures figures{.domain_volume_m3 = complex.rock_volume().si(), .hash = std::move(hash)};
  figures.count = complex.blocks().size();
  for (const topology::Block& block : complex.blocks()) {
    figures.volume_m3 += block.volume.si();
    figures.concave += block.convex ? 0U : 1U;
    figures.with_holes += block.counts.genus > 0 || block.counts.loops > block.counts.faces ? 1U : 0U;
    figures.with_cavities += block.counts.shells > 1 ? 1U : 0U;
    figures.slivers += block.sliver ? 1U : 0U;
  }
  const topology::CutReport& report = complex.report();
  if (report.predicate_calls > 0) {
    figures.exact_share = static_cast<double>(report.predicate_exact) / static_cast<double>(report.predicate_calls);
  }
  return figures;
}

bool below(const stability::Judgement& judgement, const TargetFactors& target) {
  const bool free = judgement.mode == stability::Mode::falling || judgement.mode == stability::Mode::lifting;
  return stability::moves(judgement.mode) && judgement.factor_of_safety < (free ? target.falling : target.sliding);
}

KeyBlockFigures count_key_blocks(const stability::Analysis& analysis, const std::optional<TargetFactors>& target) {
  KeyBlockFigures figures{.batches = {},
                          .stopped_at_max_batches = analysis.stopped_at_max_batches,
                          .equilibrium_residual = analysis.equilibrium_residual,
                          .hash = {}};
  if (target) figures.below_target = 0;
  if (analysis.rotation != stability::RotationCheck::off) figures.turning = 0;
  for (const stability::Judgement& judgement : analysis.judgements) {
    figures.lowest_factor_of_safety = std::min(figures.lowest_factor_of_safety, judgement.factor_of_safety);
    if (target && below(judgement, *target)) ++*figures.below_target;
    if (figures.turning && judgement.rotation && judgement.rotation->turns) ++*figures.turning;
  }
  for (const stability::Batch& batch : analysis.batches) {
    BatchFigures row{.batch = batch.number, .count = batch.blocks.size(), .volume_m3 = batch.volume.si()};
    for (const topology::BlockId block : batch.blocks) {
      const auto judgement = std::ranges::lower_bound(analysis.judgements, block, {}, &stability::Judgement::block);
      if (judgement == analysis.judgements.end() || judgement->block != block) continue;
      if (stability::moves(judgement->mode)) ++row.modes[std::to_underlying(judgement->mode)];
    }
    figures.count += row.count;
    figures.volume_m3 += row.volume_m3;
    figures.batches.push_back(row);
  }
  return figures;
}

namespace {

/// By the way the blocks' free faces look: down within 45 degrees is the roof, up the floor.
std::vector<PressureFigures> pressures_of(const stability::SupportResult& support) {
  std::vector<PressureFigures> out;
  for (const auto& [where, low, high] : {std::tuple{"roof", -2.0, -std::numbers::sqrt2 / 2},
                                         {"walls", -std::numbers::sqrt2 / 2, std::numbers::sqrt2 / 2},
                                         {"floor", std::numbers::sqrt2 / 2, 2.0}}) {
    std::vector<std::pair<double, double>> rows;  // pressure, area
    PressureFigures side{.where = where};
    for (const stability::SupportedBlock& b : support.blocks) {
      const double z = b.free_outward.z;
      if (b.small || !(z >= low && z < high)) continue;
      rows.emplace_back(b.required_pressure, b.free_area);
      side.free_area_m2 += b.free_area;
    }
    if (rows.empty()) continue;
    std::ranges::sort(rows);
    side.blocks = rows.size();
    const auto at = [&](double share) {
      double area = 0;
      for (const auto& [pressure, part] : rows) {
        area += part;
        if (area >= share * side.free_area_m2) return pressure;
      }
      return rows.back().first;
    };
    side.median_pa = at(0.5);
    side.p90_pa = at(0.9);
    side.largest_pa = rows.back().first;
    out.push_back(side);
  }
  return out;
}

}  // namespace

SupportFigures count_support(const stability::SupportResult& support) {
  SupportFigures f;
  f.passes = support.passes();
  f.blocks = support.blocks.size();
  f.bolts = support.bolts.size();
  f.spot_bolts = support.spot_bolts;
  for (const stability::SupportedBlock& b : support.blocks) {
    f.held_by_bolts += b.held == stability::Held::bolts ? 1U : 0U;
    f.held_by_shotcrete += b.held == stability::Held::shotcrete ? 1U : 0U;
    f.held_by_both += b.held == stability::Held::together ? 1U : 0U;
    f.not_held += b.held == stability::Held::not_held ? 1U : 0U;
    f.required_force_n += b.required_force;
    f.missing_force_n += b.missing_force;
    if (b.small) {
      ++f.small_blocks;
      f.small_not_held += b.held == stability::Held::not_held ? 1U : 0U;
      f.small_required_force_n += b.required_force;
    } else {
      f.largest_required_pressure_pa = std::max(f.largest_required_pressure_pa, b.required_pressure);
    }
  }
  f.pressures = pressures_of(support);
  for (const stability::BoltResult& bolt : support.bolts) {
    f.bolts_used += bolt.status == stability::BoltStatus::holds ? 1U : 0U;
    f.bolts_redundant += bolt.status == stability::BoltStatus::redundant ? 1U : 0U;
    f.bolts_too_short += bolt.status == stability::BoltStatus::too_short ? 1U : 0U;
  }
  f.combined = support.combined.size();
  for (const stability::CombinedBlock& b : support.combined) f.combined_failing += b.passes ? 0U : 1U;
  return f;
}

void write_summary_input(JsonWriter& json, const InputFigures& input) {
  json.key("input");
  json.begin_object();
  json.member("joints", input.joints);
  json.member("lattice_pitch_m", input.lattice_pitch_m);
  json.member("largest_snap_m", input.largest_snap_m);
  json.member("merged_planes", input.merged_planes);
  if (!input.snapped.empty()) {
    json.key("snapped");
    json.begin_array();
    for (const SnappedRow& row : input.snapped) {
      json.begin_object();
      json.member("joint", row.joint);
      json.member("moved_m", row.moved_m);
      json.member("plane_merged", row.plane_merged);
      json.member("edges_adopted", row.edges_adopted);
      json.end_object();
    }
    json.end_array();
  }
  json.end_object();
}

void write_summary_head(JsonWriter& json, const Summary& summary) {
  json.member("cleave", CLEAVE_VERSION);
  json.member("schema", 1U);
  json.member("title", summary.title);
  json.member("seed", summary.seed);
  json.member("scene_sha256", summary.scene_sha256);
  write_plan(json, summary.plan);
  write_cost(json, summary.cost);
}

std::string summary_json(const Summary& summary) {
  JsonWriter json;
  json.begin_object();
  write_summary_head(json, summary);
  write_summary_input(json, summary.input);
  write_blocks(json, summary);
  if (summary.key_blocks) write_key_blocks(json, summary);
  if (summary.support) write_support(json, *summary.support);
  if (summary.field_stress) {
    const FieldStressFigures& f = *summary.field_stress;
    json.key("field_stress");
    json.begin_object();
    json.member("tunnel", f.tunnel);
    json.member("elements", f.elements);
    json.member("error", f.error);
    json.member("condition", f.condition);
    json.member("residual", f.residual);
    json.member("blocks", f.blocks);
    json.member("held", f.held);
    json.member("lowest_factor_of_safety", f.lowest_factor_of_safety);  // null: no block has a finite one
    json.end_object();
  }
  if (summary.maximum_blocks) {
    json.key("maximum_blocks");
    json.begin_object();
    json.member("count", summary.maximum_blocks->count);
    json.member("largest_volume_m3", summary.maximum_blocks->largest_volume_m3);
    json.member("lowest_factor_of_safety", summary.maximum_blocks->lowest_factor_of_safety);
    json.member("largest_required_pressure_pa", summary.maximum_blocks->largest_required_pressure_pa);
    json.end_object();
  }
  if (summary.micro_blocks) write_micro_blocks(json, *summary.micro_blocks);
  if (summary.dangling) write_dangling(json, *summary.dangling);
  if (summary.sequence) write_sequence(json, *summary.sequence);
  json.end_object();
  return std::move(json).finish();
}

}  // namespace cleave::report
