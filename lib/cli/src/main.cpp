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
  std::set_new_handler(on_no_memory);
  usual_end = std::set_terminate(on_terminate);
}

/// Under a limit of addresses the stack cannot grow later, and that would look like a crash.
[[gnu::noinline]] void take_stack() {
  constexpr std::size_t bytes = 1U << 20U;
  std::array<volatile char, bytes> stack;
  stack.front() = 0;
}

/// What the program itself needs is taken while it can still say that it is not there: before all that is constructed
/// ahead of main, which may find no memory as well.
[[gnu::constructor(101)]] void on_load() {
  watch_for_crashes();
  out_of_memory = true;  // the signal for a stack that cannot grow
  take_stack();
  reserve = std::malloc(reserved_bytes);
  if (reserve == nullptr) on_crash(SIGSEGV);
  out_of_memory = false;
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

/// What the command line asks for. Each command below adds itself: what it holds is kept by its own callback.
using Chosen = std::function<ExitCode()>;

/// For options that are a number of a draw: "-1" would be the largest one. Empty: it is one.
std::string whole_from_zero(const std::string& text) {
  if (seed_of(text)) return {};
  return "\"" + text + "\" is not a whole number from 0 to 9223372036854775807";
}

/// The limit in bytes; 0: none was given.
std::shared_ptr<std::uint64_t> add_memory(CLI::App* command) {
  const auto memory = std::make_shared<std::uint64_t>(0);
  command
      ->add_option("--memory", *memory,
                   "memory that it may take at most, as \"4 GB\"; a run that needs more ends with exit code 3")
      ->transform(CLI::AsSizeValue(true));
  command->parse_complete_callback([memory, command] {
    if (command->count("--memory") == 0) return;
    if (*memory < least_memory || *memory > most_memory) {
      throw CLI::ValidationError("--memory",
                                 "is not from 64 MB to 1000 TB: give a number with its unit, as in \"4 GB\"");
    }
    if (!limit_memory(*memory)) {
      throw CLI::ValidationError("--memory", "this system knows no such limit: leave it out");
    }
  });
  return memory;
}

ExitCode run_as_asked(RunArguments& run, const std::string& seed, const std::string& shard) {
  if (!seed.empty() && !(run.seed = seed_of(seed))) {
    print_error("cleave run: --seed: " + whole_from_zero(seed));
    return ExitCode::wrong_input;
  }
  if (shard.empty()) return run_scene(run);
  if (const auto part = shard_of(shard)) {
    run.shard = *part;
    run.sharded = true;
    return run_scene(run);
  }
  print_error("cleave run: --shard: \"" + shard + "\" is not K/N with K from 1 to N; write --shard 1/3");
  return ExitCode::wrong_input;
}

void add_run(CLI::App& app, Chosen& chosen) {
  struct Given {
    RunArguments run;
    std::string seed, shard;
  };
  const auto given = std::make_shared<Given>();
  RunArguments& run = given->run;
  run.threads = threads_of_machine();
  CLI::App* command = app.add_subcommand("run", "runs a scene");
  command->add_option("scene", run.scene, "the scene file (TOML)")->required();
  command->add_option("-o,--out", run.out, "folder for the result: new, empty, or a result of cleave (replaced)")
      ->required();
  command->add_option("--threads", run.threads, "threads to use; changes nothing but the time")
      ->check(CLI::Range(1, 1024));
  command->add_option("--seed", given->seed, "instead of the scene's seed");
  const auto memory = add_memory(command);
  command->add_flag("--quiet", run.quiet, "no progress and no figures, errors only");
  command->add_option("--resume", run.resume,
                      "contact.state or motion.state of an earlier run, or its result folder: goes on from there");
  command->add_option("--shard", given->shard,
                      "part K/N of a Monte Carlo run, K from 1; merge the parts with cleave merge");
  command->callback([&chosen, given, memory] {
    chosen = [given, memory] {
      if (*memory == 0) given->run.memory_mb = machine_memory_mb();
      return run_as_asked(given->run, given->seed, given->shard);
    };
  });
}

void add_merge(CLI::App& app, Chosen& chosen) {
  struct Given {
    std::vector<std::string> parts;
    std::string out;
    bool quiet = false;
  };
  const auto given = std::make_shared<Given>();
  CLI::App* command = app.add_subcommand("merge", "merges the parts of a Monte Carlo run (cleave run --shard K/N)");
  command->add_option("parts", given->parts, "folders of all parts")->required();
  command->add_option("-o,--out", given->out, "folder for the whole result")->required();
  command->add_flag("--quiet", given->quiet, "errors only");
  command->callback(
      [&chosen, given] { chosen = [given] { return merge_results(given->parts, given->out, given->quiet); }; });
}

void add_replay(CLI::App& app, Chosen& chosen) {
  const auto replay = std::make_shared<ReplayArguments>();
  replay->threads = threads_of_machine();
  CLI::App* command =
      app.add_subcommand("replay", "re-creates one realization of a Monte Carlo run exactly, as a full single run");
  command->add_option("result", replay->result, "folder of the Monte Carlo run")->required();
  command->add_option("--realization", replay->realization, "its number, from 0")->required()->check(whole_from_zero);
  command->add_option("-o,--out", replay->out, "folder for the result instead of RESULT/realization_K");
  command
      ->add_option_function<double>(
          "--motion", [replay](double seconds) { replay->motion = seconds; },
          "lets its key blocks go, for so many seconds; without a number as [motion] of the scene says, or 10 s")
      ->expected(0, 1)
      ->default_str("0")
      ->check(CLI::Range(0.0, 1e4));
  command->add_option("--threads", replay->threads, "threads to use")->check(CLI::Range(1, 1024));
  static_cast<void>(add_memory(command));
  command->add_flag("--quiet", replay->quiet, "no progress and no figures, errors only");
  command->callback([&chosen, replay] { chosen = [replay] { return replay_realization(*replay); }; });
}

void add_survey(CLI::App& app, Chosen& chosen) {
  struct Given {
    std::string data, out;
    bool quiet = false;
  };
  const auto given = std::make_shared<Given>();
  CLI::App* command = app.add_subcommand("survey", "field data to joint sets: sets.toml, survey.json, report.html");
  command->add_option("data", given->data, "the survey file (TOML)")->required();
  command->add_option("-o,--out", given->out, "folder for the result")->required();
  command->add_flag("--quiet", given->quiet, "errors only");
  command->callback(
      [&chosen, given] { chosen = [given] { return survey_data(given->data, given->out, given->quiet); }; });
}

/// A command of one argument.
void add_simple(CLI::App& app, Chosen& chosen, const char* name, const char* help, const char* argument,
                const std::string& meaning, ExitCode (*what)(const std::string&)) {
  const auto given = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand(name, help);
  command->add_option(argument, *given, meaning)->required();
  command->callback([&chosen, given, what] { chosen = [given, what] { return what(*given); }; });
}

void add_convert(CLI::App& app, Chosen& chosen) {
  struct Given {
    std::string in, out;
    std::uint64_t realization = 0;
  };
  const auto given = std::make_shared<Given>();
  CLI::App* command = app.add_subcommand("convert", "between file formats, by their endings");
  command
      ->add_option("in", given->in,
                   "result folder or file to read: .vtu .obj .stl .ply .dxf .ts .fab .dat .csv, or a scene: its joints")
      ->required();
  command
      ->add_option("out", given->out,
                   "file to write: .vtu .obj .ply .stl .3ddat .3dec .k .nmm3d .dda; joints also .fab .dat")
      ->required();
  command->add_option("--realization", given->realization, "of a scene: which draw of its joints, from 0")
      ->check(whole_from_zero);
  command->callback(
      [&chosen, given] { chosen = [given] { return convert_file(given->in, given->out, given->realization); }; });
}

void add_diff(CLI::App& app, Chosen& chosen) {
  const auto given = std::make_shared<std::array<std::string, 2>>();
  auto& [first, second] = *given;
  CLI::App* command =
      app.add_subcommand("diff", "what changed from one result to another: plan, counts, volumes, key blocks");
  command->add_option("out1", first, "folder of a finished run")->required();
  command->add_option("out2", second, "folder of another")->required();
  command->callback([&chosen, given] { chosen = [given] { return diff_results((*given)[0], (*given)[1]); }; });
}

/// `note`: printed first.
void add_compare(CLI::App* command, Chosen& chosen, const std::string& note) {
  struct Given {
    std::string first, second, out;
  };
  const auto given = std::make_shared<Given>();
  command->add_option("out1", given->first, "folder of a finished Monte Carlo run")->required();
  command->add_option("out2", given->second, "folder of another with the same seed")->required();
  command->add_option("-o,--out", given->out, "file for the figures (JSON)");
  command->callback([&chosen, given, note] {
    chosen = [given, note] {
      print(note);
      return compare_results(given->first, given->second, given->out);
    };
  });
}

ExitCode run_program(int argc, char** argv) {
  Chosen chosen;
  CLI::App app{"Cuts rock into blocks by its joints, exactly, and finds the blocks that will move.", "cleave"};
  app.set_version_flag("--version", "cleave " CLEAVE_VERSION);
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 done, 1 a bug in cleave, 2 the input is wrong, 3 the machine failed, 4 a check did not hold, 130 "
      "interrupted.");
  app.add_subcommand("help", "prints what --help does")->group("")->callback([&app, &chosen] {
    chosen = [&app] {
      print(app.get_formatter()->make_help(&app, app.get_name(), CLI::AppFormatMode::Normal));
      return ExitCode::done;
    };
  });
  add_run(app, chosen);
  add_merge(app, chosen);
  add_replay(app, chosen);
  add_survey(app, chosen);
  add_simple(app, chosen, "plan", "says what will run, what is left out and why; runs nothing", "scene",
             "the scene file (TOML)", &plan_scene);
  add_simple(app, chosen, "check", "all problems of a scene, each with file, line, key and remedy; runs nothing",
             "scene", "the scene file (TOML)", &check_scene);
  add_simple(app, chosen, "init", "prints a commented scene to start from", "kind", "one of: " + init_kinds(),
             &init_scene);
  add_convert(app, chosen);
  add_diff(app, chosen);
  add_compare(app.add_subcommand("compare-designs",
                                 "two designs by their Monte Carlo results, realization by realization on common "
                                 "random numbers"),
              chosen, "");
  add_compare(app.add_subcommand("compare", "old name of compare-designs")->group(""), chosen,
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
