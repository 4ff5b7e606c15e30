/// Study "assembly": factors of assemblies against time. Friction is a round cone; programs of limit equilibrium cut it
/// to a polygon of 4 to 64 sides, inside (forces it admits are admissible) or outside (motion it finds is certain). A
/// polygon is made of contacts without friction along its edges, so it shares only the solver without friction with the
/// cone. `error` is relative to the closed form, or to the cone where there is none; `condition` is the factor. The
/// study is broken where an inside polygon is above the cone, an outside one below, or a factor is not its closed form.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "cleave/assembly/groups.hpp"
#include "cleave/core/rng.hpp"
#include "study.hpp"

namespace cleave {
namespace {

using assembly::Assembly;
using assembly::AssemblySpec;
using assembly::Contact;
using assembly::Freedom;
using geometry::Vec3;

double radians(double degrees) { return degrees * std::numbers::pi / 180; }
/// Upward normal of a plane.
Vec3 plane(double dip, double direction) {
  return {std::sin(radians(dip)) * std::sin(radians(direction)), std::sin(radians(dip)) * std::cos(radians(direction)),
          std::cos(radians(dip))};
}

struct Problem {
  std::string name;
  AssemblySpec spec;
  std::optional<double> up, moving;  ///< closed forms
};

void block(AssemblySpec& spec, double weight) {
  spec.bodies.push_back({.centroid = {}, .force = {0, 0, -weight}, .moment = {}, .mass = weight});
}
void contact(AssemblySpec& spec, std::uint32_t body, std::optional<std::uint32_t> other, Vec3 normal, double degrees) {
  spec.contacts.push_back(
      {.body = body, .other = other, .normal = normal, .points = {{}}, .friction = std::tan(radians(degrees))});
}

Problem wedge() {
  Problem p{"wedge 40/130 60/220", {.freedom = Freedom::translation}, 0.958055, {}};
  p.moving = std::tan(radians(30)) / std::tan(radians(33.357221));
  block(p.spec, 1);
  contact(p.spec, 0, {}, plane(40, 130), 30);
  contact(p.spec, 0, {}, plane(60, 220), 30);
  return p;
}

Problem pyramid() {
  Problem p{"roof pyramid", {.freedom = Freedom::translation}, std::tan(radians(35)) / std::tan(radians(30)), 0};
  block(p.spec, 1);
  for (const double direction : {0.0, 120.0, 240.0}) {
    const Vec3 n = plane(60, direction);
    contact(p.spec, 0, {}, {n.x, n.y, -n.z}, 35);
  }
  return p;
}

/// Blocks in line on a plane, one behind the other, joints at right angles to it: as one.
Problem line(std::uint32_t count) {
  Problem p{fmt::format("line of {}", count), {.freedom = Freedom::translation}, {}, {}};
  const Vec3 normal = plane(35, 90), along{std::cos(radians(35)), 0, -std::sin(radians(35))};
  for (std::uint32_t k = 0; k < count; ++k) {
    block(p.spec, 1);
    contact(p.spec, k, {}, normal, 30);
    if (k > 0) contact(p.spec, k, k - 1, along, 0);
  }
  p.up = p.moving = std::tan(radians(30)) / std::tan(radians(35));
  return p;
}

/// One block on three to five planes that look up, as cut at random: what statics admits has no closed form.
Problem random_block(std::uint64_t seed) {
  Problem p{fmt::format("random block {}", seed), {.freedom = Freedom::translation}, {}, {}};
  Rng rng{{.seed = seed}};
  block(p.spec, 1);
  const int planes = 2 + static_cast<int>(seed % 3);
  for (int k = 0; k < planes; ++k) {
    contact(p.spec, 0, {}, plane(35 + 40 * rng.uniform(), 150 * rng.uniform()), 20 + 20 * rng.uniform());
  }
  return p;
}

/// The edges of a pyramid of friction as contacts without friction.
Assembly with_polygons(const AssemblySpec& spec, double factor, int sides, bool outside) {
  AssemblySpec out{spec.freedom, spec.bodies, {}};
  const double wider = outside ? 1 / std::cos(std::numbers::pi / sides) : 1;
  for (const Contact& c : spec.contacts) {
    const Vec3 u = normalized(std::abs(c.normal.z) < 0.9 ? cross(c.normal, {0, 0, 1}) : cross(c.normal, {1, 0, 0}));
    const Vec3 w = cross(c.normal, u);
    for (int k = 0; k < (c.friction > 0 ? sides : 1); ++k) {
      const double a = 2 * std::numbers::pi * (k + 0.25) / sides, m = wider * c.friction / factor;
      Contact edge = c;
      edge.friction = 0;
      edge.normal = normalized(c.normal + m * std::cos(a) * u + m * std::sin(a) * w);
      out.contacts.push_back(edge);
    }
  }
  return Assembly::make(std::move(out)).value();
}

/// The largest factor at which polygons admit balance, to 1e-9.
double polygon_factor(const AssemblySpec& spec, int sides, bool outside) {
  const auto stands = [&](double factor) {
    return !(assembly::project(with_polygons(spec, factor, sides, outside), 1).largest > 1e-8);
  };
  double low = 1e-3, high = 1e3;
  if (!stands(low)) return 0;
  while (high - low > 1e-9 * high) {
    const double middle = std::sqrt(low * high);
    (stands(middle) ? low : high) = middle;
  }
  return low;
}

double off(double found, double truth) { return std::abs(found - truth) / std::max(truth, 1e-3); }

void look(study::Study& study, const Problem& p) {
  const Assembly made = Assembly::make(p.spec).value();
  double cone = 0;
  const study::Cost up = study.measure([&] { cone = assembly::static_factor(made).factor; });
  const double truth = p.up.value_or(cone);
  study.add({p.name, "upper factor", "cone", off(cone, truth), up, cone});
  if (off(cone, truth) > 2e-6) study.broken(fmt::format("{}: upper factor {} is not {}", p.name, cone, truth));
  double moving = 0;
  const study::Cost move = study.measure([&] { moving = assembly::moving_factor(made, cone).factor; });
  if (p.moving) {
    study.add({p.name, "factor of safety", "cone", off(moving, *p.moving), move, moving});
    if (off(moving, *p.moving) > 4e-6) {
      study.broken(fmt::format("{}: factor of safety {} is not {}", p.name, moving, *p.moving));
    }
  }
  if (!std::isfinite(cone) || p.spec.bodies.size() > 16) return;
  for (const int sides : {4, 8, 16, 32, 64}) {
    for (const bool outside : {false, true}) {
      double found = 0;
      const study::Cost cost = study.measure([&] { found = polygon_factor(p.spec, sides, outside); }, 0.1, 3);
      study.add({p.name, outside ? "polygon outside" : "polygon inside", fmt::format("{} sides", sides),
                 off(found, cone), cost, found});
      const double least = std::cos(std::numbers::pi / sides);
      const bool bounds = outside ? found >= cone * (1 - 1e-6) && found <= cone / least * (1 + 1e-6)
                                  : found <= cone * (1 + 1e-6) && found >= cone * least * (1 - 1e-6);
      if (!bounds) study.broken(fmt::format("{}: {} sides give {}, the cone {}", p.name, sides, found, cone));
    }
  }
}

void plot(study::Study& study) {
  study::Plot plot{.title = "Upper factor with polygons of friction",
                   .x_label = "sides",
                   .y_label = "largest error over the problems",
                   .series = {}};
  for (const std::string method : {"polygon inside", "polygon outside"}) {
    study::Series series{.name = method, .points = {}};
    for (const int sides : {4, 8, 16, 32, 64}) {
      double most = 0;
      for (const study::Row& row : study.rows()) {
        if (row.method == method && row.setting == fmt::format("{} sides", sides)) most = std::max(most, *row.error);
      }
      if (most > 0) series.points.push_back({static_cast<double>(sides), most});
    }
    plot.series.push_back(std::move(series));
  }
  study.plot("polygons", plot);
}

}  // namespace
}  // namespace cleave

int main(int argc, char** argv) {
  return cleave::study::run("assembly", argc, argv, [](cleave::study::Study& study) {
    cleave::look(study, cleave::wedge());
    cleave::look(study, cleave::pyramid());
    for (const std::uint32_t count : {2U, 8U, 32U, 128U}) {
      if (count <= 8 || !study.quick()) cleave::look(study, cleave::line(count));
    }
    for (std::uint64_t seed = 1; seed <= (study.quick() ? 3U : 12U); ++seed) {
      cleave::look(study, cleave::random_block(seed));
    }
    cleave::plot(study);
  });
}
