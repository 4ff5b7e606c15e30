#include "cleave/realize/monte_carlo.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <mutex>
#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/core/parallel.hpp"
#include "cleave/core/sha256.hpp"
#include "cleave/realize/places.hpp"
#include "cleave/realize/run.hpp"
#include "cleave/stochastic/ordered.hpp"
#include "group_notes.hpp"
#include "held_notes.hpp"

namespace cleave::scene {

using stochastic::Ensemble;
using stochastic::Outcome;
using stochastic::Record;
using stochastic::RecordFile;
using stochastic::RecordFileError;

std::string scene_and_files_sha256(const Scene& scene) {
  if (scene.files.empty()) return scene.sha256;
  Sha256 hash;
  hash.update(scene.sha256);
  for (const InputFile& file : scene.files) hash.update(file.sha256);
  return hash.hex();
}

stochastic::Questions questions_of(const Scene& scene) {
  stochastic::Questions questions;
  if (!scene.monte_carlo) return questions;
  questions.groups = scene.stability && scene.stability->decides_by_groups();
  questions.clamped = scene.stability && scene.field_stress;
  questions.whole = !(scene.output.only_key_blocks && scene.stability);
  questions.undisturbed = undisturbed_box(scene);
  questions.volumes_m3 = scene.monte_carlo->volumes;
  for (const Excavation& excavation : scene.excavations) {
    if (excavation.axis.empty()) continue;
    questions.axis = excavation.axis;
    questions.chainage_parts = scene.monte_carlo->chainage_parts;
    break;
  }
  return questions;
}

Shared shared_by_realizations(const Scene& scene, unsigned threads) {
  return {questions_of(scene), shared_fields(scene, threads), lines_in_rock(scene)};
}

std::vector<std::vector<std::uint32_t>> orders_of(const Scene& scene) {
  if (!scene.sequence || !scene.stability) return {};
  std::vector<std::vector<std::uint32_t>> orders{scene.sequence->stages};
  for (const auto& order : scene.sequence->orders) {
    if (order != scene.sequence->stages) orders.push_back(order);
  }
  return orders;
}

namespace {
/// One in the rock: all but cuts from above.
bool has_own_opening(const Scene& scene) { return std::ranges::any_of(scene.excavations, &Excavation::own_shape); }

/// What pulls at all rock of the domain at most: nothing but its weight, and an earthquake.
std::optional<Force> pull_of(const Scene& scene, const LoadSet& loads) {
  const stability::ActionSpec& spec = loads.actions.spec();
  if (!loads.dry() || !spec.surcharges.empty() || !spec.points.empty() || !spec.lines.empty()) return std::nullopt;
  const geometry::Vec3 gravity = loads.body.gravity();
  double shakes = 1;
  if (scene.monte_carlo) {
    const NumberLaw& law = scene.monte_carlo->seismic_factor;
    shakes = law.kind == FrictionLaw::Kind::constant ? law.mean : law.max;
  }
  const Force weight = scene.rock.mass.density() * scene.domain.volume() * metres_per_second_squared(norm(gravity)) *
                       scene.stability->partial.weight();
  return (1 + shakes * norm(loads.body.seismic())) * weight;
}
}  // namespace

std::optional<Length> tunnel_in_rock(const Scene& scene) {
  const auto tunnel = std::ranges::find_if(scene.excavations, [](const auto& e) { return !e.axis.empty(); });
  if (tunnel == scene.excavations.end()) return std::nullopt;
  const auto taken = excavated(scene);
  const auto number = static_cast<std::size_t>(tunnel - scene.excavations.begin());
  const double outside = taken ? taken->openings[number].outside_share.value_or(0) : 0;
  return metres(stochastic::length_of(tunnel->axis) * (1 - outside));
}

stochastic::EnsembleOptions ensemble_options_of(const Scene& scene) {
  const stochastic::Questions questions = questions_of(scene);
  stochastic::EnsembleOptions options{.stability = scene.stability.has_value(),
                                      .whole_system = questions.whole,
                                      .confidence = scene.monte_carlo ? scene.monte_carlo->confidence : 0.95,
                                      .volumes_m3 = questions.volumes_m3,
                                      .tunnel_length_m = {},
                                      .rock = scene.domain.volume(),
                                      .chainage_parts = questions.chainage_parts,
                                      .seed = scene.seed,
                                      .support = scene.support.has_value(),
                                      .stages = scene.support && scene.sequence,
                                      .groups = questions.groups,
                                      .clamped = questions.clamped,
                                      .at_parts = scene.stability.has_value() && has_own_opening(scene),
                                      .openings = !scene.excavations.empty(),
                                      .orders = orders_of(scene).size(),
                                      .lifts = scene.stability && scene.stability->loads.lifts(),
                                      .strengths_per_geometry = strengths_per_geometry(scene)};
  options.at_target = scene.stability && targets_under(scene, nullptr);
  options.turning = scene.stability && scene.stability->rotation != stability::RotationCheck::off;
  if (!questions.axis.empty()) options.tunnel_length_m = stochastic::length_of(questions.axis);
  for (const auto& [name, p] : Percentiles::levels) options.size_levels.push_back(p);
  if (scene.stability) {
    options.pull = pull_of(scene, scene.stability->loads);
    for (const LoadCase& load : scene.stability->cases) {
      options.cases.push_back(load.name);
      options.cases_lift.push_back(load.loads.lifts());
      options.cases_pull.push_back(pull_of(scene, load.loads));
    }
  }
  for (const NamedSet& set : scene.sets) options.sets.push_back(set.name);
  for (const ScanLine& line : scene.lines) options.lines.push_back(line.name);
  if (scene.flow) {
    options.flow = true;
    options.water = scene.flow->flows();
    options.sides.assign(scene.domain.tags().begin(), scene.domain.tags().end());
  }
  options.undisturbed = questions.undisturbed.has_value();
  if (scene.monte_carlo && scene.monte_carlo->stop) options.running_quantity = scene.monte_carlo->stop->quantity;
  if (!options.stability && stochastic::quantity_named(options.running_quantity)->stability) {
    options.running_quantity = "block_count";
  }
  return options;
}

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
  return !part || has_own_opening(scene) ? part : stochastic::Part::faces;
}

