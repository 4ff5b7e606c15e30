/// Surfaces that are closed on paper, in doubles, turned, scaled, shifted, in any order, some polygons twice and some
/// again a little beside themselves, with `snap` and without: the parts they are known to make come out, and their
/// certificate passes.

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <utility>

#include "byte_source.hpp"
#include "closed_check.hpp"
#include "fuzz_target.hpp"

CLEAVE_FUZZ_TARGET(bytes) {
  using namespace cleave::support;
  ByteSource source{bytes};
  // The shape comes from a seed: numbers out of the bytes themselves could repeat, and cells of points on one line are
  // no cells.
  std::mt19937_64 random{(static_cast<std::uint64_t>(source.between(0, 0xFFFF)) << 16U) |
                         static_cast<std::uint64_t>(source.between(0, 0xFFFF))};
  const auto uniform = [&] { return static_cast<double>(random() >> 11U) * 0x1p-53; };
  const ClosedSet set = any_closed_set(uniform);
  ClosedTrial trial;
  trial.at = {{6 * uniform(), 6 * uniform(), 6 * uniform()}, std::pow(10, 9 * uniform() - 3), {}};
  if (source.flip()) trial.at.shift = {5e6, -3e6, 1e3};
  trial.polygons = placed(set, trial.at).polygons;
  trial.expected = set.parts + 1;
  trial.convex = set.convex;
  const std::size_t again = source.up_to(3);
  for (std::size_t k = 0; k < again; ++k)
    trial.polygons.push_back(trial.polygons[source.up_to(set.polygons.size() - 1)]);
  for (std::size_t k = trial.polygons.size(); k > 1; --k) {
    std::swap(trial.polygons[k - 1], trial.polygons[source.up_to(k - 1)]);
  }
  if (source.flip()) {
    // Some again, moved by less than `snap` joins.
    trial.convex = false;
    trial.snap = 1e-6 * trial.at.scale;
    const double by = 1e-8 * trial.at.scale;
    for (std::size_t k = source.up_to(2); k > 0; --k) {
      Corners copy = trial.polygons[source.up_to(trial.polygons.size() - 1)];
      for (auto& corner : copy) corner += by * cleave::geometry::Vec3{uniform(), uniform(), uniform()};
      trial.polygons.push_back(std::move(copy));
    }
  }
  const auto fault = fault_of(trial);
  if (!fault || fault->empty()) return;
  std::fputs((set.name + ": " + *fault + "\n").c_str(), stderr);
  std::abort();
}
