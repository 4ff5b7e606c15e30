#include <signal.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>
#include <vector>

#include "cleave/core/version.hpp"
#include "commands.hpp"
#include "memory_limit.hpp"

namespace cleave::cli {
namespace {

constexpr std::string_view bug_text =
    "cleave: this is a bug in cleave, not in your scene; please report it with the scene and the lines above\n";
constexpr std::string_view memory_text =
    "error: memory: there is not enough of it; close other programs, raise the memory limit or make the scene "
    "smaller\n";

void write_raw(std::string_view text) {
  // Nothing sensible can be done when even stderr is gone.
  [[maybe_unused]] const auto ignored = ::write(STDERR_FILENO, text.data(), text.size());
}

std::atomic<bool> out_of_memory{false};
/// Given back when memory runs out: what takes a run apart needs a little of its own.
constexpr std::size_t reserved_bytes = 1U << 20U;
std::atomic<void*> reserve{nullptr};

/// Ends by a signal of our own making (a failed assertion, std::terminate) or a crash become the exit code for bugs,
/// unless it was memory that ran out where nothing may throw.
extern "C" void on_crash(int) {
  if (out_of_memory) {
    write_raw(memory_text);
    std::_Exit(static_cast<int>(ExitCode::machine_failed));
  }
  write_raw(bug_text);
  std::_Exit(static_cast<int>(ExitCode::bug));
}

void on_no_memory() {
  out_of_memory = true;
  std::free(reserve.exchange(nullptr));
  throw std::bad_alloc{};
}

std::terminate_handler usual_end = nullptr;
/// Some functions of the standard library let nothing out and end the program: memory is then the reason all the same.
void on_terminate() {
  if (out_of_memory) {
    write_raw(memory_text);
    std::_Exit(static_cast<int>(ExitCode::machine_failed));
  }
  if (usual_end != nullptr) usual_end();
  std::abort();
}

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define CLEAVE_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define CLEAVE_SANITIZED 1
#endif
#endif

void watch_for_crashes() {
#ifndef CLEAVE_SANITIZED  // a sanitizer tells more about a crash than we can
  // A stack of its own: when the stack has run out the handler could not run on it.
  static std::array<char, std::size_t{1} << 16U> handlers_stack;
  const stack_t stack{.ss_sp = handlers_stack.data(), .ss_flags = 0, .ss_size = handlers_stack.size()};
  ::sigaltstack(&stack, nullptr);
  struct sigaction action{};
  action.sa_handler = on_crash;
  action.sa_flags = SA_ONSTACK;
  for (const int number : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL}) ::sigaction(number, &action, nullptr);
#endif
  ::signal(SIGXFSZ, SIG_IGN);  // a file size limit is then a failed write like a full disk
  ::signal(SIGPIPE, SIG_IGN);  // and so is a reader that has gone: folders under work are still taken away
  reserve = std::malloc(reserved_bytes);
  std::set_new_handler(on_no_memory);
  usual_end = std::set_terminate(on_terminate);
}

unsigned threads_of_machine() { return std::max(1U, std::thread::hardware_concurrency()); }

/// "K/N" with 1 <= K <= N.
std::optional<stochastic::Shard> shard_of(const std::string& text) {
  stochastic::Shard shard;
  const char* const end = std::to_address(text.end());
  const auto [slash, bad] = std::from_chars(std::to_address(text.begin()), end, shard.number);
  if (bad != std::errc{} || slash == end || *slash != '/') return std::nullopt;
  const std::size_t after = static_cast<std::size_t>(slash - text.data()) + 1;
  const std::string rest = text.substr(after);
  const char* const stop = std::to_address(rest.end());
  const auto [last, wrong] = std::from_chars(std::to_address(rest.begin()), stop, shard.of);
  if (wrong != std::errc{} || last != stop || shard.number < 1 || shard.number > shard.of) return std::nullopt;
  return shard;
}

std::optional<std::uint64_t> seed_of(const std::string& text) {
  std::int64_t seed = 0;
  const char* const end = std::to_address(text.end());
  const auto [stop, bad] = std::from_chars(std::to_address(text.begin()), end, seed);
  if (bad != std::errc{} || stop != end || seed < 0) return std::nullopt;
  return static_cast<std::uint64_t>(seed);
}

ExitCode run_program(int argc, char** argv) {
  CLI::App app{"Cuts rock into blocks by its joints, exactly, and finds the blocks that will move.", "cleave"};
  app.set_version_flag("--version", "cleave " CLEAVE_VERSION);
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 done, 1 a bug in cleave, 2 the input is wrong, 3 the machine failed, 4 a check did not hold, 130 "
      "interrupted.");
  std::function<ExitCode()> chosen;

