#pragma once

#include <fmt/format.h>

#include <expected>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>

#include "cleave/core/cost.hpp"
#include "cleave/core/progress.hpp"
#include "cleave/realize/run.hpp"
#include "cleave/report/write.hpp"
#include "commands.hpp"
#include "interrupt.hpp"
#include "watched_folder.hpp"

namespace cleave::cli {

/// Prepares the folder for a result, lets `work` fill and publish it, and leaves nothing behind when it did not.
template <class Work>
[[nodiscard]] ExitCode in_out_folder(const std::string& name, InterruptWatch& interrupts, const Work& work) {
  WatchedFolder out{interrupts, [&] { return OutFolder::prepare(name); }};
  if (!*out) {
    print_error(out->error().message);
    return out->error().code;
  }
  return work(**out);
}

/// The files of a result by the steps of its plan that write them.
template <class Result>
struct Files {
  using Written = std::expected<void, report::WriteError>;
  std::function<Written(Result&, const std::filesystem::path&)> write;          ///< Step::write
  std::function<Written(const Result&, const std::filesystem::path&)> page;     ///< Step::report
  std::function<Written(const Result&, const std::filesystem::path&)> summary;  ///< last, with what the others cost
  std::function<std::string(const Result&)> log;
  std::function<std::string(const Result&)> figures;  ///< for the terminal
  std::string scene_text = {};                        ///< kept as scene.toml; empty: none is
  /// The last line on the terminal, where something has to be the last that is read.
  std::function<std::string(const Result&)> last = {};
};

/// Writes what the plan of a result says, puts the folder in its place and prints the key figures; empty when all went
/// well.
template <class Result>
[[nodiscard]] std::optional<ExitCode> publish(Result& result, const Files<Result>& files, OutFolder& out,
                                              StageTimer& timer, Progress& progress, InterruptWatch& interrupts,
                                              bool quiet) {
  typename Files<Result>::Written written;
  const auto make = [&](scene::Step step, const auto& write) {
    if (!written || !result.plan.runs(step)) return;
    progress.begin(name_of(step));
    written = timer.run(name_of(step), [&] { return write(result, out.folder()); });
    result.cost = scene::cost_of(timer, result.cost.threads);
  };
  make(scene::Step::write, files.write);
  make(scene::Step::report, files.page);
  progress.end();
  if (written) written = report::write_file(out.folder() / "log.txt", files.log(result));
  if (written && !files.scene_text.empty()) {
    written = report::write_file(out.folder() / "scene.toml", files.scene_text);
  }
  if (written) written = files.summary(result, out.folder());
  if (!written) {
    print_error(out.by_final_name(describe(written.error())));
    return ExitCode::machine_failed;
  }
  if (auto published = interrupts.guarded([&] { return out.publish(); }); !published) {
    print_error(published.error().message);
    return published.error().code;
  }
  if (!quiet) {
    std::string text = files.figures(result);
    for (const std::string& note : result.notes) text += "note: " + note + "\n";
    text += fmt::format("result in {}\n", out.final_name().generic_string());
    print(text + (files.last ? files.last(result) : std::string{}));
  }
  return std::nullopt;
}

}  // namespace cleave::cli
