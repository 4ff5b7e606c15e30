#include "cleave/realize/figures.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cleave/realize/places.hpp"
#include "cleave/realize/run.hpp"
#include "cleave/realize/run_result.hpp"

namespace cleave::scene {
/// What moves only together with others, or turns, has.
bool below(const stability::Judgement& judgement, const Targets& target) {
  if (judgement.key && !stability::moves(judgement.mode)) return true;
  const bool free = judgement.mode == stability::Mode::falling || judgement.mode == stability::Mode::lifting;
  return stability::moves(judgement.mode) && judgement.factor_of_safety < (free ? target.falling : target.sliding);
}

namespace {

MicroBlockFigures count_micro_blocks(const topology::BlockComplex& complex, const MicroBlocks& limits) {
  MicroBlockFigures figures{.policy = limits.policy};
  for (const topology::BlockId id : micro_blocks(complex, limits)) {
    const topology::Block& block = complex.blocks()[id];
    figures.thinnest_m = figures.count == 0 ? block.thickness.si() : std::min(figures.thinnest_m, block.thickness.si());
    figures.volume_m3 += block.volume.si();
    ++figures.count;
  }
  return figures;
}

MaximumFigures count_maximum_blocks(const std::vector<MaximumRow>& rows) {
  MaximumFigures figures{.count = rows.size()};
  for (const MaximumRow& row : rows) {
    figures.largest_volume_m3 = std::max(figures.largest_volume_m3, row.block.block.volume);
    figures.lowest_factor_of_safety = std::min(figures.lowest_factor_of_safety, row.block.factor_of_safety);
    figures.largest_required_pressure_pa = std::max(figures.largest_required_pressure_pa, row.block.required_pressure);
  }
  return figures;
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

KeyBlockFigures count_key_blocks(const stability::Analysis& analysis, const std::optional<Targets>& target) {
  KeyBlockFigures figures{.batches = {},
                          .stopped_at_max_batches = analysis.stopped_at_max_batches,
                          .equilibrium_residual = analysis.equilibrium_residual};
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

Stress pressure_of_share(std::vector<PressureAt> blocks, double share) {
  std::erase_if(blocks, [](const PressureAt& b) { return !(b.area.si() > 0); });
  if (blocks.empty()) return {};
  std::ranges::stable_sort(blocks, {}, [](const PressureAt& b) { return b.pressure.si(); });
  Area whole, area;
  for (const PressureAt& b : blocks) whole += b.area;
  for (const PressureAt& b : blocks) {
    area += b.area;
    if (area >= share * (1 - 1e-12) * whole) return b.pressure;
  }
  return blocks.back().pressure;
}

std::vector<PressureFigures> pressure_diagram(std::vector<PressureAt> blocks, std::span<const PressureAt> walls) {
  std::erase_if(blocks, [](const PressureAt& b) { return !(b.area.si() > 0); });
  std::vector<PressureFigures> places;
  for (const std::string_view place : all_locations()) {
    PressureFigures row{.place = std::string{place}};
    std::vector<PressureAt> here;
    std::ranges::copy_if(blocks, std::back_inserter(here), [&](const PressureAt& b) { return b.place == place; });
    for (const PressureAt& b : here) row.area += b.area;
    for (const PressureAt& wall : walls) row.opening_area += wall.place == place ? wall.area : Area{};
    if (here.empty() && !(row.opening_area > Area{})) continue;
    if (here.empty()) {
      places.push_back(std::move(row));
      continue;
    }
    row.p50 = pressure_of_share(here, 0.5);
    row.p90 = pressure_of_share(here, 0.9);
    row.p95 = pressure_of_share(here, 0.95);
    row.largest = pressure_of_share(here, 1);
    places.push_back(std::move(row));
  }
  return places;
}

SupportFigures count_support(const stability::SupportResult& support) {
  SupportFigures f;
  f.block_by_block = support.passes();
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
    if (b.passed_on) {
      ++f.passed_on_blocks;
      f.passed_on_not_held += b.held == stability::Held::not_held ? 1U : 0U;
      f.passed_on_required_force_n += b.required_force;
    }
    if (b.small) {
      ++f.small_blocks;
      f.small_not_held += b.held == stability::Held::not_held ? 1U : 0U;
      f.small_required_force_n += b.required_force;
    }
  }
  for (const stability::BoltResult& bolt : support.bolts) {
    f.bolts_used += bolt.status == stability::BoltStatus::holds ? 1U : 0U;
    f.bolts_of_groups += bolt.status == stability::BoltStatus::group ? 1U : 0U;
    f.bolts_redundant += bolt.status == stability::BoltStatus::redundant ? 1U : 0U;
    f.bolts_too_short += bolt.status == stability::BoltStatus::too_short ? 1U : 0U;
  }
  f.turning = support.turning.size();
  f.turning_not_held =
      static_cast<std::uint64_t>(std::ranges::count(support.turning, false, &stability::OnlyTurns::held));
  f.combined = support.combined.size();
  for (const stability::CombinedBlock& b : support.combined) f.combined_failing += b.passes ? 0U : 1U;
  return f;
}

std::vector<std::string> failing_cases(const std::vector<SupportCaseFigures>& cases) {
  std::vector<std::string> names;
  for (const SupportCaseFigures& load : cases) {
    if (!load.figures.passes()) names.push_back(load.name);
  }
  return names;
}

FailsElsewhere fails_elsewhere(const SupportFigures& support, const std::vector<SupportCaseFigures>& cases) {
  std::vector<std::string_view> passes;
  std::vector<std::string> fails;
  if (const auto names = failing_cases(cases); !names.empty()) {
    passes.emplace_back("without load");
    fails.push_back(fmt::format("under {}", fmt::join(names, ", ")));
  }
  if (support.failing_stages && !support.failing_stages->empty()) {
    passes.emplace_back("when all is excavated");
    fails.push_back(fmt::format("after {} {}", support.failing_stages->size() == 1 ? "stage" : "stages",
                                fmt::join(*support.failing_stages, ", ")));
  }
  return {fmt::format("{}", fmt::join(passes, " ")), fmt::format("{}", fmt::join(fails, ", "))};
}

SupportedGroupFigures count_supported_groups(const stability::GroupSupport& groups) {
  SupportedGroupFigures f;
  f.count = groups.below.groups.size();
  for (const stability::KeyGroup& group : groups.below.groups) {
    const std::optional<assembly::Verdict> left = groups.left_of(group);
    if (!left) continue;
    if (*left == assembly::Verdict::in_doubt) {
      ++f.in_doubt;
    } else {
      ++f.not_held;
      f.not_held_volume += group.volume;
    }
  }
  // What more they push was not looked at.
  if (groups.below.cut_off || groups.left.cut_off) {
    ++f.count;
    ++f.in_doubt;
  }
  return f;
}

RunResult empty_result() {
  return {{{.input = {.domain = geometry::make_box({0, 0, 0}, {1, 1, 1}).value()}}}, ResultHead{}};
}

Stress pressure_asked_at(const stability::SupportedBlock& block) { return pascals(block.lining_pressure); }

namespace {

/// Key blocks of later batches that are not below their target in place: what stands before them keeps them. Not those
/// that move with others, which their group says.
std::uint64_t count_behind(const stability::Analysis& analysis, const stability::SupportResult& support,
                           const std::optional<stability::GroupSupport>& groups) {
  const auto of_a_group = [&](topology::BlockId id) {
    return groups && std::ranges::any_of(groups->below.groups, [&](const stability::KeyGroup& group) {
             return std::ranges::binary_search(group.blocks, id);
           });
  };
  std::uint64_t behind = 0;
  for (const stability::Batch& batch : analysis.batches) {
    if (batch.number == 1) continue;
    for (const topology::BlockId id : batch.blocks) {
      const auto needy = std::ranges::lower_bound(support.blocks, id, {}, &stability::SupportedBlock::block);
      behind += (needy == support.blocks.end() || needy->block != id) && !of_a_group(id) ? 1U : 0U;
    }
  }
  return behind;
}

/// Blocks that the support holds by themselves, but not, or not for certain, with the others of their group.
std::uint64_t count_held_in_failing_groups(const stability::SupportResult& support,
                                           const std::optional<stability::GroupSupport>& groups) {
  if (!groups) return 0;
  std::vector<topology::BlockId> failing;
  for (const stability::KeyGroup& group : groups->below.groups) {
    if (groups->left_of(group)) failing.insert(failing.end(), group.blocks.begin(), group.blocks.end());
  }
  std::ranges::sort(failing);
  return static_cast<std::uint64_t>(std::ranges::count_if(support.blocks, [&](const stability::SupportedBlock& block) {
    return block.held != stability::Held::not_held && std::ranges::binary_search(failing, block.block);
  }));
}

SupportFigures count_support(const RunResult& result, const stability::Analysis& analysis,
                             const stability::SupportResult& support,
                             const std::optional<stability::GroupSupport>& groups) {
  SupportFigures figures = scene::count_support(support);
  figures.key_blocks_behind = count_behind(analysis, support, groups);
  figures.held_in_failing_groups = count_held_in_failing_groups(support, groups);
  std::vector<PressureAt> blocks;
  for (const stability::SupportedBlock& b : support.blocks) {
    for (const OpenPlace& place : pressed_places(result, result.complex->complex(), b)) {
      blocks.push_back({place.location, place.free_area, pressure_asked_at(b)});
    }
  }
  std::vector<PressureAt> walls;
  for (const OpenPlace& wall : walls_of_openings(result, result.complex->complex())) {
    walls.push_back({wall.location, wall.free_area, {}});
  }
  figures.pressures = pressure_diagram(std::move(blocks), walls);
  for (const PressureFigures& row : figures.pressures) {
    figures.largest_required_pressure_pa = std::max(figures.largest_required_pressure_pa, row.p95.si());
  }
  return figures;
}

/// All that leaves, where blocks were judged together.
std::optional<InAll> count_in_all(const RunResult& result, const stability::Analysis& analysis,
                                  const std::optional<stability::KeyGroups>& groups) {
  if (!groups || groups->too_many || !result.complex) return std::nullopt;
  std::vector<topology::BlockId> leaving;
  for (const stability::Batch& batch : analysis.batches) {
    leaving.insert(leaving.end(), batch.blocks.begin(), batch.blocks.end());
  }
  for (const stability::KeyGroup& group : groups->groups) {
    if (group.verdict == assembly::Verdict::in_doubt) continue;
    leaving.insert(leaving.end(), group.blocks.begin(), group.blocks.end());
  }
  std::ranges::sort(leaving);
  leaving.erase(std::ranges::unique(leaving).begin(), leaving.end());
  InAll out{.count = leaving.size()};
  for (const topology::BlockId id : leaving) out.volume += result.complex->complex().blocks()[id].volume;
  return out;
}

/// What key blocks lack, one by one; what turns may lack nothing.
double net_force_of(const stability::Analysis& analysis) {
  double sum = 0;
  for (const stability::Judgement& j : analysis.judgements) sum += j.key ? std::max(0.0, j.net.si()) : 0.0;
  return sum;
}

/// Where most moves, of equal cases where the factor is lowest, then where most is lacking: smaller is worse.
std::array<double, 3> how_bad(const KeyBlockFigures& figures, const std::optional<KeyGroupFigures>& groups,
                              const stability::Analysis& analysis) {
  const double moves = groups && groups->in_all ? groups->in_all->volume.si() : figures.volume_m3;
  const double together = groups ? groups->least_factor : std::numeric_limits<double>::infinity();
  return {-moves, std::min(figures.lowest_factor_of_safety, together), -net_force_of(analysis)};
}

std::optional<KeyGroupFigures> base_groups(const RunResult& result) {
  if (!result.key_groups) return std::nullopt;
  KeyGroupFigures figures = count_key_groups(*result.key_groups);
  if (result.groups_below_target) add_below_target(*result.groups_below_target, figures);
  figures.together = result.group_factor;
  if (result.analysis) figures.in_all = count_in_all(result, *result.analysis, result.key_groups);
  return figures;
}

/// Of [stability], or of the load itself.
std::optional<Targets> target_under(const RunResult& result, std::string_view load) {
  if (!result.stability) return std::nullopt;
  const auto found = std::ranges::find(result.stability->cases, load, &LoadCase::name);
  return found != result.stability->cases.end() && found->target ? found->target : result.stability->target;
}

std::optional<std::string> governing_case(const Figures& figures, const RunResult& result) {
  if (figures.load_cases.empty() || !figures.key_blocks) return std::nullopt;
  std::string out = "base";
  auto worst = how_bad(*figures.key_blocks, figures.groups, *result.analysis);
  for (std::size_t k = 0; k < figures.load_cases.size(); ++k) {
    const CaseFigures& load = figures.load_cases[k];
    const auto here = how_bad(load.figures, load.groups, result.load_cases[k].analysis);
    if (here < worst) {
      worst = here;
      out = load.name;
    }
  }
  return out;
}

}  // namespace

Figures count(const RunResult& result) {
  Figures figures;
  figures.input.joints = result.joints.size();
  figures.input.files = result.files;
  if (!result.joints.empty()) {
    std::vector<SetId> set_of;
    std::vector<std::string> names;
    for (const JointInfo& joint : result.joints) set_of.push_back(joint.set);
    for (const SetInfo& set : result.sets) names.push_back(set.name);
    if (set_of.size() == result.input.joints.size()) figures.input.sets = count_sets(result.input, set_of, names);
  }
  if (result.complex) {
    const topology::BlockComplex& complex = result.complex->complex();
    const topology::CutReport& report = complex.report();
    for (const ExcavationInfo& info : result.excavations) {
      figures.input.excavations.push_back({info.name, info.taken.removed, info.outside_share});
    }
    figures.input.lattice_pitch_m = report.lattice_pitch_m;
    figures.input.largest_snap_m = report.largest_snap_m;
    figures.input.merged_planes = report.merged_planes;
    figures.input.snapped = report.snapped;
    figures.input.coarse_snap = report.coarse_snap;
    figures.input.near_misses = report.near_misses;
    figures.blocks = count_blocks(complex, result.block_hash);
    figures.blocks->sizes = block_sizes(complex);
    for (const SetFigures& set : figures.input.sets) {
      if (figures.blocks->sizes) figures.blocks->sizes->jv += set.p10;
    }
    if (result.micro_blocks.policy != MicroBlockPolicy::keep) {
      figures.micro_blocks = count_micro_blocks(complex, result.micro_blocks);
    }
  }
  const std::optional<Targets> target = result.stability ? result.stability->target : std::nullopt;
  if (result.analysis) figures.key_blocks = count_key_blocks(*result.analysis, target);
  const auto count_held = [](const stability::DomainHeld& held) {
    return DomainHeldFigures{held.blocks.size(), held.volume,
                             held.all_free.si() > 0 ? held.free_area / held.all_free : 0, held.together};
  };
  if (figures.key_blocks && result.domain_held) figures.key_blocks->domain_held = count_held(*result.domain_held);
  if (figures.key_blocks) figures.key_blocks->held_at_target = result.held_at_target;
  figures.groups = base_groups(result);
  for (const CaseResult& load : result.load_cases) {
    CaseFigures& row =
        figures.load_cases.emplace_back(load.name, count_key_blocks(load.analysis, target_under(result, load.name)));
    if (load.domain_held) row.figures.domain_held = count_held(*load.domain_held);
    row.figures.held_at_target = load.held_at_target;
    if (!load.groups) continue;
    row.groups = count_key_groups(*load.groups);
    row.groups->in_all = count_in_all(result, load.analysis, load.groups);
    if (load.groups_below_target) add_below_target(*load.groups_below_target, *row.groups);
  }
  figures.governing_case = governing_case(figures, result);
  if (result.support) {
    figures.support = count_support(result, *result.analysis, *result.support, result.group_support);
    figures.support->targets = target.value_or(Targets{});
    figures.support->not_asked = result.not_asked;
  }
  const bool asked = result.stability && result.stability->groups != stability::GroupsCheck::off;
  const auto add_groups = [&](SupportFigures& support, const std::optional<stability::GroupSupport>& groups) {
    if (groups) support.groups = count_supported_groups(*groups);
    support.groups_judged = groups ? GroupsJudged::yes : asked ? GroupsJudged::too_many : GroupsJudged::not_asked;
  };
  if (figures.support) add_groups(*figures.support, result.group_support);
  for (const CaseSupport& load : result.support_cases) {
    const auto under = std::ranges::find(result.load_cases, load.name, &CaseResult::name);
    const stability::Analysis& analysis = under != result.load_cases.end() ? under->analysis : *result.analysis;
    figures.support_cases.push_back({load.name, count_support(result, analysis, load.support, load.groups)});
    figures.support_cases.back().figures.targets = target_under(result, load.name).value_or(Targets{});
    add_groups(figures.support_cases.back().figures, load.groups);
  }
  if (figures.support && result.sequence) {
    auto& failing = figures.support->failing_stages.emplace();
    for (const StageResult& row : result.sequence->stages) {
      // Where the rock of a stage did not pass its own check, nothing says that it holds.
      if (!row.support || !row.support->passes()) failing.push_back(row.stage);
    }
  }
  if (!result.maximum_blocks.empty()) figures.maximum_blocks = count_maximum_blocks(result.maximum_blocks);
  return figures;
}

}  // namespace cleave::scene
