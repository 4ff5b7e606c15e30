#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cleave/stochastic/record.hpp"
#include "exit_code.hpp"

/// The commands of the program; each prints what it has to say and returns how the program ends.
namespace cleave::cli {

struct RunArguments {
  std::string scene;
  std::string out;
  unsigned threads = 1;
  std::optional<std::uint64_t> seed;
  bool quiet = false;
  stochastic::Shard shard;
  bool sharded = false;         ///< --shard was given
  std::string scene_text = {};  ///< what the scene file held as the run began; kept beside the result
  std::optional<double> memory_mb = std::nullopt;  ///< of the machine; what needs more is refused
  std::string resume = {};                         ///< --resume: a contact.state or motion.state, or its folder
};
[[nodiscard]] ExitCode run_scene(RunArguments arguments);

/// Merges the finished shards of one Monte Carlo run.
[[nodiscard]] ExitCode merge_results(const std::vector<std::string>& folders, const std::string& out, bool quiet);
struct ReplayArguments {
  std::string result;
  std::uint64_t realization = 0;
  std::optional<std::string> out;  ///< else RESULT/realization_K
  /// Lets key blocks go, for so many seconds; 0: as the scene's [motion] says, or its defaults.
  std::optional<double> motion = {};
  unsigned threads = 1;
  bool quiet = false;
};
[[nodiscard]] ExitCode replay_realization(const ReplayArguments& arguments);
/// Field data to joint sets.
[[nodiscard]] ExitCode survey_data(const std::string& data, const std::string& out, bool quiet);
[[nodiscard]] ExitCode plan_scene(const std::string& scene);
[[nodiscard]] ExitCode check_scene(const std::string& scene);
[[nodiscard]] ExitCode init_scene(const std::string& kind);
/// "tunnel, slope, ...": what init_scene knows.
[[nodiscard]] std::string init_kinds();
/// Prints what differs between two finished results: scene, plan, counts, volumes, key blocks; not what they cost.
[[nodiscard]] ExitCode diff_results(const std::string& first, const std::string& second);
/// Paired differences of two Monte Carlo results with the same seed; to the file `out` too when it is not empty.
[[nodiscard]] ExitCode compare_results(const std::string& first, const std::string& second, const std::string& out);
[[nodiscard]] ExitCode convert_file(const std::string& in, const std::string& out, std::uint64_t realization);

/// ".obj" of "a/b.OBJ"; empty when there is none.
[[nodiscard]] std::string extension_of(const std::string& path);

/// "error: WHAT" on stderr.
void print_error(const std::string& what);
/// Prints to stdout; the program's end tells when that failed.
void print(const std::string& text);

}  // namespace cleave::cli
