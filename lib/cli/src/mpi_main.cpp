/// cleave_mpi SCENE.toml -o OUT [--seed S] [--quiet]: a Monte Carlo scene on many machines. Rank 0 hands out
/// realizations one by one, so no rank waits for another, and writes their records in order; all ranks work. The
/// result is the same, to the byte, as that of `cleave run`. The scene must lie under the same path on all machines.

#include <fmt/format.h>
#include <mpi.h>
#include <time.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <functional>
#include <future>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cleave/core/cost.hpp"
#include "cleave/core/progress.hpp"
#include "cleave/load/load.hpp"
#include "cleave/stochastic/dispatch.hpp"
#include "command_monte_carlo.hpp"
#include "problems.hpp"

namespace cleave::cli {
namespace {

using stochastic::Record;

constexpr int result_tag = 1, work_tag = 2;
constexpr int pieces_ahead = 2;  // at a rank, the one at work included
constexpr std::uint64_t no_more = ~std::uint64_t{0};

/// A spinning wait would take a core from a worker.
void pause() {
  constexpr timespec half_a_millisecond{.tv_sec = 0, .tv_nsec = 500'000};
  nanosleep(&half_a_millisecond, nullptr);
}
bool is_there(int tag, MPI_Status& status) {
  int there = 0;
  MPI_Iprobe(MPI_ANY_SOURCE, tag, MPI_COMM_WORLD, &there, &status);
  return there != 0;
}

double seconds() { return MPI_Wtime(); }

/// How long a rank had nothing to do.
struct Waiting {
  double waited = 0, whole = 0;
};

/// The records of a piece of work.
class Maker final {
 public:
  explicit Maker(const scene::Scene& scene)
      : scene_{&scene}, shared_{shared_by_realizations(scene)}, group_{strengths_per_geometry(scene)} {}
  [[nodiscard]] std::vector<Record> operator()(std::uint64_t first) const {
    return make_records(*scene_, shared_, first, (first / group_ + 1) * group_ - first);
  }

 private:
  const scene::Scene* scene_;
  scene::Shared shared_;
  std::uint64_t group_;
};

/// Asks for two pieces of work, then for one more with the records of each, so that there is always one at hand; ends
/// when all that was asked for is answered by "no more".
Waiting work(const scene::Scene& scene) {
  const Maker make{scene};
  Waiting waiting;
  const double begin = seconds();
  for (int i = 0; i < pieces_ahead; ++i) MPI_Send(nullptr, 0, MPI_CHAR, 0, result_tag, MPI_COMM_WORLD);
  for (int ended = 0; ended < pieces_ahead;) {
    MPI_Status status{};
    const double before = seconds();
    while (!is_there(work_tag, status)) pause();
    std::uint64_t first = 0;
    MPI_Recv(&first, 1, MPI_UINT64_T, 0, work_tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    if (first == no_more) {
      ++ended;
      continue;
    }
    waiting.waited += seconds() - before;
    std::string lines;
    for (const Record& record : make(first)) lines += line_of(record) + "\n";
    MPI_Send(lines.data(), static_cast<int>(lines.size()), MPI_CHAR, 0, result_tag, MPI_COMM_WORLD);
    waiting.whole = seconds() - begin;
  }
  return waiting;
}

/// Rank 0: hands out the work and does its share of it on a second thread, which never speaks to other ranks.
class Coordinator final {
 public:
  Coordinator(const scene::Scene& scene, int ranks)
      : ranks_{ranks}, make_{scene}, dispatch_{strengths_per_geometry(scene)}, begin_{seconds()} {
    for (int i = 0; i < pieces_ahead; ++i) dispatch_.ask(0);
  }

  void make(std::uint64_t first, std::uint64_t end, std::uint64_t step,
            const std::function<bool(const Record&)>& commit) {
    dispatch_.begin(first, end, step);
    while (!dispatch_.done()) {
      hand_out();
      bool something = false;
      MPI_Status status{};
      if (is_there(result_tag, status)) {
        something = true;
        std::vector<Record> records = receive(status);
        dispatch_.ask(status.MPI_SOURCE);
        if (!records.empty()) dispatch_.back(std::move(records), commit);
      }
      if (own_.valid() && own_.wait_for(std::chrono::seconds{0}) == std::future_status::ready) {
        something = true;
        dispatch_.ask(0);
        auto records = own_.get();
        own_done_ = seconds();
        start_own();
        dispatch_.back(std::move(records), commit);
      }
      if (!something) pause();
    }
  }

  /// Sends everybody home; those that have not asked yet do so first.
  void finish() {
    const auto others = [&] { return std::ranges::count_if(dispatch_.asking(), [](int rank) { return rank != 0; }); };
    while (others() < std::ptrdiff_t{ranks_ - 1} * pieces_ahead) {
      MPI_Status status{};
      while (!is_there(result_tag, status)) pause();
      static_cast<void>(receive(status));
      dispatch_.ask(status.MPI_SOURCE);
    }
    for (const int rank : dispatch_.asking()) {
      if (rank != 0) MPI_Send(&no_more, 1, MPI_UINT64_T, rank, work_tag, MPI_COMM_WORLD);
    }
  }

  [[nodiscard]] Waiting waiting() const { return {own_waited_, own_done_ - begin_}; }

 private:
  void hand_out() {
    while (const auto piece = dispatch_.next()) {
      if (piece->worker == 0) {
        queue_.push_back(piece->first);
        if (!own_.valid()) start_own();
      } else {
        MPI_Send(&piece->first, 1, MPI_UINT64_T, piece->worker, work_tag, MPI_COMM_WORLD);
      }
    }
  }
  void start_own() {
    if (queue_.empty()) return;
    const std::uint64_t first = queue_.front();
    queue_.pop_front();
    own_waited_ += seconds() - (own_done_ > 0 ? own_done_ : begin_);
    own_ = std::async(std::launch::async, [this, first] { return make_(first); });
  }
  static std::vector<Record> receive(const MPI_Status& status) {
    int size = 0;
    MPI_Get_count(&status, MPI_CHAR, &size);
    std::string lines(static_cast<std::size_t>(size), ' ');
    MPI_Recv(lines.data(), size, MPI_CHAR, status.MPI_SOURCE, result_tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    std::vector<Record> records;
    for (std::size_t at = 0; at < lines.size();) {
      const std::size_t end = lines.find('\n', at);
      if (auto record = stochastic::record_of(std::string_view{lines}.substr(at, end - at))) {
        records.push_back(*std::move(record));
      }
      at = end + 1;
    }
    return records;
  }

  int ranks_;
  Maker make_;
  stochastic::Dispatch dispatch_;
  std::deque<std::uint64_t> queue_;  // own work
  std::future<std::vector<Record>> own_;
  double begin_, own_done_ = 0, own_waited_ = 0;
};

/// On stderr: what share of its time each rank had nothing to do.
void say_waiting(const Waiting& mine, int rank, int ranks, bool quiet) {
  const double own[2] = {mine.waited, mine.whole};
  std::vector<double> all(2 * static_cast<std::size_t>(ranks));
  MPI_Gather(static_cast<const double*>(own), 2, MPI_DOUBLE, all.data(), 2, MPI_DOUBLE, 0, MPI_COMM_WORLD);
  if (rank != 0 || quiet) return;
  double longest = 0;
  for (int r = 0; r < ranks; ++r) longest = std::max(longest, all[2 * static_cast<std::size_t>(r) + 1]);
  std::string text = "ranks waited for work (share of the time):";
  for (int r = 0; r < ranks; ++r) {
    const double waited = all[2 * static_cast<std::size_t>(r)], whole = all[2 * static_cast<std::size_t>(r) + 1];
    // One that ended early waits for the last one, too.
    text += fmt::format(" {:.1f} %", longest > 0 ? 100 * (waited + longest - whole) / longest : 0.0);
  }
  std::fputs((text + "\n").c_str(), stderr);
}

ExitCode coordinate(const scene::Scene& scene, const RunArguments& arguments, int ranks) {
  Coordinator coordinator{scene, ranks};
  StageTimer timer;
  Progress progress{progress_style_of_stderr(arguments.quiet)};
  InterruptWatch interrupts;
  const scene::MakeRecords make = [&](std::uint64_t first, std::uint64_t end, std::uint64_t step, const auto& commit) {
    coordinator.make(first, end, step, commit);
  };
  const ExitCode end = run_monte_carlo_scene(scene, arguments, timer, progress, interrupts, &make);
  coordinator.finish();
  say_waiting(coordinator.waiting(), 0, ranks, arguments.quiet);
  return end;
}

ExitCode run(const RunArguments& arguments) {
  int rank = 0, ranks = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  auto scene = scene::load_blocks(arguments.scene);
  if (scene && arguments.seed) scene->seed = *arguments.seed;
  // All ranks must have read the same scene.
  std::string mine = scene ? scene_and_files_sha256(*scene) : std::string(64, '-');
  std::string first = mine;
  MPI_Bcast(first.data(), 64, MPI_CHAR, 0, MPI_COMM_WORLD);
  int same = scene && mine == first ? 1 : 0, all = 0;
  MPI_Allreduce(&same, &all, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
  if (all == 0) {
    if (!scene && rank == 0) return report_problems(scene.error());
    if (rank == 0) print_error(arguments.scene + ":1: scene: not the same on all machines; copy it to all of them");
    return ExitCode::wrong_input;
  }
  if (!scene->monte_carlo) {
    if (rank == 0) print_error(arguments.scene + ":1: monte_carlo: the scene has none; use cleave run");
    return ExitCode::wrong_input;
  }
  if (rank == 0) return coordinate(*scene, arguments, ranks);
  say_waiting(work(*scene), rank, ranks, arguments.quiet);
  return ExitCode::done;
}

}  // namespace
}  // namespace cleave::cli

int main(int argc, char** argv) {
  using namespace cleave::cli;
  int threads = MPI_THREAD_SINGLE;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &threads);
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
    if (end != 0) print_error(std::string{"cleave_mpi: "} + error.what());
  }
  MPI_Finalize();
  return end;
}
