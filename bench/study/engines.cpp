/// Study "engines": cleave beside Bullet, ODE and Siconos on cases whose answers are known, and at a thousand blocks in
/// contact. `error` is relative to the answer, costs are those of a simulated second, of the steps alone; `status` is
/// `refused` for engines that are not installed. Every engine is asked at several steps, in several of its ways.
///
/// Ends with 1 when cleave's best answer to a case is farther from the closed form than promised. Where another engine
/// is nearer or faster is said, and is no reason to fail.

#include "engines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine_cases.hpp"
#include "study.hpp"

namespace cleave::study {
namespace {

using namespace engines;

/// Below it all engines are right.
constexpr double rounding = 1e-9;

/// Ways of asking, without the step.
std::vector<Setting> ways_of(const std::string& engine, const Case& problem, bool quick) {
  const auto way = [](std::string words, int iterations = 0) {
    return Setting{.step = 0, .way = std::move(words), .iterations = iterations};
  };
  if (engine == "cleave") {
    if (problem.large) return {way("scene"), way("")};
    return {way(""), way("implicit")};
  }
  if (engine == "bullet") {
    if (quick) return {way("", 10)};
    if (problem.large) return {way("", 10), way("", 50), way("", 200)};
    return {way("", 10), way("", 100), way("", 1000), way("2dir", 100), way("nncg", 100), way("dantzig")};
  }
  if (engine == "ode") {
    if (quick) return {way("fdir", 20)};
    if (problem.large) return {way("fdir", 20), way("slip", 20), way("slip", 100)};
    return {way("exact"),     way("exact fdir"), way("exact slip"),     way("fdir", 20),
            way("fdir", 200), way("slip", 200),  way("fdir layer", 200)};
  }
  if (quick || problem.large) return {way("wide", 100)};
  if (problem.parts[0].scene.bodies.size() > 10) return {way("wide", 100), way("wide", 1000), way("afresh", 100)};
  return {way("afresh", 1000), way("wide", 1000), way("wide thin", 1000), way("wide implicit", 1000)};
}

bool worth_it(const std::string& engine, const Case& problem, const Setting& setting) {
  const double finest = problem.steps.back();
  if (engine == "siconos") {
    // Of Python: a few steps of a few settings.
    if (problem.large) return problem.name.starts_with("stacks") && setting.step == 0.02;
    const bool slow = setting.iterations > 100 || setting.way.contains("afresh");
    if (problem.parts[0].scene.bodies.size() > 10 && slow) return setting.step == 0.01;
    return setting.step == problem.steps[1] || setting.step == finest;
  }
  if (engine == "cleave" && problem.large) return setting.step > 0.005;
  if (engine != "cleave" && problem.large) return setting.step < 0.1;
  if (setting.way.contains("exact") && problem.parts[0].scene.bodies.size() > 10) return setting.step == 0.01;
  if (setting.way.contains("dantzig") && problem.parts[0].scene.bodies.size() > 10) return setting.step == 0.01;
  return true;
}

struct Point {
  double error = 0, cost = 0;  ///< s of processor time a simulated second
  std::string setting;
};
/// By case and measure, then by engine.
using Found = std::map<std::string, std::map<std::string, std::vector<Point>>>;

std::string words(const Setting& s) {
  std::string out = fmt::format("dt={:.4g}", s.step);
  if (s.iterations > 0) out += fmt::format(" it={}", s.iterations);
  if (!s.way.empty()) out += " " + s.way;
  return out;
}

struct Answer {
  std::vector<double> errors;
  double wall_s = 0, cpu_s = 0;
  std::string stopped;
};

Answer ask(Engine& engine, const Case& problem, const Setting& setting) {
  Answer out{.errors = std::vector<double>(problem.measures.size(), 0), .stopped = {}};
  double simulated = 0;
  for (const Part& part : problem.parts) {
    const Outcome outcome = engine.run(part.scene, setting, part.times);
    out.wall_s += outcome.wall_s;
    out.cpu_s += outcome.cpu_s;
    simulated += part.times.back();
    if (!outcome.stopped.empty()) {
      out.stopped = outcome.stopped;
      return out;
    }
    for (std::size_t m = 0; m < out.errors.size(); ++m) {
      const double error = part.errors[m](outcome);
      if (!(error <= out.errors[m])) out.errors[m] = error;
    }
  }
  out.wall_s /= simulated;
  out.cpu_s /= simulated;
  return out;
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

void run_case(Study& study, Engine& engine, const Case& problem, Found& found) {
  for (const Setting& way : ways_of(engine.name(), problem, study.quick())) {
    for (std::size_t k = 0; k < problem.steps.size(); ++k) {
      Setting setting = way;
      setting.step = problem.steps[k];
      if (study.quick() && !problem.large && k != 1 && k + 1 != problem.steps.size()) continue;
      if (study.quick() && problem.large && setting.step != 0.02) continue;
      if (!worth_it(engine.name(), problem, setting)) continue;
      Answer answer;
      std::vector<double> wall, cpu;
      double spent = 0;
      do {
        const auto start = std::chrono::steady_clock::now();
        answer = ask(engine, problem, setting);
        spent += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        wall.push_back(answer.wall_s);
        cpu.push_back(answer.cpu_s);
      } while (!study.quick() && wall.size() < 5 && spent < (problem.large ? 3 : 0.2));
      const Cost cost{.wall_s = median(wall), .cpu_s = median(cpu), .peak_mb = 0};
      for (std::size_t m = 0; m < problem.measures.size(); ++m) {
        const std::string name = problem.name + problem.measures[m];
        const bool good = answer.stopped.empty() && std::isfinite(answer.errors[m]);
        if (answer.stopped.empty() && engine.name() == "siconos" && problem.measures[m] == " reaction") continue;
        study.add({name, engine.name(), words(setting), good ? std::optional{answer.errors[m]} : std::nullopt, cost,
                   std::nullopt, good ? Status::converged : Status::stopped});
        if (good) found[name][engine.name()].push_back({answer.errors[m], cost.cpu_s, words(setting)});
      }
      if (!answer.stopped.empty()) fmt::print("  {}\n", answer.stopped);
    }
  }
}

/// The one with the least error; of those at rounding the fastest.
Point best_of(const std::vector<Point>& points) {
  return std::ranges::min(points, {}, [](const Point& p) { return std::pair{std::max(p.error, rounding), p.cost}; });
}

/// The time of the fastest with that error at most; none: nobody.
std::optional<Point> fastest(const std::vector<Point>& points, double error) {
  std::optional<Point> out;
  for (const Point& p : points) {
    if (p.error <= std::max(error, rounding) && (!out || p.cost < out->cost)) out = p;
  }
  return out;
}

/// Times of the fastest of cleave and of the others at one error.
std::string race(const std::string& problem, const std::map<std::string, std::vector<Point>>& by_engine) {
  std::string out;
  for (const double error : {1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-9}) {
    const auto own = fastest(by_engine.at("cleave"), error);
    std::optional<Point> other;
    for (const auto& [engine, points] : by_engine) {
      const auto here = engine == "cleave" ? std::nullopt : fastest(points, error);
      if (here && (!other || here->cost < other->cost)) {
        other = here;
        other->setting = engine + " " + here->setting;
      }
    }
    if (!own && !other) continue;
    out += fmt::format("{},{:g},{},{},{}\n", problem, error,
                       own ? fmt::format("{:.3g},{}", own->cost, own->setting) : "none,",
                       other ? fmt::format("{:.3g},{}", other->cost, other->setting) : "none,",
                       own && other ? fmt::format("{:.3g}", own->cost / other->cost) : "");
  }
  return out;
}

void conclude(Study& study, const std::vector<Case>& cases, const Found& found) {
  std::string table = "problem,engine,least error,setting,processor s a simulated s\n";
  std::string races = "problem,error at most,cleave s a s,setting,fastest other s a s,setting,ratio\n";
  for (const Case& problem : cases) {
    for (std::size_t m = 0; m < problem.measures.size(); ++m) {
      const std::string name = problem.name + problem.measures[m];
      const auto here = found.find(name);
      if (here == found.end() || !here->second.contains("cleave")) {
        study.broken(name + ": no answer of cleave");
        continue;
      }
      const Point own = best_of(here->second.at("cleave"));
      if (!(own.error <= problem.within[m])) {
        study.broken(fmt::format("{}: error {:.3g} of cleave, {:.3g} promised", name, own.error, problem.within[m]));
      }
      for (const auto& [engine, points] : here->second) {
        const Point p = best_of(points);
        table += fmt::format("{},{},{:.3g},{},{:.3g}\n", name, engine, p.error, p.setting, p.cost);
        if (engine != "cleave" && std::max(p.error, rounding) < std::max(own.error, rounding)) {
          fmt::print("{}: {} is nearer, {:.3g} ({}) against {:.3g} ({})\n", name, engine, p.error, p.setting, own.error,
                     own.setting);
        }
      }
      races += race(name, here->second);
    }
  }
  fmt::print("\n{}\n{}", table, races);
  study.text("least.csv", table);
  study.text("races.csv", races);
}

/// Of each engine the settings that no other of its settings beats.
void draw(Study& study, const Case& problem, const Found& found) {
  const auto here = found.find(problem.name);
  if (here == found.end()) return;
  Plot plot{.title = problem.name + ": error against time, best settings of each engine",
            .x_label = "processor time, s a simulated second",
            .y_label = "error, relative",
            .series = {}};
  for (auto [engine, points] : here->second) {
    std::ranges::sort(points, {}, &Point::cost);
    Series series{.name = engine, .points = {}, .line = true, .fit = false};
    double least = 1e300;
    for (const Point& p : points) {
      if (p.error >= least) continue;
      least = p.error;
      series.points.emplace_back(std::max(p.cost, 1e-7), std::max(p.error, 1e-16));
    }
    plot.series.push_back(std::move(series));
  }
  std::string file = problem.name;
  std::ranges::replace(file, ' ', '_');
  study.plot(file, plot);
}

void body(Study& study) {
  std::vector<Case> cases = small_cases();
  std::ranges::move(large_cases(study.quick() ? 40 : 1000), std::back_inserter(cases));
  const std::array<Engine*, 4> engines{&cleave_engine(), &bullet_engine(), &ode_engine(), &siconos_engine()};
  Found found;
  for (Engine* engine : engines) {
    if (engine->present()) continue;
    study.add({"all", engine->name(), "not installed", std::nullopt, {}, std::nullopt, Status::refused});
  }
  for (const Case& problem : cases) {
    for (Engine* engine : engines) {
      if (engine->present()) run_case(study, *engine, problem, found);
    }
    draw(study, problem, found);
  }
  conclude(study, cases, found);
}

}  // namespace
}  // namespace cleave::study

int main(int argc, char** argv) { return cleave::study::run("engines", argc, argv, cleave::study::body); }
