#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <tuple>

#include "program.hpp"

// The examples of Fu (2014), chapter 7, and what the thesis lacks, through the program.
namespace cleave::cli::test {
namespace {

constexpr double degree = std::numbers::pi / 180;

class ContactExamplesTest : public ProgramTest {
 protected:
  [[nodiscard]] static std::string scene(const std::string& name) {
    return text_of(std::string{CLEAVE_SOURCE_DIR} + "/examples/" + name + ".toml");
  }
  /// The text with `from` (which must be there) replaced.
  [[nodiscard]] static std::string with(std::string text, std::string_view from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  }
  [[nodiscard]] nlohmann::json ran(const std::string& text, int code = 0) const {
    write("s.toml", text);
    const Ended run = cleave("run s.toml --quiet -o out");
    EXPECT_EQ(run.code, code) << run.err;
    const auto summary = nlohmann::json::parse(read("out/summary.json"));
    return summary["contact"];
  }
  [[nodiscard]] nlohmann::json example(const std::string& name) const {
    auto result = ran(scene(name));
    std::uint64_t iterations = 0;
    for (const auto& solver : result["solvers"]) iterations += solver["iterations"].get<std::uint64_t>();
    EXPECT_EQ(iterations, result["iterations"].get<std::uint64_t>()) << name;
    EXPECT_EQ(result["status"], "converged") << name;
    const std::string page = read("out/report.html");
    EXPECT_NE(page.find("id=\"play\""), std::string::npos);
    for (const std::string_view wrong : {",nan", "-nan", ",inf", "-inf,"}) {
      EXPECT_EQ(page.find(wrong), std::string::npos) << name << ": no number for the page: " << wrong;
    }
    EXPECT_TRUE(exists("out/contact_0001.vtu"));
    EXPECT_FALSE(result["points"].empty()) << name << ": no histories";
    EXPECT_NE(page.find("<div id=\"ux\">"), std::string::npos) << name;
    return result;
  }
  [[nodiscard]] static std::vector<double> at(const nlohmann::json& result, const std::string& point) {
    for (const auto& p : result["points"]) {
      if (p["name"] == point) return p["displacement"].get<std::vector<double>>();
    }
    ADD_FAILURE() << "no point " << point;
    return {0, 0};
  }
  [[nodiscard]] static nlohmann::json body(const nlohmann::json& result, const std::string& name) {
    for (const auto& b : result["bodies"]) {
      if (b["name"] == name) return b;
    }
    ADD_FAILURE() << "no body " << name;
    return {};
  }
  /// x displacements of the one point, a row a step.
  [[nodiscard]] std::vector<double> history() const {
    std::istringstream rows{read("out/points.csv")};
    std::string line;
    std::getline(rows, line);
    std::vector<double> out;
    while (std::getline(rows, line)) {
      for (int k = 0; k < 4; ++k) line.erase(0, line.find(',') + 1);
      out.push_back(std::stod(line));
    }
    return out;
  }
};

TEST_F(ContactExamplesTest, ElasticArchesDoWhatRigidOnesDo) {
  const auto falls = example("arch/arch_12_100_elastic"), stands = example("arch/arch_12_112_elastic");
  EXPECT_EQ(falls["mode"], "elastic");
  EXPECT_LT(at(falls, "crown")[1], -0.5);
  // rho g R2 / E is 2.4e-6 m; the thrust runs near the rims of some joints, where stones give about ten times as much.
  EXPECT_NEAR(at(stands, "crown")[1], 0, 5e-5);
  // Stress of its thrust, in every frame and as a table.
  const std::string vtu = read("out/contact_0001.vtu");
  for (const std::string array : {"stress", "von_mises", "safety"}) {
    EXPECT_NE(vtu.find("Name=\"" + array + "\""), std::string::npos) << array;
  }
  EXPECT_TRUE(exists("out/stress.csv"));
}

TEST_F(ContactExamplesTest, ElasticColumnsTopple) {
  const auto result = example("toppling_columns/toppling_columns_elastic");
  EXPECT_LT(body(result, "column 1")["max_displacement_m"].get<double>(), 0.05);
  EXPECT_LT(body(result, "column 2")["max_displacement_m"].get<double>(), 0.05);
  for (const std::string top : {"top of 3", "top of 7", "top of 10"}) EXPECT_LT(at(result, top)[1], -1) << top;
}

TEST_F(ContactExamplesTest, DampedExamplesTakeTheTimesThatArePublished) {
  const auto arch = example("arch/arch_12_100_damped");
  EXPECT_NEAR(at(arch, "crown")[1], -1.7, 0.1);
  const auto columns = example("toppling_columns/toppling_columns_damped");
  for (const std::string top : {"top of 3", "top of 7"}) EXPECT_LT(at(columns, top)[1], -0.5) << top;
  EXPECT_LT(at(columns, "top of 10")[1], -2);
  EXPECT_LT(body(columns, "column 1")["max_displacement_m"].get<double>(), 0.05);
}

TEST_F(ContactExamplesTest, ElasticRoofWithClosedJointsIsAnArch) {
  const auto roof = example("tunnel_roof/closed_elastic");
  EXPECT_EQ(roof["mode"], "elastic");
  for (const std::string layer : {"1", "2", "3", "4", "5"}) {
    EXPECT_LT(at(roof, "layer " + layer)[1], -0.005) << layer;
    EXPECT_GT(at(roof, "layer " + layer)[1], -0.02) << layer;
  }
  const auto left = body(roof, "left abutment")["contact_force"], right = body(roof, "right abutment")["contact_force"];
  const double weight = 5 * 18 * 2600 * 9.81;
  EXPECT_NEAR(-(left[1].get<double>() + right[1].get<double>()) / weight, 1, 1e-2);
  EXPECT_LT(left[0].get<double>(), -5e5);  // an arch thrusts
}

TEST_F(ContactExamplesTest, ForcesMoveAColumnLikeTheTractionTheyReplace) {
  (void)example("concentrated_forces/traction");
  const auto whole = history();
  const double most = *std::ranges::max_element(whole);
  for (const auto& [name, tolerance] : std::map<std::string, double>{
           {"outer", 0.01}, {"inner", 0.01}, {"middle", 0.04}, {"off_middle", 0.01}, {"three", 0.01}}) {
    const auto result = example("concentrated_forces/" + name);
    EXPECT_LT(result["energy"]["largest_gain_j"].get<double>(), 1e-9 * result["energy"]["work_j"].get<double>());
    const auto one = history();
    ASSERT_EQ(one.size(), whole.size());
    double off = 0;
    for (std::size_t k = 0; k < one.size(); ++k) off = std::max(off, std::abs(one[k] - whole[k]));
    EXPECT_LT(off, tolerance * most) << name;
    EXPECT_GT(off, 0) << name;
  }
}

TEST_F(ContactExamplesTest, BlockSlidesAsTheClosedFormSays) {
  const auto slid = [&](const nlohmann::json& result) {
    const auto u = at(result, "block");
    EXPECT_NEAR(u[0] * std::sin(30 * degree) + u[1] * std::cos(30 * degree), 0, 1e-6);  // stays on the plane
    return std::hypot(u[0], u[1]);
  };
  const auto exact = [](double friction) {
    return 9.81 / 2 * (std::sin(30 * degree) - std::cos(30 * degree) * std::tan(friction * degree)) * 0.64;
  };
  for (const int friction : {0, 5, 10, 15, 20, 25}) {
    const auto result =
        example("sliding_block/friction_" + std::string{friction < 10 ? "0" : ""} + std::to_string(friction));
    EXPECT_NEAR(slid(result), exact(friction), 1e-9) << friction;
    EXPECT_EQ(result["mode"], "rigid");
  }
  for (const int friction : {10, 20}) {
    const auto result = example("sliding_block/elastic_" + std::to_string(friction));
    EXPECT_NEAR(slid(result) / exact(friction), 1, 1e-4) << friction;  // it vibrates when it is let go
    EXPECT_EQ(result["mode"], "elastic");
  }
  const std::string steep = with(scene("sliding_block/friction_25"), "friction = 25", "friction = 35");
  EXPECT_LT(slid(ran(steep)), 1e-9);
}

// Its equation of motion under the record, integrated apart in steps of 5e-6 s.
TEST_F(ContactExamplesTest, ABlockOnAShakenSlopeSlidesAsNewmarkSays) {
  const auto result = example("shaken_slope/shaken_slope");
  const auto u = at(result, "block");
  EXPECT_NEAR(u[0] * std::sin(20 * degree) + u[1] * std::cos(20 * degree), 0, 1e-9);
  EXPECT_NEAR(std::hypot(u[0], u[1]), 0.2460462066, 1e-4 * 0.246);
}

// 0.0397 m in plane strain with shear; alone the thin layer would sag 0.0595 m (beam), the thick one 0.0335 m.
TEST_F(ContactExamplesTest, TwoLayersSagTogether) {
  const auto result = example("two_layer_beam/two_layer_beam");
  EXPECT_EQ(result["mode"], "elastic");
  EXPECT_NEAR(at(result, "middle")[1], -0.0397, 0.002 * 0.0397);
  EXPECT_NEAR(at(result, "middle of the upper")[1], -0.0397, 0.002 * 0.0397);
  const double weight = 2600 * 9.81 * 36 * 1.5;
  const double pressed = body(result, "thick")["contact_force"][1].get<double>();
  EXPECT_LT(pressed, -0.05 * weight);  // the thin layer rests on the thick one in part
  EXPECT_GT(pressed, -weight);
  const auto stress =
      ran(with(scene("two_layer_beam/two_layer_beam"), "static = true", "static = true\nplane = \"stress\""));
  EXPECT_NEAR(at(stress, "middle")[1], -0.0423, 0.002 * 0.0423);
}

TEST_F(ContactExamplesTest, ArchFallsOrStandsByItsThickness) {
  for (const std::string name : {"12_100", "21_100"}) {
    const auto result = example("arch/arch_" + name);
    EXPECT_LT(at(result, "crown")[1], -0.5) << name;
  }
  for (const std::string name : {"12_112", "21_112", "7_100"}) {
    const auto result = example("arch/arch_" + name);
    EXPECT_LT(result["max_displacement_m"].get<double>(), 1e-8) << name;
  }
}

// An arch falls by turning about hinges that lie on its outside and its inside in turn: at the springings, the haunches
// and the crown. A four-hinge mechanism and its mirror image, which a symmetric arch goes through at once; where the
// crown is a stone, its hinge is on both sides of that. All else stays together.
TEST_F(ContactExamplesTest, FallingArchesTurnAboutHingesInTurn) {
  for (const auto& [name, stones, hinges] :
       {std::tuple{std::string{"12_100"}, 12, std::vector<int>{0, 2, 6, 10, 12}},
        std::tuple{std::string{"21_100"}, 21, std::vector<int>{0, 4, 10, 11, 17, 21}}}) {
    const auto result = ran(with(scene("arch/arch_" + name), "duration = 0.8", "duration = 0.3"));
    std::vector<double> turned{0};  // the right abutment, the stones, the left abutment
    for (int k = 1; k <= stones; ++k) {
      turned.push_back(body(result, "stone " + std::to_string(k))["rotation"].get<double>());
    }
    turned.push_back(0);
    std::vector<int> found;
    std::vector<int> outside;
    for (std::size_t k = 0; k + 1 < turned.size(); ++k) {
      const double opens = turned[k + 1] - turned[k];
      if (std::abs(opens) < 1e-3) continue;
      EXPECT_GT(std::abs(opens), 3) << name << ' ' << k;
      found.push_back(static_cast<int>(k));
      outside.push_back(opens < 0 ? 1 : 0);
    }
    EXPECT_EQ(found, hinges) << name;
    const auto twice = std::ranges::unique(outside);
    outside.erase(twice.begin(), twice.end());
    EXPECT_EQ(outside, (std::vector<int>{1, 0, 1, 0, 1})) << name;
  }
}

// Critical thickness by limit analysis (linear programming): 0.105098, 0.106790 and 0.096245 m.
TEST_F(ContactExamplesTest, CriticalThicknessOfAnArchIsThatOfLimitAnalysis) {
  for (const auto& [name, critical] :
       std::map<std::string, double>{{"12_100", 0.105098}, {"21_100", 0.106790}, {"7_100", 0.096245}}) {
    double low = 0.09, high = 0.12;
    while (high - low > 0.0004) {
      const double middle = (low + high) / 2;
      std::string text = with(scene("arch/arch_" + name), "thickness = 0.100", "thickness = " + std::to_string(middle));
      text = with(text, "duration = 0.8", "duration = 0.4") + "\n[output]\nvtu = false\nreport = false\n";
      (ran(text)["max_displacement_m"].get<double>() > 1e-6 ? low : high) = middle;
    }
    EXPECT_NEAR((low + high) / 2, critical, 0.005 * critical) << name;
  }
}

TEST_F(ContactExamplesTest, LongColumnsToppleAndShortOnesStay) {
  const auto result = example("toppling_columns/toppling_columns");
  const auto turned = [&](int k) { return body(result, "column " + std::to_string(k))["rotation"].get<double>(); };
  for (const int k : {3, 7, 10}) EXPECT_GT(turned(k), 15) << k;
  for (const int k : {4, 5, 6}) EXPECT_GT(turned(k), 5) << k;  // pushed
  for (const int k : {1, 2, 11, 12, 13, 14}) EXPECT_LT(std::abs(turned(k)), 1) << k;
}

// Limit equilibrium: 38.1512 degrees; with tan(friction) = 0.65 a horizontal bolt of 2012.87 kN/m.
// Friction holds the wall on the ground; its left end has nothing to lean on.
TEST_F(ContactExamplesTest, EndOfAPushedWallBreaksAwayAndTheRestStays) {
  const auto result = example("brick_wall/brick_wall");
  EXPECT_EQ(result["bodies"].size(), 85U);
  const auto left = at(result, "top left");
  EXPECT_LT(left[0], -0.3);
  EXPECT_LT(left[1], -0.1);
  const auto right = at(result, "top right");
  EXPECT_LT(std::hypot(right[0], right[1]), 1e-6);
  std::size_t fallen = 0;
  for (const auto& b : result["bodies"]) fallen += b["max_displacement_m"].get<double>() > 0.1 ? 1U : 0U;
  EXPECT_GT(fallen, 10U);
  EXPECT_LT(fallen, 40U);
  const double work = -result["energy"]["gravity_j"].get<double>();
  EXPECT_LE(result["energy"]["largest_gain_j"].get<double>(), 1e-6 * work);
}

TEST_F(ContactExamplesTest, GoodmanAndBraysSlopeHasItsLimit) {
  EXPECT_LT(example("goodman_bray/stands")["max_displacement_m"].get<double>(), 1e-6);
  const auto falls = example("goodman_bray/falls");
  EXPECT_GT(falls["max_displacement_m"].get<double>(), 1);
  const auto turned = [&](int k) { return body(falls, "column " + std::to_string(k))["rotation"].get<double>(); };
  for (int k = 4; k <= 13; ++k) EXPECT_GT(turned(k), 1) << k;
  for (const int k : {1, 2, 3})
    EXPECT_GT(body(falls, "column " + std::to_string(k))["max_displacement_m"].get<double>(), 0.3);
  for (const int k : {1, 2, 14, 15, 16}) EXPECT_LT(std::abs(turned(k)), 0.1) << k;
  EXPECT_LT(example("goodman_bray/bolted")["max_displacement_m"].get<double>(), 1e-6);
  const auto weak = ran(with(scene("goodman_bray/bolted"), "force = [2053000, 0]", "force = [1972000, 0]"));
  EXPECT_GT(weak["max_displacement_m"].get<double>(), 0.05);
}

TEST_F(ContactExamplesTest, RoofFallsBelowAndCarriesItselfAbove) {
  const auto result = example("tunnel_roof/tunnel_roof");
  for (const std::string layer : {"1", "2", "3", "4"}) {
    EXPECT_NEAR(at(result, "layer " + layer)[1], -4, 1e-3) << layer;
  }
  EXPECT_GT(at(result, "layer 5")[1], -1e-3);
  // What stands and what has fallen weighs what the supports carry; the arch thrusts outwards on both sides alike.
  double weight = 0, carried = 0;
  for (const double gap : {0.004, 0.003, 0.001, 0.0005, 0.0}) weight += 12 * (1.5 - gap) * 2600 * 9.81;
  // Layers of eleven bricks and two halves.
  for (const std::string support : {"left abutment", "right abutment", "floor"}) {
    carried -= body(result, support)["contact_force"][1].get<double>();
  }
  EXPECT_NEAR(carried / weight, 1, 1e-6);
  const double left = body(result, "left abutment")["contact_force"][0].get<double>();
  EXPECT_LT(left, -1e5);
  EXPECT_NEAR(body(result, "right abutment")["contact_force"][0].get<double>(), -left, 1e-6 * -left);
  EXPECT_LT(result["energy"]["kinetic_j"].get<double>(), 1e-6 * -result["energy"]["gravity_j"].get<double>());
}

// Bolts through all layers: those in the middle of the opening hang four bricks each on the top layer.
TEST_F(ContactExamplesTest, BoltsHangTheLowerLayersOnTheArch) {
  const auto held = example("bolted_roof/bolted_roof");
  EXPECT_EQ(held["verdict"], "stands");
  double hanging = 0;
  for (const auto& bolt : held["bolts"]) {
    EXPECT_EQ(bolt["state"], "holds") << bolt["name"];
    if (bolt["name"] == "bolt 4" && bolt["second"] == "layer 5 6") hanging = bolt["force_n"].get<double>();
  }
  EXPECT_EQ(held["bolts"].size(), 32U);
  const double bricks = (1.496 + 1.497 + 1.499 + 1.4995) * 2600 * 9.81;
  EXPECT_NEAR(hanging / bricks, 1, 0.02);
  EXPECT_NE(read("out/report.html").find("<h2>Bolts</h2>"), std::string::npos);
  // Bolts that grip too little: what hangs on them comes down.
  std::string weak = scene("bolted_roof/bolted_roof");
  for (const std::string_view key : {"400 kN/m", "pretension = \"20 kN\"", "ductility = 0.05"}) {
    for (std::size_t at = weak.find(key); at != std::string::npos; at = weak.find(key, at + 1)) {
      weak.replace(at, key.size(), key.starts_with("400") ? "20 kN/m" : "");
    }
  }
  const auto falls = ran(weak);
  EXPECT_NE(falls["verdict"], "stands");
  EXPECT_GT(std::ranges::count_if(falls["bolts"], [](const auto& bolt) { return bolt["state"] == "broken"; }), 4);
}

// Closed joints: at 35 degrees all five layers carry themselves by friction alone, nothing falls; at 5 degrees the roof
// comes down between its abutments.
TEST_F(ContactExamplesTest, RoofWithClosedJointsIsAnArchOfFiveLayers) {
  std::string text = scene("tunnel_roof/tunnel_roof");
  text.resize(text.find("[[body]]\nname = \"layer 1\""));
  const auto row = [&](int layer, const std::string& name, double x, double width, int count) {
    text += fmt::format(
        "[[body]]\nname = \"{} {}\"\nrectangle = {{ corner = [{}, {}], width = {}, height = 1 }}\nrepeat = {{ count = "
        "{}, shift = [1.5, 0] }}\n",
        name, layer, x, 3 + layer, width, count);
  };
  for (const int layer : {1, 3, 5}) row(layer, "layer", -9, 1.5, 12);
  for (const int layer : {2, 4}) {
    row(layer, "left end of layer", -9, 0.75, 1);
    row(layer, "layer", -8.25, 1.5, 11);
    row(layer, "right end of layer", 8.25, 0.75, 1);
  }
  const auto stands = ran(with(text, "duration = 2", "duration = 0.3"));
  EXPECT_LT(stands["max_displacement_m"].get<double>(), 1e-9);
  double carried = 0;
  for (const std::string support : {"left abutment", "right abutment"}) {
    carried -= body(stands, support)["contact_force"][1].get<double>();
  }
  EXPECT_NEAR(carried / (5 * 18 * 2600 * 9.81), 1, 1e-6);
  const double left = body(stands, "left abutment")["contact_force"][0].get<double>();
  EXPECT_LT(left, -5e5);  // an arch thrusts
  EXPECT_NEAR(body(stands, "right abutment")["contact_force"][0].get<double>(), -left, 1e-6 * -left);
  const auto falls = ran(with(with(text, "duration = 2", "duration = 0.3"), "friction = 35", "friction = 5"));
  for (const std::string layer : {"1", "3", "5"}) EXPECT_LT(at(falls, "layer " + layer)[1], -0.2) << layer;
}

TEST_F(ContactExamplesTest, ThreadsChangeNoByte) {
  write("s.toml", with(scene("two_layer_beam/two_layer_beam"), "element = 2", "element = 4"));
  ASSERT_EQ(cleave("run s.toml --quiet -o a --threads 1").code, 0);
  ASSERT_EQ(cleave("run s.toml --quiet -o b --threads 4").code, 0);
  for (const std::string file : {"history.csv", "points.csv", "bodies.csv", "contact.pvd", "contact_0002.vtu"}) {
    EXPECT_FALSE(read("a/" + file).empty()) << file;
    EXPECT_EQ(read("a/" + file), read("b/" + file)) << file;
  }
  ASSERT_EQ(cleave("run s.toml --quiet -o a").code, 0);  // a finished result is replaced
}

// A section of a block system is a scene of contact of its own: fixed where the blocks are, and it runs.
TEST_F(ContactExamplesTest, SectionOfBlocksRuns) {
  write(
      "rock.toml",
      "title = \"slope\"\n[domain]\nbox = { min = [0, 0, 0], max = [12, 4, 8] }\n"
      "[[joint]]\nset = \"bedding\"\nplane = { through = [6, 2, 3], dip = 20, dip_direction = 270 }\n"
      "[[joint]]\nset = \"cross\"\nplane = { through = [5, 2, 3], dip = 70, dip_direction = 90 }\n"
      "[joints.bedding]\nfriction = 10\n[joints.cross]\nfriction = 30\ncohesion = 1000\n"
      "[stability]\nfree = [\"top\", \"west\", \"north\", \"south\"]\n"
      "[output]\nreport = false\nsection = [{ through = [0, 2, 0], azimuth = 90 }, { name = \"plan\", level = 6 }]\n");
  const Ended cut = cleave("run rock.toml -o out");
  ASSERT_EQ(cut.code, 0) << cut.err;
  EXPECT_NE(cut.out.find("section.toml: 4 bodies, 96 m2"), std::string::npos) << cut.out;
  const std::string text = read("out/section.toml");
  EXPECT_NE(text.find("[joints.\"bedding\"]"), std::string::npos);
  EXPECT_EQ(cleave("check out/section.toml").code, 0) << cleave("check out/section.toml").err;
  EXPECT_EQ(cleave("check out/section_plan.toml").code, 0);
  const Ended run = cleave("run out/section.toml --quiet -o moved");
  ASSERT_EQ(run.code, 0) << run.err;
  const auto contact = nlohmann::json::parse(read("moved/summary.json"))["contact"];
  std::size_t fixed = 0, moved = 0;
  for (const auto& b : contact["bodies"]) {
    fixed += b["fixed"].get<bool>() ? 1U : 0U;
    moved += b["max_displacement_m"].get<double>() > 0.1 ? 1U : 0U;
  }
  EXPECT_EQ(fixed, 3U);
  EXPECT_EQ(moved, 1U);  // the block upon the bedding slides to the west
  // The horizontal section lies in a plan without gravity: what nothing pushes rests; pushed to the west, what is free
  // there leaves.
  const std::string plan = read("out/section_plan.toml");
  const Ended rests = cleave("run out/section_plan.toml --quiet -o plan");
  ASSERT_EQ(rests.code, 0) << rests.err;
  EXPECT_LT(nlohmann::json::parse(read("plan/summary.json"))["contact"]["max_displacement_m"].get<double>(), 1e-12);
  EXPECT_NE(plan.find("gravity = [0, 0]"), std::string::npos) << plan;
  const auto west = ran(with(plan, "gravity = [0, 0]", "gravity = [-5, 0]"));
  std::size_t left = 0;
  for (const auto& b : west["bodies"]) left += b["max_displacement_m"].get<double>() > 0.1 ? 1U : 0U;
  EXPECT_EQ(left, 1U);
  ASSERT_EQ(cleave("run rock.toml --quiet -o out").code, 0);  // a result with sections is replaced
}

// A horizontal section has no weight in its plane: the seismic push of the rock mass moves the four wedges around the
// shaft, each in its own way.
TEST_F(ContactExamplesTest, WedgesAroundAShaftInPlanMoveAsTheClosedFormsSay) {
  write("shaft.toml", scene("shaft_in_plan/shaft_in_plan"));
  const Ended cut = cleave("run shaft.toml -o rock");
  ASSERT_EQ(cut.code, 0) << cut.err;
  EXPECT_NE(cut.out.find(" bodies, 180 m2"), std::string::npos) << cut.out;  // 14 m by 14 m without the shaft
  const std::string plan = read("rock/section_plan.toml");
  EXPECT_NE(plan.find("# Level z = 5 m; x = east, y = north."), std::string::npos) << plan;
  write("plan.toml", plan);
  ASSERT_EQ(cleave("run plan.toml --quiet -o whole").code, 0);  // as it is
  EXPECT_TRUE(exists("whole/report.html"));
  constexpr double end = 0.6, push = 0.26 * 9.81;
  (void)ran(with(plan, "duration = 2", "duration = 0.6"));
  std::istringstream rows{read("out/bodies.csv")};
  std::string line;
  std::getline(rows, line);
  std::map<std::string, std::array<double, 3>> moved;  // x, y and rotation of the wedge behind each wall
  while (std::getline(rows, line)) {
    std::vector<std::string> cells;
    std::istringstream row{line};
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    ASSERT_EQ(cells.size(), 11U) << line;
    if (cells[1] == "1") continue;
    const auto value = [&](std::size_t k) { return std::stod(cells[k]); };
    const double x = value(3) - value(5) - 10, y = value(4) - value(6) - 10;  // of the start, from the middle
    const std::string wall = std::abs(x) > std::abs(y) ? (x > 0 ? "east" : "west") : y > 0 ? "north" : "south";
    EXPECT_NEAR(std::max(std::abs(x), std::abs(y)), 2 + 2.0 / 3, 1e-9) << line;
    EXPECT_TRUE(moved.emplace(wall, std::array{value(5), value(6), value(7)}).second) << wall;
  }
  ASSERT_EQ(moved.size(), 4U);
  const double free = push / 2 * end * end;
  const double along = free * (56 - 33 * std::tan(30 * degree)) / 65;
  EXPECT_NEAR(moved["east"][0], -12.0 / 13 * free, 1e-9);
  EXPECT_NEAR(moved["east"][1], -5.0 / 13 * free, 1e-9);
  EXPECT_NEAR(moved["north"][0], -0.6 * along, 1e-9);
  EXPECT_NEAR(moved["north"][1], -0.8 * along, 1e-9);
  for (const std::string wall : {"east", "north"}) EXPECT_NEAR(moved[wall][2], 0, 1e-7) << wall;
  for (const std::string wall : {"south", "west"}) EXPECT_LT(std::hypot(moved[wall][0], moved[wall][1]), 1e-9) << wall;
}

// A step that meets the contact law in no way, however short, is not taken: the run stops, and what it reached stays.
TEST_F(ContactExamplesTest, AStepThatCannotBeSolvedStopsTheRun) {
  // Pivoting alone refuses more than 100 contacts, which a stack of 60 has when all have landed.
  const std::string text =
      "[contact]\nduration = 0.5\nstep = 0.01\nsolver = \"lemke\"\n"
      "[[body]]\nname = \"floor\"\nfixed = true\nrectangle = { corner = [-2, -1], width = 5, height = 1 }\n"
      "[[body]]\nname = \"b\"\nrectangle = { corner = [0, 0.2], width = 1, height = 1 }\nrepeat = { count = 60, "
      "shift = [0, 1.001] }\n";
  const auto stopped = ran(text, 4);
  write("lemke.toml", with(text, "duration = 0.5", "duration = 0.25"));
  const Ended run = cleave("run lemke.toml -o out");
  EXPECT_NE(run.err.find("the state reached is in the result; try solver = \"cascade\""), std::string::npos) << run.err;
  EXPECT_EQ(stopped["status"], "stopped");
  EXPECT_NE(stopped["reason"].get<std::string>().find("the contact law was not met"), std::string::npos)
      << stopped["reason"];
  // The state is that of the last step that was solved.
  const double end = stopped["end_time_s"].get<double>();
  EXPECT_GT(end, 0.19);
  EXPECT_LT(end, 0.3);
  EXPECT_LE(stopped["residual"].get<double>(), 1e-8);
  EXPECT_NEAR(body(stopped, "b 60")["centroid"][1].get<double>(), 0.7 + 59 * 1.001 - 9.81 / 2 * end * end, 1e-3);
  for (const std::string file : {"report.html", "history.csv", "bodies.csv", "contact.pvd"}) {
    EXPECT_TRUE(exists("out/" + file)) << file;
  }
  EXPECT_EQ(ran(with(text, "solver = \"lemke\"\n", ""))["status"], "converged");
}

// No equilibrium: the state reached is written, the exit code says so.
TEST_F(ContactExamplesTest, NoRestEndsWithFour) {
  write("f.toml",
        "[contact]\nstatic = true\nduration = 0.5\nstep = 0.05\n[[body]]\nrectangle = { corner = [0, 0], width = 1, "
        "height = 1 }\n");
  const Ended run = cleave("run f.toml -o out");
  EXPECT_EQ(run.code, 4);
  EXPECT_NE(run.err.find("error: f.toml:1: contact: the bodies did not come to rest"), std::string::npos) << run.err;
  const auto contact = nlohmann::json::parse(read("out/summary.json"))["contact"];
  EXPECT_EQ(contact["status"], "stopped");
  EXPECT_NE(read("out/report.html").find("not at rest: means nothing"), std::string::npos);
  EXPECT_NE(cleave("plan f.toml").out.find("contact      run"), std::string::npos);
  write("g.toml",
        "[contact]\nduration = 1\n[[body]]\ndensity = 0\nrectangle = { corner = [0, 0], width = 1, height = 1 }\n");
  EXPECT_EQ(cleave("run g.toml -o none").code, 2);
  EXPECT_FALSE(exists("none"));
}

}  // namespace
}  // namespace cleave::cli::test
