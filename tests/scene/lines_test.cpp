#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "cleave/core/rng.hpp"
#include "cleave/realize/block_sizes.hpp"
#include "cleave/realize/monte_carlo.hpp"
#include "cleave/realize/run.hpp"
#include "parse_support.hpp"

// Scanlines and boreholes through the rock: against pieces by hand, closed forms and a count of its own.

namespace cleave::scene::test::lines_test {
namespace {

const std::string cube = "schema = 1\n[domain]\nbox = { min = [0, 0, 0], max = [10, 10, 10] }\n";

std::string level(double z) {
  return fmt::format("[[joint]]\nplane = {{ through = [0, 0, {}], dip = 0, dip_direction = 0 }}\n", z);
}
std::string polygon(const std::string& corners, const std::string& more = "") {
  return "[[joint]]\npolygon = [" + corners + "]\n" + more;
}
const std::string down = "[[scanline]]\nname = \"B1\"\nfrom = [5, 5, 10]\ntrend = 0\nplunge = 90\nlength = 10\n";

LinePieces pieces_of(const std::string& text) {
  const Scene scene = scene_of(text);
  return pieces_on(lines_in_rock(scene).at(0), sample(scene)->input);
}

void expect_pieces(const LinePieces& found, std::vector<double> wanted) {
  ASSERT_EQ(found.pieces.size(), wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) EXPECT_NEAR(found.pieces[i], wanted[i], 1e-9) << i;
  EXPECT_NEAR(std::accumulate(wanted.begin(), wanted.end(), 0.0), found.length.si(), 1e-9);
}

TEST(LinesInRock, PiecesByHand) {
  const std::string text = cube + down + level(1) + level(1.05) + level(7);
  expect_pieces(pieces_of(text), {3, 5.95, 0.05, 1});
  const Scene scene = scene_of(text);
  StageTimer timer;
  Progress progress{ProgressStyle::quiet};
  const auto result = run(scene, {.threads = 1}, timer, progress);
  ASSERT_TRUE(result.has_value());
  ASSERT_EQ(result->figures.input.lines.size(), 1U);
  const LineFigures& line = result->figures.input.lines[0];
  EXPECT_EQ(line.name, "B1");
  EXPECT_EQ(line.joints, 3U);
  EXPECT_NEAR(line.length.si(), 10, 1e-9);
  EXPECT_NEAR(*line.frequency.value, 0.3, 1e-12);
  EXPECT_NEAR(*line.rqd.value, 99.5, 1e-9);
  EXPECT_NEAR(line.longest_piece.si(), 5.95, 1e-9);
  EXPECT_NEAR(line.mean_piece.si(), 2.5, 1e-9);
}

// What is excavated, and what lies outside, is no rock: pieces end there.
TEST(LinesInRock, VoidsEndPieces) {
  const std::string tunnel =
      "[[excavation]]\nkind = \"tunnel\"\nsection = { shape = \"rectangle\", width = 4, height = 4 }\n"
      "axis = [[5, -1, 5], [5, 11, 5]]\n";
  expect_pieces(pieces_of(cube + down + level(5) + level(2) + tunnel), {3, 1, 2});
  const std::string beyond = "[[scanline]]\npoints = [[5, 5, 14], [5, 5, -3]]\n";
  expect_pieces(pieces_of(cube + beyond + level(12) + level(4)), {6, 4});
  const Scene scene = scene_of(cube + "[[scanline]]\npoints = [[50, 5, 14], [50, 5, -3]]\n" + level(4));
  const std::vector<std::string> notes = notes_on_lines(scene);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_TRUE(notes[0].contains("meets no rock")) << notes[0];
  EXPECT_TRUE(count_lines(scene, sample(scene)->input).empty());
}

// A piece goes on round a bend of the line.
TEST(LinesInRock, PiecesGoOnRoundABend) {
  const std::string bent = "[[scanline]]\npoints = [[5, 5, 8], [5, 5, 4], [5, 5, 4], [5, 9, 4]]\n";
  expect_pieces(pieces_of(cube + bent + level(6)), {2, 6});
  // A joint that crosses at the bend is met once.
  EXPECT_EQ(pieces_of(cube + bent + polygon("[0, 0, 9], [10, 0, 9], [10, 9, 0], [0, 9, 0]")).joints, 1U);
}

// Two polygons that share an edge, four that share a corner: a line through the edge or the corner crosses one.
TEST(LinesInRock, AnEdgeIsCrossedOnce) {
  const auto square = [](double x, double y, double z) {
    return polygon(
        fmt::format("[{0}, {1}, {4}], [{2}, {1}, {4}], [{2}, {3}, {4}], [{0}, {3}, {4}]", x, y, x + 2, y + 2, z));
  };
  EXPECT_EQ(pieces_of(cube + down + square(3, 4, 6) + square(5, 4, 6)).joints, 1U);
  EXPECT_EQ(pieces_of(cube + down + square(3, 3, 6) + square(5, 3, 6) + square(3, 5, 6) + square(5, 5, 6)).joints, 1U);
  // A joint along the line is not met.
  EXPECT_EQ(pieces_of(cube + down + polygon("[5, 0, 0], [5, 10, 0], [5, 10, 10], [5, 0, 10]")).joints, 0U);
}

TEST(LinesInRock, HolesAndEndsOfJointsAreNotMet) {
  const std::string holes = "holes = [[[4, 4, 3], [6, 4, 3], [6, 6, 3], [4, 6, 3]]]\n";
  EXPECT_EQ(pieces_of(cube + down + polygon("[0, 0, 3], [9, 0, 3], [9, 9, 3], [0, 9, 3]", holes)).joints, 0U);
  EXPECT_EQ(pieces_of(cube + down + polygon("[6, 0, 3], [9, 0, 3], [9, 9, 3], [6, 9, 3]")).joints, 0U);
  // A joint that ends at the plane x = 4 or x = 7: the line at x = 5 is beyond the one, not beyond the other.
  for (const double x : {4.0, 7.0}) {
    const std::string end = fmt::format(
        "[[joint]]\nname = \"wall\"\nplane = {{ through = [{}, 0, 0], dip = 90, dip_direction = 90 }}\n", x);
    const std::string ended = polygon("[0, 0, 3], [6, 0, 3], [6, 9, 3], [0, 9, 3]", "terminates_at = [\"wall\"]\n");
    EXPECT_EQ(pieces_of(cube + down + end + ended).joints, x < 5 ? 0U : 1U) << x;
  }
}

// Discs and an inclined line, against the distance from the disc's centre of the point where its plane is met.
TEST(LinesInRock, DiscsAsTheirDistancesSay) {
  const Scene scene = scene_of(cube +
                               "[[scanline]]\npoints = [[1, 2, 9.5], [8.5, 7, 0.5]]\n"
                               "[[joint_set]]\nname = \"A\"\nshape = \"disc\"\norientation = { distribution = "
                               "\"fisher\", dip = 50, dip_direction = 120, kappa = 8 }\n"
                               "size = { distribution = \"exponential\", mean = 2 }\nintensity = { count = 1500 }\n");
  const LineInRock line = lines_in_rock(scene).at(0);
  const SampledScene drawn = sample(scene).value();
  std::uint64_t sure = 0, possible = 0;
  const geometry::Vec3 from = line.legs[0].from, way = line.legs[0].to - from;
  for (const auto& joint : drawn.input.joints) {
    const auto corners = std::get<topology::Joint>(joint).polygons[0].corners();
    geometry::Vec3 centre{0, 0, 0};
    for (const geometry::Vec3 corner : corners) centre += corner / static_cast<double>(corners.size());
    const geometry::Vec3 n = area_vector(std::get<topology::Joint>(joint).polygons[0]);
    const double share = dot(n, centre - from) / dot(n, way);
    if (share < 0 || share > 1) continue;
    const double distance = norm(from + share * way - centre), outer = norm(corners[0] - centre);
    const double inner = outer * std::cos(3.141592653589793 / static_cast<double>(corners.size()));
    sure += distance < inner * (1 - 1e-9) ? 1U : 0U;
    possible += distance < outer * (1 + 1e-9) ? 1U : 0U;
  }
  const std::uint64_t met = pieces_on(line, drawn.input).joints;
  EXPECT_GT(sure, 30U);
  EXPECT_GE(met, sure);
  EXPECT_LE(met, possible);
}

// Poisson planes of spacing 0.2 m: along a line 30 degrees off their normal 5 cos 30 joints a metre, and the RQD of
// Priest & Hudson (1976).
TEST(LinesInRock, EnsemblesHaveTheFrequencyAndRqdOfPoissonLines) {
  const Scene scene =
      scene_of(cube +
               "[[scanline]]\nname = \"hole\"\nfrom = [5, 1, 9.5]\ntrend = 0\nplunge = 60\nlength = 10\n"
               "[[scanline]]\nname = \"far\"\nfrom = [50, 1, 9.5]\ntrend = 0\nplunge = 60\nlength = 10\n"
               "[[joint_set]]\nname = \"A\"\norientation = { dip = 0, dip_direction = 0 }\n"
               "size = \"persistent\"\nintensity = { spacing = 0.2 }\n"
               "[monte_carlo]\nrealizations = 100\n");
  stochastic::Ensemble ensemble{ensemble_options_of(scene)};
  const Shared shared = shared_by_realizations(scene);
  for (std::uint64_t k = 0; k < 100; ++k) ensemble.add(make_record(scene, shared, k), "");
  const stochastic::Figures f = ensemble.figures();
  ASSERT_EQ(f.lines.size(), 1U);
  EXPECT_EQ(f.lines[0].name, "hole");
  const double lambda = 5 * std::cos(3.141592653589793 / 6);
  const stochastic::Estimate &frequency = f.lines[0].frequency, &rqd = f.lines[0].rqd;
  EXPECT_LT(std::abs(frequency.mean - lambda) / frequency.standard_error, 3.5);
  EXPECT_NEAR(frequency.std, std::sqrt(lambda / 10), 0.25 * std::sqrt(lambda / 10));
  EXPECT_LT(std::abs(rqd.mean - survey::rqd_of_frequency(lambda)) / rqd.standard_error, 3.5);
  EXPECT_LT(rqd.standard_error, 0.6);
}

TEST(LinesInRock, WhatIsWrongIsSaid) {
  const auto problem = [](const std::string& line) { return error_of(cube + "[[scanline]]\n" + line); };
  EXPECT_TRUE(problem("points = [[1, 1, 1], [1, 1, 1]]\n").contains("line without length"));
  EXPECT_TRUE(problem("points = [[1, 1, 1], [1, 1, 2]]\nlength = 3\n").contains("stands beside \"points\""));
  EXPECT_TRUE(problem("from = [1, 1, 1]\ntrend = 0\nplunge = 100\nlength = 3\n").contains("plunge"));
  EXPECT_TRUE(problem("from = [1, 1, 1]\ntrend = 0\nplunge = 10\n").contains("length"));
}

}  // namespace
}  // namespace cleave::scene::test::lines_test
