#pragma once

#include <cstdint>
#include <expected>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "cleave/core/cost.hpp"
#include "cleave/realize/block_sizes.hpp"
#include "cleave/realize/run.hpp"
#include "cleave/realize/sequence.hpp"
#include "cleave/scene3d/scene.hpp"
#include "cleave/stability/support.hpp"
#include "cleave/stochastic/ensemble.hpp"
#include "cleave/stochastic/record.hpp"

namespace cleave::scene {

/// SHA-256 of the scene file and, in their order, of the files it names: what a Monte Carlo run belongs to.
[[nodiscard]] std::string scene_and_files_sha256(const Scene& scene);

/// What is counted in every realization of the scene. Chainage runs along the first tunnel.
[[nodiscard]] stochastic::Questions questions_of(const Scene& scene);
/// Without `tunnel_in_rock`, for which rock is cut.
[[nodiscard]] stochastic::EnsembleOptions ensemble_options_of(const Scene& scene);
/// What of the first tunnel removes rock, the same in every realization: the openings are cut alone. Empty: no tunnel.
[[nodiscard]] std::optional<Length> tunnel_in_rock(const Scene& scene);

/// Orders of the excavation stages that every realization is judged in: the scene's own first, then those to compare;
/// empty without [sequence].
[[nodiscard]] std::vector<std::vector<std::uint32_t>> orders_of(const Scene& scene);
/// How many realizations in a row share their joints; 1: each has its own.
[[nodiscard]] std::uint64_t strengths_per_geometry(const Scene& scene) noexcept;

/// What all realizations of a scene have in common.
struct Shared {
  stochastic::Questions questions = {};
  std::shared_ptr<const TunnelFields> fields = nullptr;
  std::vector<LineInRock> lines = {};
};
/// What is kept of realization `k` of the scene.
[[nodiscard]] stochastic::Record record_of(std::uint64_t k, const Realization& made, const Scene& scene,
                                           const Shared& shared);
[[nodiscard]] Shared shared_by_realizations(const Scene& scene, unsigned threads = 1);

/// Realizations `first` .. `first + count - 1`, all of one geometry, which is cut once.
[[nodiscard]] std::vector<stochastic::Record> make_records(const Scene& scene, const Shared& shared,
                                                           std::uint64_t first, std::uint64_t count);
/// The same, booked by stage.
[[nodiscard]] std::vector<stochastic::Record> make_records(const Scene& scene, const Shared& shared,
                                                           std::uint64_t first, std::uint64_t count, StageTimer& timer);

/// Realization `k`: draws, cuts, audits and judges on the calling thread. Whatever goes wrong is in the record.
/// Precondition: the scene has [monte_carlo].
[[nodiscard]] stochastic::Record make_record(const Scene& scene, const Shared& shared, std::uint64_t k);

enum class StoppedBy : std::uint8_t {
  realizations,  ///< their fixed number is done
  precision,     ///< the stated precision is reached
  max,           ///< the largest number is done and the precision is not reached
};

/// Seconds that the threads of this process spent in a stage, over all realizations it made.
struct StepSeconds {
  std::string stage;
  double seconds = 0;
};

/// What a run that may stop early went by when it ended.
struct StopFigures {
  stochastic::Stop asked;
  std::optional<double> half_width = {};           ///< the figure's unit; empty before two realizations
  std::optional<double> relative_half_width = {};  ///< of the mean; empty for a mean of 0
};

struct MonteCarloResult {
  stochastic::Figures figures;
  StoppedBy stopped_by = StoppedBy::realizations;
  stochastic::Shard shard;
  std::vector<StepSeconds> stages = {};  ///< in the order of the plan; empty where records were read alone
  std::optional<StopFigures> stop = {};
};

struct MonteCarloWatch {
  /// Called after each record, in order, with the number done and the number that is aimed at.
  std::function<void(const stochastic::Ensemble&, std::uint64_t done, std::uint64_t aim)> progress;
  /// Called once, before the first record is made, with the number that earlier calls have left.
  std::function<void(std::uint64_t records)> found = {};
};

/// Makes the records of the geometries of `first` (perhaps not from its first realization on), then every `step`-th
/// geometry's, up to realization `end`, and hands each to `commit` in this order; ends early when `commit` says false.
using MakeRecords = std::function<void(std::uint64_t first, std::uint64_t end, std::uint64_t step,
                                       const std::function<bool(const stochastic::Record&)>& commit)>;

/// Runs what is left of a scene's realizations (those of `shard`) and writes their records to `file`, then gives the
/// figures of all of them. The bytes of the file and the figures are the same for any number of threads or ranks and
/// any interruptions.
[[nodiscard]] std::expected<MonteCarloResult, stochastic::RecordFileError> run_monte_carlo(
    const Scene& scene, const MakeRecords& make, const std::filesystem::path& file, const stochastic::Shard& shard,
    const MonteCarloWatch& watch);
/// The same on threads of this process.
[[nodiscard]] std::expected<MonteCarloResult, stochastic::RecordFileError> run_monte_carlo(
    const Scene& scene, unsigned threads, const std::filesystem::path& file, const stochastic::Shard& shard,
    const MonteCarloWatch& watch);

/// Figures from records that are all there: of a merged file of all shards.
[[nodiscard]] std::expected<MonteCarloResult, stochastic::RecordFileError> figures_of_records(
    const Scene& scene, const std::filesystem::path& file);

}  // namespace cleave::scene