/// By Part; empty where there are only cuts from above.
std::vector<stochastic::PartTally> tally_parts(const Scene& scene, const topology::BlockComplex& complex,
                                               const stability::Analysis& analysis) {
  if (!has_own_opening(scene)) return {};
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

std::vector<Record> make_records(const Scene& scene, const Shared& shared, std::uint64_t first, std::uint64_t count) {
  StageTimer timer;
  return make_records(scene, shared, first, count, timer);
}

std::vector<Record> make_records(const Scene& scene, const Shared& shared, std::uint64_t first, std::uint64_t count,
                                 StageTimer& timer) {
  std::vector<Record> records;
  realize(scene, shared.fields, first, count, timer, [&](std::uint64_t k, const Realization* made) {
    if (made != nullptr) {
      records.push_back(record_of(k, *made, scene, shared));
    } else {
      records.emplace_back().realization = k;
      records.back().outcome = Outcome::refused;
    }
  });
  return records;
}

Record make_record(const Scene& scene, const Shared& shared, std::uint64_t k) {
  return make_records(scene, shared, k, 1).front();
}

std::uint64_t strengths_per_geometry(const Scene& scene) noexcept {
  return scene.monte_carlo ? scene.monte_carlo->strengths_per_geometry : 1;
}

namespace {

/// Where a run may stop: only there figures are looked at, so that they depend on no order of work.
std::vector<std::uint64_t> looks_of(const MonteCarloSettings& settings) {
  if (!settings.stop) return {settings.realizations};
  // The sample unit is the geometry.
  const std::uint64_t group = settings.strengths_per_geometry;
  auto looks = stochastic::looks(settings.stop->max / group);
  for (std::uint64_t& look : looks) look *= group;
  return looks;
}

/// What the stages of the threads' realizations took in all.
class Spent final {
 public:
  void add(const StageTimer& timer) {
    const std::scoped_lock lock{mutex_};
    for (const cleave::StageCost& row : timer.stages()) seconds_[row.stage] += row.wall_s;
  }
  [[nodiscard]] std::vector<StepSeconds> in_order(const Plan& plan) const {
    std::vector<StepSeconds> out;
    for (const PlannedStep& planned : plan.steps) {
      const auto it = seconds_.find(name_of(planned.step));
      if (it != seconds_.end()) out.push_back({it->first, it->second});
    }
    return out;
  }

 private:
  std::mutex mutex_;
  std::map<std::string, double, std::less<>> seconds_;
};

StoppedBy reason(const MonteCarloSettings& settings, const Ensemble& ensemble) {
  if (!settings.stop) return StoppedBy::realizations;
  return narrow_enough(ensemble.moments(settings.stop->quantity), *settings.stop) ? StoppedBy::precision
                                                                                  : StoppedBy::max;
}

std::optional<StopFigures> stop_figures(const MonteCarloSettings& settings, const Ensemble& ensemble) {
  if (!settings.stop) return std::nullopt;
  StopFigures figures{.asked = *settings.stop};
  const stochastic::Moments& seen = ensemble.moments(settings.stop->quantity);
  if (seen.count() < 2) return figures;
  figures.half_width = half_width(seen, *settings.stop);
  if (seen.mean() != 0) figures.relative_half_width = *figures.half_width / std::abs(seen.mean());
  return figures;
}

}  // namespace

namespace {
/// With nothing added yet.
Ensemble empty_ensemble(const Scene& scene) {
  stochastic::EnsembleOptions options = ensemble_options_of(scene);
  options.tunnel_in_rock = tunnel_in_rock(scene);
  return Ensemble{std::move(options)};
}
}  // namespace

std::expected<MonteCarloResult, RecordFileError> run_monte_carlo(const Scene& scene, unsigned threads,
                                                                 const std::filesystem::path& path,
                                                                 const stochastic::Shard& shard,
                                                                 const MonteCarloWatch& watch) {
  const Shared shared = shared_by_realizations(scene, threads);
  const ThreadLimit limit{threads};
  const std::uint64_t group = strengths_per_geometry(scene);
  Spent spent;
  const auto booked = [&](std::uint64_t first, std::uint64_t count) {
    StageTimer timer;
    std::vector<Record> records = make_records(scene, shared, first, count, timer);
    spent.add(timer);
    return records;
  };
  const MakeRecords make = [&](std::uint64_t first, std::uint64_t end, std::uint64_t step, const auto& commit) {
    // An interrupted run may have stopped inside a geometry.
    const auto first_of = [&](std::uint64_t geometry) { return std::max(first, geometry * group); };
    stochastic::run_ordered(
        first / group, (end + group - 1) / group, step, limit, 64 * limit.count(),
        [&](std::uint64_t geometry) -> std::function<bool()> {
          const std::uint64_t k = first_of(geometry), count = std::min(end, (geometry + 1) * group) - k;
          return [&commit, records = booked(k, count)] {
            return std::ranges::all_of(records, [&](const Record& record) { return commit(record); });
          };
        });
  };
  CLEAVE_TRY(MonteCarloResult result, run_monte_carlo(scene, make, path, shard, watch));
  result.stages = spent.in_order(make_plan(scene));
  return result;
}

std::expected<MonteCarloResult, RecordFileError> run_monte_carlo(const Scene& scene, const MakeRecords& make,
                                                                 const std::filesystem::path& path,
                                                                 const stochastic::Shard& shard,
                                                                 const MonteCarloWatch& watch) {
  const MonteCarloSettings& settings = *scene.monte_carlo;
  CLEAVE_TRY(RecordFile file,
             RecordFile::open(path, {.scene_sha256 = scene_and_files_sha256(scene),
                                     .seed = scene.seed,
                                     .shard = {shard.number, shard.of, strengths_per_geometry(scene)}}));
  if (watch.found) watch.found(file.records());
  Ensemble ensemble = empty_ensemble(scene);
  // Records of an earlier call come first; they may reach beyond the look at which the run stops.
  std::uint64_t seen = 0;
  const auto take_until = [&](std::uint64_t end) -> std::expected<void, RecordFileError> {
    std::uint64_t number = 0;
    const auto read = stochastic::read_records(path, [&](const Record& record, std::string_view line) {
      if (record.realization >= end) return false;
      if (number++ >= seen) {
        ensemble.add(record, line);
        ++seen;
      }
      return true;
    });
    if (!read) return std::unexpected(read.error());
    return {};
  };
  std::optional<RecordFileError> failed;
  for (const std::uint64_t end : looks_of(settings)) {
    const std::uint64_t first = file.next_realization();
    if (seen < file.records()) CLEAVE_CHECK(take_until(end));
    make(first, end, shard.of, [&](const Record& record) {
      if (auto written = file.append(record); !written) {
        failed = std::move(written).error();
        return false;
      }
      ensemble.add(record, line_of(record));
      ++seen;
      if (watch.progress) watch.progress(ensemble, seen, (end + shard.of - 1) / shard.of);
      return true;
    });
    if (failed) return std::unexpected(*std::move(failed));
    if (settings.stop && reason(settings, ensemble) == StoppedBy::precision) break;
  }
  CLEAVE_CHECK(file.flush_to_disk());
  return MonteCarloResult{.figures = ensemble.figures(),
                          .stopped_by = reason(settings, ensemble),
                          .shard = shard,
                          .stop = stop_figures(settings, ensemble)};
}

std::expected<MonteCarloResult, RecordFileError> figures_of_records(const Scene& scene,
                                                                    const std::filesystem::path& path) {
  Ensemble ensemble = empty_ensemble(scene);
  const auto read = stochastic::read_records(path, [&](const Record& record, std::string_view line) {
    ensemble.add(record, line);
    return true;
  });
  if (!read) return std::unexpected(read.error());
  return MonteCarloResult{.figures = ensemble.figures(),
                          .stopped_by = reason(*scene.monte_carlo, ensemble),
                          .shard = {},
                          .stop = stop_figures(*scene.monte_carlo, ensemble)};
}

}  // namespace cleave::scene
