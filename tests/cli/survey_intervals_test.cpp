#include <cmath>
#include <initializer_list>
#include <numbers>
#include <string>

#include "cleave/core/rng.hpp"
#include "survey_program.hpp"

namespace cleave::cli::test {
namespace {

using nlohmann::json;

class SurveyIntervalsTest : public SurveyProgramTest {
 protected:
  int intervals = 0;
  bool worse = false;  ///< not the best law: its likelihood may have no curvature to tell its parameters from

  void expect_between(const json& object, const std::string& value, const std::string& where) {
    SCOPED_TRACE(where + ": " + value);
    ASSERT_TRUE(object.contains(value));
    ASSERT_TRUE(object.contains(value + "_low") && object.contains(value + "_high"));
    expect_within(object[value], object[value + "_low"], object[value + "_high"]);
  }
  void expect_within(const json& value, const json& low, const json& high) {
    if (worse && high.is_null()) return;
    ASSERT_TRUE(low.is_number() && high.is_number()) << low << ' ' << high;
    EXPECT_LT(low, high);
    EXPECT_LE(low.get<double>(), value.get<double>() * (1 + 1e-12));
    EXPECT_GE(high.get<double>(), value.get<double>() * (1 - 1e-12));
    ++intervals;
  }
  /// Every object with a name and a value has its ends.
  void walk(const json& node) {
    if (node.is_object() && node.contains("name") && node.contains("value") && !node["value"].is_null()) {
      SCOPED_TRACE(node.dump());
      ASSERT_TRUE(node.contains("low") && node.contains("high"));
      expect_within(node["value"], node["low"], node["high"]);
    }
    for (const json& child : node) {
      if (child.is_structured()) walk(child);
    }
  }
};

// A map of two sets with dips stated, a line, and poles about a girdle: no figure that is estimated stands alone.
TEST_F(SurveyIntervalsTest, EveryEstimateHasItsInterval) {
  Rng rng{5};
  constexpr double pi = std::numbers::pi;
  std::string traces = "x1,y1,x2,y2\n", rows = "distance,dip,dip_direction,length,ends\n",
              poles = "dip,dip_direction\n";
  for (int i = 0; i < 900; ++i) {
    const double l = -2 * std::log(rng.uniform()), a = (i % 2 == 0 ? 0.4 : 1.9) + 0.15 * rng.normal();
    const double x = 40 * rng.uniform() - 10, y = 40 * rng.uniform() - 10;
    traces += std::to_string(x) + "," + std::to_string(y) + "," + std::to_string(x + l * std::cos(a)) + "," +
              std::to_string(y + l * std::sin(a)) + "\n";
  }
  double at = 0;
  for (int i = 0; i < 60; ++i) {
    at -= 0.3 * std::log(rng.uniform());
    rows += std::to_string(at) + "," + std::to_string(70 + 4 * rng.normal()) + "," +
            std::to_string(90 + 6 * rng.normal()) + "," + std::to_string(-3 * std::log(rng.uniform())) + "," +
            std::to_string(i % 3) + "\n";
  }
  for (int i = 0; i < 120; ++i) {
    poles +=
        std::to_string(88 * std::abs(std::sin(pi * rng.uniform()))) + "," + std::to_string(2 * rng.normal()) + "\n";
  }
  write("t.csv", traces);
  write("l.csv", rows);
  write("p.csv", poles);
  const json result = survey(
      "[[window]]\ntraces = \"t.csv\"\nrectangle = { min = [0, 0], max = [20, 20] }\n"
      "[[scanline]]\nname = \"L\"\ntrend = 90\nplunge = 0\nlength = 30\nfile = \"l.csv\"\n"
      "[[orientations]]\nfile = \"p.csv\"\nset = \"girdle\"\nwrap = true\n"
      "[[set]]\nname = \"E\"\npolygon = [[230, 0], [310, 0], [310, 60], [230, 60]]\n"
      "[[set]]\nname = \"one\"\nazimuth = [45, 90]\ndip = 85\n"
      "[[set]]\nname = \"two\"\nazimuth = [140, 180]\ndip = 85\nshape = \"rectangle\"\naspect = 2\n");
  walk(result);
  for (const json& set : result["sets"]) {
    const std::string name = set["name"];
    const json& orientation = set["orientation"];
    expect_between(orientation, "kappa", name);
    if (!orientation["measured"]) expect_between(orientation, "dip_direction", name);
    for (const json& law : set["trace_lengths"]) {
      worse = law != set["trace_lengths"][0];
      for (const char* key : {"mean", "std", "a"}) expect_between(law, key, name);
      if (law["law"] == "lognormal" || law["law"] == "gamma") expect_between(law, "b", name);
      if (law.contains("size_mean")) expect_between(law, "size_mean", name);
    }
    for (const json& law : set["spacings"]) {
      worse = law != set["spacings"][0];
      for (const char* key : {"mean", "std", "a"}) expect_between(law, key, name);
    }
    for (const json& law : set["sizes"]) {
      worse = law != set["sizes"][0];
      for (const char* key : {"mean", "std"}) expect_between(law, key, name);
      if (law["law"] == "power") expect_between(law, "exponent", name);
    }
    worse = false;
    if (set.contains("size")) expect_between(set["size"], "mean", name);
    if (name == "girdle") {
      for (const char* key : {"bingham_k1", "bingham_k2"}) {
        ASSERT_TRUE(orientation.contains(key));
        EXPECT_LE(orientation[std::string{key} + "_low"], orientation[key]);
        EXPECT_GE(orientation[std::string{key} + "_high"], orientation[key]);
      }
    }
  }
  for (std::size_t i = 0; i < 3; ++i) {
    expect_within(result["eigenvalues"][i], result["eigenvalues_low"][i], result["eigenvalues_high"][i]);
  }
  expect_between(result["windows"][0], "connections_per_trace", "window");
  EXPECT_GT(intervals, 100);
  const std::string page = read("out/report.html");
  for (const char* part :
       {"connections per trace", "alignment", "RQD", "Bingham k1", "Poles, lower hemisphere, equal area",
        "Poles, lower hemisphere, equal angle", "Density of poles", "class=\"net-contour\"", "Rosette",
        "Histogram of trace lengths", "Histogram of spacings", "Kolmogorov-Smirnov p = ", "for comparison only"}) {
    EXPECT_TRUE(page.contains(part)) << part;
  }
  // Formulas of Fu (2014) stand beside by name, and say what they are.
  const auto compared = [](const json& list, const std::string& method) {
    for (const json& e : list) {
      if (e["method"].get<std::string>().contains(method)) return e["note"].get<std::string>();
    }
    return std::string{"not there"};
  };
  for (const json& set : result["sets"]) {
    if (set["name"] != "one" && set["name"] != "two") continue;
    for (const char* method : {"A.26", "Kulatilake et al. 1993", "Zhang & Einstein 2000"}) {
      EXPECT_TRUE(compared(set["comparisons"], method).starts_with("for comparison only")) << method;
    }
    ASSERT_TRUE(set["trace_lengths"][0].contains("p_value")) << set["name"];
  }
  EXPECT_TRUE(compared(result["windows"][0]["estimates"], "A.11").starts_with("for comparison only"));
  EXPECT_TRUE(compared(result["windows"][0]["estimates"], "N/A").contains("for comparison only"));
  EXPECT_TRUE(compared(result["lines"][0]["comparisons"], "thesis A.3").contains("for comparison only"));
  // So does the terminal of those that it prints.
  const std::string said = read("out/log.txt");
  EXPECT_TRUE(said.contains("  N/A (biased: counts what reaches in; for comparison only)\n")) << said;
  EXPECT_TRUE(said.contains("(Pahl 1981, A.11) (for comparison only: parallel traces, biased by the 1)\n")) << said;
}

// No trace lies within the azimuths of a set whose dip direction is to come from them: said, and the others go on.
TEST_F(SurveyIntervalsTest, SetWithoutATraceHasNoDipDirection) {
  write("t.csv", "x1,y1,x2,y2\n1,1,3,3.2\n2,5,4,6.9\n6,2,8,4.1\n");
  const json result = survey(
      "[[window]]\ntraces = \"t.csv\"\nrectangle = { min = [0, 0], max = [20, 20] }\n"
      "[[set]]\nname = \"met\"\nazimuth = [0, 90]\ndip = 80\n"
      "[[set]]\nname = \"missed\"\nazimuth = [90, 180]\ndip = 70\n");
  ASSERT_EQ(result["sets"].size(), 2U);
  const json& met = result["sets"][0];
  const json& missed = result["sets"][1];
  EXPECT_EQ(met["traces"], 3);
  EXPECT_EQ(missed["traces"], 0);
  EXPECT_TRUE(met["orientation"].contains("dip_direction"));
  EXPECT_FALSE(missed.contains("orientation")) << missed;
  EXPECT_TRUE(missed["notes"].dump().contains("no trace seen has an azimuth of 90 to 180")) << missed;
  EXPECT_TRUE(read("out/sets.toml").contains("met"));
}

}  // namespace
}  // namespace cleave::cli::test
