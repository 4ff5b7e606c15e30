#include "result.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <sstream>
#include <system_error>
#include <utility>

#include "cleave/core/cost.hpp"
#include "cleave/core/expected.hpp"
#include "cleave/core/overloaded.hpp"
#include "cleave/core/progress.hpp"
#include "cleave/realize/monte_carlo.hpp"
#include "cleave/realize/run.hpp"
#include "cleave/report/bodies.hpp"
#include "cleave/report/contact.hpp"
#include "cleave/report/key_blocks.hpp"
#include "cleave/report/summary.hpp"

namespace cleave::python {
namespace {

namespace fs = std::filesystem;

/// A folder of its own that goes away again.
class Scratch final {
 public:
  static std::optional<Scratch> make() {
    std::error_code failed;
    const fs::path base = fs::temp_directory_path(failed);
    if (failed) return std::nullopt;
    std::random_device random;
    for (int attempt = 0; attempt < 100; ++attempt) {
      std::ostringstream name;
      name << "cleave-" << std::hex << random() << random();
      if (fs::create_directory(base / name.str(), failed)) return Scratch{base / name.str()};
      if (failed) return std::nullopt;
    }
    return std::nullopt;
  }
  Scratch(Scratch&& other) noexcept : path_{std::exchange(other.path_, {})} {}
  Scratch& operator=(Scratch&&) = delete;
  ~Scratch() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  [[nodiscard]] const fs::path& path() const noexcept { return path_; }

