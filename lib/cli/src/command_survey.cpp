#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "cleave/geometry/orientation.hpp"
#include "cleave/load/load.hpp"
#include "cleave/report/survey.hpp"
#include "cleave/report/write.hpp"
#include "commands.hpp"
#include "interrupt.hpp"
#include "out_folder.hpp"
#include "problems.hpp"

namespace cleave::cli {
namespace {

std::string figures_of(const scene::SurveyScene& survey, const survey::SurveyResult& result) {
  std::string text = fmt::format("{}\norientations {}, {} of no set\n", survey.input.title,
                                 survey.input.orientations.size(), result.unassigned);
  for (const survey::SetResult& set : result.sets) {
    text += fmt::format("set {:<10} {} joints, {} traces", set.name, set.joints, set.traces);
    if (set.joints > 0 || set.orientation_stated) {
      const geometry::Attitude mean = geometry::attitude_of(set.orientation.mean);
      text += fmt::format(", {:.1f}/{:05.1f}, kappa {:.3g}", mean.dip.degrees(), mean.direction.degrees(),
                          set.orientation.kappa);
    }
    if (set.p32 && set.p32->value) {
      text += fmt::format(", P32 {:.4g} [{:.4g}, {:.4g}] 1/m", *set.p32->value, set.p32->low, set.p32->high);
    }
    if (set.size)
      text += fmt::format(", {} {:.3g} +- {:.3g} m ({})",
                          set.shape.shape == survey::JointShape::disc        ? "diameter"
                          : set.shape.shape == survey::JointShape::rectangle ? "long side"
                                                                             : "long axis",
                          set.size->mean, set.size->std, name_of(set.size->family));
    text += "\n";
  }
  for (const survey::WindowResult& window : result.windows) {
    text += fmt::format("window {}: {} traces, ends inside 0/1/2: {}/{}/{}\n", window.name, window.counts.traces(),
                        window.counts.n0, window.counts.n1, window.counts.n2);
    for (const survey::Estimate& e : window.estimates) {
      text += e.value
                  ? fmt::format("  {:<20} {:>10.5g} [{:.5g}, {:.5g}]  {}\n", e.name, *e.value, e.low, e.high, e.method)
                  : fmt::format("  {:<20} not estimable: {}\n", e.name, e.note);
    }
  }
  for (const survey::LineResult& line : result.lines) {
    text += fmt::format("line {}: {:.4g} [{:.4g}, {:.4g}] 1/m, RQD {:.1f} [{:.1f}, {:.1f}]\n", line.name,
                        line.frequency.value.value_or(0), line.frequency.low, line.frequency.high, line.rqd_measured,
                        line.rqd.low, line.rqd.high);
  }
  return text;
}

}  // namespace

ExitCode survey_data(const std::string& data, const std::string& out, bool quiet) {
  InterruptWatch interrupts;
  const auto survey = scene::load_survey(data);
  if (!survey) return report_problems(survey.error());
  const survey::SurveyResult result = survey::analyse(survey->input);
  auto folder = OutFolder::prepare(out);
  if (!folder) {
    print_error(folder.error().message);
    return folder.error().code;
  }
  interrupts.on_interrupt([&] { folder->discard(); });
  const scene::SetsFile sets = sets_file(*survey, result);
  const std::string text = figures_of(*survey, result);
  std::vector<std::pair<std::string, std::string>> files = sets.files;
  files.emplace_back("sets.toml", sets.toml);
  const std::vector<scene::SimulatedTraceMaps> maps = maps_beside(*survey, result);
  files.emplace_back("report.html", report::survey_html(*survey, result, maps));
  files.emplace_back("log.txt", text);
  files.emplace_back("survey.json", report::survey_json(*survey, result, maps));
  for (const auto& [name, content] : files) {
    if (auto written = report::write_file(folder->folder() / name, content); !written) {
      print_error(describe(written.error()));
      interrupts.guarded([&] { folder->discard(); });
      return ExitCode::machine_failed;
    }
  }
  if (auto published = interrupts.guarded([&] { return folder->publish(); }); !published) {
    print_error(published.error().message);
    interrupts.guarded([&] { folder->discard(); });
    return published.error().code;
  }
  interrupts.on_interrupt({});
  if (quiet) return ExitCode::done;
  print(text);
  for (const survey::SetResult& set : result.sets) {
    for (const std::string& note : set.notes) print("note: " + set.name + ": " + note + "\n");
  }
  for (const std::string& note : result.notes) print("note: " + note + "\n");
  for (const scene::Problem& note : survey->notes) print("note: " + describe(note) + "\n");
  print(fmt::format("result in {}\n", folder->final_name().generic_string()));
  return ExitCode::done;
}

}  // namespace cleave::cli
