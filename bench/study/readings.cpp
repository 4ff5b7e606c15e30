/// Study "readings": which reading of the text of Fu (2014) comes nearest to all that its sections 4.5.2, 4.5.3, 5.2.1,
/// 5.3 and 5.4 print. Problems are these sections (and `all`), methods the readings, the setting a figure; `error` is
/// |ln(printed/ours)|, `condition` our figure. Rows of `all`: `error` is what no reading explains (the spread that is
/// left between printed and ours, of logarithms), `condition` the logarithm of the likelihood. The best quarter of the
/// readings is run on with more realizations, and the best quarter of these; the table of the best one is printed last.

#include "readings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "cleave/realize/monte_carlo.hpp"
#include "cleave/scene3d/scene.hpp"
#include "study.hpp"

namespace cleave {
namespace {

using namespace readings;
using stochastic::Record;

scene::Scene parsed(const std::string& text) {
  auto scene = scene::parse(text, "study", [](const std::string&) {
    return std::expected<scene::LoadedFile, scene::FileRefusal>{std::unexpect, "no files here", ""};
  });
  if (scene) return *std::move(scene);
  for (const scene::Problem& problem : scene.error()) fmt::print(stderr, "{}\n", describe(problem));
  std::abort();
}

class Runs final {
 public:
  explicit Runs(study::Study& study) : study_{study} {}

  /// Realizations 0 to n - 1 of a section; what the section does not depend on is not run again.
  const std::vector<Record>& of(const Section& section, Reading reading, std::size_t n) {
    const std::vector<double> joints = of_section(section, reading, n);
    // A single printed realization tells little: more of ours would not help.
    if (section.realizations == 1) n = std::min<std::size_t>(n, 24);
    return records(section, reading, joints, n);
  }
  [[nodiscard]] const study::Cost& spent() const { return spent_; }
  /// The scene of a section in that reading, as n realizations have it.
  std::string scene_of(const Section& section, Reading reading, std::size_t n) {
    const std::vector<double> joints = of_section(section, reading, n);
    return scene_text(section, reading, joints);
  }

 private:
  /// What a section does not depend on is left out of `reading`; its numbers of joints, found where they are lost.
  std::vector<double> of_section(const Section& section, Reading& reading, std::size_t n) {
    if (!section.limited) reading.limits = Limits::redrawn;
    if (!section.joints.empty()) return section.joints;
    reading.density = true;
    return {joints_of(section, reading, std::min<std::size_t>(n, 24))};
  }

  const std::vector<Record>& records(const Section& section, const Reading& reading, const std::vector<double>& joints,
                                     std::size_t n) {
    const std::string text = scene_text(section, reading, joints);
    std::vector<Record>& made = made_[text];
    if (made.size() >= n) return made;
    const scene::Scene scene = parsed(text);
    const scene::Shared shared = shared_by_realizations(scene);
    const study::Cost cost = study_.measure(
        [&] {
          while (made.size() < n) made.push_back(make_record(scene, shared, made.size()));
        },
        0, 1);
    spent_.cpu_s += cost.cpu_s;
    spent_.wall_s += cost.wall_s;
    spent_.peak_mb = std::max(spent_.peak_mb, cost.peak_mb);
    return made;
  }

  /// So many joints a set (a whole number in the box) that the printed number of blocks comes out, on average of n.
  double joints_of(const Section& section, const Reading& reading, std::size_t n) {
    if (!section.figures.front().name.starts_with("blocks")) {
      // The same rock as in 4.5.2, in 100 x 100 x 60 m instead of 80 x 80 x 60 m.
      return joints_of(sections().front(), reading, n) * (100.0 * 100 / (80.0 * 80));
    }
    const auto key = std::tuple{std::string{section.name}, reading.label(), n};
    if (const auto known = joints_.find(key); known != joints_.end()) return known->second;
    const double target = section.figures.front().mean, volume = std::pow(reading.box, 3);
    const auto mean = [&](double total) {
      const auto& sample = records(section, reading, {total / volume}, n);
      double sum = 0;
      for (const Record& r : sample) sum += static_cast<double>(r.blocks);
      return std::max(sum / static_cast<double>(sample.size()), 1.0);
    };
    double low = std::round(section.start * volume / (1 + reading.extent)), of_low = mean(low);
    // The number of blocks goes with a power of the number of joints between one and three.
    for (int round = 0; round < (study_.quick() ? 1 : 6); ++round) {
      const double next = std::max(1.0, std::round(low * std::pow(target / of_low, 1 / 2.4)));
      if (next == low) break;
      const double of_next = mean(next);
      const bool nearer = std::abs(std::log(of_next / target)) < std::abs(std::log(of_low / target));
      if (!nearer) break;
      low = next;
      of_low = of_next;
    }
    return joints_[key] = low / volume;
  }

