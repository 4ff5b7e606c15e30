/// Study "stability": the boundary elements on stiff and extreme input. Each row is an answer with its error, or a
/// typed refusal. `error` is relative to an exact answer, to the same problem in tame units, or (motion) the relative
/// energy or frequency error; `condition` is that of the dense system, or the ratio of the largest to the smallest
/// eigenvalue.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "cleave/bem/motion.hpp"
#include "cleave/bem/statics.hpp"
#include "study.hpp"

namespace cleave {
namespace {

using namespace bem;

struct Outcome {
  std::optional<double> error;
  double condition = 0;
  bool refused = false;
};

Material material(double young, double nu, double density = 0) {
  return Material::make(pascals(young), nu, kilograms_per_cubic_metre(density)).value();
}

/// Lame cylinder under inner pressure, given displacement outside.
Outcome lame(double nu, double young, double scale, Vec2 offset) {
  const double mu = young / (2 * (1 + nu));
  const double p = young * 1e-3;
  const auto u = [=](Vec2 x) {
    const Vec2 y = (x - offset) / scale;
    const double r = norm(y);
    return (scale * p / mu * ((1 - 2 * nu) / 3 * r + 4.0 / 3 / r) / 2 / r) * y;
  };
  Region region{.material = material(young, nu),
                .loops = {circle(offset, 2 * scale, false, 0, 32), circle(offset, scale, true, 1, 16)},
                .conditions = {bem::displacement(u), pressure(p)}};
  const auto s = solve(Problem{.regions = {region}}, {});
  if (!s) return {.error = std::nullopt, .condition = 0, .refused = true};
  double worst = 0, size = 0;
  for (std::size_t n = 0; n < s->regions()[0].mesh.nodes.size(); ++n) {
    const Vec2 want = u(s->node(0, n));
    size = std::max(size, norm(want));
    worst = std::max(worst, norm(s->regions()[0].displacement[n] - want));
  }
  return {.error = worst / size, .condition = s->diagnostics().condition, .refused = false};
}

/// A bar pulled along its length: the answer is linear and exact for any mesh.
Outcome bar(double aspect, std::size_t elements, double grade) {
  Loop loop = polygon({{0, 0}, {aspect, 0}, {aspect, 1}, {0, 1}}, 0, 1);
  loop[0].elements = loop[2].elements = elements;
  loop[0].grade_start = loop[2].grade_end = grade;
  loop[1].condition = 2;
  loop[3].condition = 1;
  const Material m = material(1, 0.25);
  const Sym2 e = m.strain({1, 0, 0});
  const auto u = [e](Vec2 x) { return Vec2{e.xx * x.x, e.yy * x.y}; };
  Region region{
      .material = m, .loops = {loop}, .conditions = {free_surface(), bem::displacement(u), traction(Vec2{1, 0})}};
  const auto s = solve(Problem{.regions = {region}}, {});
  if (!s) return {.error = std::nullopt, .condition = 0, .refused = true};
  double worst = 0;
  for (std::size_t n = 0; n < s->regions()[0].mesh.nodes.size(); ++n) {
    worst = std::max(worst, norm(s->regions()[0].displacement[n] - u(s->node(0, n))));
  }
  return {.error = worst / (e.xx * aspect), .condition = s->diagnostics().condition, .refused = false};
}

/// Vibration of a clamped block from rest under a sudden load, over steps of a share of the smallest period: does it
/// stay bounded, and does its mean approach the static displacement?
Outcome vibration(double share) {
  const Material m = material(1e9, 0.25, 2600);
  const BlockOperator b = BlockOperator::make({polygon({{0, 0}, {2, 0}, {2, 1}, {0, 1}}, 0, 2)}, m, {}).value();
  std::vector<HeldFreedom> held;
  for (std::size_t n = 0; n < b.mesh().nodes.size(); ++n) {
    if (b.mesh().nodes[n].x.x > -1 + 1e-9) continue;
    held.push_back({n, {1, 0}});
    held.push_back({n, {0, 1}});
  }
  const Modes modes = supported_modes(b, held);
  const double condition = modes.eigenvalues.back() / modes.eigenvalues.front();
  const double smallest = 2 * 3.141592653589793 / std::sqrt(modes.eigenvalues.back());
  const auto f = b.forces_of_acceleration({0, -9.81});
  const auto still = static_displacement(b, held, f);
  double largest = 0;
  for (const double v : still) largest = std::max(largest, std::abs(v));
  Vibration motion{b, modes, GeneralizedAlpha{0.8}, share * smallest, {}, {{f, [](double) { return 1.0; }, false}}};
  double most = 0;
  const BoundaryPlace place = b.place({1, 0});
  double static_there = norm(b.displacement_at(place, still));
  for (int k = 0; k < 20000; ++k) {
    motion.advance();
    most = std::max(most, norm(motion.displacement_at(place)));
  }
  // Undamped the peak is about twice the static displacement and never more than the sum of all modes allows; energy
  // put in by the load bounds it: growth beyond 2.5 times would be an instability.
  const bool bounded = most < 2.5 * static_there;
  return {.error = bounded ? std::optional{std::max(0.0, most / (2 * static_there) - 1)} : std::nullopt,
          .condition = condition,
          .refused = false};
}

/// The same block of 1 mm and of 1 km.
Outcome beside(double small, double large) {
  const auto stretch = [](double size) {
    Loop loop = polygon({{0, 0}, {size, 0}, {size, size}, {0, size}}, 0, 2);
    loop[0].condition = 1;
    loop[2].condition = 2;
    Condition held = roller();
    held.component[1] = {Given::spring, {}, 1};
    Region region{.material = material(1e9, 0.25),
                  .loops = {loop},
                  .conditions = {free_surface(), clamped(), traction(Vec2{0, 1e6})}};
    return solve(Problem{.regions = {region}}, {});
  };
  const auto a = stretch(small);
  const auto b = stretch(large);
  if (!a || !b) return {.error = std::nullopt, .condition = 0, .refused = true};
  return {.error = std::abs(a->largest_displacement() / small / (b->largest_displacement() / large) - 1),
          .condition = std::max(a->diagnostics().condition, b->diagnostics().condition),
          .refused = false};
}

/// Side of a cut square beside a sliver element: 1 to 10^4 in length.
Outcome length_ratio(double ratio) {
  // The corner at 1/ratio from the next: a short straight side.
  const Material m = material(1, 0.25);
  Loop loop = polygon({{0, 0}, {1, 0}, {1, 1}, {1 / ratio, 1}, {0, 1}}, 0, 2);
  const Sym2 s{1, 0.4, -2};
  const Sym2 e = m.strain(s);
  const auto u = [e](Vec2 x) { return Vec2{e.xx * x.x + e.xy * x.y, e.xy * x.x + e.yy * x.y}; };
  Region region{.material = m,
                .loops = {loop},
                .conditions = {traction([s](Vec2, Vec2 n) { return s * n; }), bem::displacement(u)}};
  region.loops[0][0].condition = 1;
  const auto made = solve(Problem{.regions = {region}}, {});
  if (!made) return {.error = std::nullopt, .condition = 0, .refused = true};
  double worst = 0;
  for (std::size_t n = 0; n < made->regions()[0].mesh.nodes.size(); ++n) {
    worst = std::max(worst, norm(made->regions()[0].displacement[n] - u(made->node(0, n))));
  }
  return {.error = worst / 2, .condition = made->diagnostics().condition, .refused = false};
}

Outcome refused_material(double young, double nu) {
  return {.error = std::nullopt, .condition = 0, .refused = !Material::make(pascals(young), nu, {}).has_value()};
}

Outcome floating() {
  Region region{
      .material = material(1, 0.25), .loops = {polygon({{0, 0}, {1, 0}, {1, 1}})}, .conditions = {free_surface()}};
  return {.error = std::nullopt, .condition = 0, .refused = !solve(Problem{.regions = {region}}, {}).has_value()};
}

void study_stability(study::Study& study) {
  const auto row = [&](const std::string& problem, const std::string& setting, const std::function<Outcome()>& work) {
    Outcome out;
    const auto cost = study.measure([&] { out = work(); }, 0, 1);
    study.add({.problem = problem,
               .method = "bem",
               .setting = setting,
               .error = out.error,
               .cost = cost,
               .condition = out.condition > 0 ? std::optional{out.condition} : std::nullopt,
               .status = out.refused ? study::Status::refused
                                     : (out.error ? study::Status::converged : study::Status::stopped)});
  };
  for (const double nu : {-0.5, 0.0, 0.25, 0.49, 0.4999, 0.499999}) {
    row("poisson", fmt::format("nu={}", nu), [=] { return lame(nu, 1, 1, {}); });
  }
  row("poisson", "nu=0.5", [] { return refused_material(1, 0.5); });
  for (const double young : {1.0, 1e6, 1e12})
    row("modulus", fmt::format("young={:.0e}", young), [=] { return lame(0.25, young, 1, {}); });
  row("modulus", "young=0", [] { return refused_material(0, 0.25); });
  for (const double scale : {1e-3, 1.0, 1e3})
    row("size", fmt::format("metres={:.0e}", scale), [=] { return lame(0.25, 1e9, scale, {}); });
  for (const double offset : {0.0, 1e3, 1e6})
    row("offset", fmt::format("metres={:.0e}", offset), [=] { return lame(0.25, 1e9, 1, {offset, -offset}); });
  for (const double aspect : {1.0, 100.0, 1e4})
    row("aspect", fmt::format("ratio={:.0e}", aspect), [=] { return bar(aspect, 100, 1); });
  for (const double grade : {1.0, 2.0, 4.0})
    row("graded", fmt::format("power={} shortest={:.1e}", grade, std::pow(0.1, grade)),
        [=] { return bar(1, 10, grade); });
  for (const double ratio : {10.0, 1e2, 1e4, 1e6})
    row("element_length", fmt::format("ratio={:.0e}", ratio), [=] { return length_ratio(ratio); });
  for (const double share : {1e-3, 1e-1, 1.0, 10.0, 1e3})
    row("step", fmt::format("of_smallest_period={:.0e}", share), [=] { return vibration(share); });
  row("sizes_apart", "1 mm and 1 km", [] { return beside(1e-3, 1e3); });
  row("free_body", "static load without supports", [] { return floating(); });
}

}  // namespace
}  // namespace cleave

int main(int argc, char** argv) { return cleave::study::run("stability", argc, argv, cleave::study_stability); }