  std::uint64_t memory = 0;
  const auto takes_memory = [&memory](CLI::App* command) {
    command
        ->add_option("--memory", memory,
                     "memory that it may take at most, as \"4 GB\"; a run that needs more ends with exit code 3")
        ->transform(CLI::AsSizeValue(true));
    command->parse_complete_callback([&memory, command] {
      if (command->count("--memory") == 0) return;
      if (memory < least_memory || memory > most_memory) {
        throw CLI::ValidationError("--memory",
                                   "is not from 64 MB to 1000 TB: give a number with its unit, as in \"4 GB\"");
      }
      if (!limit_memory(memory)) {
        throw CLI::ValidationError("--memory", "this system knows no such limit: leave it out");
      }
    });
  };
  RunArguments run;
  run.threads = threads_of_machine();
  std::string shard;
  CLI::App* run_command = app.add_subcommand("run", "runs a scene");
  run_command->add_option("scene", run.scene, "the scene file (TOML)")->required();
  run_command->add_option("-o,--out", run.out, "folder for the result: new, empty, or a result of cleave (replaced)")
      ->required();
  run_command->add_option("--threads", run.threads, "threads to use; changes nothing but the time")
      ->check(CLI::Range(1, 1024));
  std::string seed;
  run_command->add_option("--seed", seed, "instead of the scene's seed");
  takes_memory(run_command);
  run_command->add_flag("--quiet", run.quiet, "no progress and no figures, errors only");
  run_command->add_option(
      "--resume", run.resume,
      "contact.state of an earlier run of bodies in contact, or its result folder: goes on from there");
  run_command->add_option("--shard", shard,
                          "part K/N of a Monte Carlo run, K from 1; merge the parts with cleave merge");
  run_command->callback([&] {
    chosen = [&] {
      if (!seed.empty() && !(run.seed = seed_of(seed))) {
        print_error("cleave run: --seed: \"" + seed + "\" is not a whole number from 0 to 9223372036854775807");
        return ExitCode::wrong_input;
      }
      if (memory == 0) run.memory_mb = machine_memory_mb();
      if (shard.empty()) return run_scene(run);
      if (const auto part = shard_of(shard)) {
        run.shard = *part;
        run.sharded = true;
        return run_scene(run);
      }
      print_error("cleave run: --shard: \"" + shard + "\" is not K/N with K from 1 to N; write --shard 1/3");
      return ExitCode::wrong_input;
    };
  });

  std::vector<std::string> parts;
  std::string merged;
  bool merge_quiet = false;
  CLI::App* merge = app.add_subcommand("merge", "merges the parts of a Monte Carlo run (cleave run --shard K/N)");
  merge->add_option("parts", parts, "folders of all parts")->required();
  merge->add_option("-o,--out", merged, "folder for the whole result")->required();
  merge->add_flag("--quiet", merge_quiet, "errors only");
  merge->callback([&] { chosen = [&] { return merge_results(parts, merged, merge_quiet); }; });

  ReplayArguments replay;
  replay.threads = threads_of_machine();
  CLI::App* replay_command =
      app.add_subcommand("replay", "re-creates one realization of a Monte Carlo run exactly, as a full single run");
  replay_command->add_option("result", replay.result, "folder of the Monte Carlo run")->required();
  replay_command->add_option("--realization", replay.realization, "its number, from 0")->required();
  replay_command->add_option("-o,--out", replay.out, "folder for the result instead of RESULT/realization_K");
  replay_command->add_option("--threads", replay.threads, "threads to use")->check(CLI::Range(1, 1024));
  takes_memory(replay_command);
  replay_command->add_flag("--quiet", replay.quiet, "no progress and no figures, errors only");
  replay_command->callback([&] { chosen = [&] { return replay_realization(replay); }; });

  std::string data, survey_out;
  bool survey_quiet = false;
  CLI::App* survey = app.add_subcommand("survey", "field data to joint sets: sets.toml, survey.json, report.html");
  survey->add_option("data", data, "the survey file (TOML)")->required();
  survey->add_option("-o,--out", survey_out, "folder for the result")->required();
  survey->add_flag("--quiet", survey_quiet, "errors only");
  survey->callback([&] { chosen = [&] { return survey_data(data, survey_out, survey_quiet); }; });

