#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "cleave/core/rng.hpp"
#include "cleave/geometry/orientation.hpp"
#include "cleave/survey/analyse.hpp"
#include "lines_and_windows.hpp"
#include "north_set.hpp"

// What is made of lines and windows together, against rock whose figures are known.

namespace cleave::survey {
namespace {

using geometry::Vec3;

Vec3 plane(double dip, double direction) {
  return geometry::upward_normal({Dip::degrees(dip), DipDirection::degrees(direction)});
}
std::string all_notes(const SetResult& set) {
  std::string text;
  for (const std::string& note : set.notes) text += note + "\n";
  return text;
}
MeasuredOrientation measured(Vec3 normal, std::optional<Vec3> line = {}) { return {normal, "a", line, {}}; }

/// A line along x that meets joints across it at these places.
LineSurvey straight(SurveyInput& input, const std::string& name, double length, const std::vector<double>& places) {
  LineSurvey line{.name = name, .pieces = {{Vec3{1, 0, 0}, length}}, .positions = places, .lengths = {}};
  for (std::size_t i = 0; i < places.size(); ++i) {
    line.joints.emplace_back(input.orientations.size());
    input.orientations.push_back(measured(plane(88 + static_cast<double>(i % 3), 90), Vec3{1, 0, 0}));
  }
  return line;
}
std::vector<double> every(double spacing, std::size_t number) {
  std::vector<double> places;
  for (std::size_t i = 0; i < number; ++i) places.push_back(spacing * (static_cast<double>(i) + 0.5));
  return places;
}

// One reading of a compass does not undo what is stated of a set; five do, and it is said how far apart both are.
TEST(AnalysisTest, FewJointsMeasuredLeaveTheStatedOrientation) {
  const auto with = [](std::size_t joints) {
    SurveyInput input;
    input.rules.push_back({.name = "a",
                           .polygon = {},
                           .azimuth = {},
                           .dip = Dip::degrees(80),
                           .dip_direction = DipDirection::degrees(90),
                           .kappa = 20,
                           .shape = {}});
    for (std::size_t i = 0; i < joints; ++i) {
      input.orientations.push_back(measured(plane(55, 93 + static_cast<double>(i))));
    }
    return analyse(input).sets.at(0);
  };
  const SetResult one = with(1), five = with(5), none = with(0);
  EXPECT_TRUE(one.orientation_stated);
  EXPECT_EQ(one.joints, 1U);
  EXPECT_EQ(one.orientation.kappa, 20);
  EXPECT_NEAR(std::abs(dot(one.orientation.mean, plane(80, 90))), 1, 1e-12);
  EXPECT_TRUE(
      all_notes(one).contains("the orientation stated, 80/090, stands: one joint was measured (mean 55/093, 25 "
                              "degrees off it), and 5 or more take its place"))
      << all_notes(one);
  EXPECT_FALSE(all_notes(none).contains("stands"));
  EXPECT_FALSE(five.orientation_stated);
  EXPECT_NEAR(std::abs(dot(five.orientation.mean, plane(55, 95))), 1, 1e-3);
  EXPECT_TRUE(
      all_notes(five).contains("that of the 5 joints measured, 55/095; the one stated, 80/090, 25 degrees off "
                               "it, is not used"))
      << all_notes(five);
}

// Planes one metre apart, met by a line that bends: each piece by its own angle.
TEST(AnalysisTest, SpacingsOnBentLinesAreThoseOfThePlanes) {
  SurveyInput input;
  LineSurvey line{.name = "bent",
                  .pieces = {{Vec3{1, 0, 0}, 10}, {Vec3{0.5, std::sqrt(0.75), 0}, 20}, {Vec3{1, 0, 0}, 10}},
                  .positions = {},
                  .lengths = {}};
  for (int i = 0; i < 30; ++i) {
    const double x = i + 0.5, place = x < 10 ? x : x < 20 ? 10 + 2 * (x - 10) : x + 10;
    line.positions.push_back(place);
    line.joints.emplace_back(input.orientations.size());
    input.orientations.push_back(measured({1, 0, 0}, line.direction_at(place)));
  }
  input.lines.push_back(line);
  const SetResult set = analyse(input).sets.at(0);
  ASSERT_EQ(set.gaps.size(), 29U);
  for (const double gap : set.gaps) EXPECT_NEAR(gap, 1, 1e-12);
  EXPECT_NEAR(*set.p10_normal->value, 1, 1e-3);
}

// A line well off the mean normal of a scattered set: what it meets is turned to the mean normal by Fisher's law.
TEST(AnalysisTest, FrequencyAlongTheMeanNormalIsThatOfTheLaw) {
  // Poles of a law about the z axis: kappa 8; joints are met in proportion to |n.l|.
  Rng rng{{.seed = 3}};
  const Vec3 mean{0, 0, 1}, along{std::sin(1.4), 0, std::cos(1.4)};
  const double p32 = 2, kappa = 8, length = 3000;
  SurveyInput input;
  LineSurvey line{.name = "l", .pieces = {{along, length}}, .positions = {}, .lengths = {}};
  const auto joints = static_cast<std::size_t>(p32 * length * mean_line_cosine(mean, kappa, along));
  while (line.positions.size() < joints) {
    const double u = rng.uniform(), c = 1 + std::log(u + (1 - u) * std::exp(-2 * kappa)) / kappa;
    const double turn = 2 * std::acos(-1.0) * rng.uniform(), s = std::sqrt(1 - c * c);
    const Vec3 n{s * std::cos(turn), s * std::sin(turn), c};
    if (rng.uniform() > std::abs(dot(n, along))) continue;
    line.positions.push_back(length * rng.uniform());
    line.joints.emplace_back(input.orientations.size());
    input.orientations.push_back(measured(n.z < 0 ? -n : n, along));
  }
  input.lines.push_back(line);
  const SetResult set = analyse(input).sets.at(0);
  const double truth = p32 * mean_line_cosine(mean, kappa, mean);
  EXPECT_NEAR(*set.p10_normal->value, truth, 0.08 * truth);
  EXPECT_NEAR(*set.p32->value, p32, 0.08 * p32);
}

// A girdle along the line is no Fisher law: intensities go by the poles as they were measured.
TEST(AnalysisTest, IntensityOfPolesWithoutFishersLawIsTheirOwn) {
  Rng rng{{.seed = 4}};
  const Vec3 along{1, 0, 0};
  const double p32 = 1.5, length = 2000;
  SurveyInput input;
  LineSurvey line{.name = "l", .pieces = {{along, length}}, .positions = {}, .lengths = {}};
  // Normals all round in the plane of x and y: E|n.l| = 2/pi.
  const double pi = std::acos(-1.0), cosine = 2 / pi;
  const auto joints = static_cast<std::size_t>(p32 * length * cosine);
  while (line.positions.size() < joints) {
    const double turn = pi * rng.uniform();
    const Vec3 n = normalized(Vec3{std::cos(turn), std::sin(turn), 0.02 * rng.normal()});
    if (rng.uniform() > std::abs(dot(n, along))) continue;
    line.positions.push_back(length * rng.uniform());
    line.joints.emplace_back(input.orientations.size());
    input.orientations.push_back(measured(n.z < 0 ? -n : n, along));
  }
  input.lines.push_back(line);
  const SetResult set = analyse(input).sets.at(0);
  ASSERT_FALSE(set.orientation.fisher);
  EXPECT_NEAR(*set.p32->value, p32, 0.07 * p32);
  EXPECT_LT(set.p32->low, p32);
  EXPECT_GT(set.p32->high, p32);
}

// The same in a window: an upright face across the x axis shows joints of such a girdle with a mean sine of 2/pi, where
// Fisher's law of so wide a spread has nearly pi/4.
TEST(AnalysisTest, IntensityInWindowsOfPolesWithoutFishersLawIsTheirOwn) {
  SurveyInput input;
  Rng rng{{.seed = 5}};
  const double pi = std::acos(-1.0);
  constexpr std::size_t joints = 400;
  for (std::size_t i = 0; i < joints; ++i) {
    const double turn = pi * (static_cast<double>(i) + 0.5) / joints;
    const Vec3 n = normalized(Vec3{std::cos(turn), std::sin(turn), 0.02 * rng.normal()});
    input.orientations.push_back(measured(n.z < 0 ? -n : n));
  }
  WindowSurvey window{.name = "face",
                      .window = PolygonWindow{{{0, 0}, {20, 0}, {20, 20}, {0, 20}}},
                      .normal = {1, 0, 0},
                      .x_axis = {0, 1, 0},
                      .traces = {}};
  for (std::size_t i = 0; i < 80; ++i) {
    const double x = 0.25 * (static_cast<double>(i) + 0.5), y = 2 + static_cast<double>(i % 10);
    window.traces.push_back({{x, y}, {x, y + 5}});
  }
  input.windows.push_back(window);
  const SetResult set = analyse(input).sets.at(0);
  ASSERT_FALSE(set.orientation.fisher);
  const double truth = 80 * 5 / 400.0 / (2 / pi);
  EXPECT_NEAR(*set.p32->value, truth, 0.002 * truth);
  EXPECT_LT(set.p32->low, truth);
  EXPECT_GT(set.p32->high, truth);
}

TEST(AnalysisTest, LinesThatContradictEachOtherAreSaid) {
  SurveyInput input;
  input.lines.push_back(straight(input, "many", 20, every(0.5, 40)));
  input.lines.push_back(straight(input, "few", 40, every(2, 20)));
  const std::string said = all_notes(analyse(input).sets.at(0));
  EXPECT_TRUE(said.contains("lines differ beyond chance for this set")) << said;
  EXPECT_TRUE(said.contains("line few gives a P32 of 0.5") && said.contains("line many one of 2")) << said;
  SurveyInput alike;
  alike.lines.push_back(straight(alike, "one", 20, every(1, 20)));
  alike.lines.push_back(straight(alike, "other", 40, every(1.3, 30)));
  EXPECT_FALSE(all_notes(analyse(alike).sets.at(0)).contains("differ beyond chance"));
  SurveyInput short_one;  // too few joints are expected on it to say anything
  short_one.lines.push_back(straight(short_one, "one", 50, every(1, 50)));
  short_one.lines.push_back(straight(short_one, "other", 2, {}));
  EXPECT_FALSE(all_notes(analyse(short_one).sets.at(0)).contains("differ beyond chance"));
}

// Of lines alike by chance one survey in a hundred is said to differ.
TEST(AnalysisTest, LinesAlikeAreSaidToDifferAtTheLevel) {
  Rng rng{{.seed = 11}};
  int said = 0;
  constexpr int surveys = 4000;
  for (int k = 0; k < surveys; ++k) {
    std::vector<LineSurvey> lines;
    std::vector<detail::MetOnLine> met;
    for (const double length : {15.0, 30.0, 40.0}) {
      double joints = 0;
      for (double x = -std::log(rng.uniform()); x < length; x -= std::log(rng.uniform())) ++joints;
      met.push_back({lines.size(), joints, length});
      lines.push_back({.name = "l", .pieces = {{Vec3{1, 0, 0}, length}}, .positions = {}, .lengths = {}});
    }
    said += detail::unlike_lines_note(lines, met) ? 1 : 0;
  }
  EXPECT_LE(said, 62);
  EXPECT_GE(said, 22);
}

TEST(AnalysisTest, WindowsThatContradictEachOtherAreSaid) {
  const auto notes_for = [](int first, int second) {
    SurveyInput input;
    input.rules.push_back(support::north_set());
    Rng rng{{.seed = 5}};
    for (const int traces : {first, second}) {
      WindowSurvey window{.name = traces == first ? "A" : "B",
                          .window = CircleWindow{{0, 0}, 10},
                          .traces = {},
                          .border = {},
                          .truncation = {}};
      for (int i = 0; i < traces; ++i) {
        const double x = 30 * (rng.uniform() - 0.5), y = 30 * (rng.uniform() - 0.5);
        const double half = -std::log(rng.uniform());
        window.traces.push_back({{x, y - half}, {x, y + half}});
      }
      input.windows.push_back(std::move(window));
    }
    return all_notes(analyse(input).sets.at(0));
  };
  EXPECT_TRUE(notes_for(60, 260).contains("windows differ beyond chance for this set")) << notes_for(60, 260);
  EXPECT_FALSE(notes_for(150, 160).contains("differ beyond chance"));
}

// Exponential discs of mean 1 m on a line that recorded no trace below 1 m: intensities are those of all joints.
TEST(AnalysisTest, TruncationOnLinesIsAllowedFor) {
  const auto surveyed = [](bool lengths) {
    Rng rng{{.seed = 8}};
    SurveyInput input;
    LineSurvey line{
        .name = "l", .pieces = {{Vec3{1, 0, 0}, 400}}, .positions = {}, .lengths = {}, .truncation = metres(1)};
    for (double x = -std::log(rng.uniform()); x < 400; x -= std::log(rng.uniform())) {
      // Of the joints met the square of the size weighs: a gamma law of shape 3; the line passes at u radii.
      const double size = -std::log(rng.uniform() * rng.uniform() * rng.uniform());
      const double chord = size * std::sqrt(1 - rng.uniform());
      if (chord < 1) continue;
      line.positions.push_back(x);
      if (lengths) line.lengths.push_back(SeenLength{chord, 2});
      line.joints.emplace_back(input.orientations.size());
      input.orientations.push_back(measured(plane(90, 90), Vec3{1, 0, 0}));
    }
    input.lines.push_back(std::move(line));
    return analyse(input).sets.at(0);
  };
  const SetResult set = surveyed(true);
  ASSERT_TRUE(set.recorded.has_value());
  EXPECT_LT(*set.recorded->value, 0.9);
  EXPECT_LT(set.p32->low, 1);
  EXPECT_GT(set.p32->high, 1);
  EXPECT_NEAR(*set.p32->value, 1, 0.2);
  EXPECT_NEAR(*set.p10_normal->value, 1, 0.2);
  // P32 over the mean area, pi/4 E D^2 = pi/2.
  EXPECT_LT(set.p30->low, 2 / std::acos(-1.0));
  EXPECT_GT(set.p30->high, 2 / std::acos(-1.0));
  EXPECT_TRUE(all_notes(set).contains("joints whose traces are below 1 m were not recorded on lines: under the law"))
      << all_notes(set);
  EXPECT_TRUE(set.cautions.empty());
  // Without lengths nothing says how many are missing: that stands beside the intensity.
  const SetResult unknown = surveyed(false);
  ASSERT_EQ(unknown.cautions.size(), 1U);
  EXPECT_TRUE(unknown.cautions[0].contains("are those of the longer ones")) << unknown.cautions[0];
}

}  // namespace
}  // namespace cleave::survey
