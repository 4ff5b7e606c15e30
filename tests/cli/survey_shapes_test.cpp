#include <cmath>
#include <numbers>
#include <sstream>
#include <string>
#include <utility>

#include "cleave/core/rng.hpp"
#include "survey_program.hpp"

namespace cleave::cli::test {
namespace {

using nlohmann::json;

class SurveyShapesTest : public SurveyProgramTest {
 protected:
  /// Traces from north to south of discs of one law about vertical joints, mapped on a square of 30 m: exponential
  /// diameters of mean 2 m, of which the chords are drawn.
  [[nodiscard]] std::string north_south_traces() const {
    Rng rng{3};
    std::string rows = "x1,y1,x2,y2\n";
    for (int i = 0; i < 1500; ++i) {
      double d = 0;
      do d = -2 * std::log(rng.uniform());
      while (rng.uniform() * 40 > d);
      const double u = rng.uniform(), half = d / 2 * std::sqrt(1 - u * u);
      const double x = 60 * rng.uniform() - 15, y = 60 * rng.uniform() - 15;
      rows += std::to_string(x) + "," + std::to_string(y - half) + "," + std::to_string(x) + "," +
              std::to_string(y + half) + "\n";
    }
    return rows;
  }
  static std::string map_with(const std::string& set, const std::string& more = "") {
    return "[[window]]\ntraces = \"t.csv\"\nrectangle = { min = [0, 0], max = [30, 30] }\n" + more +
           "[[set]]\nname = \"A\"\nazimuth = [150, 30]\ndip = 90\nkappa = 200\n" + set;
  }
};

// The same traces taken for discs, for ellipses lying along or across them, for squares and for rectangles: sizes are
// those of the discs divided by what the shape does to its chords, P30 follows from the width across.
TEST_F(SurveyShapesTest, SizesOfEllipsesAndRectanglesFollowFromTheirChords) {
  write("t.csv", north_south_traces());
  const json discs = survey(map_with(""))["sets"][0];
  EXPECT_EQ(discs["shape"], "disc");
  EXPECT_NEAR(discs["size"]["mean"], 2, 0.5);
  EXPECT_LT(discs["size"]["mean_low"], discs["size"]["mean"]);
  EXPECT_GT(discs["size"]["mean_high"], discs["size"]["mean"]);
  EXPECT_EQ(discs["sizes"].size(), 5U);  // exponential, lognormal, gamma, power, constant
  // Long axis along the strike: the traces run along it, chords are those of a disc of that size.
  const json along = survey(map_with("shape = \"ellipse\"\naspect = 3\n"))["sets"][0];
  EXPECT_NEAR(along["size"]["mean"], discs["size"]["mean"], 1e-6);
  // Across: chords of a disc of a third of it.
  const json across = survey(map_with("shape = \"ellipse\"\naspect = 3\nrotation = 90\n"))["sets"][0];
  EXPECT_NEAR(across["size"]["mean"].get<double>(), 3 * discs["size"]["mean"].get<double>(), 1e-6);
  const auto p30 = [](const json& set) {
    for (const json& e : set["estimates"]) {
      if (e["name"] == "P30") return e["value"].get<double>();
    }
    return 0.0;
  };
  // Widths across the traces: D for discs, a third of the long axis (= D/3) along it, the long axis (= 3 D) across it.
  EXPECT_NEAR(p30(along), 3 * p30(discs), 1e-6 * p30(along));
  EXPECT_NEAR(p30(across), p30(discs) / 3, 1e-6 * p30(discs));
  const std::string sets = read("out/sets.toml");
  EXPECT_TRUE(sets.contains("shape = \"ellipse\"")) << sets;
  EXPECT_TRUE(sets.contains("aspect = 3") && sets.contains("rotation = 90")) << sets;
  // Rectangles with sides along the traces: every chord is the long side, m2 = mean, m3 = second moment.
  const json rectangle = survey(map_with("shape = \"rectangle\"\naspect = 2\n"))["sets"][0];
  const json& law = rectangle["trace_lengths"][0];
  double m2 = 0;
  for (const json& e : rectangle["estimates"]) {
    if (e["name"] == "E L^2 / E L") m2 = e["value"];
  }
  EXPECT_NEAR(m2, law["mean"], 1e-6);
  EXPECT_GT(rectangle["sizes"].size(), 0U);
  // Its sets make a network as they are.
  write("s.toml", "include = [\"out/sets.toml\"]\n[domain]\nbox = { min = [0, 0, 0], max = [4, 4, 4] }\n");
  const Ended cut = cleave("run s.toml --quiet -o cut");
  EXPECT_EQ(cut.code, 0) << cut.err;
  write("t.csv", north_south_traces());
  EXPECT_TRUE(refusal(map_with("shape = \"oval\"\n")).contains("\"oval\" is not known"));
  EXPECT_TRUE(refusal(map_with("shape = \"ellipse\"\n")).contains("aspect"));
  EXPECT_TRUE(refusal(map_with("aspect = 2\n")).contains("belongs to ellipses and rectangles"));
}

// Short traces that were not mapped: without a word of it the mean comes out too large, with truncation it comes back.
TEST_F(SurveyShapesTest, TruncationIsAllowedFor) {
  const std::string all = north_south_traces();
  write("t.csv", all);
  const json untouched = survey(map_with(""));
  std::string kept = "x1,y1,x2,y2\n";
  std::size_t at = all.find('\n') + 1;
  while (at < all.size()) {
    const std::size_t end = all.find('\n', at);
    const std::string row = all.substr(at, end - at);
    at = end + 1;
    double x1 = 0, y1 = 0, x2 = 0, y2 = 0;
    char comma = 0;
    std::istringstream{row} >> x1 >> comma >> y1 >> comma >> x2 >> comma >> y2;
    // Pieces within the square are what the mapper sees.
    if (std::min(y2, 30.0) - std::max(y1, 0.0) >= 1.5) kept += row + "\n";
  }
  write("t.csv", kept);
  const auto exponential = [](const json& result) {
    for (const json& size : result["sets"][0]["sizes"]) {
      if (size["law"] == "exponential") return size["mean"].get<double>();
    }
    return 0.0;
  };
  const double wrong = exponential(survey(map_with("")));
  const json told = survey(map_with("", "truncation = 1.5\n"));
  EXPECT_GT(wrong, 1.15 * exponential(untouched));
  EXPECT_NEAR(exponential(told), 2, 0.35);
  EXPECT_TRUE(told["sets"][0]["notes"].dump().contains("below 1.5 m were not mapped"));
}

// Lengths of the traces that a scanline meets: longer ones are met more often, the fit knows.
TEST_F(SurveyShapesTest, TraceLengthsOnScanlines) {
  Rng rng{4};
  std::string rows = "distance,dip,dip_direction,length,ends,set\n";
  for (int i = 0; i < 300; ++i) {
    // Exponential traces of mean 3 m met by a line: the sum of two exponentials; none is seen beyond 6 m on one side.
    double first = -3 * std::log(rng.uniform()), second = -3 * std::log(rng.uniform());
    int ends = 2;
    if (first > 6) {
      first = 6;
      --ends;
    }
    if (second > 6) {
      second = 6;
      --ends;
    }
    rows += std::to_string(0.2 * i) + ",80," + std::to_string(85 + i % 11) + "," + std::to_string(first + second) +
            "," + std::to_string(ends) + ",J\n";
  }
  write("line.csv", rows);
  const std::string line = "[[scanline]]\nname = \"S\"\ntrend = 90\nplunge = 0\nlength = 60\nfile = \"line.csv\"\n";
  const json result = survey(line);
  const json& set = result["sets"][0];
  bool found = false;
  for (const json& law : set["trace_lengths"]) {
    if (law["law"] != "exponential") continue;
    found = true;
    EXPECT_LT(law["mean_low"], 3);
    EXPECT_GT(law["mean_high"], 3);
    EXPECT_NEAR(law["mean"], 3, 0.5);
  }
  EXPECT_TRUE(found);
  EXPECT_TRUE(set.contains("size"));
  EXPECT_TRUE(read("out/sets.toml").contains("shape = \"disc\""));
  // RQD with intervals, and estimators for comparison by name.
  const json& figures = result["lines"][0];
  EXPECT_EQ(figures["rqd"].size(), 2U);
  for (const json& rqd : figures["rqd"]) {
    EXPECT_LE(rqd["low"], rqd["value"]);
    EXPECT_GE(rqd["high"], rqd["value"]);
  }
  EXPECT_TRUE(figures["comparisons"].dump().contains("thesis A.3"));
  EXPECT_TRUE(set["spacings"][0].contains("chi_squared_p_low"));
  write("line.csv", "distance,dip,dip_direction,length,ends\n1,80,90,2,5\n");
  EXPECT_TRUE(refusal(line).contains("line.csv:2: ends: is 5")) << refusal(line);
}

// Simulated maps beside the measured one: cut off at the window, as many as stated, and around the measured figures.
TEST_F(SurveyShapesTest, SimulatedMapsLieBesideTheMeasuredOne) {
  write("t.csv", north_south_traces());
  const json window = survey(map_with(""))["windows"][0];
  ASSERT_EQ(window["simulated_maps"].size(), 19U);
  for (const char* figure :
       {"traces", "p20", "p21", "mean_length_m", "connections_per_trace", "direction", "alignment"}) {
    EXPECT_TRUE(window["map"].contains(figure)) << figure;
  }
  double p21 = 0;
  for (const json& map : window["simulated_maps"]) {
    p21 += map["p21"].get<double>() / 19;
    EXPECT_GT(map["alignment"], 0.8);
  }
  EXPECT_NEAR(p21, window["map"]["p21"], 0.1 * p21);
  const std::string page = read("out/report.html");
  EXPECT_TRUE(page.contains("<clipPath id=\"map0\">") && page.contains("clip-path=\"url(#map0)\""));
  EXPECT_TRUE(page.contains("<clipPath id=\"map0s\">") && page.contains("clip-path=\"url(#map0s)\""));
  for (const char* part : {"Map as a whole", "Connections per trace", "Mean direction of the traces"}) {
    EXPECT_TRUE(page.contains(part)) << part;
  }
}

// A bent line: each joint is met by the piece it lies on, and only pieces that can meet a set count for it. Sets are
// cut out of the stereonet by polygons; the map's north is 10 degrees off.
TEST_F(SurveyShapesTest, BentLinesBoreholesAndPolygonsOnTheNet) {
  std::string rows = "distance,trend,plunge\n";
  for (int i = 0; i < 8; ++i) rows += std::to_string(0.5 + i) + ",80,0\n";           // poles to the east
  for (int i = 0; i < 16; ++i) rows += std::to_string(10.2 + 0.6 * i) + ",350,0\n";  // to the north
  write("bent.csv", rows);
  write("hole.csv", "depth,dip,strike\n1,2,20\n2.5,2,200\n4,1,90\n");
  const json result = survey(
      "north = 10\n[[scanline]]\nname = \"L\"\npoints = [[0, 0, 0], [10, 0, 0], [10, 10, 0]]\nfile = \"bent.csv\"\n"
      "[[borehole]]\nname = \"B\"\ntrend = 0\nplunge = 90\nlength = 5\nfile = \"hole.csv\"\n"
      "[[set]]\nname = \"E\"\npolygon = [[60, 0], [100, 0], [100, 30], [60, 30]]\n"
      "[[set]]\nname = \"N\"\npolygon = [[330, 0], [10, 0], [10, 30], [330, 30]]\n"
      "[[set]]\nname = \"flat\"\npolygon = [[0, 60], [90, 60], [180, 60], [270, 60]]\n");
  ASSERT_EQ(result["sets"].size(), 3U);
  EXPECT_EQ(result["unassigned"], 0);
  EXPECT_EQ(result["sets"][0]["joints"], 8);
  EXPECT_EQ(result["sets"][1]["joints"], 16);
  EXPECT_EQ(result["sets"][2]["joints"], 3);
  EXPECT_NEAR(result["sets"][0]["orientation"]["dip"], 90, 1e-6);
  // Parallel joints: N over the lengths projected on the normal; the hole adds nothing to vertical joints.
  EXPECT_NEAR(result["sets"][0]["p32"]["value"], 0.8, 1e-6);
  EXPECT_NEAR(result["sets"][1]["p32"]["value"], 1.6, 1e-6);
  EXPECT_NEAR(result["sets"][2]["p32"]["value"], 0.6, 0.05);
  EXPECT_NEAR(result["lines"][1]["frequency"]["value"], 0.6, 1e-12);
}

// Circular windows have estimators of their own.
TEST_F(SurveyShapesTest, CircularWindowsCountEndsAndCrossings) {
  // Radius 2 about (5, 5): one trace inside, one with one end, one across.
  write("t.csv", "x1,y1,x2,y2\n4,5,6,5\n5,5.5,5,9\n0,4,10,4\n");
  const json window =
      survey("[[window]]\ntraces = \"t.csv\"\ncircle = { centre = [5, 5], radius = 2 }\n")["windows"][0];
  EXPECT_EQ(window["ends_2"], 1);
  EXPECT_EQ(window["ends_1"], 1);
  EXPECT_EQ(window["ends_0"], 1);
  EXPECT_EQ(window["crossings"], 3);
  double p21 = 0, mean = 0;
  for (const json& e : window["estimates"]) {
    if (e["method"] == "x/(4R)") p21 = e["value"];
    if (e["method"] == "(pi R/2) x/m") mean = e["value"];
  }
  EXPECT_TRUE(window["estimates"].dump().contains("(A.13)"));
  EXPECT_NEAR(p21, 3.0 / 8, 1e-12);
  EXPECT_NEAR(mean, std::numbers::pi, 1e-12);
  EXPECT_NEAR(window["length_inside_m"], 2 + 1.5 + 2 * std::sqrt(3.0), 1e-12);
}

}  // namespace
}  // namespace cleave::cli::test
