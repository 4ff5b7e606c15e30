/// Study "contact_speed": the cost of a pass over fixed contact states in the condensed form, as one sparse system and
/// as Fu (2014) does it (blocks built anew, one dense system); and of whole steps of large scenes. `error` of a pass
/// is the largest difference of impulses from the sparse system's over the largest impulse, of a scene the worst
/// residual; `condition` is the number of contacts. Costs of scenes are a step's.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "../contact_suite/reference.hpp"
#include "cleave/dbem/world.hpp"
#include "elastic_body.hpp"
#include "study.hpp"

namespace cleave {
namespace {

using bem::Vec2;

double difference(const std::vector<Vec2>& a, const std::vector<Vec2>& b) {
  if (a.size() != b.size()) return INFINITY;
  double worst = 0, size = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    worst = std::max(worst, norm(a[k] - b[k]));
    size = std::max(size, norm(b[k]));
  }
  return worst / size;
}

/// Impulses sorted by size: the two sides list contacts in their own orders.
std::vector<Vec2> sorted(std::vector<Vec2> p) {
  for (Vec2& v : p) v = {norm(v), 0};
  std::ranges::sort(p, {}, &Vec2::x);
  return p;
}

void passes(study::Study& study, std::size_t side, std::size_t per_side, bool with_source, bool every_node = false) {
  const contact_suite::PassProblem problem{side, per_side, every_node};
  const auto size = problem.size();
  const std::string name = fmt::format("pass{}/{}x{}", every_node ? "_every_node" : "", size.blocks, size.freedoms);
  std::vector<Vec2> full, condensed, dense;
  const auto row = [&](const std::string& method, const study::Cost& cost, const std::vector<Vec2>& answer) {
    const double error = difference(sorted(answer), sorted(full));
    study.add({.problem = name,
               .method = method,
               .setting = fmt::format("contacts={}", size.contacts),
               .error = error,
               .cost = cost,
               .condition = static_cast<double>(size.contacts),
               .status = error < 1e-6 ? study::Status::converged : study::Status::stopped});
    return cost.cpu_s;
  };
  const auto cost_full = study.measure([&] { full = problem.sparse_full(); }, 0.5, 5);
  const auto cost_condensed = study.measure([&] { condensed = problem.condensed(); }, 0.5, 9);
  const double sparse_s = row("sparse_full", cost_full, full);
  const double ours = row("condensed", cost_condensed, condensed);
  fmt::print("{}: sparse system / condensed = {:.1f}\n", name, sparse_s / ours);
  if (!with_source) return;
  const double source = row("source", study.measure([&] { dense = problem.dense_full(true); }, 0, 1), dense);
  fmt::print("{}: source / condensed = {:.0f}\n", name, source / ours);
}

dbem::Body brick(bool elastic) {
  const std::vector<Vec2> corners{{0, 0}, {1, 0}, {1, 0.5}, {0, 0.5}};
  if (elastic) return support::elastic_body(corners, {.young = 1e10}, 1, 12);
  return dbem::Body{.name = "", .outline = corners, .density = 2600};
}

/// Leaning stacks of 25 bricks side by side on a floor.
std::vector<dbem::Body> stacks(std::size_t count, bool elastic) {
  dbem::Body floor{
      .name = "floor",
      .outline = {
          {-5, -1}, {2 * static_cast<double>(count) + 5, -1}, {2 * static_cast<double>(count) + 5, 0}, {-5, 0}}};
  floor.held = {true, true, true};
  std::vector<dbem::Body> bodies{floor};
  const dbem::Body one = brick(elastic);
  for (std::size_t s = 0; s < count; ++s) {
    for (std::size_t k = 0; k < 25; ++k) {
      bodies.push_back(one);
      bodies.back().origin +=
          Vec2{2 * static_cast<double>(s) + 0.02 * static_cast<double>((7 * k + s) % 5), 0.5 * static_cast<double>(k)};
    }
  }
  return bodies;
}

/// One group: a wall in running bond with open head joints.
std::vector<dbem::Body> wall(std::size_t rows, std::size_t columns, bool elastic) {
  const auto n = static_cast<double>(columns);
  dbem::Body floor{.name = "floor", .outline = {{-20, -1}, {1.1 * n + 20, -1}, {1.1 * n + 20, 0}, {-20, 0}}};
  floor.held = {true, true, true};
  std::vector<dbem::Body> bodies{floor};
  const dbem::Body one = brick(elastic);
  for (std::size_t r = 0; r < rows; ++r) {
    for (std::size_t k = 0; k + r % 2 < columns; ++k) {
      bodies.push_back(one);
      bodies.back().origin +=
          Vec2{1.002 * static_cast<double>(k) + (r % 2 == 1 ? 0.5 : 0.0), 0.5 * static_cast<double>(r)};
    }
  }
  return bodies;
}

void scene(study::Study& study, const std::string& name, std::vector<dbem::Body> bodies, dbem::WorldOptions options,
           std::size_t skipped, std::size_t steps) {
  const std::size_t count = bodies.size() - 1;
  dbem::Laws laws;
  laws.otherwise.friction = 0.5;
  auto world = dbem::World::make(std::move(bodies), laws, std::move(options));
  if (!world) {
    fmt::print(stderr, "error: {}\n", dbem::describe(world.error()));
    return;
  }
  double residual = 0, speed = 0;
  std::size_t contacts = 0, iterations = 0, asleep = 0;
  bool good = true;
  const auto advance = [&](std::size_t many) {
    for (std::size_t k = 0; k < many && good; ++k) {
      const auto report = world->step();
      good = report.has_value();
      if (!good) break;
      residual = std::max(residual, report->residual);
      speed = report->max_speed;
      contacts = report->contacts;
      iterations += report->iterations;
      asleep = report->asleep;
    }
  };
  advance(skipped);
  iterations = 0;
  study::Cost cost = study.measure([&] { advance(steps); }, 0, 1);
  const double each = 1 / static_cast<double>(steps);
  cost.wall_s *= each;
  cost.cpu_s *= each;
  study.add({.problem = fmt::format("{}/{}", name, count),
             .method = "cascade",
             .setting = fmt::format("contacts={} iterations={} speed={:.3g} asleep={}", contacts, iterations / steps,
                                    speed, asleep),
             .error = residual,
             .cost = cost,
             .condition = static_cast<double>(contacts),
             .status = good ? study::Status::converged : study::Status::stopped});
  fmt::print("{}/{}: {:.1f} steps a second, {:.1f} KB a block\n", name, count, 1 / cost.cpu_s,
             cost.peak_mb * 1e3 / static_cast<double>(count));
}

void study_speed(study::Study& study) {
  const bool quick = study.quick();
  if (!quick) {
    passes(study, 6, 2, false);
    passes(study, 6, 4, false);
    passes(study, 6, 8, false);
    passes(study, 6, 4, false, true);
    passes(study, 6, 8, false, true);
  }
  const std::size_t many = quick ? 8 : 400;
  const std::size_t fewer = quick ? 2 : 40;
  scene(study, "rigid_rest", stacks(many, false), {.step = 1e-3, .sleep = false}, 5, quick ? 2 : 10);
  scene(study, "rigid_asleep", stacks(many, false), {.step = 1e-3}, 20, quick ? 2 : 10);
  scene(study, "rigid_moving", stacks(many, false), {.gravity = {7, -9.81}, .step = 1e-3}, 2, quick ? 2 : 50);
  scene(study, "elastic_moving", stacks(fewer, true), {.gravity = {7, -9.81}, .step = 1e-3}, 2, quick ? 2 : 50);
  // One connected group each; the first step, from nothing, is a problem of its own.
  const std::size_t rows = quick ? 4 : 25, columns = quick ? 5 : 40;
  const Vec2 pushed{0.3 * 9.81, -9.81};
  scene(study, "wall_first_step", wall(rows, columns, false), {.gravity = pushed, .step = 1e-3}, 0, 1);
  scene(study, "wall_pushed", wall(rows, columns, false), {.gravity = pushed, .step = 1e-3}, 1, quick ? 2 : 30);
  scene(study, "elastic_wall", wall(rows, columns, true), {.step = 1e-3}, 1, quick ? 2 : 20);
  if (!quick) {
    // Beyond what friction holds: hundreds of joints slip at once.
    const Vec2 sliding{0.6 * 9.81, -9.81};
    scene(study, "sliding_first_step", wall(rows, columns, false), {.gravity = sliding, .step = 1e-3}, 0, 1);
    scene(study, "sliding_wall", wall(rows, columns, false), {.gravity = sliding, .step = 1e-3}, 1, 10);
    for (const auto& [name, share] : {std::pair{"wall_0.1g", 0.1}, std::pair{"wall_0.3g", 0.3}}) {
      const Vec2 leaning{share * 9.81, -9.81};
      scene(study, fmt::format("{}_first_step", name), wall(80, 125, false),
            {.gravity = leaning, .step = 1e-3, .sleep = false}, 0, 1);
      scene(study, name, wall(80, 125, false), {.gravity = leaning, .step = 1e-3, .sleep = false}, 1, 10);
    }
  }
  passes(study, quick ? 2 : 10, 3, true);  // that of Fu (2014) last: it takes long
}

}  // namespace
}  // namespace cleave

int main(int argc, char** argv) { return cleave::study::run("contact_speed", argc, argv, cleave::study_speed); }
