/// Blocks in motion by the ten thousand: stacks at rest, cubes that slide, columns that fall, a rock asleep in which a
/// few blocks slide. One thread, and where said two. Answers checked.

#include <benchmark/benchmark.h>

#include <chrono>
#include <cmath>
#include <utility>
#include <vector>

#include "cleave/motion/world.hpp"
#include "shapes.hpp"

namespace cleave {
namespace {

using namespace motion;
using motion::shapes::box;

BodySpec cube(double x, double y, double z, Vec3 velocity = {}) {
  return {
      .shape = box({x, y, z}, {x + 1, y + 1, z + 1}), .density = kilograms_per_cubic_metre(2600), .velocity = velocity};
}
BodySpec floor(double half) { return {.shape = box({-half, -half, -1}, {half, half, 0}), .fixed = true}; }

/// `side` x `side` stacks.
std::vector<BodySpec> stacks(int side, int height, double gap = 0, double drop = 0) {
  std::vector<BodySpec> out;
  for (int k = 0; k < side * side; ++k) {
    for (int z = 0; z < height; ++z) out.push_back(cube(2 * (k % side), 2 * (k / side), drop + z * (1 + gap)));
  }
  out.push_back(floor(2 * side + 100));
  return out;
}

double reaction(const World& w) {
  double sum = 0;
  const std::size_t wall = w.size() - 1;
  for (const Contact& c : w.contacts()) sum += (c.other == wall ? 1 : c.body == wall ? -1 : 0) * c.force.z;
  return sum;
}

void steps(benchmark::State& state, World& w, int count, bool& fine) {
  for (int k = 0; k < count; ++k) fine = fine && w.step().has_value();
  state.SetItemsProcessed(state.items_processed() + count);
}

/// 10,000 cubes in 400 stacks that are not let sleep, by what scenes accept; the first step is counted apart.
void stacks_at_rest(benchmark::State& state) {
  const int height = static_cast<int>(state.range(0));
  WorldOptions options{.step = 0.01, .sleep = false};
  options.solver.accept = 1e-5;
  auto made = World::make({.bodies = stacks(20, height), .surfaces = {{0.5, 0}}}, options);
  bool fine = made.has_value();
  const auto before = std::chrono::steady_clock::now();
  fine = fine && made->step().has_value();
  state.counters["first_s"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
  for (auto _ : state) {
    if (fine) steps(state, *made, 10, fine);
  }
  const double weight = 400 * height * 2600 * 9.81;
  if (!fine || std::abs(reaction(*made) / weight - 1) > 1e-6) state.SkipWithError("the stacks do not rest");
}
BENCHMARK(stacks_at_rest)->Arg(25)->Unit(benchmark::kMillisecond)->Iterations(1);

/// Cubes on the level, each for itself, slower by the same.
void cubes_slide(benchmark::State& state) {
  const int side = static_cast<int>(state.range(0));
  const auto threads = static_cast<unsigned>(state.range(1));
  std::vector<BodySpec> bodies = stacks(side, 1);
  for (BodySpec& b : bodies) b.velocity = b.fixed ? Vec3{} : Vec3{2, 1, 0};
  auto made = World::make({.bodies = std::move(bodies), .surfaces = {{0.3, 0}}}, {.step = 0.01, .threads = threads});
  bool fine = made.has_value();
  for (auto _ : state) {
    if (fine) steps(state, *made, 20, fine);
  }
  const double left = fine ? std::sqrt(5) - 0.3 * 9.81 * made->time() : 0;
  for (std::size_t b = 0; fine && b + 1 < made->size(); ++b) fine = std::abs(norm(made->velocity(b)) - left) < 1e-6;
  if (!fine) state.SkipWithError("not the speed of a slide");
}
BENCHMARK(cubes_slide)->Args({100, 1})->Args({100, 2})->Unit(benchmark::kMillisecond)->Iterations(1)->UseRealTime();

/// Smooth columns with gaps that come down: the last cube has landed after 0.78 s, and all energy is lost.
void columns_fall(benchmark::State& state) {
  const int side = static_cast<int>(state.range(0)), height = static_cast<int>(state.range(1));
  const auto threads = static_cast<unsigned>(state.range(2));
  auto made = World::make({.bodies = stacks(side, height, 0.01, 2)}, {.step = 0.01, .threads = threads});
  bool fine = made.has_value();
  double count = 0;
  for (auto _ : state) {
    while (fine && made->time() < 0.9) {
      fine = made->step().has_value();
      ++count;
    }
  }
  state.counters["steps"] = count;
  const double fall = side * side * 2600 * 9.81 * (2.0 * height + 0.005 * height * (height - 1));
  const double lost = fine ? made->energy().lost + made->energy().friction : 0;
  if (!fine || std::abs(lost / fall - 1) > 1e-6) state.SkipWithError("not all that they fell is lost");
}
BENCHMARK(columns_fall)
    ->Args({10, 20, 1})
    ->Args({10, 100, 1})
    ->Args({10, 100, 2})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1)
    ->UseRealTime();

/// Cubes that sleep, and ten that slide far from them.
void asleep(benchmark::State& state) {
  const int side = static_cast<int>(state.range(0));
  std::vector<BodySpec> bodies = stacks(side, 5);
  for (int k = 0; k < 10; ++k) bodies.push_back(cube(2 * k, -50, 0, {0, -50, 0}));
  auto made = World::make({.bodies = std::move(bodies), .surfaces = {{0.1, 0}}}, {.step = 0.01});
  bool fine = made.has_value();
  for (int k = 0; fine && k < 15; ++k) fine = made->step().has_value();
  const std::size_t still = static_cast<std::size_t>(5 * side * side);
  for (std::size_t b = 0; fine && b < still; ++b) fine = made->asleep(b);
  const Vec3 place = fine ? made->displacement(0) : Vec3{};
  for (auto _ : state) {
    if (fine) steps(state, *made, 100, fine);
  }
  if (!fine || made->displacement(0) != place || !(norm(made->velocity(made->size() - 1)) > 1)) {
    state.SkipWithError("not asleep, or nothing slides");
  }
}
BENCHMARK(asleep)->Arg(100)->Unit(benchmark::kMillisecond)->Iterations(1);

}  // namespace
}  // namespace cleave
