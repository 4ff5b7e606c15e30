#include "cleave/scene/monte_carlo.hpp"

#include <algorithm>
#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/core/parallel.hpp"
#include "cleave/core/sha256.hpp"
#include "cleave/scene/run.hpp"
#include "cleave/stochastic/ordered.hpp"

namespace cleave::scene {

using stochastic::Ensemble;
using stochastic::Outcome;
using stochastic::Record;
using stochastic::RecordFile;
using stochastic::RecordFileError;

std::string_view name_of(StoppedBy stopped) noexcept {
  switch (stopped) {
    case StoppedBy::count: return "realizations";
    case StoppedBy::precision: return "precision";
    case StoppedBy::max: return "max";
  }
  std::unreachable();
}

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
  questions.volumes_m3 = scene.monte_carlo->volumes;
  for (const Excavation& excavation : scene.excavations) {
    if (excavation.axis.empty()) continue;
    questions.axis = excavation.axis;
    questions.chainage_parts = scene.monte_carlo->chainage_parts;
    break;
  }
  return questions;
}

stochastic::EnsembleOptions ensemble_options_of(const Scene& scene) {
  const stochastic::Questions questions = questions_of(scene);
  stochastic::EnsembleOptions options{.stability = scene.stability.has_value(),
                                      .whole_system = !(scene.output.only_key_blocks && scene.stability),
                                      .confidence = scene.monte_carlo ? scene.monte_carlo->confidence : 0.95,
                                      .volumes_m3 = questions.volumes_m3,
                                      .tunnel_length_m = {},
                                      .chainage_parts = questions.chainage_parts,
                                      .seed = scene.seed};
  if (!questions.axis.empty()) options.tunnel_length_m = stochastic::length_of(questions.axis);
  if (scene.monte_carlo && scene.monte_carlo->stop) options.running_quantity = scene.monte_carlo->stop->quantity;
  return options;
}

Record make_record(const Scene& scene, const stochastic::Questions& questions, std::uint64_t k) {
  auto realized = realize(scene, k);
  Record record;
  if (!realized) {
    record.outcome = Outcome::refused;
  } else if (!realized->complex) {
    record.outcome = Outcome::certificate_failed;
  } else {
    record = stochastic::measure(realized->complex->complex(), realized->analysis ? &*realized->analysis : nullptr,
                                 questions);
    record.joints = realized->drawn.joints.size();
  }
  record.realization = k;
  return record;
}

namespace {

/// Where a run may stop: only there figures are looked at, so that they depend on no order of work.
std::vector<std::uint64_t> looks_of(const MonteCarloSettings& settings) {
  return settings.stop ? stochastic::looks(settings.stop->max) : std::vector{settings.realizations};
}

StoppedBy reason(const MonteCarloSettings& settings, const Ensemble& ensemble) {
  if (!settings.stop) return StoppedBy::count;
  return narrow_enough(ensemble.moments(settings.stop->quantity), *settings.stop) ? StoppedBy::precision
                                                                                  : StoppedBy::max;
}

}  // namespace

std::expected<MonteCarloResult, RecordFileError> run_monte_carlo(const Scene& scene, unsigned threads,
                                                                 const std::filesystem::path& path,
                                                                 const stochastic::Shard& shard,
                                                                 const std::string& version,
                                                                 const MonteCarloWatch& watch) {
  const stochastic::Questions questions = questions_of(scene);
  const ThreadLimit limit{threads};
  const MakeRecords make = [&](std::uint64_t first, std::uint64_t end, std::uint64_t step, const auto& commit) {
    stochastic::run_ordered(first, end, step, limit, 8 + 4 * limit.count(),
                            [&](std::uint64_t k) -> std::function<bool()> {
                              return [&commit, record = make_record(scene, questions, k)] { return commit(record); };
                            });
  };
  return run_monte_carlo(scene, make, path, shard, version, watch);
}

std::expected<MonteCarloResult, RecordFileError> run_monte_carlo(const Scene& scene, const MakeRecords& make,
                                                                 const std::filesystem::path& path,
                                                                 const stochastic::Shard& shard,
                                                                 const std::string& version,
                                                                 const MonteCarloWatch& watch) {
  const MonteCarloSettings& settings = *scene.monte_carlo;
  CLEAVE_TRY(RecordFile file, RecordFile::open(path, {.version = version,
                                                      .scene_sha256 = scene_and_files_sha256(scene),
                                                      .seed = scene.seed,
                                                      .shard = shard}));
  Ensemble ensemble{ensemble_options_of(scene)};
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
  return MonteCarloResult{ensemble.figures(), reason(settings, ensemble), shard};
}

std::expected<MonteCarloResult, RecordFileError> figures_of_records(const Scene& scene,
                                                                    const std::filesystem::path& path) {
  Ensemble ensemble{ensemble_options_of(scene)};
  const auto read = stochastic::read_records(path, [&](const Record& record, std::string_view line) {
    ensemble.add(record, line);
    return true;
  });
  if (!read) return std::unexpected(read.error());
  return MonteCarloResult{ensemble.figures(), reason(*scene.monte_carlo, ensemble), {}};
}

}  // namespace cleave::scene
