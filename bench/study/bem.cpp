/// Study "bem": error against run time of the boundary elements on problems with exact answers. `error` is the largest
/// error of displacement at the nodes over the largest displacement (bar: rms over the static displacement; column:
/// first frequency); `condition` is the estimate of the dense system's condition number.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "bem_problems.hpp"
#include "cleave/bem/motion.hpp"
#include "cleave/bem/statics.hpp"
#include "drbem.hpp"
#include "initial_stress.hpp"
#include "study.hpp"

namespace cleave {
namespace {

using namespace bem;

using study::cantilever;
using study::Exact;
using study::kirsch;
using study::lame;
using study::nu;
using study::of_shear;

Exact gravity_column() {
  const Material m = of_shear(1, nu, 1);
  Loop loop = polygon({{0, 0}, {1, 0}, {1, 2}, {0, 2}}, 1, 1);
  loop[1].elements = loop[3].elements = 2;
  loop[2].condition = 0;
  Problem problem{.regions = {Region{.material = m, .loops = {loop}, .conditions = {free_surface(), roller()}}}};
  problem.load.gravity = {0, -1};
  const double modulus = m.lambda() + 2 * m.mu();
  return {"gravity_column", problem, [modulus](Vec2 x) { return Vec2{0, -(2 * x.y - x.y * x.y / 2) / modulus}; }, 6};
}

double error_of(const Solution& s, const Exact& exact) {
  double worst = 0, size = 0;
  const auto& part = s.regions().front();
  for (std::size_t n = 0; n < part.mesh.nodes.size(); ++n) {
    const Vec2 u = exact.displacement(s.node(0, n));
    size = std::max(size, norm(u));
    worst = std::max(worst, norm(part.displacement[n] - u));
  }
  return worst / size;
}

struct Curve {
  std::vector<std::pair<double, double>> time, elements;
};

constexpr std::array orders{Order::constant, Order::linear, Order::quadratic};
constexpr std::array names{"constant", "linear", "quadratic"};

void add_statics(study::Study& study, const Exact& exact) {
  std::map<std::string, Curve> curves;
  std::vector<std::pair<double, double>> all, defaults;  // time, error
  const auto one = [&](Order order, std::size_t doublings, double tolerance, unsigned threads) {
    Options options;
    options.mesh.order = order;
    options.mesh.subdivide = std::size_t{1} << doublings;
    options.integration = tolerance;
    options.threads = threads;
    std::optional<Solution> s;
    const auto cost = study.measure(
        [&] {
          if (auto made = solve(exact.problem, options)) s = *std::move(made);
        },
        0.05);
    const std::string method = names[static_cast<std::size_t>(order)];
    const std::size_t elements = exact.base_elements * options.mesh.subdivide;
    study::Row row{.problem = exact.name,
                   .method = method,
                   .setting = fmt::format("elements={} integration={:.0e} threads={}", elements, tolerance, threads),
                   .error = std::nullopt,
                   .cost = cost,
                   .condition = std::nullopt,
                   .status = study::Status::refused};
    if (s) {
      row.error = error_of(*s, exact);
      row.condition = s->diagnostics().condition;
      row.status = study::Status::converged;
      if (threads == 1) {
        all.emplace_back(cost.cpu_s, *row.error);
        if (tolerance == Options{}.integration) {
          curves[method].time.emplace_back(cost.cpu_s, *row.error);
          curves[method].elements.emplace_back(static_cast<double>(elements), *row.error);
          if (order == Options{}.mesh.order) defaults.emplace_back(cost.cpu_s, *row.error);
        }
      }
    }
    study.add(row);
  };
  const std::size_t most = study.quick() ? 2 : 5;
  for (const Order order : orders) {
    for (std::size_t k = 0; k < most; ++k) one(order, k, Options{}.integration, 1);
  }
  for (const double tolerance : {1e-3, 1e-5, 1e-7, 1e-13}) one(Order::quadratic, most - 2, tolerance, 1);
  one(Order::quadratic, most - 1, Options{}.integration, 2);

  study::Plot time{.title = exact.name + ": error against run time",
                   .x_label = "processor time (s)",
                   .y_label = "relative error of displacement",
                   .series = {}};
  study::Plot elements{.title = exact.name + ": error against elements",
                       .x_label = "elements",
                       .y_label = "relative error of displacement",
                       .series = {}};
  for (const auto& [method, curve] : curves) {
    time.series.push_back({.name = method, .points = curve.time, .line = false, .fit = true});
    elements.series.push_back({.name = method, .points = curve.elements, .line = false, .fit = true});
  }
  // Efficient: nothing else is both faster and more accurate.
  std::ranges::sort(all);
  std::vector<std::pair<double, double>> frontier;
  for (const auto& point : all) {
    if (frontier.empty() || point.second < frontier.back().second) frontier.push_back(point);
  }
  time.series.push_back({.name = "efficient frontier", .points = frontier, .line = true, .fit = false});
  time.series.push_back({.name = "default settings", .points = defaults, .line = false, .fit = false});
  study.plot(exact.name + "-time", time);
  study.plot(exact.name + "-elements", elements);
}

/// Bar of 2 x 4 m under a sudden unit tension, nu = 0: d'Alembert's triangle wave.
void add_bar(study::Study& study) {
  const Material m = Material::make(pascals(1e5), 0, kilograms_per_cubic_metre(1)).value();
  const double c = std::sqrt(1e5);
  const auto exact = [c](double t) {
    const double phase = std::fmod(t, 16 / c);
    return 1e-5 * (phase <= 8 / c ? phase : 16 / c - phase) * c;
  };
  const auto rms = [&](const std::vector<double>& t, const std::vector<double>& u) {
    double sum = 0;
    for (std::size_t k = 0; k < t.size(); ++k) sum += std::pow(u[k] - exact(t[k]), 2);
    return std::sqrt(sum / static_cast<double>(t.size())) / 4e-5;
  };
  Loop loop = polygon({{-1, 0}, {1, 0}, {1, 4}, {-1, 4}}, 0, 2);
  loop[1].elements = loop[3].elements = 4;
  const auto one = [](double) { return 1.0; };
  const std::vector<std::pair<std::string, Scheme>> schemes{{"generalized_alpha_0.8", GeneralizedAlpha{0.8}},
                                                            {"newmark_0.5_1", Newmark{0.5, 1}},
                                                            {"average_acceleration", Newmark{}},
                                                            {"houbolt", Houbolt{}}};
  study::Plot plot{.title = "bar: error against run time",
                   .x_label = "processor time (s)",
                   .y_label = "rms error / static",
                   .series = {}};
  const std::vector<double> steps = study.quick() ? std::vector{5e-4} : std::vector{1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5};
  for (const std::size_t bubbles : {std::size_t{0}, std::size_t{3}}) {
    for (const auto& [name, scheme] : schemes) {
      std::vector<std::pair<double, double>> points;
      for (const double step : steps) {
        std::vector<double> t, u;
        double condition = 0;
        const auto cost = study.measure(
            [&] {
              BlockOptions o;
              o.bubbles = bubbles;
              const BlockOperator b = BlockOperator::make({loop}, m, o).value();
              std::vector<HeldFreedom> held;
              std::vector<std::array<Vec2, 3>> top(b.mesh().elements.size());
              for (std::size_t e = 0; e < top.size(); ++e) {
                if (b.mesh().elements[e].normal(0).y > 0.5) top[e] = {Vec2{0, 1}, Vec2{0, 1}, Vec2{0, 1}};
              }
              for (std::size_t n = 0; n < b.mesh().nodes.size(); ++n) {
                if (b.mesh().nodes[n].x.y > -2 + 1e-9) continue;
                held.push_back({n, {1, 0}});
                held.push_back({n, {0, 1}});
              }
              const Modes modes = supported_modes(b, held);
              condition = modes.eigenvalues.back() / modes.eigenvalues.front();
              Vibration motion{b, modes, scheme, step, {}, {{b.forces_of(top), one, false}}};
              const BoundaryPlace place = b.place({0, 2});
              t.clear();
              u.clear();
              while (motion.time() < 0.1 - step / 2) {
                motion.advance();
                t.push_back(motion.time());
                u.push_back(motion.displacement_at(place).y);
              }
            },
            0.05, 5);
        study.add({.problem = "bar",
                   .method = "symmetric_" + name,
                   .setting = fmt::format("elements=12 bubbles={} step={}", bubbles, step),
                   .error = rms(t, u),
                   .cost = cost,
                   .condition = condition,
                   .status = study::Status::converged});
        points.emplace_back(cost.cpu_s, rms(t, u));
      }
      plot.series.push_back(
          {.name = fmt::format("{} bubbles {}", name, bubbles), .points = points, .line = true, .fit = false});
    }
  }
  // The operator of Fu (2014): with and without inner nodes, refused where it grows.
  Loop held = loop;
  held[0].condition = 1;
  held[2].condition = 2;
  const Region region{.material = m, .loops = {held}, .conditions = {free_surface(), clamped(), traction(Vec2{0, 1})}};
  const std::vector<std::pair<std::string, std::vector<Vec2>>> inner{{"inner=0", {}},
                                                                     {"inner=3", {{0, 1}, {0, 2}, {0, 3}}}};
  const std::vector<std::pair<std::string, Basis>> bases{
      {"1+r", Basis::one_plus_r}, {"r", Basis::r}, {"r+linear", Basis::r_plus_linear}};
  for (const auto& [label, nodes] : inner) {
    for (const auto& [basis_name, basis] : bases) {
      for (const double step : steps) {
        std::optional<Drbem::History> history;
        double radius = 0;
        const auto cost = study.measure(
            [&] {
              const auto d = Drbem::make(region, {}, basis, nodes);
              const auto run = d->run(Newmark{0.5, 1}, step, static_cast<std::size_t>(0.1 / step), one, {0, 4}, false);
              radius = d->radius(Newmark{0.5, 1}, step);
              if (run) history = *run;
            },
            0.05, 3);
        study::Row row{.problem = "bar",
                       .method = "dual_reciprocity_" + basis_name + "_newmark_0.5_1",
                       .setting = fmt::format("elements=12 {} step={}", label, step),
                       .error = std::nullopt,
                       .cost = cost,
                       .condition = radius,
                       .status = study::Status::refused};
        if (history) {
          std::vector<double> u;
          for (const Vec2 v : history->displacement) u.push_back(v.y);
          row.error = rms(history->time, u);
          row.status = study::Status::converged;
        }
        study.add(row);
      }
    }
  }
  study.plot("bar-time", plot);
}

/// First frequency of the clamped column of Fu (2014) (Ritz: 35.4263 per second).
void add_frequency(study::Study& study) {
  const Material m = of_shear(4e4, 0.25, 1);
  study::Plot plot{.title = "column: error of the first frequency",
                   .x_label = "processor time (s)",
                   .y_label = "relative error",
                   .series = {}};
  for (std::size_t bubbles = 0; bubbles < 5; ++bubbles) {
    std::vector<std::pair<double, double>> points;
    for (const std::size_t k : study.quick() ? std::vector<std::size_t>{1} : std::vector<std::size_t>{1, 2, 4}) {
      Loop loop = polygon({{-1, 0}, {1, 0}, {1, 4}, {-1, 4}}, 0, k);
      loop[1].elements = loop[3].elements = 2 * k;
      double first = 0, condition = 0;
      const auto cost = study.measure(
          [&] {
            BlockOptions o;
            o.bubbles = bubbles;
            const BlockOperator b = BlockOperator::make({loop}, m, o).value();
            std::vector<HeldFreedom> held;
            for (std::size_t n = 0; n < b.mesh().nodes.size(); ++n) {
              if (b.mesh().nodes[n].x.y > -2 + 1e-9) continue;
              held.push_back({n, {1, 0}});
              held.push_back({n, {0, 1}});
            }
            const Modes modes = supported_modes(b, held);
            first = std::sqrt(modes.eigenvalues.front());
            condition = modes.eigenvalues.back() / modes.eigenvalues.front();
          },
          0.05, 5);
      const double error = std::abs(first / 35.4263 - 1);
      study.add({.problem = "column_frequency",
                 .method = "symmetric",
                 .setting = fmt::format("elements={} bubbles={}", 6 * k, bubbles),
                 .error = error,
                 .cost = cost,
                 .condition = condition,
                 .status = study::Status::converged});
      points.emplace_back(cost.cpu_s, error);
    }
    plot.series.push_back({.name = fmt::format("bubbles {}", bubbles), .points = points, .line = true, .fit = false});
  }
  study.plot("column-frequency", plot);
}

/// Initial stress by the cells of Fu (2014) and without them, from every node of a square: uniform stress, whose term
/// in the equations is exactly that of its tractions. Error: largest difference to that over the largest value.
void add_initial_stress(study::Study& study) {
  const Sym2 stress{-3, 0.7, -1};
  const Loop square = polygon({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, 0, 4);
  const Mesh mesh = make_mesh({square}, {});
  const Elastic elastic{1, nu};
  const auto field = [stress](Vec2) { return stress; };
  const auto term = [&](const std::function<Vec2(Vec2)>& by) {
    std::vector<Vec2> out;
    for (const Node& node : mesh.nodes) out.push_back(by(node.x));
    return out;
  };
  const auto exact = term([&](Vec2 y) { return initial_stress_by_boundary(mesh, y, elastic, field, 1e-14); });
  const auto row = [&](const std::string& method, const std::string& setting, const std::function<Vec2(Vec2)>& by) {
    std::vector<Vec2> values;
    const auto cost = study.measure([&] { values = term(by); }, 0.1);
    double worst = 0, size = 0;
    for (std::size_t n = 0; n < values.size(); ++n) {
      worst = std::max(worst, norm(values[n] - exact[n]));
      size = std::max(size, norm(exact[n]));
    }
    study.add({.problem = "initial_stress",
               .method = method,
               .setting = setting,
               .error = worst / size,
               .cost = cost,
               .condition = std::nullopt,
               .status = study::Status::converged});
    return std::pair{cost.cpu_s, std::max(worst / size, 1e-17)};
  };
  study::Series boundary{.name = "boundary only", .points = {}, .line = true, .fit = false};
  study::Series cells{.name = "cells", .points = {}, .line = true, .fit = false};
  for (const double target : {1e-4, 1e-7, 1e-10}) {
    boundary.points.push_back(row("boundary", fmt::format("elements=16 integration={:.0e}", target),
                                  [&](Vec2 y) { return initial_stress_by_boundary(mesh, y, elastic, field, target); }));
  }
  for (const std::size_t points : std::vector<std::size_t>{2, 4, 8, 16}) {
    cells.points.push_back(row("cells", fmt::format("cells=16 points={}x{}", points, points),
                               [&](Vec2 y) { return initial_stress_by_cells(mesh, y, elastic, field, points); }));
  }
  study.plot("initial-stress", {.title = "initial stress: error against run time",
                                .x_label = "processor time (s)",
                                .y_label = "relative error",
                                .series = {boundary, cells}});
}

/// A cantilever bent far by a force on its end (Bisshopp and Drucker 1945: P L^2 / E I = 2 takes the end down by
/// 0.49346 L), with operators rebuilt at smaller and smaller changes of the boundary's tangent; 0: never.
void add_rebuilding(study::Study& study) {
  BlockOptions o;
  o.bubbles = 0;
  Loop loop = polygon({{0, 0}, {10, 0}, {10, 0.5}, {0, 0.5}}, 0, 1);
  loop[0].elements = loop[2].elements = 12;
  const BlockOperator b =
      BlockOperator::make({loop}, Material::make(pascals(1e7), 0, kilograms_per_cubic_metre(1000)).value(), o).value();
  std::vector<HeldFreedom> held;
  for (std::size_t n = 0; n < b.mesh().nodes.size(); ++n) {
    if (b.mesh().nodes[n].x.x > -5 + 1e-9) continue;
    held.push_back({n, {1, 0}});
    held.push_back({n, {0, 1}});
  }
  std::vector<std::array<Vec2, 3>> end(b.mesh().elements.size());
  const double force = 2 * 1e7 * 0.125 / 12 / 100;
  for (std::size_t e = 0; e < end.size(); ++e) {
    if (b.mesh().elements[e].normal(0).x > 0.5) end[e].fill({0, -force / 0.5});
  }
  const Modes modes = supported_modes(b, held);
  const double w = std::sqrt(modes.eigenvalues.front());
  study::Series series{.name = "rebuilt", .points = {}, .line = true, .fit = false};
  for (const double gradient : study.quick() ? std::vector{0.0, 0.1} : std::vector{0.0, 0.2, 0.1, 0.05, 0.02, 0.01}) {
    double error = 0;
    std::size_t rebuilds = 0;
    const auto cost = study.measure(
        [&] {
          Vibration motion{b,
                           modes,
                           BackwardEuler{},
                           0.1 / w,
                           {.alpha = 2 * w},
                           {{b.forces_of(end), [w](double t) { return std::min(1.0, t * w / 20); }, false, {}}}};
          if (gradient > 0) motion.rebuild_by({gradient, o}, held, {});
          for (int k = 0; k < 500; ++k) (void)motion.advance();
          error = std::abs(-motion.displacement_at(b.place({5, 0})).y / 10 / 0.49346 - 1);
          rebuilds = motion.rebuilds();
        },
        0.05, 3);
    study.add({.problem = "elastica",
               .method = gradient == 0 ? "one_operator" : "rebuilt",
               .setting = fmt::format("elements=26 gradient={} rebuilds={}", gradient, rebuilds),
               .error = error,
               .cost = cost,
               .condition = std::nullopt,
               .status = study::Status::converged});
    if (gradient > 0) series.points.emplace_back(cost.cpu_s, error);
  }
  study.plot("elastica", {.title = "bent cantilever: error against run time",
                          .x_label = "processor time (s)",
                          .y_label = "relative error of the end's way down",
                          .series = {series}});
}

void study_bem(study::Study& study) {
  for (const Exact& exact : {kirsch(), lame(), cantilever(), gravity_column()}) add_statics(study, exact);
  add_bar(study);
  add_frequency(study);
  add_initial_stress(study);
  add_rebuilding(study);
}

}  // namespace
}  // namespace cleave

int main(int argc, char** argv) { return cleave::study::run("bem", argc, argv, cleave::study_bem); }
