#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "cleave/realize/monte_carlo.hpp"
#include "cleave/realize/places.hpp"
#include "group_notes.hpp"
#include "held_notes.hpp"

/// What is kept of a realization.
namespace cleave::scene {

using stochastic::Outcome;
using stochastic::Record;

namespace {

/// Where it was asked, also when too many blocks were near to look.
stochastic::SupportedTogether supported_together(const std::optional<stability::GroupSupport>& found) {
  if (!found) return {.too_many = true};
  const SupportedGroupFigures figures = count_supported_groups(*found);
  return {.not_held = figures.not_held, .in_doubt = figures.in_doubt, .not_held_volume = figures.not_held_volume};
}

/// With free faces that are roof, walls or floor of an opening, or none of these.
std::optional<stochastic::Part> part_of(const Scene& scene, const OpenPlace& place) {
  const std::optional<stochastic::Part> part = scene::part_of(place);
  return !part || has_own_opening(scene.excavations) ? part : stochastic::Part::faces;
}

/// By Part; empty where there are only cuts from above.
std::vector<stochastic::PartTally> tally_parts(const Scene& scene, const topology::BlockComplex& complex,
                                               const stability::Analysis& analysis) {
  if (!has_own_opening(scene.excavations)) return {};
  std::vector<stochastic::PartTally> tallies(stochastic::part_count);
  for (const stability::Judgement& judgement : analysis.judgements) {
    if (!judgement.batch) continue;
    const auto part = part_of(scene, open_place_of(scene, complex, judgement.block));
    if (!part) continue;
    stochastic::PartTally& tally = tallies[std::to_underlying(*part)];
    ++tally.count;
    tally.volume += complex.blocks()[judgement.block].volume;
  }
  return tallies;
}

std::array<Stress, stochastic::part_count> pressures_at_parts(const Scene& scene, const topology::BlockComplex& complex,
                                                              const stability::SupportResult& support) {
  std::array<std::vector<PressureAt>, stochastic::part_count> blocks;
  for (const stability::SupportedBlock& block : support.blocks) {
    const Stress most = scene.support ? scene.support->plan.most_pressure : pressure_asked_at(block);
    for (const OpenPlace& place : pressed_places(scene, complex, block)) {
      const auto part = part_of(scene, place);
      if (!part) continue;
      blocks.at(std::to_underlying(*part))
          .push_back({place.location, place.free_area, std::min(most, pressure_asked_at(block))});
    }
  }
  std::array<Stress, stochastic::part_count> pressures;
  std::ranges::transform(blocks, pressures.begin(), [](const auto& here) { return pressure_of_share(here, 0.95); });
  return pressures;
}

stochastic::Supported tally_support(const Scene& scene, const topology::BlockComplex& complex,
                                    const stability::SupportResult& support,
                                    const std::optional<stability::GroupSupport>& together,
                                    const stochastic::Questions& questions) {
  stochastic::Supported sum;
  sum.spot_bolts = support.spot_bolts;
  sum.pressures = pressures_at_parts(scene, complex, support);
  for (const stability::SupportedBlock& block : support.blocks) {
    ++sum.needing;
    if (block.held != stability::Held::not_held) continue;
    ++sum.not_held;
    sum.not_held_m3 += complex.blocks()[block.block].volume.si();
    // A block that no force holds at its target has an infinite lack: counted, not added.
    if (std::isfinite(block.missing_force)) sum.missing_n += block.missing_force;
  }
  for (const stability::OnlyTurns& turning : support.turning) {
    ++sum.needing;
    if (turning.held) continue;
    ++sum.not_held;
    sum.not_held_m3 += complex.blocks()[turning.block].volume.si();
  }
  for (const stability::CombinedBlock& body : support.combined) sum.failing_bodies += body.passes ? 0U : 1U;
  if (questions.groups) sum.groups = supported_together(together);
  return sum;
}

stochastic::SupportedStages tally_stages(const SequenceResult& sequence) {
  stochastic::SupportedStages sum;
  for (const StageResult& row : sequence.stages) {
    if (!row.support) continue;
    ++sum.judged;
    sum.failing += row.support->passes() ? 0U : 1U;
  }
  return sum;
}

stochastic::Grouped tally_groups(const stability::KeyGroups& found) {
  stochastic::Grouped groups;
  groups.too_many = found.too_many;
  for (const stability::KeyGroup& group : found.groups) {
    const bool doubt = group.verdict == assembly::Verdict::in_doubt;
    ++(doubt ? groups.in_doubt : groups.moving);
    (doubt ? groups.in_doubt_volume : groups.moving_volume) += group.volume;
  }
  return groups;
}

stochastic::Staying tally_tapered(const std::vector<stability::Barred>& tapered,
                                  const std::optional<stability::KeyGroups>& groups,
                                  const stochastic::Questions& questions) {
  stochastic::Staying sum;
  for (const stability::Barred& row : questions.groups ? in_no_group(tapered, groups) : tapered) {
    ++sum.count;
    sum.volume += row.volume;
  }
  return sum;
}

std::optional<stochastic::StayingAtTarget> tally_at_target(const std::optional<HeldAtTarget>& held) {
  return held.transform([](const HeldAtTarget& h) {
    return stochastic::StayingAtTarget{.border = {h.border.count, h.border.volume},
                                       .tapered = {h.tapered.count, h.tapered.volume}};
  });
}

std::vector<stochastic::CaseTally> tally_cases(const Realization& made, const Scene& scene,
                                               const stochastic::Questions& questions) {
  const topology::BlockComplex& complex = made.complex->complex();
  std::vector<stochastic::CaseTally> tallies;
  for (std::size_t k = 0; k < made.load_cases.size(); ++k) {
    const CaseResult& load = made.load_cases[k];
    stochastic::CaseTally& tally = tallies.emplace_back(stochastic::measure_case(complex, load.analysis));
    if (const auto& held = questions.groups ? load.domain_held : load.held_alone) {
      tally.border = {.count = held->blocks.size(), .volume = held->volume};
    }
    tally.tapered = tally_tapered(load.tapered, load.groups, questions);
    tally.turning = stochastic::count_turning(load.analysis);
    if (made.held_at_target) tally.at_target = tally_at_target(load.held_at_target);
    tally.at_parts = tally_parts(scene, complex, load.analysis);
    if (questions.groups && load.groups) tally.groups = tally_groups(*load.groups);
    if (k >= made.support_cases.size()) continue;
    const CaseSupport& with = made.support_cases[k];
    tally.support = tally_support(scene, complex, with.support, with.groups, questions);
  }
  return tallies;
}

stochastic::FlowTally tally_flow(const FlowResult& found) {
  const flow::Connectivity& c = found.connectivity;
  stochastic::FlowTally tally{.clusters = c.clusters.size(),
                              .opening_share = found.share_at_openings(),
                              .backbone_share = found.share_of_backbone()};
  if (!c.clusters.empty() && c.area > Area{}) tally.largest_share = c.clusters.front().area / c.area;
  for (const auto& [a, b] : found.percolating_tags) tally.connected.push_back(stochastic::pair_of_sides(a, b));
  std::ranges::sort(tally.connected);
  tally.connected.erase(std::ranges::unique(tally.connected).begin(), tally.connected.end());
  if (!found.flow) return tally;
  const flow::Flow& f = *found.flow;
  tally.water = stochastic::WaterTally{.inflow = FlowRate::from_si(f.drained.value),
                                       .low = FlowRate::from_si(f.drained.low),
                                       .high = FlowRate::from_si(f.drained.high),
                                       .wet_share = f.area > Area{} ? f.wet_area / f.area : 0.0,
                                       .settled = f.status == flow::FlowStatus::converged};
  return tally;
}

std::vector<stochastic::SetTally> tally_sets(const SampledScene& made) {
  std::vector<SetId> set_of;
  std::vector<std::string> names;
  for (const JointInfo& joint : made.joints) set_of.push_back(joint.set);
  for (const SetInfo& set : made.sets) names.push_back(set.name);
  std::vector<stochastic::SetTally> tallies;
  for (const SetFigures& set : count_all_sets(made.input, set_of, names)) {
    tallies.push_back({set.joints, set.p32, set.p10, set.p21});
  }
  return tallies;
}

}  // namespace

Record record_of(std::uint64_t k, const Realization& made, const Scene& scene, const Shared& shared) {
  const stochastic::Questions& questions = shared.questions;
  Record record;
  record.realization = k;
  if (!made.complex) {
    record.outcome = Outcome::certificate_failed;
    return record;
  }
  const topology::BlockComplex& complex = made.complex->complex();
  const std::optional<stability::DomainHeld>& held = questions.groups ? made.domain_held : made.held_alone;
  record = stochastic::measure(complex, made.analysis ? &*made.analysis : nullptr, questions, held ? &*held : nullptr);
  record.realization = k;
  record.joints = made.joints.size();
  if (questions.whole) record.whole = tally_blocks(complex, questions.undisturbed);
  record.sets = tally_sets(made);
  for (const LineInRock& line : shared.lines) {
    const LinePieces found = pieces_on(line, made.input);
    const double rqd = found.length.si() > 0 ? survey::rqd_measured(found.pieces, found.length.si()) : 0;
    record.lines.push_back({found.joints, found.length, rqd});
  }
  if (made.support) record.support = tally_support(scene, complex, *made.support, made.group_support, questions);
  if (made.analysis) record.at_parts = tally_parts(scene, complex, *made.analysis);
  if (questions.groups && made.key_groups) record.groups = tally_groups(*made.key_groups);
  if (made.analysis) record.turning = stochastic::count_turning(*made.analysis);
  record.at_target = tally_at_target(made.held_at_target);
  if (made.analysis) record.tapered = tally_tapered(made.tapered, made.key_groups, questions);
  record.cases = tally_cases(made, scene, questions);
  if (made.flow) record.flow = tally_flow(*made.flow);
  if (made.field_stress) {
    record.clamped = {.held = made.field_stress->held,
                      .undecided = made.field_stress->undecided,
                      .held_volume = made.field_stress->held_volume};
  }
  if (made.sequence) {
    for (const OrderResult& order : made.sequence->orders) {
      record.orders.push_back({order.key_blocks, order.key_volume.si()});
    }
    if (scene.support) record.supported_stages = tally_stages(*made.sequence);
  }
  return record;
}

}  // namespace cleave::scene
