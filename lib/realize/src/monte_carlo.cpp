#include "cleave/realize/monte_carlo.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <mutex>
#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/core/parallel.hpp"
#include "cleave/core/sha256.hpp"
#include "cleave/realize/run.hpp"
#include "cleave/stochastic/ordered.hpp"

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

Shared shared_by_realizations(const Scene& scene, unsigned threads) {
  return {questions_of(scene), shared_fields(scene, threads), lines_in_rock(scene)};
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
