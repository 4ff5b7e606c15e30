#include "summary.hpp"

#include <utility>

#include "cleave/report/json_fields.hpp"
#include "monte_carlo_fields.hpp"

namespace cleave::report {
namespace {

using scene::head_fields;

template <class Result>
std::string written(const Result& result) {
  JsonWriter json;
  JsonFields figures{json};
  figures.put(group([&](auto& v) {
    head_fields(v, result);
    fields(v, result);
  }));
  return std::move(json).finish();
}

}  // namespace

std::string summary_json(const scene::RunResult& result) { return written(result); }
std::string summary_json(const scene::BodiesResult& result) { return written(result); }
std::string summary_json(const scene::ContactResult& result) { return written(result); }
std::string monte_carlo_json(const MonteCarloPage& page) { return written(page); }

<<<<<<< Updated upstream
std::string summary_schema() {
  JsonWriter json;
  json.begin_object();
  json.member("$schema", "https://json-schema.org/draft/2020-12/schema");
  json.member("title", "summary.json of cleave");
  json.member("description",
              "Figures of one run. Sections of stages that did not run are absent. A Monte Carlo run has `monte_carlo` "
              "in place of `input`, `blocks` and `key_blocks`: no one block system stands for it. Keys are only ever "
              "added. Volumes in m3, lengths in m, times in s, memory in MB.");
  json.member("type", "object");
  json.key("properties");
  json.begin_object();
  SchemaFields figures{json};
  const scene::RunResult blocks = scene::empty_result();
  head_fields(figures, blocks);
  const std::vector<std::string> head = figures.required();
  fields(figures, blocks);
  plane_fields(figures, scene::BodiesResult{});
  plane_fields(figures, scene::ContactResult{});
  fields(figures, MonteCarloPage{});
  json.end_object();
  json.key("required");
  JsonFields{json}.put(head);
  json.key("anyOf");
  json.begin_array();
  for (const char* section : {"blocks", "elastic", "contact", "monte_carlo"}) {
=======
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

KeyGroupFigures count_key_groups(const stability::KeyGroups& groups) {
  KeyGroupFigures figures;
  for (const stability::KeyGroup& group : groups.groups) {
    const bool doubt = group.verdict == assembly::Verdict::in_doubt;
    figures.certain += group.verdict == assembly::Verdict::certain ? 1U : 0U;
    figures.unsafe += group.verdict == assembly::Verdict::unsafe ? 1U : 0U;
    figures.in_doubt += doubt ? 1U : 0U;
    if (doubt) continue;
    ++figures.count;
    figures.volume_m3 += group.volume.si();
    if (group.factors) figures.factor = std::min(figures.factor, group.factor_move);
  }
  return figures;
}

SupportFigures count_support(const stability::SupportResult& support) {
  SupportFigures f;
  f.passes = support.passes();
  f.blocks = support.blocks.size();
  f.bolts = support.bolts.size();
  f.spot_bolts = support.spot_bolts;
  for (const stability::SupportedBlock& b : support.blocks) {
    f.held_by_bolts += b.held == stability::Held::bolts ? 1U : 0U;
    f.held_by_shotcrete += b.held == stability::Held::shotcrete ? 1U : 0U;
    f.not_held += b.held == stability::Held::not_held ? 1U : 0U;
    f.required_force_n += b.required_force;
    f.missing_force_n += b.missing_force;
    f.largest_required_pressure_pa = std::max(f.largest_required_pressure_pa, b.required_pressure);
  }
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
  if (summary.key_groups) {
    const KeyGroupFigures& f = *summary.key_groups;
    json.key("key_groups");
    json.begin_object();
    json.member("count", f.count);
    json.member("volume_m3", f.volume_m3);
    json.member("certain", f.certain);
    json.member("unsafe", f.unsafe);
    json.member("in_doubt", f.in_doubt);
    json.member("factor", f.factor);  // null: no group
    json.end_object();
  }
  if (summary.support) write_support(json, *summary.support);
  if (summary.field_stress) {
    const FieldStressFigures& f = *summary.field_stress;
    json.key("field_stress");
>>>>>>> Stashed changes
    json.begin_object();
    json.key("required");
    json.begin_array();
    json.value(section);
    json.end_array();
    json.end_object();
  }
  json.end_array();
  json.end_object();
  return std::move(json).finish();
}

}  // namespace cleave::report
