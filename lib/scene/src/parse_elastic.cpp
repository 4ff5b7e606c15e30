#include "parse_elastic.hpp"

#include <fmt/format.h>

#include <array>
#include <string_view>

#include "plane_input.hpp"

namespace cleave::scene {

using bem::Vec2;
using std::string_view;

namespace {
constexpr NumberRule any_time{0, false, 1e12, false, " s"};
}  // namespace

void parse_elastic_time(const TableReader& elastic, BodiesScene& scene) {
  const TomlTable* found = elastic.table("time");
  if (found == nullptr) return;
  constexpr std::array<string_view, 11> keys{"end",     "step",   "scheme", "rho",     "beta",    "gamma",
                                             "damping", "frames", "modes",  "rebuild", "estimate"};
  constexpr std::array<string_view, 4> schemes{"generalized_alpha", "newmark", "houbolt", "backward_euler"};
  const TableReader table{*found, elastic.line_of("time"), elastic.path_of("time"), elastic.problems(), keys};
  TimeSettings time;
  time.end = table.need_number("end", time_rule).value_or(1);
  time.step = table.need_number("step", time_rule).value_or(1);
  if (time.end / time.step > 5e7)
    table.error("step", "makes more than fifty million steps", "use a longer step or a shorter time");
  if (time.step > time.end) table.error("step", "is longer than the whole time", "use a shorter step");
  switch (table.choice("scheme", schemes).value_or(0)) {
    case 0: time.scheme = bem::GeneralizedAlpha{table.number("rho", {0, false, 1, false, ""}).value_or(0.8)}; break;
    case 1:
      time.scheme = bem::Newmark{table.number("beta", {0, true, 1, false, ""}).value_or(0.25),
                                 table.number("gamma", {0.5, false, 1, false, ""}).value_or(0.5)};
      break;
    case 2: time.scheme = bem::Houbolt{}; break;
    default: time.scheme = bem::BackwardEuler{}; break;
  }
  if (const TomlTable* d = table.table("damping")) {
    constexpr std::array<string_view, 3> damping_keys{"share", "alpha", "beta"};
    const TableReader damping{*d, table.line_of("damping"), table.path_of("damping"), table.problems(), damping_keys};
    time.damping.share = damping.number("share", {0, false, 10, false, ""}).value_or(0);
    time.damping.alpha = damping.number("alpha", {0, false, 1e9, false, " 1/s"}).value_or(0);
    time.damping.beta = damping.number("beta", any_time).value_or(0);
  }
  time.frames = static_cast<std::size_t>(table.integer("frames", 1, 2000).value_or(60));
  if (const auto modes = table.integer("modes", 0, 1000)) time.modes = static_cast<std::size_t>(*modes);
  time.rebuild = table.number("rebuild", {0, false, 1, false, ""}).value_or(time.rebuild);
  time.estimate = table.boolean("estimate").value_or(time.estimate);
  scene.time = time;
}

void parse_elastic_points(const TableReader& elastic, BodiesScene& scene) {
  const auto points = elastic.tables("points");
  constexpr std::array<string_view, 4> point_keys{"name", "at", "body", "stress"};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto table = reader(*points[i], fmt::format("elastic.points[{}]", i + 1), elastic.problems(), point_keys);
    const auto at = pair(table, "at", rule::coordinate);
    if (!table.has("at")) table.missing("at", "write at = [x, y]");
    if (!at) continue;
    PointSpec point{.name = table.text("name").value_or(fmt::format("point {}", i + 1)),
                    .at = *at,
                    .body = 0,
                    .stress = table.boolean("stress").value_or(false)};
    const auto wanted = table.text("body");
    bool known = false;
    for (std::size_t b = 0; b < scene.bodies.size() && !known; ++b) {
      const BodySpec& body = scene.bodies[b];
      known = wanted ? body.name == *wanted
                     : (body.extent == bem::Extent::bounded ? bem::inside(body.region.loops, *at) : true);
      if (known) point.body = b;
    }
    if (!known && !wanted) {
      // On a boundary: the body whose outline is nearest.
      double best = 1e300;
      for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
        for (const bem::Loop& loop : scene.bodies[b].region.loops) {
          for (std::size_t s = 0; s < loop.size(); ++s) {
            for (int k = 0; k <= 64; ++k) {
              const double d = norm(bem::point_on(loop, s, k / 64.0).x - *at);
              const double near = bem::length_of(loop, s) / 64;
              if (d < best && d <= near) {
                best = d;
                point.body = b;
                known = true;
              }
            }
          }
        }
      }
    }
    if (!known) {
      table.error(wanted ? "body" : "at", wanted ? "there is no body of that name" : "lies in no body",
                  "move the point, or name its body");
    }
    scene.points.push_back(point);
  }
}

}  // namespace cleave::scene
