#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <utility>

#include "cleave/core/cost.hpp"
#include "cleave/core/fields.hpp"
#include "cleave/core/progress.hpp"
#include "cleave/core/version.hpp"
#include "cleave/realize/monte_carlo.hpp"
#include "cleave/realize/run.hpp"
#include "cleave/report/monte_carlo.hpp"
#include "cleave/report/monte_carlo_fields.hpp"
#include "cleave/report/write.hpp"
#include "command_monte_carlo.hpp"
#include "figures.hpp"
#include "monte_carlo_folder.hpp"
#include "problems.hpp"
#include "say.hpp"

namespace cleave::cli {
namespace {

namespace fs = std::filesystem;
using stochastic::Estimate;

std::string figures_text(const report::MonteCarloPage& page) {
  const stochastic::Figures& f = page.result.figures;
  std::string text = fmt::format("{}\nrealizations {} ({}), seed {}\n", page.title, f.realizations,
                                 enum_name(page.result.stopped_by), page.seed);
  if (const auto& stop = page.result.stop; stop && stop->relative_half_width) {
    text += fmt::format("half width   {} {:.3g} % of the mean by {}, {:.3g} % asked for\n", stop->asked.quantity,
                        100 * *stop->relative_half_width, enum_name(stop->asked.rule),
                        100 * stop->asked.relative_half_width);
  }
  for (const scene::ExcavationFigures& e : page.excavations) {
    text += say("excavated    {name}, {volume_m3:.6g} m3\n", e);
  }
  const auto line = [](const Estimate& e) {
    return fmt::format("  {:<44} ", e.name) +
           say(std::isfinite(e.high) ? "{mean:>12.5g} +- {standard_error:<10.3g} [{low:.5g}, {high:.5g}]\n"
                                     : "{mean:>12.5g} +- {standard_error:<10.3g} [{low:.5g}, not known]\n",
               group([&](auto& v) { mean_fields(v, e); }));
  };
  for (const Estimate& e : f.estimates) {
    if (!e.name.starts_with("share") && !e.name.starts_with("first_batch_share")) text += line(e);
  }
  for (const stochastic::CaseEstimates& under : f.cases) {
    text += fmt::format("load case     {}\n", under.name);
    for (const Estimate& e : under.estimates) text += line(e);
  }
  for (const auto& e : f.exceedances) {
    text += say("  P(key block above {volume_m3:g} m3){probability:>24.5g} [{low:.5g}, {high:.5g}]\n", e);
  }
  text += cost_line(page.cost);
  for (const scene::StepSeconds& row : page.result.stages) {
    text += say("  {stage:<10} {thread_s:.2f} s of threads\n", group([&](auto& v) { report::fields(v, row); }));
  }
  return text;
}

std::string log_text(const report::MonteCarloPage& page) {
  std::string text =
      fmt::format("cleave {}\nscene {} (sha256 {})\n\nplan\n", version, page.scene_file, page.scene_sha256);
  text += describe(page.plan);
  text += "\nresult\n" + figures_text(page);
  if (!page.notes.empty()) text += "\nnotes\n";
  for (const std::string& note : page.notes) text += "  " + note + "\n";
  return text;
}

ExitCode end_of(const scene::MonteCarloResult& result, const std::string& scene) {
  const stochastic::Figures& f = result.figures;
  if (f.failures > 0) {
    std::string list;
    for (std::size_t i = 0; i < std::min<std::size_t>(f.failed.size(), 10); ++i) {
      list += (list.empty() ? "" : ", ") + std::to_string(f.failed[i]);
    }
    print_error(
        fmt::format("{}:1: monte_carlo: {} realizations could not be done ({}{}); look at one with cleave replay",
                    scene, f.failures, list, f.failures > 10 ? ", ..." : ""));
    return ExitCode::check_failed;
  }
  if (result.stopped_by == scene::StoppedBy::max) {
    print_error(
        fmt::format("{}:1: monte_carlo.stop: the stated precision is not reached after {} realizations; raise max "
                    "or relative_half_width",
                    scene, f.realizations));
    return ExitCode::check_failed;
  }
  return ExitCode::done;
}

std::string running_text(const stochastic::Ensemble& ensemble, const std::string& quantity, double confidence) {
  const stochastic::Moments& m = ensemble.moments(quantity);
  if (m.count() < 2) return {};
  const auto t = stochastic::t_interval(m.mean(), m.standard_error(), m.count(), confidence);
  const double low = m.smallest() >= 0 ? std::max(0.0, t.low) : t.low;
  return fmt::format("{} {:.4g} [{:.4g}, {:.4g}]", quantity, m.mean(), low, t.high);
}

}  // namespace

ExitCode publish_monte_carlo(const scene::Scene& scene, scene::MonteCarloResult result, MonteCarloFolder& folder,
                             std::vector<MonteCarloFolder::File> copies, StageTimer& timer, unsigned threads,
                             bool quiet, InterruptWatch* interrupts) {
  auto page = report::monte_carlo_page(scene, scene::cost_of(timer, threads), std::move(result));
  std::vector<MonteCarloFolder::File> files;
  const auto write = [&](scene::Step step, const auto& make) {
    if (!page.plan.runs(step)) return;
    timer.run(name_of(step), [&] { files.push_back(make()); });
    page.cost = scene::cost_of(timer, threads);
  };
  write(scene::Step::write, [&]() -> MonteCarloFolder::File { return {"log.txt", log_text(page)}; });
  write(scene::Step::report,
        [&]() -> MonteCarloFolder::File { return {"report.html", report::monte_carlo_html(page)}; });
  if (std::string sizes = report::block_sizes_csv(page); scene.output.csv && !sizes.empty()) {
    files.push_back({"block_sizes.csv", std::move(sizes)});
  }
  std::ranges::move(copies, std::back_inserter(files));
  files.push_back({"summary.json", report::monte_carlo_json(page)});
  auto published =
      interrupts != nullptr ? interrupts->guarded([&] { return folder.publish(files); }) : folder.publish(files);
  if (!published) {
    print_error(published.error().message);
    return published.error().code;
  }
  if (!quiet) {
    std::string text = figures_text(page);
    for (const std::string& note : page.notes) text += "note: " + note + "\n";
    print(text + fmt::format("result in {}\n", folder.folder().generic_string()));
  }
  return end_of(page.result, scene.shown);
}

ExitCode run_monte_carlo_scene(const scene::Scene& scene, const RunArguments& arguments, StageTimer& timer,
                               Progress& progress, InterruptWatch& interrupts, const scene::MakeRecords* make) {
  const scene::MonteCarloSettings& settings = *scene.monte_carlo;
  const auto refuse = [&](std::string_view what, std::string_view remedy) {
    print_error(fmt::format("{}:1: --shard: {}; {}", arguments.scene, what, remedy));
    return ExitCode::wrong_input;
  };
  if (arguments.shard.of > 1 && settings.stop) {
    return refuse("monte_carlo.stop looks at all realizations, a shard has only its own",
                  "give monte_carlo.realizations instead of stop");
  }
  if (arguments.shard.of > settings.realizations / settings.strengths_per_geometry) {
    return refuse("there are fewer realizations than shards", "ask for fewer shards");
  }
  if (const auto taken = scene::excavated(scene); !taken) return report_problems(taken.error());
  auto copies = scene_copies(scene, arguments.scene);
  if (!copies) {
    print_error(copies.error().message);
    return copies.error().code;
  }
  const std::string header = header_of(stochastic::RunIdentity{
      .scene_sha256 = scene_and_files_sha256(scene), .seed = scene.seed, .shard = arguments.shard});
  auto folder = MonteCarloFolder::prepare(arguments.out, header);
  if (!folder) {
    print_error(folder.error().message);
    return folder.error().code;
  }
  std::atomic<std::uint64_t> kept{0};
  interrupts.on_interrupt(
      [&] {
        std::fputs(fmt::format("\ncleave: {} realizations are kept in {}; the same command goes on from there\n",
                               kept.load(), folder->folder().generic_string())
                       .c_str(),
                   stderr);
      },
      "interrupted");
  const std::string quantity = ensemble_options_of(scene).running_quantity;
  progress.begin("monte_carlo", settings.realizations / arguments.shard.of);
  std::uint64_t shown = 0;
  const scene::MonteCarloWatch watch{.progress =
                                         [&](const stochastic::Ensemble& ensemble, std::uint64_t done, std::uint64_t) {
                                           // Called after each record that is made: what came since the last one
                                           // besides it was there before.
                                           if (done - shown > 1) progress.found(done - shown - 1);
                                           progress.advance();
                                           shown = done;
                                           kept = done;
                                           progress.note(running_text(ensemble, quantity, settings.confidence));
                                         },
                                     .found = [&](std::uint64_t records) { kept = records; }};
  auto result = timer.run("monte_carlo", [&] {
    if (make != nullptr) {
      return scene::run_monte_carlo(scene, *make, folder->unfinished(), arguments.shard, watch);
    }
    return scene::run_monte_carlo(scene, arguments.threads, folder->unfinished(), arguments.shard, watch);
  });
  progress.end();
  if (!result) {
    print_error(fmt::format("{}:1: -o: {}", arguments.out, describe(result.error())));
    return std::holds_alternative<stochastic::SystemFailure>(result.error()) ? ExitCode::machine_failed
                                                                             : ExitCode::wrong_input;
  }
  const ExitCode end = publish_monte_carlo(scene, *std::move(result), *folder, *std::move(copies), timer,
                                           arguments.threads, arguments.quiet, &interrupts);
  interrupts.on_interrupt({});
  return end;
}

}  // namespace cleave::cli
