#include <fmt/format.h>

#include <string_view>
#include <utility>
#include <vector>

#include "cleave/load/load.hpp"
#include "cleave/report/survey.hpp"
#include "cleave/report/survey_fields.hpp"
#include "cleave/report/write.hpp"
#include "commands.hpp"
#include "interrupt.hpp"
#include "problems.hpp"
#include "say.hpp"
#include "watched_folder.hpp"

namespace cleave::cli {
namespace {

/// A line of an estimate that stands, be there a value or none.
std::string interval(std::string_view text, survey::Estimate estimate) {
  estimate.value = estimate.value.value_or(0);
  return say(text, estimate);
}

std::string set_line(const survey::SetResult& set, double confidence) {
  const auto figures = group([&](auto& v) { survey::set_fields(v, set, confidence); });
  std::string text = say("set {name:<10} {joints} joints, {traces} traces in windows", figures);
  if (set.joints > 0 || set.orientation_stated) {
    text += say(", {dip:.1f}/{dip_direction:05.1f}, kappa {kappa:.3g}", figures);
  }
  if (set.p32 && set.p32->value) text += say(", P32 {value:.4g} [{low:.4g}, {high:.4g}] 1/m", *set.p32);
  if (set.size) {
    const std::string_view size = set.shape.shape == survey::JointShape::disc        ? ", diameter"
                                  : set.shape.shape == survey::JointShape::rectangle ? ", long side"
                                                                                     : ", long axis";
    text.append(size).append(say(" {mean:.3g} +- {std:.3g} m ({law})", *set.size));
  }
  return text + "\n";
}

std::string figures_of(const scene::SurveyScene& survey, const survey::SurveyResult& result) {
  std::string text = say("{title}\norientations {orientations}, {unassigned} of no set\n",
                         group([&](auto& v) { report::survey_fields(v, survey, result, {}); }));
  for (const survey::SetResult& set : result.sets) text += set_line(set, survey.input.confidence);
  for (const survey::WindowResult& window : result.windows) {
    text += say("window {name}: {traces} traces, ends inside 0/1/2: {ends_0}/{ends_1}/{ends_2}\n",
                group([&](auto& v) { survey::window_fields(v, window); }));
    for (const survey::Estimate& e : window.estimates) {
      text += !e.value      ? say("  {name:<20} not estimable: {note}\n", e)
              : !bounded(e) ? say("  {name:<20} {value:>10.5g} ({note})  {method}\n", e)
                            : say("  {name:<20} {value:>10.5g} [{low:.5g}, {high:.5g}]  {method}", e) +
                                  (e.note.empty() ? "\n" : say(" ({note})\n", e));
    }
  }
  for (const survey::LineResult& line : result.lines) {
    text += say("line {name}: ", line) + interval("{value:.4g} [{low:.4g}, {high:.4g}] 1/m, ", line.frequency) +
            say("RQD {rqd_measured:.1f}", line) + interval(" [{low:.1f}, {high:.1f}]\n", line.rqd);
  }
  return text;
}

}  // namespace

ExitCode survey_data(const std::string& data, const std::string& out, bool quiet) {
  InterruptWatch interrupts;
  const auto survey = scene::load_survey(data);
  if (!survey) return report_problems(survey.error());
  const survey::SurveyResult result = survey::analyse(survey->input);
  WatchedFolder watched{interrupts, [&] { return OutFolder::prepare(out); }};
  auto& folder = *watched;
  if (!folder) {
    print_error(folder.error().message);
    return folder.error().code;
  }
  const scene::SetsFile sets = sets_file(*survey, result);
  const std::string text = figures_of(*survey, result);
  std::vector<std::pair<std::string, std::string>> files = sets.files;
  files.emplace_back("sets.toml", sets.toml);
  const std::vector<scene::SimulatedTraceMaps> maps = simulated_trace_maps(*survey, result);
  files.emplace_back("report.html", report::survey_html(*survey, result, maps));
  files.emplace_back("log.txt", text);
  files.emplace_back("survey.json", report::survey_json(*survey, result, maps));
  for (const auto& [name, content] : files) {
    if (auto written = report::write_file(folder->folder() / name, content); !written) {
      print_error(describe(written.error()));
      return ExitCode::machine_failed;
    }
  }
  if (auto published = interrupts.guarded([&] { return folder->publish(); }); !published) {
    print_error(published.error().message);
    return published.error().code;
  }
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
