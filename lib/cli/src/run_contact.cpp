#include "run_contact.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <expected>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "cleave/load/load.hpp"
#include "cleave/report/contact.hpp"
#include "say.hpp"
#include "scene2d_run.hpp"

namespace cleave::cli {
namespace {

namespace fs = std::filesystem;

std::string figures_of(const scene::ContactResult& result) {
  const std::string end = !result.to_rest    ? fmt::format("to {:.6g} s", result.end_time)
                          : result.converged ? "to rest"
                                             : "without rest";
  const auto figures = group([&](auto& v) { scene::scene2d_fields(v, result); });
  const scene::ContactVerdict verdict = scene::verdict_of(result);
  std::string text = say("{steps} steps ", figures) + end +
                     say(", largest displacement {max_displacement_m:.6g} m, residual {residual:.1e}\n"
                         "verdict: {verdict}",
                         figures);
  if (verdict.since) {
    text += say(", first \"{moved_first}\", seen at {moved_since_s:.3g} s; in all ", figures) + counts_of(verdict);
  }
  text += '\n';
  text += result.error ? fmt::format("estimated error of the steps {:.1e}\n", *result.error)
                       : fmt::format("no estimate of the error of the steps: {}\n", result.no_estimate);
  for (std::size_t p = 0; p < result.points.size() && !result.history.empty(); ++p) {
    const bem::Vec2 u = result.history.back().points[p];
    text += fmt::format("{}: displacement ({:.6g}, {:.6g}) m\n", result.points[p].name, u.x, u.y);
  }
  return text;
}

/// The state that a run goes on from, or what is wrong with it.
using Found = std::expected<std::optional<scene::SavedRun>, std::vector<scene::Problem>>;

Found read_state(const fs::path& path) {
  auto bytes = scene::read_file(path);
  if (bytes) return scene::SavedRun{path.generic_string(), *std::move(bytes)};
  return std::unexpected(std::vector{scene::Problem{path.generic_string(), 1, "state", bytes.error().what,
                                                    "name a contact.state, or the folder of a result that holds one"}});
}

/// An interrupted run of the same scene in OUT goes on.
Found state_of_run(const RunArguments& arguments, const scene::ContactScene& scene) {
  std::error_code reason;
  if (!arguments.resume.empty()) {
    const fs::path from{arguments.resume};
    return read_state(fs::is_directory(from, reason) ? from / scene::contact_state_name : from);
  }
  const fs::path out{arguments.out};
  const auto text = scene::read_file(out / "summary.json");
  if (!text) return std::nullopt;
  const auto summary = nlohmann::json::parse(*text, nullptr, false);
  if (!summary.is_object() || summary.value("scene_sha256", "") != scene.sha256) return std::nullopt;
  const auto contact = summary.find("contact");
  if (contact == summary.end() || !contact->is_object()) return std::nullopt;
  if (!contact->value("reason", "").starts_with("interrupted at")) return std::nullopt;
  return read_state(out / scene::contact_state_name);
}

}  // namespace

ExitCode run_contact(const RunArguments& arguments, const scene::ContactScene& scene, StageTimer& timer,
                     Progress& progress, InterruptWatch& interrupts) {
  using Result = scene::ContactResult;
  auto from = state_of_run(arguments, scene);
  if (!from) return report_problems(from.error());
  interrupts.ask_first("stops after this step and writes what is done; interrupt again to leave without it");
  const scene::ContactRun how{.from = *std::move(from), .stop = [&] { return interrupts.asked(); }};
  return run_scene2d<Result>(
      arguments, timer, progress, interrupts,
      {.run = [&] { return scene::run(scene, arguments.threads, timer, progress, how); },
       .files = {.write = report::write_contact_files,
                 .page = report::write_contact_report,
                 .summary = report::write_contact_summary,
                 .log = {},
                 .figures = figures_of},
       .complaint =
           [&](const Result& result) {
             return "contact: " + result.stopped_why + "; the state reached is in the result" +
                    (scene.settings.solver == dbem::Method::cascade ? "" : "; try solver = \"cascade\"");
           },
       .stopped = [&](const Result& result) -> std::optional<ExitCode> {
         if (!result.interrupted) return std::nullopt;
         std::fputs(fmt::format("cleave: {}; what is done is in {}; the same command goes on from there\n",
                                result.stopped_why, arguments.out)
                        .c_str(),
                    stderr);
         return ExitCode::interrupted;
       }});
}

}  // namespace cleave::cli