  std::string scene;
  CLI::App* plan = app.add_subcommand("plan", "says what will run, what is left out and why; runs nothing");
  plan->add_option("scene", scene, "the scene file (TOML)")->required();
  plan->callback([&] { chosen = [&] { return plan_scene(scene); }; });
  CLI::App* check =
      app.add_subcommand("check", "all problems of a scene, each with file, line, key and remedy; runs nothing");
  check->add_option("scene", scene, "the scene file (TOML)")->required();
  check->callback([&] { chosen = [&] { return check_scene(scene); }; });

  std::string kind;
  CLI::App* init = app.add_subcommand("init", "prints a commented scene to start from");
  init->add_option("kind", kind, "one of: " + init_kinds())->required();
  init->callback([&] { chosen = [&] { return init_scene(kind); }; });

  std::string in, out;
  CLI::App* convert = app.add_subcommand("convert", "between file formats, by their endings");
  convert
      ->add_option("in", in,
                   "result folder or file to read: .vtu .obj .stl .ply .dxf .ts .fab .dat .csv, or a scene: its joints")
      ->required();
  convert
      ->add_option("out", out, "file to write: .vtu .obj .ply .stl .3ddat .3dec .k .nmm3d .dda; joints also .fab .dat")
      ->required();
  std::uint64_t converted_realization = 0;
  convert->add_option("--realization", converted_realization, "of a scene: which draw of its joints, from 0");
  convert->callback([&] { chosen = [&] { return convert_file(in, out, converted_realization); }; });
  CLI::App* diff =
      app.add_subcommand("diff", "what changed from one result to another: plan, counts, volumes, key blocks");
  std::string first, second;
  diff->add_option("out1", first, "folder of a finished run")->required();
  diff->add_option("out2", second, "folder of another")->required();
  diff->callback([&] { chosen = [&] { return diff_results(first, second); }; });

  std::string compared;
  const auto compare_designs = [&](CLI::App* compare, const std::string& note) {
    compare->add_option("out1", first, "folder of a finished Monte Carlo run")->required();
    compare->add_option("out2", second, "folder of another with the same seed")->required();
    compare->add_option("-o,--out", compared, "file for the figures (JSON)");
    compare->callback([&, note] {
      chosen = [&, note] {
        print(note);
        return compare_results(first, second, compared);
      };
    });
  };
  compare_designs(app.add_subcommand("compare-designs",
                                     "two designs by their Monte Carlo results, realization by realization on common "
                                     "random numbers"),
                  "");
  compare_designs(app.add_subcommand("compare", "old name of compare-designs")->group(""),
                  "note: cleave compare is now cleave compare-designs; the old name goes with the next version\n");

  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked) {  // --help, --version
    return static_cast<ExitCode>(app.exit(asked));
  } catch (const CLI::RequiredError& error) {
    // A wrong option is why the right one is missing: it is named first.
    const std::vector<std::string> left = app.remaining(true);
    const auto option = std::ranges::find_if(left, [](const std::string& word) { return word.starts_with('-'); });
    print_error(std::string{"cleave: "} +
                (option != left.end() ? "The following argument was not expected: " + *option : error.what()) +
                "; see cleave --help");
    return ExitCode::wrong_input;
  } catch (const CLI::ParseError& error) {
    print_error(std::string{"cleave: "} + error.what() + "; see cleave --help");
    return ExitCode::wrong_input;
  }
  return chosen();
}

}  // namespace
}  // namespace cleave::cli

int main(int argc, char** argv) {
  using namespace cleave::cli;
  watch_for_crashes();
  ExitCode end = ExitCode::bug;
  try {
    end = run_program(argc, argv);
  } catch (const std::bad_alloc&) {
    write_raw(memory_text);
    end = ExitCode::machine_failed;
  } catch (const std::system_error& error) {  // no threads to be had, a file system that fails
    print_error(std::string{"machine: "} + error.what() + "; check limits, memory and disks, then try again");
    end = ExitCode::machine_failed;
  } catch (const std::exception& error) {
    print_error(error.what());
    write_raw(bug_text);
  }
  if (std::fflush(stdout) != 0 && end == ExitCode::done) {
    print_error("stdout: cannot be written; check the space left");
    end = ExitCode::machine_failed;
  }
  return static_cast<int>(end);
}
