/// Study "estimates": the error that runs of elastic bodies say they have against the error they have, at rest and
/// moving. `error` is the true one, relative as the estimate is: closed forms of a hole in an infinite plane (Kirsch),
/// a ring (Lame) and a bar under a sudden pull (d'Alembert), and for a beam and a hole near an edge the same run four
/// or eight times as fine. `condition` is the estimate over it; none: the run said why it has no estimate. Ends with 1
/// when fewer than 90 % of the estimates lie within a factor of 3.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "cleave/core/cost.hpp"
#include "cleave/core/progress.hpp"
#include "cleave/scene2d/bodies.hpp"
#include "study.hpp"

namespace cleave {
namespace {

using bem::Vec2;
using scene::BodiesResult;
using std::numbers::pi;

constexpr double nu = 0.3;
const std::string rock = fmt::format("[rock]\nyoung = {}\npoisson = {}\n", 2 * (1 + nu), nu);  // shear modulus 1

/// One run at some fineness; places are looked at in every picture.
struct Case {
  std::string name;
  /// The scene by the length of its elements (and, moving, by the step, which goes with it).
  std::function<std::string(double element)> scene;
  std::vector<double> elements;
  std::vector<Vec2> places;
  /// Displacement at a place and time; empty: a run that is finer than the finest by so many times tells.
  std::function<Vec2(Vec2 x, double time)> exact = {};
  double finer = 8;
};

std::optional<BodiesResult> result_of(const std::string& text) {
  const auto parsed = scene::parse_bodies(text, "study.toml");
  if (!parsed) {
    fmt::print(stderr, "{}", describe(parsed.error().front()));
    return std::nullopt;
  }
  StageTimer timer;
  Progress progress{ProgressStyle::quiet};
  auto result = scene::run(*parsed, 1, timer, progress);
  if (!result) {
    fmt::print(stderr, "{}", describe(result.error().front()));
    return std::nullopt;
  }
  return *std::move(result);
}

/// Largest difference in any picture over the largest displacement.
double error_of(const BodiesResult& found, const std::function<Vec2(std::size_t place, std::size_t frame)>& right) {
  double worst = 0, size = 0;
  for (std::size_t p = 0; p < found.points.size(); ++p) {
    for (std::size_t f = 0; f < found.points[p].displacement.size(); ++f) {
      const Vec2 u = right(p, f);
      worst = std::max(worst, norm(found.points[p].displacement[f] - u));
      size = std::max(size, norm(u));
    }
  }
  return worst / size;
}

std::string points_of(const std::vector<Vec2>& places) {
  std::string out = "points = [";
  for (const Vec2 x : places) out += fmt::format("{{ at = [{:.17g}, {:.17g}] }}, ", x.x, x.y);
  return out + "]\n";
}

/// Of circles: the elements on each half, as many as go into 1.
std::string halves(double element) { return fmt::format("elements = {}\n", std::lround(1 / element)); }

std::vector<Vec2> around(Vec2 centre, double radius) {
  std::vector<Vec2> out;
  for (int k = 0; k < 24; ++k) {
    const double angle = 2 * pi * (k + 0.37) / 24;
    out.push_back(centre + radius * Vec2{std::cos(angle), std::sin(angle)});
  }
  return out;
}

/// On the rim of a hole of radius 1 under a pull along x: what the hole adds.
Vec2 kirsch(Vec2 x) {
  const double kappa = 3 - 4 * nu, t = std::atan2(x.y, x.x);
  const double ur = 0.25 * (1 + kappa * std::cos(2 * t)), ut = -0.25 * kappa * std::sin(2 * t);
  return {ur * std::cos(t) - ut * std::sin(t), ur * std::sin(t) + ut * std::cos(t)};
}

Case hole(double across) {
  return {.name = fmt::format("hole_{}", across),
          .scene =
              [=](double element) {
                return rock + "[elastic]\nstress = false\n" + points_of(around({0, 0}, 1)) + "[[body]]\n" +
                       halves(element) + "extent = \"plane\"\nround_holes = [{ centre = [0, 0], radius = 1 }]\n" +
                       fmt::format("in_situ = {{ stress = [1, {}, 0] }}\n", across);
              },
          .elements = {1, 0.5, 0.333, 0.25},
          .places = around({0, 0}, 1),
          .exact =
              [=](Vec2 x, double) {
                const Vec2 other = kirsch({x.y, x.x});
                return kirsch(x) + across * Vec2{other.y, other.x};
              }};
}

/// A disc with a hole, its rim held, pressed from within.
Case ring() {
  return {
      .name = "disc",
      .scene =
          [](double element) {
            return rock + fmt::format("[elastic]\nstress = false\nelement = {}\n", element) +
                   points_of(around({0, 0}, 1)) +
                   "[[body]]\ncircle = { centre = [0, 0], radius = 2 }\n"
                   "round_holes = [{ centre = [0, 0], radius = 1 }]\n"
                   "support = [{ sides = \"all\", kind = \"fixed\" }]\nload = [{ hole = 1, sides = \"all\", pressure "
                   "= 1 }]\n";
          },
      .elements = {1, 0.5, 0.333, 0.25},
      .places = around({0, 0}, 1),
      .exact =
          [](Vec2 x, double) {
            const double inner = 1 / (2 * (1 / (1 - 2 * nu) + 4));
            return (4 * inner - inner) * x;  // -A r + 4 A / r at r = 1
          }};
}

Case edge(double cover) {
  return {.name = fmt::format("hole_{}_below_an_edge", cover),
          .scene =
              [=](double element) {
                const Vec2 centre{0, -1 - cover};
                return rock + "[elastic]\nstress = false\n" + points_of(around(centre, 1)) + "[[body]]\n" +
                       halves(element) + "extent = \"half_plane\"\nsurface = 0\n" +
                       fmt::format("round_holes = [{{ centre = [0, {}], radius = 1 }}]\n", centre.y) +
                       "in_situ = { stress = [1, 0, 0] }\n";
              },
          .elements = {1, 0.5, 0.333, 0.25},
          .places = around({0, -1 - cover}, 1)};
}

Case beam(double slender) {
  std::vector<Vec2> places;
  for (int k = 1; k <= 32; ++k) places.push_back({slender * k / 32.0, k % 2 == 0 ? 0.0 : 1.0});
  return {.name = fmt::format("beam_{}", slender),
          .scene =
              [=](double element) {
                return rock + fmt::format("[elastic]\nstress = false\nelement = {}\n", element) + points_of(places) +
                       fmt::format("[[body]]\noutline = [[0, 0], [{0}, 0], [{0}, 1], [0, 1]]\n", slender) +
                       "support = [{ side = 4, kind = \"fixed\" }]\nload = [{ side = 2, traction = [0, -0.001] }]\n";
              },
          .elements = {1, 0.5, 0.25},
          .places = places};
}

/// Held on the left, pulled on the right from time 0 on.
Case moving_bar(double length, double share) {
  std::vector<Vec2> places;
  for (int k = 1; k <= 32; ++k) places.push_back({length * k / 32.0, k % 2 == 0 ? 0.0 : 1.0});
  return {.name = fmt::format("bar_{}_under_a_sudden_pull{}", length, share > 0 ? "_damped" : ""),
          .scene =
              [=](double element) {
                return "[rock]\nyoung = 1\npoisson = 0\ndensity = 1\n" +
                       fmt::format("[elastic]\nstress = false\nelement = {}\n", element) + points_of(places) +
                       fmt::format(
                           "time = {{ end = {}, step = {}, frames = 160, rebuild = 0, damping = {{ share = {} }} "
                           "}}\n",
                           4 * length, 0.05 * length * element, share) +
                       fmt::format("[[body]]\noutline = [[0, 0], [{0}, 0], [{0}, 1], [0, 1]]\n", length) +
                       "support = [{ side = 4, kind = \"roller\" }, { side = 1, kind = \"roller\" }]\n"
                       "load = [{ side = 2, traction = [1e-4, 0] }]\n";
              },
          .elements = {0.5, 0.25},
          .places = places,
          .exact =
              [=](Vec2 x, double time) {
                double u = x.x;
                for (int n = 0; n < 2000; ++n) {
                  const double k = (2 * n + 1) * pi / (2 * length);
                  const double sign = n % 2 == 0 ? 1 : -1;
                  // Each mode swings about its share of the static answer.
                  const double damped = k * std::sqrt(1 - share * share);
                  const double swing = std::exp(-share * k * time) *
                                       (std::cos(damped * time) + share * k / damped * std::sin(damped * time));
                  u -= 2 * sign / (length * k * k) * std::sin(k * x.x) * swing;
                }
                return Vec2{1e-4 * u, 0};
              }};
}

Case moving_beam() {
  std::vector<Vec2> places;
  for (int k = 1; k <= 16; ++k) places.push_back({k / 4.0, k % 2 == 0 ? 0.0 : 1.0});
  return {.name = "beam_under_a_sudden_load",
          .scene =
              [=](double element) {
                return "[rock]\nyoung = 1\npoisson = 0.3\ndensity = 1\n" +
                       fmt::format("[elastic]\nstress = false\nelement = {}\n", element) + points_of(places) +
                       fmt::format("time = {{ end = 120, step = {}, frames = 120, rebuild = 0 }}\n", element) +
                       "[[body]]\noutline = [[0, 0], [4, 0], [4, 1], [0, 1]]\n"
                       "support = [{ side = 4, kind = \"fixed\" }]\nload = [{ side = 2, traction = [0, -1e-6] }]\n";
              },
          .elements = {0.5, 0.25},
          .places = places,
          .exact = {},
          .finer = 4};
}

std::vector<Case> cases(bool quick) {
  if (quick) return {hole(0), ring(), moving_bar(2, 0)};
  return {hole(0),
          hole(0.4),
          hole(-1),
          ring(),
          edge(1),
          edge(0.5),
          edge(0.2),
          beam(2),
          beam(4),
          beam(8),
          moving_bar(1, 0),
          moving_bar(2, 0),
          moving_bar(4, 0),
          moving_bar(2, 0.05),
          moving_bar(2, 0.2),
          moving_beam()};
}

void study_estimates(study::Study& study) {
  constexpr double rounding = 1e-9;
  int within = 0, above = 0, below = 0, none = 0;
  for (const Case& one : cases(study.quick())) {
    std::optional<BodiesResult> finest;
    if (!one.exact) finest = result_of(one.scene(one.elements.back() / one.finer));
    if (!one.exact && !finest) {
      study.broken("no reference for " + one.name);
      continue;
    }
    for (const double element : one.elements) {
      std::optional<BodiesResult> found;
      const study::Cost cost = study.measure([&] { found = result_of(one.scene(element)); }, 0, 1);
      study::Row row{one.name,
                     "bem",
                     fmt::format("element={}", element),
                     std::nullopt,
                     cost,
                     std::nullopt,
                     study::Status::stopped};
      if (found && found->converged) {
        row.status = study::Status::converged;
        row.error = error_of(*found, [&](std::size_t place, std::size_t frame) {
          if (!one.exact) return finest->points[place].displacement[frame];
          return one.exact(one.places[place], found->times[frame]);
        });
        const std::optional<double> estimate = found->bodies[0].error;
        if (!estimate) {
          ++none;
        } else if (*row.error > rounding) {
          const double ratio = *estimate / *row.error;
          row.condition = ratio;
          ++(ratio > 3 ? above : ratio < 1.0 / 3 ? below : within);
        }
      }
      study.add(std::move(row));
    }
  }
  const int all = within + above + below;
  const std::string table = fmt::format(
      "| estimates | within a factor of 3 | larger | smaller | none, with the reason |\n|---|---|---|---|---|\n"
      "| {} | {} | {} | {} | {} |\n",
      all, within, above, below, none);
  fmt::print("\n{}", table);
  study.text("shares.md", table);
  if (!study.quick() && 10 * within < 9 * all) study.broken("90 % of the estimates within a factor of 3");
}

}  // namespace
}  // namespace cleave

int main(int argc, char** argv) { return cleave::study::run("estimates", argc, argv, cleave::study_estimates); }