 private:
  explicit Scratch(fs::path path) : path_{std::move(path)} {}
  fs::path path_;
};

std::string whole(const fs::path& path) {
  std::ifstream file{path, std::ios::binary};
  return {std::istreambuf_iterator<char>{file}, {}};
}

std::expected<AnyResult, RunFailure> run_ensemble(const scene::Scene& scene, const RunSettings& settings,
                                                  StageTimer& timer, Progress& progress) {
  const auto scratch = Scratch::make();
  if (!scratch) return std::unexpected(RunFailure{std::string{"no folder for temporary files could be made"}});
  const fs::path file = scratch->path() / "realizations.csv";
  progress.begin("monte_carlo", scene.monte_carlo->realizations);
  std::uint64_t shown = 0;
  const scene::MonteCarloWatch watch{[&](const stochastic::Ensemble&, std::uint64_t done, std::uint64_t) {
    progress.advance(done - std::exchange(shown, done));
  }};
  auto result =
      timer.run("monte_carlo", [&] { return scene::run_monte_carlo(scene, settings.threads, file, {}, watch); });
  progress.end();
  if (!result) return std::unexpected(RunFailure{describe(result.error())});
  Ensemble ensemble{report::monte_carlo_page(scene, scene::cost_of(timer, settings.threads), *std::move(result)), {}};
  ensemble.records_csv = whole(file);
  return AnyResult{std::move(ensemble)};
}

template <class Result>
std::expected<AnyResult, RunFailure> either(std::expected<Result, std::vector<scene::Problem>> result) {
  if (!result) return std::unexpected(RunFailure{std::move(result).error()});
  return AnyResult{*std::move(result)};
}

}  // namespace

std::expected<AnyResult, RunFailure> run(scene::AnyScene scene, const RunSettings& settings, Progress& progress) {
  StageTimer timer;
  timer.run("read", [] {});
  if (settings.seed) std::visit([&](auto& loaded) { loaded.seed = *settings.seed; }, scene);
  return std::visit(
      overloaded{[&](const scene::Scene& of) {
                   return of.monte_carlo ? run_ensemble(of, settings, timer, progress)
                                         : either(scene::run(of, {.threads = settings.threads}, timer, progress));
                 },
                 [&](const auto& of) { return either(scene::run(of, settings.threads, timer, progress)); }},
      scene);
}

std::string_view kind_of(const AnyResult& result) noexcept {
  return std::visit(
      overloaded{[](const scene::RunResult&) { return "blocks"; }, [](const Ensemble&) { return "monte_carlo"; },
                 [](const scene::BodiesResult&) { return "elastic"; },
                 [](const scene::ContactResult&) { return "contact"; }},
      result);
}

std::string summary_of(const AnyResult& result) {
  return std::visit(overloaded{[](const Ensemble& e) { return report::monte_carlo_json(e.page); },
                               [](const auto& r) { return report::summary_json(r); }},
                    result);
}

std::vector<std::string> notes_of(const AnyResult& result) {
  return std::visit(overloaded{[](const Ensemble& e) { return e.page.notes; }, [](const auto& r) { return r.notes; }},
                    result);
}

std::string complaint_of(const AnyResult& result) {
  return std::visit(
      overloaded{[](const scene::RunResult& r) {
                   return r.complex ? std::string{}
                                    : "the block system did not pass its own check: " + describe(r.complex.error());
                 },
                 [](const Ensemble& e) {
                   const auto& f = e.page.result.figures;
                   if (f.failures > 0) return std::to_string(f.failures) + " realizations could not be done";
                   return e.page.result.stopped_by == scene::StoppedBy::max
                              ? std::string{"the stated precision is not reached"}
                              : std::string{};
                 },
                 [](const scene::BodiesResult& r) {
                   return r.converged ? std::string{} : std::string{"the solution did not converge"};
                 },
                 [](const scene::ContactResult& r) { return r.converged ? std::string{} : r.stopped_why; }},
      result);
}

namespace {

std::optional<std::string> text_of_run(const scene::RunResult& result, std::string_view name) {
  if (!result.complex) return std::nullopt;
  if (name == "key_blocks.csv" && result.analysis) {
    return report::key_blocks_csv(result.complex->complex(), result);
  }
  if (name == "bolts.csv" && result.support) return report::bolts_csv(result);
  if (name == "support_blocks.csv" && result.support) return report::support_blocks_csv(result);
  if (name == "load_cases.csv" && !result.load_cases.empty()) {
    return report::load_cases_csv(result.complex->complex(), result);
  }
  return std::nullopt;
}

std::optional<std::string> text_of_contact(const scene::ContactResult& result, std::string_view name) {
  if (name == "bodies.csv") return report::contact_bodies_csv(result);
  if (name == "points.csv") return report::contact_points_csv(result);
  if (name == "history.csv") return report::contact_history_csv(result);
  return std::nullopt;
}

}  // namespace

std::optional<std::string> text_of(const AnyResult& result, std::string_view name) {
  using Text = std::optional<std::string>;
  return std::visit(
      overloaded{[&](const scene::RunResult& r) -> Text { return text_of_run(r, name); },
                 [&](const Ensemble& e) -> Text { return name == "realizations.csv" ? Text{e.records_csv} : Text{}; },
                 [&](const scene::BodiesResult& r) -> Text {
                   return name == "points.csv" ? Text{report::bodies_points_csv(r)} : Text{};
                 },
                 [&](const scene::ContactResult& r) -> Text { return text_of_contact(r, name); }},
      result);
}

std::expected<void, report::WriteError> write(const AnyResult& result, const fs::path& folder) {
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) return std::unexpected(report::CannotCreate{folder, failed.message()});
  using Written = std::expected<void, report::WriteError>;
  return std::visit(
      overloaded{[&](const scene::RunResult& r) -> Written { return report::write_all(r, folder); },
                 [&](const Ensemble& e) -> Written {
                   CLEAVE_CHECK(report::write_file(folder / "realizations.csv", e.records_csv));
                   CLEAVE_CHECK(report::write_file(folder / "report.html", report::monte_carlo_html(e.page)));
                   return report::write_file(folder / "summary.json", report::monte_carlo_json(e.page));
                 },
                 [&](const scene::BodiesResult& r) -> Written {
                   CLEAVE_CHECK(report::write_bodies_files(r, folder));
                   if (r.output.report) CLEAVE_CHECK(report::write_bodies_report(r, folder));
                   return report::write_bodies_summary(r, folder);
                 },
                 [&](const scene::ContactResult& r) -> Written {
                   CLEAVE_CHECK(report::write_contact_files(r, folder));
                   if (r.output.report) CLEAVE_CHECK(report::write_contact_report(r, folder));
                   return report::write_contact_summary(r, folder);
                 }},
      result);
}

}  // namespace cleave::python
