#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "cleave/core/rng.hpp"
#include "cleave/survey/analyse.hpp"
#include "cleave/survey/orientation.hpp"
#include "cleave/survey/traces.hpp"
#include "line.hpp"

// Coverage of the intervals that are not of round_trip_test: 95 % ones over 1,000 samples of known laws hold the truth
// in 930 to 970 (2.9 standard errors to either side: a right interval fails one such bound once in 260, and the seeds
// are fixed).

namespace cleave::survey::interval_test {
namespace {

using geometry::Vec3;
constexpr double pi = std::numbers::pi;
constexpr std::uint64_t samples = 1000;

struct Covered {
  std::string name;
  double truth = 0;
  int count = 0;
  void look(double low, double high) { count += low <= truth && truth <= high ? 1 : 0; }
  void look(const Estimate& e) {
    ASSERT_TRUE(e.value.has_value()) << name << ": " << e.note;
    look(e.low, e.high);
  }
  void expect() const {
    testing::Test::RecordProperty(name, count);
    EXPECT_GE(count, 930) << name;
    EXPECT_LE(count, 970) << name;
  }
};

/// Uniform on the sphere, kept with probability exp(k1 x^2 + k2 y^2).
Vec3 bingham_draw(double k1, double k2, Rng& rng) {
  for (;;) {
    const double z = 2 * rng.uniform() - 1, a = 2 * pi * rng.uniform(), r = std::sqrt(1 - z * z);
    const double x = r * std::cos(a), y = r * std::sin(a);
    if (std::log(rng.uniform()) < k1 * x * x + k2 * y * y) return {x, y, z};
  }
}

TEST(IntervalTest, BinghamsParametersAndEigenvaluesAreCovered) {
  for (const auto& [k1, k2] : {std::array{-30.0, -8.0}, std::array{-20.0, -2.0}, std::array{-60.0, -15.0}}) {
    const std::string law = std::to_string(static_cast<int>(-k1)) + "_" + std::to_string(static_cast<int>(-k2));
    Covered first{"k1_of_" + law, k1}, second{"k2_of_" + law, k2};
    std::array<double, 3> moments{};
    std::vector<std::array<std::array<double, 2>, 3>> tensors;
    for (std::uint64_t k = 0; k < samples; ++k) {
      Rng rng{{.seed = 31, .realization = k}};
      std::vector<Vec3> normals;
      for (int i = 0; i < 120; ++i) {
        normals.push_back(bingham_draw(k1, k2, rng));
        const Vec3 n = normals.back();
        moments[0] += n.z * n.z;
        moments[1] += n.y * n.y;
        moments[2] += n.x * n.x;
      }
      const std::vector<double> weights(normals.size(), 1.0);
      const BinghamFit fit = fit_bingham(normals, weights);
      EXPECT_LE(fit.first[0], fit.k1);
      EXPECT_GE(fit.second[1], fit.k2);
      first.look(fit.first[0], fit.first[1]);
      second.look(fit.second[0], fit.second[1]);
      tensors.push_back(tensor_intervals(orientation_tensor(normals, weights), normals, weights));
    }
    first.expect();
    second.expect();
    for (std::size_t i = 0; i < 3; ++i) {
      Covered value{"eigenvalue_" + std::to_string(i + 1) + "_of_" + law, moments.at(i) / (120.0 * samples)};
      for (const auto& t : tensors) value.look(t.at(i)[0], t.at(i)[1]);
      value.expect();
    }
  }
}

// Weights against a bias scatter more than equal ones: joints met by a line, weighted as Terzaghi says.
TEST(IntervalTest, BinghamsParametersAreCoveredUnderWeights) {
  const Vec3 line = normalized(Vec3{0.3, 0.4, 1});
  Covered first{"k1_weighted", -25}, second{"k2_weighted", -9};
  for (std::uint64_t k = 0; k < samples; ++k) {
    Rng rng{{.seed = 32, .realization = k}};
    std::vector<Vec3> normals;
    std::vector<double> weights;
    while (normals.size() < 200) {
      const Vec3 n = bingham_draw(-25, -9, rng);
      if (rng.uniform() > std::abs(dot(n, line))) continue;
      normals.push_back(n);
      weights.push_back(terzaghi_weight(n, line));
    }
    const BinghamFit fit = fit_bingham(normals, weights);
    first.look(fit.first[0], fit.first[1]);
    second.look(fit.second[0], fit.second[1]);
  }
  first.expect();
  second.expect();
}

/// Traces of exponential length in two directions about a circle; with `abut` half of them end where they first meet an
/// older one.
std::vector<Polyline> random_traces(std::uint64_t k, bool abut) {
  Rng rng{{.seed = 33, .realization = k}};
  std::vector<Polyline> traces;
  const auto number = static_cast<int>(std::lround(300 + std::sqrt(300.0) * rng.normal()));
  for (int i = 0; i < number; ++i) {
    const double l = -2.5 * std::log(rng.uniform()), angle = (rng.uniform() < 0.5 ? 0.3 : 1.7) + 0.3 * rng.normal();
    const MapPoint a{24 * (rng.uniform() - 0.5), 24 * (rng.uniform() - 0.5)};
    double reach = 1;
    if (abut && rng.uniform() < 0.5) {
      for (const Polyline& t : traces) {
        const MapPoint d{l * std::cos(angle), l * std::sin(angle)}, e{t[1].x - t[0].x, t[1].y - t[0].y};
        const MapPoint f{t[0].x - a.x, t[0].y - a.y};
        const double det = d.x * e.y - d.y * e.x;
        const double u = (f.x * e.y - f.y * e.x) / det, v = (f.x * d.y - f.y * d.x) / det;
        if (v > 0 && v < 1 && u > 0) reach = std::min(reach, u);
      }
    }
    traces.push_back({a, {a.x + reach * l * std::cos(angle), a.y + reach * l * std::sin(angle)}});
  }
  return traces;
}

TEST(IntervalTest, ConnectionsPerTraceAreCovered) {
  const CircleWindow circle{{0, 0}, 7};
  for (const bool abut : {false, true}) {
    Covered connections{abut ? "connections_abutting" : "connections_crossing"};
    std::vector<Estimate> all;
    double met = 0, ends = 0;
    for (std::uint64_t k = 0; k < samples; ++k) {
      const Nodes n = nodes(circle, random_traces(k, abut), 1e-6);
      met += static_cast<double>(n.abutting + n.crossing);
      ends += static_cast<double>(n.isolated + n.abutting);
      all.push_back(n.connections);
    }
    connections.truth = 4 * met / ends;
    for (const Estimate& e : all) connections.look(e);
    connections.expect();
  }
}

TEST(IntervalTest, NoConnectionHasAnUpperBound) {
  const CircleWindow circle{{0, 0}, 7};
  const std::vector<Polyline> apart{{{0, 0}, {1, 0}}, {{0, 1}, {1, 1}}};
  const Estimate none = nodes(circle, apart, 1e-6).connections;
  EXPECT_EQ(none.value.value(), 0);
  EXPECT_NEAR(none.high, -std::log(0.025), 1e-12);  // 4 nodes for 4 ends
  EXPECT_FALSE(nodes(circle, std::vector<Polyline>{}, 1e-6).connections.value.has_value());
}

// Steep joints leave traces on level ground: direction, alignment, and the concentration of the joints.
TEST(IntervalTest, DirectionsOfTracesAreCovered) {
  constexpr double kappa = 50;
  Covered direction{"direction", 35}, concentration{"kappa_of_traces", kappa}, alignment{"alignment"};
  std::vector<Estimate> alignments;
  double c = 0, sum = 0;
  for (std::uint64_t k = 0; k < samples; ++k) {
    Rng rng{{.seed = 34, .realization = k}};
    std::vector<WeightedAxis> axes;
    for (int i = 0; i < 120; ++i) {
      const double versine = -std::log1p(rng.uniform() * std::expm1(-2 * kappa)) / kappa, psi = 2 * pi * rng.uniform();
      const double sine = std::sqrt(versine * (2 - versine));
      const double off = std::atan2(sine * std::cos(psi), 1 - versine);  // of the horizontal part
      const double length = std::exp(0.6 * rng.normal());
      axes.push_back({35 * pi / 180 + off + (rng.uniform() < 0.5 ? pi : 0), length});
      c += length * std::cos(2 * off);
      sum += length;
    }
    const MeanAxis mean = mean_axis(axes);
    direction.look(mean.direction);
    concentration.look(mean.kappa);
    alignments.push_back(mean.alignment);
  }
  alignment.truth = c / sum;
  for (const Estimate& e : alignments) alignment.look(e);
  direction.expect();
  concentration.expect();
  alignment.expect();
}

TEST(IntervalTest, DirectionsOfFewTraces) {
  const MeanAxis one = mean_axis(std::vector<WeightedAxis>{{0.3, 2}});
  EXPECT_NEAR(one.direction.value.value(), 0.3 * 180 / pi, 1e-12);
  EXPECT_EQ(one.direction.high - one.direction.low, 180);
  EXPECT_EQ(one.alignment.low, 0);
  EXPECT_TRUE(std::isinf(one.kappa.high));
  EXPECT_FALSE(mean_axis(std::vector<WeightedAxis>{}).direction.value.has_value());
  // Evenly round: no direction is preferred.
  std::vector<WeightedAxis> round;
  for (int i = 0; i < 36; ++i) round.push_back({pi * i / 36, 1});
  EXPECT_EQ(mean_axis(round).alignment.low, 0);
  EXPECT_NEAR(mean_axis(round).direction.high - mean_axis(round).direction.low, 180, 1e-9);
}

// Spacings: mean, standard deviation and the parameters themselves.
TEST(IntervalTest, LawsOfSpacingsAreCovered) {
  for (const Family family : {Family::exponential, Family::lognormal, Family::gamma}) {
    Fit truth;
    truth.family = family;
    truth.a = family == Family::lognormal ? -0.5 : family == Family::gamma ? 2 : 0.4;
    truth.b = family == Family::lognormal ? 0.6 : 0.3;
    const std::string law{name_of(family)};
    Covered mean{"mean_spacing_" + law, truth.moment(1)}, spread{"std_spacing_" + law, std_of(truth)};
    std::array<Covered, 2> parameters{Covered{"a_" + law, truth.a}, Covered{"b_" + law, truth.b}};
    for (std::uint64_t k = 0; k < samples; ++k) {
      Rng rng{{.seed = 35, .realization = k}};
      std::vector<double> gaps(100);
      for (double& g : gaps) g = truth.quantile(rng.uniform());
      const auto fit = fit_complete(gaps, family, 0, 1);
      ASSERT_TRUE(fit.has_value());
      mean.look(estimate_of(*fit, "mean", [](const Fit& f) { return f.moment(1); }));
      spread.look(estimate_of(*fit, "std", [](const Fit& f) { return std_of(f); }));
      const std::vector<Estimate> own = parameters_of(*fit);
      ASSERT_EQ(own.size(), family == Family::exponential ? 1U : 2U);
      for (std::size_t i = 0; i < own.size(); ++i) parameters.at(i).look(own[i]);
    }
    mean.expect();
    spread.expect();
    parameters[0].expect();
    if (family != Family::exponential) parameters[1].expect();
  }
}

// A line far off the mean: joints nearly along it are few and heavy.
TEST(IntervalTest, ConesOfWeightedMeansAreCovered) {
  struct Case {
    double off, kappa;
    std::size_t joints;
  };
  for (const auto& [off, kappa, joints] :
       {Case{64, 10, 12}, Case{64, 10, 25}, Case{64, 10, 60}, Case{64, 10, 200}, Case{75, 40, 25}, Case{75, 40, 200}}) {
    const Vec3 line{std::sin(off * pi / 180), 0, std::cos(off * pi / 180)};
    int held = 0, light = 0, held_light = 0;
    std::vector<Sampling> met{sampling_of({.normal = {}, .set = {}, .line = line, .window = {}})};
    met[0].joints = joints;
    for (std::uint64_t k = 0; k < samples; ++k) {
      Rng rng{{.seed = 37, .realization = k}};
      std::vector<Vec3> normals;
      std::vector<double> weights;
      while (normals.size() < joints) {
        const double c = 1 + std::log1p(rng.uniform() * std::expm1(-2 * kappa)) / kappa, psi = 2 * pi * rng.uniform();
        const double s = std::sqrt(1 - c * c);
        const Vec3 n{s * std::cos(psi), s * std::sin(psi), c};
        if (rng.uniform() > std::abs(dot(n, line))) continue;
        normals.push_back(n.z < 0 ? -n : n);
        weights.push_back(weight_of({.normal = normals.back(), .set = {}, .line = line, .window = {}}, 10));
      }
      const FisherFit fit = fit_fisher(normals, weights, 0.95, 10, met);
      const bool holds = std::acos(std::min(1.0, fit.mean.z)) * 180 / pi <= fit.cone_degrees;
      held += holds ? 1 : 0;
      // Samples that met none of the heavy joints look as if all counted alike.
      if (fit.effective_count < 0.75 * static_cast<double>(joints)) continue;
      ++light;
      held_light += holds ? 1 : 0;
    }
    const std::string name = "cone_" + std::to_string(std::lround(off)) + "_" + std::to_string(std::lround(kappa)) +
                             "_" + std::to_string(joints);
    RecordProperty(name, held);
    RecordProperty(name + "_light", light);
    RecordProperty(name + "_held_light", held_light);
    EXPECT_GE(held, 930) << name;
    EXPECT_LE(held, 975) << name;
    if (light < 0.2 * samples) continue;
    EXPECT_GE(held_light, light * 0.9 - 2.5 * std::sqrt(light * 0.09)) << name;
  }
}

// Poisson lines against Priest & Hudson's value. Where less than one short piece is expected the interval is that of a
// rare event: it covers more.
TEST(IntervalTest, RqdIsCovered) {
  for (const double length : {10.0, 50.0}) {
    for (const double lambda : {0.5, 2.0, 5.0, 10.0, 20.0, 40.0}) {
      Covered share{"rqd_" + std::to_string(std::lround(10 * lambda)) + "_" + std::to_string(std::lround(length)),
                    rqd_of_frequency(lambda)};
      for (std::uint64_t k = 0; k < samples; ++k) {
        Rng rng{{.seed = 36, .realization = k}};
        std::vector<double> positions;
        for (double at = -std::log(rng.uniform()) / lambda; at < length; at -= std::log(rng.uniform()) / lambda) {
          positions.push_back(at);
        }
        share.look(rqd(pieces_of(positions, length), length));
      }
      RecordProperty(share.name, share.count);
      EXPECT_GE(share.count, 930) << share.name;
      EXPECT_LE(share.count, 0.1 * lambda * lambda * length < 3 ? 1000 : 975) << share.name;
    }
  }
}

TEST(IntervalTest, FrequencyOfTheThesisHasItsInterval) {
  const std::vector<double> gaps{0.3, 0.9, 0.2, 0.7, 0.4, 1.1};
  const Estimate e = frequency_by_truncated_exponential(gaps, 5);
  EXPECT_LT(e.low, e.value.value());
  EXPECT_GT(e.high, e.value.value());
}

}  // namespace
}  // namespace cleave::survey::interval_test