  study::Study& study_;
  study::Cost spent_;
  std::map<std::string, std::vector<Record>> made_;
  std::map<std::tuple<std::string, std::string, std::size_t>, double> joints_;
};

std::vector<Compared> all_figures(Runs& runs, const Reading& reading, std::size_t n) {
  std::vector<Compared> all;
  for (const Section& section : sections()) {
    for (Compared& figure : compare(section, runs.of(section, reading, n))) all.push_back(std::move(figure));
  }
  return all;
}

std::vector<Reading> every_reading(bool quick) {
  std::vector<Reading> all;
  if (quick) return {{1, 1, Limits::redrawn, true}, {1, 1.4, Limits::clamped, true}};
  for (const double extent : {1.0, 2.0}) {
    for (const double box : {1.0, 1.2, 1.4, 1.5, 1.6, 1.7, 1.8, 1.9, 2.0, 2.3}) {
      if (extent > 1 && box > 1.8) continue;  // many times the printed numbers of blocks
      for (const Limits limits : {Limits::redrawn, Limits::clamped, Limits::none, Limits::upper_alone}) {
        all.push_back({extent, box, limits, true});
        if (box > 1) all.push_back({extent, box, limits, false});
      }
    }
  }
  return all;
}

void study_readings(study::Study& study) {
  struct Judged {
    Reading reading;
    Likelihood likelihood;
    std::vector<Compared> figures;
  };
  Runs runs{study};
  std::vector<Judged> judged;
  const auto judge = [&](const Reading& reading, std::size_t n) {
    std::vector<Compared> figures = all_figures(runs, reading, n);
    const Likelihood l = likelihood(figures);
    study.add({.problem = "all",
               .method = reading.label(),
               .setting = fmt::format("n={}", n),
               .error = l.apart,
               .cost = runs.spent(),
               .condition = l.log});
    return Judged{reading, l, std::move(figures)};
  };
  // The worse three quarters of a round are left; the others are run on.
  const auto better = [](const Judged& a, const Judged& b) { return a.likelihood.log > b.likelihood.log; };
  const std::vector<std::size_t> rounds =
      study.quick() ? std::vector<std::size_t>{3, 4} : std::vector<std::size_t>{6, 24, 120};
  std::vector<Reading> left = every_reading(study.quick());
  for (const std::size_t n : rounds) {
    judged.clear();
    for (const Reading& reading : left) judged.push_back(judge(reading, n));
    std::ranges::sort(judged, better);
    left.clear();
    for (std::size_t i = 0; 4 * i < judged.size(); ++i) left.push_back(judged[i].reading);
  }
  for (const Judged& one : judged) {
    for (const Compared& f : one.figures) {
      study.add({.problem = f.section,
                 .method = one.reading.label(),
                 .setting = fmt::format("{} printed {:.4g} ours {:.4g} [{:.4g}; {:.4g}]", f.name, f.printed, f.ours,
                                        f.low, f.high),
                 .error = std::abs(f.difference),
                 .cost = {},
                 .condition = f.ours});
    }
  }
  for (const Section& section : sections()) {
    std::string file = fmt::format("{}.toml", section.name);
    std::ranges::replace(file, ' ', '-');
    study.text(file, runs.scene_of(section, judged.front().reading, rounds.back()));
  }
  fmt::print("\nreadings within 1.92 of the best log likelihood:\n");
  for (const Judged& one : judged) {
    if (one.likelihood.log < judged.front().likelihood.log - 1.92) continue;
    fmt::print("  {} ({:.2f} below, {:.2f} left over)\n", one.reading.label(),
               judged.front().likelihood.log - one.likelihood.log, one.likelihood.apart);
  }
  fmt::print("\n| section | figure | printed | ours [95 %] |\n|---|---|---|---|\n");
  for (const Compared& f : judged.front().figures) {
    fmt::print("| {} | {} | {:.4g} | {:.3g} [{:.3g}, {:.3g}] |\n", f.section, f.name, f.printed, f.ours, f.low, f.high);
  }
}

}  // namespace
}  // namespace cleave

int main(int argc, char** argv) { return cleave::study::run("readings", argc, argv, cleave::study_readings); }
