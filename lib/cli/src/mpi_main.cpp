/// cleave_mpi SCENE.toml -o OUT [--seed S] [--quiet]: a Monte Carlo scene on many machines. Rank 0 hands out
/// realizations one by one, so no rank waits for another, and writes their records in order; the others work. The
/// result is the same, to the byte, as that of `cleave run`. The scene must lie under the same path on all machines.

#include <mpi.h>
#include <time.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cleave/core/cost.hpp"
#include "cleave/core/progress.hpp"
#include "cleave/scene/parse.hpp"
#include "command_monte_carlo.hpp"
#include "problems.hpp"

namespace cleave::cli {
namespace {

using stochastic::Record;

constexpr int result_tag = 1, work_tag = 2;
constexpr std::uint64_t no_more = ~std::uint64_t{0};

/// A spinning wait would take a core from a worker.
void wait_for(int tag, MPI_Status& status) {
  for (int there = 0; there == 0;) {
    MPI_Iprobe(MPI_ANY_SOURCE, tag, MPI_COMM_WORLD, &there, &status);
    constexpr timespec pause{.tv_sec = 0, .tv_nsec = 500'000};
    if (there == 0) nanosleep(&pause, nullptr);
  }
}

void send_work(int rank, std::uint64_t k) { MPI_Send(&k, 1, MPI_UINT64_T, rank, work_tag, MPI_COMM_WORLD); }

/// Asks for work with the line of the last record (at first an empty one) until told that there is no more.
void work(const scene::Scene& scene) {
  const auto questions = questions_of(scene);
  std::string line;
  for (;;) {
    MPI_Send(line.data(), static_cast<int>(line.size()), MPI_CHAR, 0, result_tag, MPI_COMM_WORLD);
    MPI_Status status{};
    wait_for(work_tag, status);
    std::uint64_t k = 0;
    MPI_Recv(&k, 1, MPI_UINT64_T, 0, work_tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    if (k == no_more) return;
    line = line_of(make_record(scene, questions, k));
  }
}

/// Rank 0's side: who is free, and what came too early to be written.
class Coordinator final {
 public:
  explicit Coordinator(int ranks) : ranks_{ranks} {}

  void make(std::uint64_t first, std::uint64_t end, std::uint64_t step,
            const std::function<bool(const Record&)>& commit) {
    std::uint64_t next = first, due = first;
    std::map<std::uint64_t, Record> early;
    bool stopped = false;
    std::size_t busy = 0;
    const auto hand_out = [&] {
      while (!free_.empty() && next < end && !stopped) {
        send_work(free_.back(), next);
        free_.pop_back();
        next += step;
        ++busy;
      }
    };
    hand_out();
    while ((due < end && !stopped) || busy > 0) {
      const auto record = take();
      if (record) {
        --busy;
        early.emplace(record->realization, *record);
      }
      hand_out();
      for (auto it = early.find(due); it != early.end() && !stopped; it = early.find(due)) {
        stopped = !commit(it->second);
        early.erase(it);
        due += step;
      }
    }
  }

  /// Sends everybody home; those that never asked yet do so first.
  void finish() {
    while (static_cast<int>(free_.size()) < ranks_ - 1) static_cast<void>(take());
    for (const int rank : free_) send_work(rank, no_more);
  }

 private:
  std::optional<Record> take() {
    MPI_Status status{};
    wait_for(result_tag, status);
    int size = 0;
    MPI_Get_count(&status, MPI_CHAR, &size);
    std::string line(static_cast<std::size_t>(size), ' ');
    MPI_Recv(line.data(), size, MPI_CHAR, status.MPI_SOURCE, result_tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    free_.push_back(status.MPI_SOURCE);
    return stochastic::record_of(line);
  }

  int ranks_;
  std::vector<int> free_;
};

ExitCode coordinate(const scene::Scene& scene, const RunArguments& arguments, int ranks) {
  Coordinator coordinator{ranks};
  StageTimer timer;
  Progress progress{progress_style_of_stderr(arguments.quiet)};
  InterruptWatch interrupts;
  const scene::MakeRecords make = [&](std::uint64_t first, std::uint64_t end, std::uint64_t step, const auto& commit) {
    coordinator.make(first, end, step, commit);
  };
  const ExitCode end = run_monte_carlo_scene(scene, arguments, timer, progress, interrupts, &make);
  coordinator.finish();
  return end;
}

ExitCode run(const RunArguments& arguments) {
  int rank = 0, ranks = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  auto scene = scene::load(arguments.scene);
  if (scene && arguments.seed) scene->seed = *arguments.seed;
  // All ranks must have read the same scene.
  std::string mine = scene ? scene_and_files_sha256(*scene) : std::string(64, '-');
  std::string first = mine;
  MPI_Bcast(first.data(), 64, MPI_CHAR, 0, MPI_COMM_WORLD);
  int same = scene && mine == first ? 1 : 0, all = 0;
  MPI_Allreduce(&same, &all, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
  if (all == 0) {
    if (!scene && rank == 0) return report_problems(scene.error());
    if (rank == 0) complain(arguments.scene + ":1: scene: not the same on all machines; copy it to all of them");
    return ExitCode::wrong_input;
  }
  if (ranks < 2 || !scene->monte_carlo) {
    if (rank == 0) {
      complain(ranks < 2 ? std::string{"cleave_mpi: one rank alone has nobody to give work to; mpirun -n 2 or more"}
                         : arguments.scene + ":1: monte_carlo: the scene has none; use cleave run");
    }
    return ExitCode::wrong_input;
  }
  if (rank == 0) return coordinate(*scene, arguments, ranks);
  work(*scene);
  return ExitCode::done;
}

}  // namespace
}  // namespace cleave::cli

int main(int argc, char** argv) {
  using namespace cleave::cli;
  MPI_Init(&argc, &argv);
  RunArguments arguments;
  std::int64_t seed = -1;
  CLI::App app{"Monte Carlo scenes of cleave on many machines.", "cleave_mpi"};
  app.add_option("scene", arguments.scene, "the scene file (TOML), under this path on all machines")->required();
  app.add_option("-o,--out", arguments.out, "folder for the result, written by rank 0")->required();
  app.add_option("--seed", seed, "instead of the scene's seed");
  app.add_flag("--quiet", arguments.quiet, "no progress and no figures, errors only");
  int end = 0;
  try {
    app.parse(argc, argv);
    if (seed >= 0) arguments.seed = static_cast<std::uint64_t>(seed);
    end = static_cast<int>(run(arguments));
  } catch (const CLI::ParseError& error) {
    end = error.get_exit_code() == 0 ? app.exit(error) : static_cast<int>(ExitCode::wrong_input);
    if (end != 0) complain(std::string{"cleave_mpi: "} + error.what());
  }
  MPI_Finalize();
  return end;
}
