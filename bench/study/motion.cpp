/// Study "motion": one cold step of groups of blocks in three dimensions with contacts and friction, by the whole
/// cascade and without the second look for answers that move. `error` is the residual of the answer, `condition` the
/// largest over the smallest mass. Solved: accepted at 1e-8 without a cut. Ends with 1 when a promised share is not
/// kept. A second part runs a toppling prism whose angle is known, error against time.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "assemblies.hpp"
#include "cleave/motion/world.hpp"
#include "shapes.hpp"
#include "study.hpp"

namespace cleave {
namespace {

using namespace motion;
using namespace motion::shapes;
using Random = std::mt19937_64;

struct Problem {
  std::string family;
  double ratio = 1, friction = 0;
  SceneSpec scene;
  Vec3 gravity;
};

/// Of the generator's bits alone: the same numbers with every library.
double between(Random& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11U) * 0x1p-53;
}

BodySpec wall(Vec3 lo, Vec3 hi) { return {.shape = box(lo, hi), .fixed = true}; }
BodySpec stone(Polyhedron shape) { return {.shape = std::move(shape)}; }
Polyhedron upright(const std::vector<std::pair<double, double>>& xz) {
  Polyhedron out = moved(prism(xz, -0.25, 0.25), {}, turn_by({90 * degree, 0, 0}));
  if (mass_properties(out)) return out;
  for (Facet& f : out.facets) std::ranges::reverse(f.loops[0]);
  return out;
}

std::vector<BodySpec> stack(int count) {
  std::vector<BodySpec> out;
  for (int k = 0; k < count; ++k) out.push_back(stone(box({-0.5, -0.5, k + 0.0}, {0.5, 0.5, k + 1.0})));
  out.push_back(wall({-20, -20, -1}, {20, 20, 0}));
  return out;
}

std::vector<BodySpec> masonry(int rows, int columns) {
  std::vector<BodySpec> out;
  for (int row = 0; row < rows; ++row) {
    for (int k = 0; k < columns; ++k) {
      const double x = k + 0.5 * (row % 2);
      out.push_back(stone(box({x, 0, 0.5 * row}, {x + 1, 0.5, 0.5 * row + 0.5})));
    }
  }
  out.push_back(wall({-20, -20, -1}, {20, 20, 0}));
  return out;
}

std::vector<BodySpec> arch(int stones, double thickness) {
  std::vector<BodySpec> out;
  const double each = 180 * degree / stones;
  for (int k = -1; k <= stones; ++k) {
    const double a = -90 * degree + k * each, b = a + each, ri = 1 - thickness / 2, ro = 1 + thickness / 2;
    const auto at = [](double r, double angle) { return std::pair{r * std::sin(angle), r * std::cos(angle)}; };
    out.push_back(stone(upright({at(ri, a), at(ri, b), at(ro, b), at(ro, a)})));
    out.back().fixed = k < 0 || k == stones;
  }
  return out;
}

/// Blocks that hit what is below them.
std::vector<BodySpec> pile(int count, Random& random) {
  std::vector<BodySpec> out;
  for (int k = 0; k < count; ++k) {
    const double x = 1.1 * (k % 2), y = 1.1 * (k / 2 % 2), z = 0.9 * (k / 4);
    const double tilt = between(random, -0.2, 0.2);
    out.push_back(stone(moved(block(0.7, 0.7, 0.6), {x, y, z + 0.5}, turn_by({tilt, 0.5 * tilt, 3 * tilt}))));
    out.back().velocity = {between(random, -1, 1), between(random, -1, 1), -6};
  }
  out.push_back(wall({-20, -20, -1}, {20, 20, 0}));
  return out;
}

/// Between parallel walls, all gaps closed.
std::vector<BodySpec> shaft(int count) {
  std::vector<BodySpec> out;
  for (int k = 0; k < count; ++k) out.push_back(stone(box({k + 0.0, 0, 0}, {k + 1.0, 1, 1 + 0.25 * (k % 3)})));
  out.push_back(wall({-1, -2, -6}, {0, 3, 6}));
  out.push_back(wall({count + 0.0, -2, -6}, {count + 1.0, 3, 6}));
  out.push_back(wall({0, -1, -6}, {count + 0.0, 0, 6}));
  return out;
}

Problem problem_of(const std::string& family, int number) {
  Random random{static_cast<std::uint64_t>(number) * 7919U + family.size()};
  Problem out{.family = family, .ratio = 1, .friction = 0, .scene = {}, .gravity = {}};
  const int size = number % 5;
  if (family == "stack") out.scene.bodies = stack(std::vector{2, 5, 10, 30, 100}[static_cast<std::size_t>(size)]);
  if (family == "masonry") out.scene.bodies = masonry(2 + size, 3);
  if (family == "arch") out.scene.bodies = arch(5 + 3 * size, between(random, 0.08, 0.2));
  if (family == "pile") out.scene.bodies = pile(4 + 4 * size, random);
  if (family == "shaft") out.scene.bodies = shaft(1 + 2 * size);
  constexpr std::array ratios{1.0, 10.0, 100.0, 1e3, 1e6};
  out.ratio = ratios[static_cast<std::size_t>(number / 5 % 5)];
  for (BodySpec& body : out.scene.bodies) {
    if (body.fixed) continue;
    body.density = kilograms_per_cubic_metre(std::pow(out.ratio, between(random, 0, 1)));
  }
  out.friction = std::tan(between(random, 0, 60) * degree);
  out.scene.surfaces = {{out.friction, 0}};
  const double push = between(random, 0, 0.3) * 9.81, way = between(random, 0, 360) * degree;
  out.gravity = {push * std::cos(way), push * std::sin(way), -9.81};
  return out;
}

struct Share {
  int solved = 0, all = 0;
};

void solve_suite(study::Study& study) {
  const std::vector<std::string> families{"stack", "masonry", "arch", "pile", "shaft"};
  const std::vector<std::pair<std::string, bool>> ways{{"cascade", true}, {"first answer", false}};
  const int each = study.quick() ? 2 : 85;
  std::map<std::string, Share> by_family, by_ratio;
  std::map<std::string, std::vector<double>> times;
  std::vector<double> best;
  bool wrong = false;
  for (const std::string& family : families) {
    for (int k = 0; k < each; ++k) {
      const Problem problem = problem_of(family, k);
      best.push_back(1e300);
      for (const auto& [way, second_look] : ways) {
        study::Row row{
            .problem = fmt::format("{}/{}", family, k),
            .method = way,
            .setting = fmt::format("bodies={} friction={:.3f}", problem.scene.bodies.size(), problem.friction),
            .error = std::nullopt,
            .cost = {},
            .condition = problem.ratio,
            .status = study::Status::stopped};
        WorldOptions options{.gravity = problem.gravity, .step = 0.01, .cuts = 0};
        options.solver.prefer_motion = second_look;
        auto world = World::make(problem.scene, options);
        if (!world) {
          study.broken("every problem of the suite is a scene: " + describe(world.error()));
          continue;
        }
        row.cost = study.measure(
            [&] {
              const auto report = world->step();
              if (!report) return;
              row.status = study::Status::converged;
              row.error = report->residual;
              wrong = wrong || !(report->residual <= options.solver.accept) || !(report->overlap <= options.overlap);
            },
            0, 1);
        const bool solved = row.status == study::Status::converged;
        const double time = std::max(row.cost.cpu_s, 1e-6);
        times[way].push_back(solved ? time : -1);
        if (solved) best.back() = std::min(best.back(), time);
        if (second_look) {
          const std::string ratio = problem.ratio > 1e3 ? "1e6" : problem.ratio > 100 ? "1e3" : "up to 100";
          for (Share* share : {&by_family[family], &by_ratio[ratio]}) {
            ++share->all;
            share->solved += solved ? 1 : 0;
          }
        }
        study.add(std::move(row));
      }
    }
  }
  for (const auto& [family, share] : by_family) fmt::print("{}: {} of {} solved\n", family, share.solved, share.all);
  const std::map<std::string, double> promised{{"up to 100", 0.99}, {"1e3", 0.95}, {"1e6", 0}};
  for (const auto& [ratio, share] : by_ratio) {
    fmt::print("mass ratio {}: {} of {} solved\n", ratio, share.solved, share.all);
    if (share.solved < promised.at(ratio) * share.all) study.broken("share solved at a mass ratio " + ratio);
  }
  if (wrong) study.broken("no false convergence");

  study::Plot profile{.title = "share of the suite of blocks in motion solved within a factor of the fastest",
                      .x_label = "processor time over the faster of the two",
                      .y_label = "share solved",
                      .series = {}};
  for (const auto& [way, own] : times) {
    std::vector<double> factors;
    for (std::size_t p = 0; p < own.size(); ++p) {
      if (own[p] > 0) factors.push_back(own[p] / best[p]);
    }
    std::ranges::sort(factors);
    study::Series series{.name = way, .points = {}, .line = true, .fit = false};
    for (std::size_t k = 0; k < factors.size(); ++k) {
      series.points.emplace_back(factors[k], static_cast<double>(k + 1) / static_cast<double>(own.size()));
    }
    profile.series.push_back(std::move(series));
  }
  study.plot("profile", profile);
}

/// A prism 1 x 1 x 2 from 3 degrees past its balance over an edge: its angle after 0.4 s is known.
void toppling(study::Study& study) {
  constexpr double exact = 0.082412283189;
  study::Plot plot{.title = "toppling prism: error of the angle after 0.4 s",
                   .x_label = "processor time, s",
                   .y_label = "relative error",
                   .series = {}};
  for (const double theta : {0.5, 1.0}) {
    study::Series series{.name = fmt::format("theta {:g}", theta), .points = {}, .line = true, .fit = false};
    for (const double step : {0.02, 0.01, 0.005, 0.0025}) {
      const double lean = std::atan(0.5) + 3 * degree;
      const Turn turn = turn_by({0, lean, 0});
      const Polyhedron shape = moved(box({-1, -0.5, 0}, {0, 0.5, 2}), {}, turn);
      double angle = 0;
      const study::Cost cost = study.measure([&] {
        auto world = World::make({.bodies = {stone(shape), wall({-5, -5, -1}, {5, 5, 0})}, .surfaces = {{10, 0}}},
                                 {.step = step, .theta = theta});
        while (world && world->time() < 0.4 - 1e-12) {
          if (!world->step(0.4 - world->time())) break;
        }
        angle = world ? 3 * degree + angle_of(world->turn(0)) : 0;
      });
      const double error = std::abs(angle - exact) / exact;
      study.add({.problem = "toppling prism",
                 .method = series.name,
                 .setting = fmt::format("step={:g}", step),
                 .error = error,
                 .cost = cost,
                 .condition = std::nullopt,
                 .status = study::Status::converged});
      series.points.emplace_back(std::max(cost.cpu_s, 1e-6), error);
    }
    plot.series.push_back(std::move(series));
  }
  study.plot("toppling", plot);
}

/// Random assemblies let go from rest: what a certificate says moves must move, what one says stands must stand.
/// `error` is 0 where it does; those in doubt are counted.
void certificates(study::Study& study) {
  AssemblyMaker maker{1};
  const int count = study.quick() ? 10 : 200;
  std::array<int, 3> said{}, kept{};
  for (int k = 0; k < count; ++k) {
    const RandomAssembly random = maker.make();
    Certain certain = Certain::in_doubt;
    std::optional<double> moved;
    const study::Cost cost = study.measure(
        [&] {
          certain = certified(random.statics);
          if (certain == Certain::in_doubt) return;
          if (const auto let_go = moved_from_rest(random)) moved = *let_go;
        },
        0, 1);
    const auto which = static_cast<std::size_t>(certain);
    ++said.at(which);
    if (certain == Certain::in_doubt) continue;
    const bool right = moved && (*moved > 1e-6) == (certain == Certain::moves);
    kept.at(which) += right ? 1 : 0;
    study.add({.problem = fmt::format("random assembly {}", k),
               .method = certain == Certain::moves ? "certainly moves" : "certainly stands",
               .setting = fmt::format("bodies={}", random.statics.bodies.size()),
               .error = moved ? std::optional{right ? 0.0 : 1.0} : std::nullopt,
               .cost = cost,
               .condition = moved,
               .status = moved ? study::Status::converged : study::Status::stopped});
  }
  fmt::print(
      "random assemblies: {} of {} that certainly move do, {} of {} that certainly stand do, {} of {} in doubt\n",
      kept[0], said[0], kept[1], said[1], said[2], count);
  if (kept[0] != said[0] || kept[1] != said[1]) study.broken("what is certain of random assemblies");
}

void study_motion(study::Study& study) {
  solve_suite(study);
  toppling(study);
  certificates(study);
}

}  // namespace
}  // namespace cleave

int main(int argc, char** argv) { return cleave::study::run("motion", argc, argv, cleave::study_motion); }
