/// Drawing of joints on one thread: items are joints. The answer is checked: the number drawn is Poisson with the mean
/// of the intensity, and the area per volume is what was asked for.

#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "cleave/dfn/sample.hpp"

namespace cleave::dfn {
namespace {

using geometry::Vec3;

/// About 100,000 joints: small ones in a large box, so that few are drawn in vain.
constexpr DomainBox box{{0, 0, 0}, {100, 100, 100}};

SizeLaw lognormal() {
  return SizeLaw::make({.distribution = SizeDistribution::lognormal,
                        .mean = metres(2),
                        .std = metres(1),
                        .exponent = {},
                        .min = metres(0.5),
                        .max = metres(8)})
      .value();
}

JointSet set_of(Shape shape) {
  const FisherOrientation fisher{Dip::degrees(40), DipDirection::degrees(120), 20};
  return JointSet::make({.orientation = fisher, .shape = std::move(shape), .intensity = P30{0.1}, .model = Baecher{}})
      .value();
}

double area_of(const geometry::Polygon& polygon) {
  const auto corners = polygon.corners();
  Vec3 sum;
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    sum += cross(corners[i] - corners[0], corners[i + 1] - corners[0]);
  }
  return norm(sum) / 2;
}

void draw(benchmark::State& state, const Shape& shape, bool polygons) {
  const JointSet set = set_of(shape);
  const double expected = expected_draws(set, box);
  std::uint64_t realization = 0, joints = 0;
  std::vector<SampledJoint> last;
  for (auto _ : state) {
    auto drawn = sample(set, 0, box, 1, realization++);
    if (!drawn) return state.SkipWithError(describe(drawn.error()).c_str());
    last = polygons ? with_polygons(*std::move(drawn)) : *std::move(drawn);
    joints += last.size();
  }
  // Centres in the box alone: area per volume there has no edge effect. Five standard errors of the sum of areas.
  double sum = 0, squares = 0;
  last = with_polygons(std::move(last));
  for (const SampledJoint& joint : last) {
    const Vec3 c = joint.centre;
    if (c.x < 0 || c.y < 0 || c.z < 0 || c.x > 100 || c.y > 100 || c.z > 100) continue;
    const double area = area_of(std::get<geometry::Polygon>(joint.shape));
    sum += area;
    squares += area * area;
  }
  if (std::abs(sum - set.expected_p32(1e6) * 1e6) > 5 * std::sqrt(squares)) {
    state.SkipWithError("joint area per volume is not what was asked for");
  }
  const double mean = static_cast<double>(joints) / static_cast<double>(realization);
  // Those drawn in the grown region that miss the box are few: between the count in the box and that of the region.
  if (mean > expected + 5 * std::sqrt(expected) || mean < 1e5 - 5 * std::sqrt(1e5)) {
    state.SkipWithError("not as many joints as the intensity says");
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(joints));
}

/// Discs as they are drawn: centre, axes, diameter.
void sample_discs(benchmark::State& state) {
  draw(state, Disc{.size = lognormal(), .sides = static_cast<std::uint32_t>(state.range(0))}, false);
}
BENCHMARK(sample_discs)->Arg(16)->Arg(32)->Unit(benchmark::kMillisecond);

/// And with their corners written out.
void sample_disc_polygons(benchmark::State& state) {
  draw(state, Disc{.size = lognormal(), .sides = static_cast<std::uint32_t>(state.range(0))}, true);
}
BENCHMARK(sample_disc_polygons)->Arg(16)->Arg(32)->Unit(benchmark::kMillisecond);

void sample_rectangles(benchmark::State& state) {
  draw(state, Rectangle{.size = lognormal(), .second = AspectRatio{2}}, false);
}
BENCHMARK(sample_rectangles)->Unit(benchmark::kMillisecond);

void sample_rectangle_polygons(benchmark::State& state) {
  draw(state, Rectangle{.size = lognormal(), .second = AspectRatio{2}}, true);
}
BENCHMARK(sample_rectangle_polygons)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace cleave::dfn
