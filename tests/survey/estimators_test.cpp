#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "cleave/core/rng.hpp"
#include "cleave/geometry/orientation.hpp"
#include "cleave/survey/analyse.hpp"
#include "cleave/survey/orientation.hpp"
#include "cleave/survey/traces.hpp"
#include "line.hpp"
#include "north_set.hpp"

// Worked examples of the literature and figures derived by hand; statistics at 4.5 standard errors.

namespace cleave::survey {
namespace {

using geometry::Vec3;
constexpr double pi = std::numbers::pi;

Vec3 fisher(Vec3 mean, double kappa, Rng& rng) {
  const Vec3 e1 = normalized(cross(mean, std::abs(mean.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0})), e2 = cross(mean, e1);
  const double versine = -std::log1p(rng.uniform() * std::expm1(-2 * kappa)) / kappa, psi = 2 * pi * rng.uniform();
  const double s = std::sqrt(versine * (2 - versine));
  return (1 - versine) * mean + s * (std::cos(psi) * e1 + std::sin(psi) * e2);
}

TEST(LineTest, FrequencyHasTheExactPoissonInterval) {
  const Estimate e = frequency(12, 20);
  EXPECT_DOUBLE_EQ(*e.value, 0.6);
  EXPECT_NEAR(e.low, 0.310029, 5e-7);
  EXPECT_NEAR(e.high, 1.048079, 5e-7);
  EXPECT_EQ(frequency(0, 20).low, 0);
}

TEST(LineTest, GapsOnShortLinesAreCorrected) {
  EXPECT_NEAR(mean_gap_share(2), 0.476812, 5e-7);
  EXPECT_NEAR(mean_gap_share(5), 0.760510, 5e-7);
  EXPECT_NEAR(mean_gap_share(20), 0.947368, 5e-7);
  // Lines of 5 mean spacings: the corrected frequency is right, the thesis's is 1.3 times too high.
  std::vector<double> gaps;
  Rng rng{1};
  for (int line = 0; line < 20000; ++line) {
    double last = -1;
    for (double at = -std::log(rng.uniform()); at < 5; at -= std::log(rng.uniform())) {
      if (last >= 0) gaps.push_back(at - last);
      last = at;
    }
  }
  EXPECT_NEAR(*frequency_from_gaps(gaps, 5).value, 1, 0.02);
  EXPECT_NEAR(*frequency_by_truncated_exponential(gaps, 5).value, 1.305, 0.03);
  EXPECT_FALSE(frequency_from_gaps(std::vector{3.0}, 5).value.has_value());
}

TEST(LineTest, RqdByHand) {
  EXPECT_NEAR(rqd_of_frequency(10), 73.575888, 5e-7);
  EXPECT_DOUBLE_EQ(rqd_measured(std::vector{0.05, 0.5, 0.2}, 1), 70);
  // Pieces of 0.1 m, as differences of positions in decimal numbers: all of them count, or none.
  std::vector<double> tenths;
  for (int k = 0; k < 100; ++k) tenths.push_back((k + 1) / 10.0 - k / 10.0);
  EXPECT_NEAR(rqd_measured(tenths, 10), 100, 1e-9);
}

TEST(LineTest, RqdCountsThePiecesAtTheEnds) {
  const auto pieces = pieces_of({4, 5.3, 4.7, 6}, 10);
  ASSERT_EQ(pieces.size(), 5U);
  const Estimate whole = rqd(pieces, 10);
  EXPECT_DOUBLE_EQ(whole.value.value(), 100);
  EXPECT_DOUBLE_EQ(whole.high, 100);
  EXPECT_LT(whole.low, 99);
  EXPECT_GT(whole.low, 90);
  // No joint at all is one piece; one joint near an end takes off what lies beyond it.
  EXPECT_DOUBLE_EQ(rqd(pieces_of({}, 10), 10).value.value(), 100);
  EXPECT_NEAR(rqd(pieces_of({9.95}, 10), 10).value.value(), 99.5, 1e-12);
  // Crushed throughout: none is kept, and the interval begins at 0.
  std::vector<double> crushed;
  for (int i = 1; i < 100; ++i) crushed.push_back(0.05 * i);
  const Estimate none = rqd(pieces_of(crushed, 5), 5);
  EXPECT_DOUBLE_EQ(none.value.value(), 0);
  EXPECT_GE(none.low, 0);
  EXPECT_GT(none.high, 1);
  EXPECT_LT(none.high, 20);
}

TEST(OrientationTest, WeightsByHand) {
  // 3 x 2 m horizontal window, disc of 2.4 m, plane 50/070: hits per P30 = sin V [D w h + pi/4 D^2 (w |sin| + h
  // |cos|)].
  const Vec3 n = geometry::upward_normal({Dip::degrees(50), DipDirection::degrees(70)});
  const double beta = 70 * pi / 180;  // trace along 160/340: angle to the east (w) side
  const double b = 3 * std::abs(std::cos(beta)) + 2 * std::abs(std::sin(beta));
  const double hits = 6 * 2.4 / window_weight(n, {0, 0, 1}, 2.4, 6, b);
  EXPECT_NEAR(hits, std::sin(50 * pi / 180) * (2.4 * 6 + pi / 4 * 2.4 * 2.4 * b), 1e-9);
  EXPECT_DOUBLE_EQ(terzaghi_weight({0, 0, 1}, {0, 0, 1}), 1);
  EXPECT_DOUBLE_EQ(terzaghi_weight({0, 0, 1}, {1, 0, 0}), 10);
  EXPECT_NEAR(std::acos(0.1) * 180 / pi, 84.260830, 5e-7);
}

// Joints of one Fisher law met by a line 60 degrees off its mean: without weights the mean is 6.6 degrees wrong.
TEST(OrientationTest, TerzaghiWeightsUndoTheBias) {
  const Vec3 mean{0, 0, 1}, line = normalized(Vec3{std::sqrt(3.0), 0, 1});
  Rng rng{2};
  std::vector<Vec3> met;
  std::vector<double> plain, weights;
  while (met.size() < 20000) {
    const Vec3 n = fisher(mean, 15, rng);
    if (rng.uniform() > std::abs(dot(n, line))) continue;
    met.push_back(n);
    plain.push_back(1);
    weights.push_back(terzaghi_weight(n, line));
  }
  const auto angle = [&](const FisherFit& fit) { return std::acos(std::abs(dot(fit.mean, mean))) * 180 / pi; };
  EXPECT_NEAR(angle(fit_fisher(met, plain)), 6.6, 0.5);
  const FisherFit corrected = fit_fisher(met, weights);
  EXPECT_LT(angle(corrected), 1.2);
  EXPECT_GT(corrected.capped, 100U);
}

// The cone is that of the law where joints are met so: a sample without the few heavy joints has no smaller one.
TEST(OrientationTest, ConeDoesNotHangOnHeavyJointsMet) {
  const double off = 64 * std::numbers::pi / 180, kappa = 10;
  const Vec3 line{std::sin(off), 0, std::cos(off)};
  Rng rng{5};
  std::vector<Vec3> normals;
  std::vector<double> weights;
  std::vector<Sampling> met{sampling_of({.normal = {}, .set = {}, .line = line, .window = {}})};
  while (normals.size() < 25) {
    const double c = 1 + std::log1p(rng.uniform() * std::expm1(-2 * kappa)) / kappa;
    const double psi = 2 * std::numbers::pi * rng.uniform(), s = std::sqrt(1 - c * c);
    const Vec3 n{s * std::cos(psi), s * std::sin(psi), c};
    if (dot(n, line) < 0.25 || rng.uniform() > dot(n, line)) continue;  // none of the heavy ones
    normals.push_back(n);
    weights.push_back(weight_of({.normal = n, .set = {}, .line = line, .window = {}}, 10));
  }
  met[0].joints = normals.size();
  const FisherFit blind = fit_fisher(normals, weights), fit = fit_fisher(normals, weights, 0.95, 10, met);
  EXPECT_FALSE(few_carry(blind));
  EXPECT_GT(fit.cone_degrees.value(), 1.2 * blind.cone_degrees.value());
  EXPECT_LT(fit.expected_count, blind.effective_count);
  // Equal weights: Fisher's own cone, met on whatever.
  const std::vector<double> equal(normals.size(), 1.0);
  EXPECT_EQ(fit_fisher(normals, equal, 0.95, 10, met).cone_degrees, fit_fisher(normals, equal).cone_degrees);
}

// One pole, or equal ones, say nothing of the spread.
TEST(OrientationTest, EqualPolesHaveNoCone) {
  const Vec3 pole = normalized(Vec3{1, 2, 3});
  for (const std::size_t joints : {1U, 2U, 5U}) {
    const FisherFit fit = fit_fisher(std::vector<Vec3>(joints, pole), std::vector<double>(joints, 1.5));
    EXPECT_FALSE(fit.cone_degrees.has_value());
    EXPECT_FALSE(fit.statistic.has_value());
    EXPECT_TRUE(std::isinf(fit.kappa));
  }
  const FisherFit two = fit_fisher(std::vector{pole, normalized(Vec3{1, 2, 2.9})}, std::vector<double>(2, 1.0));
  EXPECT_NEAR(two.cone_degrees.value(), 2.0, 0.1);  // Fisher's for two, 0.9 degrees apart
  EXPECT_FALSE(two.statistic.has_value());
}

TEST(OrientationTest, ConesAndKappaCover) {
  int cones = 0, kappas = 0, refused = 0;
  constexpr int runs = 1000;
  for (int r = 0; r < runs; ++r) {
    Rng rng{{.seed = 3, .realization = static_cast<std::uint64_t>(r)}};
    const Vec3 mean = geometry::upward_normal({Dip::degrees(60), DipDirection::degrees(210)});
    std::vector<Vec3> normals;
    for (int i = 0; i < 30; ++i) {
      const Vec3 n = fisher(mean, 20, rng);
      normals.push_back(i % 3 == 0 ? -n : n);  // axes: the sense says nothing
    }
    const FisherFit fit = fit_fisher(normals, std::vector<double>(30, 1.0));
    cones += std::acos(std::abs(dot(fit.mean, mean))) * 180 / pi <= fit.cone_degrees ? 1 : 0;
    kappas += fit.kappa_low <= 20 && 20 <= fit.kappa_high ? 1 : 0;
    refused += fit.fisher ? 0 : 1;
  }
  EXPECT_NEAR(cones, 0.95 * runs, 0.02 * runs);
  EXPECT_NEAR(kappas, 0.95 * runs, 0.02 * runs);
  EXPECT_LT(refused, 0.14 * runs);
}

TEST(OrientationTest, GirdlesAreNotFisher) {
  Rng rng{4};
  std::vector<Vec3> girdle;
  for (int i = 0; i < 100; ++i) {
    const double t = 0.9 * (rng.uniform() - 0.5) * pi;
    girdle.push_back(normalized(Vec3{std::sin(t), 0.05 * rng.normal(), std::cos(t)}));
  }
  EXPECT_FALSE(fit_fisher(girdle, std::vector<double>(100, 1.0)).fisher);
  const OrientationTensor tensor = orientation_tensor(girdle, std::vector<double>(100, 1.0));
  const BinghamFit bingham = fit_bingham(tensor);
  EXPECT_LT(bingham.k1, -50);
  EXPECT_GT(bingham.k2, -10);
}

// Poles close together are a normal law in the plane: E x^2 = 1 / (2 |k|). Found by fuzzing: the law fell between the
// rings of the integration, and k was not a number.
TEST(OrientationTest, BinghamOfPolesCloseTogether) {
  for (const double spread : {1e-2, 1e-4, 1e-6}) {
    OrientationTensor tensor;
    tensor.values = {1 - 3 * spread, 2 * spread, spread};
    const BinghamFit fit = fit_bingham(tensor);
    EXPECT_NEAR(fit.k1 * 2 * spread, -1, 4 * spread + 1e-3) << spread;
    EXPECT_NEAR(fit.k2 * 4 * spread, -1, 8 * spread + 1e-3) << spread;
  }
}

TEST(OrientationTest, ClustersAreFoundAndParallelJointsAreOneSet) {
  Rng rng{5};
  const std::array<Vec3, 3> means{Vec3{0, 0, 1}, normalized(Vec3{1, 0, 0.1}), normalized(Vec3{0, 1, 0.2})};
  std::vector<Vec3> normals;
  for (int i = 0; i < 300; ++i) normals.push_back(fisher(means[static_cast<std::size_t>(i % 3)], 60, rng));
  const Clustering three = cluster(normals, std::vector<double>(300, 1.0), 3);
  int wrong = 0;
  for (std::size_t i = 0; i < 300; ++i) {
    if (!three.set[i]) continue;
    wrong += std::abs(dot(three.centres[*three.set[i]], means[i % 3])) < 0.9 ? 1 : 0;
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(three.silhouette, cluster(normals, std::vector<double>(300, 1.0), 2).silhouette);
  EXPECT_GT(three.silhouette, cluster(normals, std::vector<double>(300, 1.0), 5).silhouette);
  const std::vector<Vec3> same(7, Vec3{0, 0, 1});
  EXPECT_EQ(cluster(same, std::vector<double>(7, 1.0), 2).set.size(), 7U);
  EXPECT_TRUE(std::isinf(fit_fisher(same, std::vector<double>(7, 1.0)).kappa));
}

TEST(OrientationTest, PolygonsOnTheNet) {
  const auto line = [](double trend, double plunge) {
    return geometry::line_vector({geometry::Trend::degrees(trend), geometry::Plunge::degrees(plunge)});
  };
  const std::vector<Vec3> square{line(80, 20), line(120, 20), line(120, 60), line(80, 60)};
  EXPECT_TRUE(pole_inside(line(100, 40), square));
  EXPECT_TRUE(pole_inside(-line(100, 40), square));
  EXPECT_FALSE(pole_inside(line(200, 40), square));
  // On the rim: level poles, at either end, and those just below it between two corners.
  const std::vector<Vec3> rim{line(60, 0), line(100, 0), line(100, 30), line(60, 30)};
  for (const double trend : {65.0, 80.0, 95.0, 245.0, 260.0}) EXPECT_TRUE(pole_inside(line(trend, 0), rim)) << trend;
  EXPECT_TRUE(pole_inside(line(80, 0.5), rim));
  EXPECT_TRUE(pole_inside(line(80, 29), rim));
  EXPECT_FALSE(pole_inside(line(80, 35), rim));
  EXPECT_FALSE(pole_inside(line(260, 5), rim));
  for (const double trend : {55.0, 105.0, 170.0}) EXPECT_FALSE(pole_inside(line(trend, 0), rim)) << trend;
}

TEST(OrientationTest, MeanCosinesByHand) {
  EXPECT_NEAR(mean_line_cosine({0, 0, 1}, 2, {0, 0, 1}), 0.619203, 2e-4);
  EXPECT_NEAR(mean_line_cosine({0, 0, 1}, 0, {1, 0, 0}), 0.5, 1e-3);
  EXPECT_NEAR(mean_plane_sine({0, 0, 1}, 0, {1, 0, 0}), pi / 4, 1e-3);
}

// Ten circles of 5 m pooled: n0 14, n1 132, n2 90.
TEST(TracesTest, CircleCountsByHand) {
  WindowCounts c;
  c.n0 = 14;
  c.n1 = 132;
  c.n2 = 90;
  c.crossings = 160;
  c.area = 10 * pi * 25;
  c.width = 100;
  c.radius = 50;
  c.sum_crossings2 = 4 * 14 + 132;
  c.sum_crossings_ends = 132;
  const Estimate e = mean_length_by_counts(c);
  EXPECT_NEAR(*e.value, 4.027683, 5e-7);
  // Delta method 0.165269 on the logarithm, with Student's t of 235 degrees of freedom for the normal quantile.
  EXPECT_NEAR(e.low, 4.027683 / std::exp(0.165269 * 1.970110 / 1.959964 * std::sqrt(236.0 / 235)), 1e-4);
  EXPECT_NEAR(e.high, 4.027683 * std::exp(0.165269 * 1.970110 / 1.959964 * std::sqrt(236.0 / 235)), 1e-4);
}

// One trace, or traces all alike, say nothing of how others scatter; the interval of few goes by Student's t.
TEST(TracesTest, FewTracesHaveNoNarrowInterval) {
  const PolygonWindow square{{{0, 0}, {5, 0}, {5, 5}, {0, 5}}};
  const auto of = [&](const std::vector<Polyline>& traces) {
    const WindowCounts c = count(square, seen_through(square, traces));
    return std::pair{mean_length(c), mean_length_by_counts(c)};
  };
  const Polyline one{{1, 1}, {2, 3}}, cut{{4, 4}, {6, 4}};
  using Map = std::vector<Polyline>;
  for (const Map& traces : {Map(1, one), Map(1, cut), Map(6, one), Map(6, cut)}) {
    const auto [sums, counts] = of(traces);
    EXPECT_TRUE(sums.value.has_value());
    EXPECT_FALSE(bounded(sums));
    EXPECT_TRUE(sums.note.contains(traces.size() == 1 ? "one trace says nothing" : "all alike")) << sums.note;
    EXPECT_EQ(counts.value.has_value(), traces[0] == cut);
    EXPECT_FALSE(counts.value && bounded(counts));
  }
  const Polyline half{{1, 1}, {1, 2}}, whole{{2, 1}, {2, 3}};  // S 3, m 4: (1/3 - 1/2)^2 + (2/3 - 1/2)^2 = 1/18
  const Estimate two = of({half, whole}).first;
  EXPECT_DOUBLE_EQ(*two.value, 1.5);
  EXPECT_NEAR(two.high, 1.5 * std::exp(12.706205 / 3), 1e-3);
  EXPECT_NEAR(two.low, 1.5 * std::exp(-12.706205 / 3), 1e-6);
}

// Given how many traces are seen, intervals of the mean hold it.
TEST(TracesTest, IntervalsOfFewTracesCover) {
  const PolygonWindow square{{{0, 0}, {2, 0}, {2, 2}, {0, 2}}};
  Rng rng{11};
  for (const std::size_t number : {2U, 3U, 5U, 10U}) {
    int hold = 0, told = 0;
    for (int run = 0; run < 1000; ++run) {
      std::vector<Polyline> traces;
      while (traces.size() < number) {
        const double l = -std::log(rng.uniform()), a = 0.4 + 0.3 * rng.normal(), reach = 12;
        const double x = 1 + reach * (rng.uniform() - 0.5), y = 1 + reach * (rng.uniform() - 0.5);
        Polyline trace{{x - l / 2 * std::cos(a), y - l / 2 * std::sin(a)},
                       {x + l / 2 * std::cos(a), y + l / 2 * std::sin(a)}};
        if (!seen_through(square, std::vector<Polyline>(1, trace)).empty()) traces.push_back(std::move(trace));
      }
      const Estimate e = mean_length(count(square, seen_through(square, traces)));
      if (!e.value) continue;
      ++told;
      hold += e.low <= 1 && 1 <= e.high ? 1 : 0;
    }
    EXPECT_GT(hold, 0.91 * told) << number;
  }
}

TEST(TracesTest, WindowsClipAndCountByHand) {
  const PolygonWindow square{{{0, 0}, {4, 0}, {4, 4}, {0, 4}}};
  const std::vector<Polyline> traces{{{1, 1}, {3, 1}},                 // both ends inside
                                     {{1, 2}, {9, 2}},                 // one end
                                     {{-1, 3}, {5, 3}},                // none
                                     {{-1, -1}, {-2, 5}},              // outside
                                     {{2, 2}, {2, 2}},                 // no length
                                     {{1, 3.5}, {5, 3.5}, {3, 3.8}}};  // out and back in
  const auto seen = seen_through(square, traces);
  ASSERT_EQ(seen.size(), 4U);
  EXPECT_DOUBLE_EQ(seen[0].length, 2);
  EXPECT_EQ(seen[0].ends, 2U);
  EXPECT_DOUBLE_EQ(seen[1].length, 3);
  EXPECT_EQ(seen[1].ends, 1U);
  EXPECT_DOUBLE_EQ(seen[2].length, 4);
  EXPECT_EQ(seen[2].ends, 0U);
  EXPECT_EQ(seen[2].crossings, 2U);
  EXPECT_EQ(seen[3].ends, 2U);
  EXPECT_EQ(seen[3].crossings, 2U);
  const WindowCounts c = count(square, seen);
  EXPECT_EQ(c.n0, 1U);
  EXPECT_EQ(c.n1, 1U);
  EXPECT_EQ(c.n2, 2U);
  EXPECT_DOUBLE_EQ(*p20(c).value, 5 / 32.0);
  EXPECT_DOUBLE_EQ(c.area, 16);
  const CircleWindow circle{{0, 0}, 2};
  const auto chord = seen_through(circle, std::vector<Polyline>{{{-5, 0}, {5, 0}}});
  EXPECT_DOUBLE_EQ(chord[0].length, 4);
  EXPECT_FALSE(p20(count(circle, chord)).value.has_value());
}

// A digitised map ends its traces at the window, but for rounding: with `border` it says the same as the whole traces.
TEST(TracesTest, AMapCutAtItsBorderCountsAsTheWholeOne) {
  constexpr double rounding = 1e-3;
  const auto rounded = [](double x) { return std::round(x / rounding) * rounding; };
  const std::vector<Window> windows{CircleWindow{{0, 0}, 5}, PolygonWindow{{{-5, -4}, {5, -4}, {5, 4}, {-5, 4}}}};
  for (const Window& window : windows) {
    Rng rng{{.seed = 9}};
    std::vector<Polyline> whole, cut;
    for (int i = 0; i < 1500; ++i) {
      const double l = -5 * std::log(rng.uniform()), angle = pi * rng.uniform();
      const MapPoint a{30 * (rng.uniform() - 0.5), 30 * (rng.uniform() - 0.5)};
      const MapPoint b{a.x + l * std::cos(angle), a.y + l * std::sin(angle)};
      // Where it lies inside, by bisection between many points: nothing of the library.
      double from = 2, to = -1;
      const int steps = 8000;
      for (int k = 0; k <= steps; ++k) {
        const double t = static_cast<double>(k) / steps;
        if (!holds(window, {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)})) continue;
        from = std::min(from, t);
        to = std::max(to, t);
      }
      if (!((to - from) * l > 0.1)) continue;
      if (std::min(distance_to_border(window, a), distance_to_border(window, b)) < 0.02) continue;
      whole.push_back({a, b});
      cut.push_back({{rounded(a.x + from * (b.x - a.x)), rounded(a.y + from * (b.y - a.y))},
                     {rounded(a.x + to * (b.x - a.x)), rounded(a.y + to * (b.y - a.y))}});
    }
    const WindowCounts all = count(window, seen_through(window, whole));
    const WindowCounts map = count(window, seen_through(window, cut, 0.01));
    ASSERT_GT(all.crossings, 60U);
    EXPECT_EQ(map.crossings, all.crossings);
    EXPECT_EQ(map.n0, all.n0);
    EXPECT_EQ(map.n1, all.n1);
    EXPECT_EQ(map.n2, all.n2);
    EXPECT_NEAR(mean_length_by_counts(map).value.value(), mean_length_by_counts(all).value.value(), 0.02);
  }
}

// Ends on the border, at a corner or on a side, are not inside; ends near it only when no border is stated.
TEST(TracesTest, EndsOnTheBorderAreCutOff) {
  const PolygonWindow triangle{{{0, 0}, {3, 1}, {1, 3}}};
  for (const MapPoint p : {MapPoint{0, 0}, {3, 1}, {1.5, 0.5}, {2, 2}, {0.75, 0.25}, {0.5, 1.5}}) {
    EXPECT_FALSE(holds(triangle, p)) << p.x << ' ' << p.y;
    EXPECT_EQ(distance_to_border(triangle, p), 0) << p.x << ' ' << p.y;
  }
  // One unit in the last place to either side of the side x = 3 y, where rounded products vanish.
  const double up = std::nextafter(0.25, 1), down = std::nextafter(0.25, 0);
  EXPECT_TRUE(holds(triangle, {0.75, up}));
  EXPECT_FALSE(holds(triangle, {0.75, down}));
  EXPECT_TRUE(holds(triangle, {4 / 3.0, 4 / 3.0}));
  EXPECT_FALSE(holds(triangle, {-1, -1 / 3.0}));  // on the line of a side, beyond its end
  EXPECT_NEAR(distance_to_border(triangle, {-3, -4}), 5, 1e-15);
  EXPECT_NEAR(distance_to_border(CircleWindow{{1, 1}, 2}, {1, 0}), 1, 1e-15);
  const PolygonWindow square{{{0, 0}, {4, 0}, {4, 4}, {0, 4}}};
  const std::vector<Polyline> traces{{{1, 1}, {4, 1}}, {{1, 2}, {3.9999, 2}}, {{0, 3}, {4, 3}}};
  const WindowCounts strict = count(square, seen_through(square, traces));
  EXPECT_EQ(strict.n0, 1U);
  EXPECT_EQ(strict.n1, 1U);
  EXPECT_EQ(strict.n2, 1U);
  const WindowCounts wide = count(square, seen_through(square, traces, 0.001));
  EXPECT_EQ(wide.n0, 1U);
  EXPECT_EQ(wide.n1, 2U);
  EXPECT_EQ(wide.n2, 0U);
}

TEST(TracesTest, NodesOfASmallMap) {
  const PolygonWindow square{{{0, 0}, {4, 0}, {4, 4}, {0, 4}}};
  // A cross, and one trace that ends on another.
  const std::vector<Polyline> traces{
      {{1, 1}, {3, 3}}, {{1, 3}, {3, 1}}, {{3.5, 0.5}, {3.5, 3.5}}, {{3, 3.2}, {3.5, 3.2}}};
  const Nodes n = nodes(square, traces, 1e-6);
  EXPECT_EQ(n.crossing, 1U);
  EXPECT_EQ(n.abutting, 1U);
  EXPECT_EQ(n.isolated, 7U);
  EXPECT_DOUBLE_EQ(n.connections.value.value(), 2 * 2 / 4.0);
}

TEST(FitTest, LawsComeBackFromTheirOwnSamples) {
  for (const Family family : {Family::exponential, Family::lognormal, Family::gamma, Family::power}) {
    Fit truth;
    truth.family = family;
    truth.a = family == Family::lognormal ? 0.7 : family == Family::gamma ? 2.5 : family == Family::power ? 2.2 : 3;
    truth.b = family == Family::lognormal ? 0.6 : 1.3;
    truth.min = 1;
    truth.max = 100;
    Rng rng{6};
    std::vector<double> x(20000);
    for (double& v : x) v = truth.quantile(rng.uniform());
    const auto fit = fit_complete(x, family, 0, 1);
    ASSERT_TRUE(fit.has_value());
    EXPECT_NEAR(fit->a, truth.a, 0.05 * truth.a) << name_of(family);
    EXPECT_NEAR(truth.below(truth.quantile(0.3)), 0.3, 1e-9) << name_of(family);
    EXPECT_NEAR(fit->moment(1), truth.moment(1), 0.05 * truth.moment(1)) << name_of(family);
    // E (X - x)+ as the integral of the survival function.
    double integral = 0;
    for (int i = 0; i < 400000; ++i) integral += (1 - truth.below(2 + (i + 0.5) * 1e-3)) * 1e-3;
    EXPECT_NEAR(truth.mean_excess(2), integral, 2e-3 * integral) << name_of(family);
  }
}

// Textbook Kolmogorov-Smirnov with fitted parameters never alarms; refitting in each resample keeps its level.
TEST(FitTest, BootstrapPValuesAreUniform) {
  int alarms = 0;
  constexpr int runs = 200;
  for (int r = 0; r < runs; ++r) {
    Rng rng{{.seed = 8, .realization = static_cast<std::uint64_t>(r)}};
    std::vector<double> x(40);
    for (double& v : x) v = -2 * std::log(rng.uniform());
    alarms += *fit_complete(x, Family::exponential, 99, 5)->p_value <= 0.1 ? 1 : 0;
  }
  EXPECT_NEAR(alarms, 0.1 * runs, 4.5 * std::sqrt(0.09 * runs));
}

// A circle of 3 m mapped to 1 cm: traces cut at it end up to 7 mm off. What takes them so is found from the ends,
// whatever the rounding; ends that are near by chance are no reason to say so.
TEST(TracesTest, EndsCutOffByTheBorderAreFound) {
  const CircleWindow circle{{0, 0}, 3};
  int false_alarms = 0;
  for (const double digit : {0.001, 0.01, 0.02, 0.0}) {  // 0: not cut
    int found = 0;
    for (std::uint64_t k = 0; k < 40; ++k) {
      Rng rng{{.seed = 31, .realization = k}};
      std::vector<Polyline> whole, map;
      for (int i = 0; i < 250; ++i) {
        const double l = 4 * rng.uniform(), x = 10 * (rng.uniform() - 0.5), y = 10 * (rng.uniform() - 0.5);
        if (std::abs(x) >= 3) continue;
        const double reach = std::sqrt(9 - x * x), low = std::max(y - l / 2, -reach), high = std::min(y + l / 2, reach);
        if (high - low < 0.05) continue;
        whole.push_back({{x, y - l / 2}, {x, y + l / 2}});
        const auto digitised = [&](double v) { return digit > 0 ? digit * std::round(v / digit) : v; };
        map.push_back({{digitised(x), digitised(low)}, {digitised(x), digitised(high)}});
      }
      if (digit == 0) {
        false_alarms += cut_off_by_border(circle, whole).ends > 0 ? 1 : 0;
        continue;
      }
      const CutOffEnds cut = cut_off_by_border(circle, map);
      const double truth = p21_by_crossings(count(circle, seen_through(circle, whole))).value.value();
      const double as_is = p21_by_crossings(count(circle, seen_through(circle, map))).value.value();
      const double told = p21_by_crossings(count(circle, seen_through(circle, map, cut.border.si()))).value.value();
      EXPECT_LT(as_is, 0.85 * truth);
      found += cut.ends > 0 && std::abs(told - truth) < 0.06 * truth ? 1 : 0;
      EXPECT_LT(cut.within.si(), 1.2 * digit) << digit;
    }
    if (digit > 0) {
      EXPECT_GE(found, 36) << digit;
    }
  }
  EXPECT_LE(false_alarms, 2);
}

// Traces that only a law of mostly tiny joints explains: a note says that mean size and P30 hang on the law.
TEST(AnalysisTest, SaysWhenTracesAndSizesDisagree) {
  const auto notes_of = [](double sigma) {
    WindowSurvey window{.name = "w",
                        .window = CircleWindow{{0, 0}, 60},
                        .normal = {0, 0, 1},
                        .x_axis = {1, 0, 0},
                        .traces = {},
                        .border = {},
                        .truncation = {}};
    Rng rng{{.seed = 21}};
    for (int i = 0; i < 250; ++i) {
      // Sizes of the joints met: in proportion to the size.
      const double u = rng.uniform(), l = std::exp(sigma * rng.normal()) * std::sqrt(1 - u * u);
      const double x = 80 * (rng.uniform() - 0.5), y = 80 * (rng.uniform() - 0.5);
      window.traces.push_back({{x, y - l / 2}, {x, y + l / 2}});
    }
    SurveyInput input;
    input.windows.push_back(std::move(window));
    input.rules.push_back(support::north_set());
    const SurveyResult result = analyse(input);
    return std::ranges::count_if(result.sets.front().notes,
                                 [](const std::string& note) { return note.contains("disagree"); });
  };
  EXPECT_EQ(notes_of(0.4), 0);
  EXPECT_EQ(notes_of(1.6), 1);
}

}  // namespace
}  // namespace cleave::survey
