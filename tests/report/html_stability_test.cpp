// Sections of report.html on key blocks and support, and the bolts of its 3D view.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <regex>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "cleave/exchange/text.hpp"
#include "cleave/report/key_blocks.hpp"
#include "hand_made.hpp"
#include "html.hpp"
#include "html_table.hpp"
#include "key_groups.hpp"
#include "motion.hpp"
#include "view3d.hpp"

namespace cleave::report::html_stability_test {
namespace {

using namespace testing;

std::size_t count(const std::string& text, std::string_view what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}
/// The section of that id.
std::string section(const std::string& html, const std::string& id) {
  const std::size_t from = html.find("<section id=\"" + id + "\"");
  if (from == std::string::npos) return {};
  return html.substr(from, html.find("</section>", from) - from);
}

struct Tunnel {
  topology::BlockComplex complex = grid(3);
  scene::RunResult result = scene::empty_result();
  stability::Analysis& analysis = result.analysis.emplace();
  stability::SupportResult& support = result.support.emplace();
  Page page{result, &complex};

  Tunnel() {
    analysis.judgements = {judgement(3, stability::Mode::falling, 1, 0), judgement(7, stability::Mode::sliding, 2, 0.7),
                           judgement(9, stability::Mode::sliding, std::nullopt, 1.2)};
    analysis.batches = {{.number = 1, .blocks = {topology::BlockId{3U}}, .volume = cubic_metres(1)},
                        {.number = 2, .blocks = {topology::BlockId{7U}}, .volume = cubic_metres(1)}};
    analysis.rotation = stability::RotationCheck::flag;
    analysis.judgements[1].pressing = {{complex.blocks()[topology::BlockId{7U}].faces[0], newtons(2000)}};
    analysis.judgements[2].rotation = stability::Rotation{.turns = true, .axis = {0, 1, 0}, .lack = 0.1};
    stability::Bolt bolt;
    bolt.collar = {1, 2, 3};
    bolt.direction = {0, 0, 1};
    bolt.length = metres(4);
    for (const auto status : {stability::BoltStatus::holds, stability::BoltStatus::too_short}) {
      stability::BoltResult row{.bolt = bolt};
      row.status = status;
      if (status == stability::BoltStatus::holds) row.serves = topology::BlockId{3U};
      support.bolts.push_back(row);
    }
    support.blocks = {{.block = topology::BlockId{3U}, .mode = stability::Mode::falling, .target = 1.5}};
    support.blocks[0].held = stability::Held::bolts;
    support.combined = {{.members = {topology::BlockId{3U}, topology::BlockId{7U}}, .removable = true}};
    support.combined[0].mode = stability::Mode::wedge;
    support.combined[0].passes = false;
    scene::Figures& figures = result.figures;
    figures.key_blocks = scene::count_key_blocks(analysis);
    figures.support = scene::count_support(support);
    figures.support_cases = {{"quake <1>", {.blocks = 5, .not_held = 2, .combined = 3, .combined_failing = 1}}};
    scene::MaximumRow row{.sets = {"A", "B", "C & D"}, .block = {}, .where = "roof"};
    row.block.block.volume = 12.5;
    row.block.block.code = 5;
    row.block.upward = {geometry::normalized({0.5, 0.1, 1}), geometry::normalized({-0.4, 0.6, 0.7}),
                        geometry::normalized({-0.2, -0.9, 0.4})};
    row.block.direction = {0, 0, -1};
    row.block.mode = stability::Mode::falling;
    result.maximum_blocks = {row};
    set_friction(0.5);
  }
  void set_friction(double tangent) {
    result.joints =
        IdVector<topology::JointId, scene::JointInfo>{std::vector<scene::JointInfo>(8, joint({0, 0, 1}, 0, tangent))};
    result.sets = IdVector<scene::SetId, scene::SetInfo>{{{"A", 8}}};
  }
};

TEST(HtmlStability, EachKeyBlockTellsItsFacesItsForcesAndWhyItMoves) {
  const Tunnel t;
  const std::string why = section(report_html(t.page), "why");
  ASSERT_FALSE(why.empty());
  EXPECT_EQ(count(why, "<details id=\"why-"), 2U);
  const std::string block = why.substr(why.find("<details id=\"why-7\""));
  EXPECT_NE(block.find("along one joint plane"), std::string::npos);
  EXPECT_NE(block.find("pressed with 2 kN"), std::string::npos);
  EXPECT_EQ(count(block, "aria-label=\"Forces on the block\""), 1U);
  EXPECT_EQ(count(block, "aria-label=\"Stereonet of the block\""), 2U);  // equal area and equal angle
  EXPECT_EQ(count(block, "<table class=\"faces\">"), 1U);
  const std::string faces = block.substr(block.find("<table class=\"faces\">"));
  EXPECT_EQ(count(faces.substr(0, faces.find("</table>")), "<tr><td>"), 6U);
  EXPECT_EQ(count(faces, "slides on it"), 1U);
  EXPECT_EQ(count(faces, "opens"), 1U);  // the lid: the block moves straight down
}

// Vectors are those of the scene; what an engineer compares with a compass counts from true north.
TEST(HtmlStability, DipDirectionsCountFromTrueNorth) {
  Tunnel t;
  const std::string plain = report_html(t.page);
  EXPECT_TRUE(plain.contains("x east, y north, z up; dip directions clockwise from north"));
  t.result.north = 30;
  const std::string turned = report_html(t.page);
  EXPECT_TRUE(turned.contains("z up, true north 30° clockwise from y; dip directions clockwise from true north"));
  const auto attitudes = [](const std::string& page) {
    static const std::regex pair{">([0-9]+)° / ([0-9]+)°<"};
    const std::string why = section(page, "why");
    const std::string faces = why.substr(why.find("<table class=\"faces\">"));
    std::vector<std::array<int, 2>> found;
    for (std::sregex_iterator at{faces.begin(), faces.end(), pair}, end; at != end; ++at) {
      found.push_back({std::stoi((*at)[1]), std::stoi((*at)[2])});
    }
    return found;
  };
  const auto before = attitudes(plain), after = attitudes(turned);
  ASSERT_GE(before.size(), 6U);
  ASSERT_EQ(before.size(), after.size());
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_EQ(after[i][0], before[i][0]);
    EXPECT_EQ(after[i][1], (before[i][1] + 330) % 360);
  }
}

// By itself it stays: its forces say nothing, its group does.
TEST(HtmlStability, BlocksOfAGroupPointToIt) {
  Tunnel t;
  stability::Judgement& j = t.analysis.judgements[1];
  j.mode = stability::Mode::stable;
  j.key = true;
  j.factor_of_safety = 0.849;
  t.result.key_groups = stability::KeyGroups{.groups = {{.batch = 1,
                                                         .verdict = assembly::Verdict::unsafe,
                                                         .blocks = {topology::BlockId{7U}, topology::BlockId{9U}}}}};
  t.result.group_support = stability::GroupSupport{.below = *t.result.key_groups, .left = {}};
  const auto block = [&] {
    const std::string why = section(report_html(t.page), "why");
    return why.substr(why.find("<details id=\"why-7\""));
  };
  EXPECT_TRUE(block().contains("does not move by itself; it moves in a group of 2 blocks"));
  EXPECT_TRUE(block().contains("Factor of safety of the group 0.849"));
  EXPECT_TRUE(block().contains("in a group, factor 0.849"));
  EXPECT_FALSE(block().contains("it stays"));
  EXPECT_FALSE(block().contains("Driving force"));
  EXPECT_EQ(count(block(), "aria-label=\"Forces on the block\""), 0U);
  const auto cell = [&](std::string_view column) {
    const std::string csv = key_blocks_csv(t.complex, t.result);
    std::istringstream lines{csv};
    std::string head, row;
    std::getline(lines, head);
    while (std::getline(lines, row) && !row.starts_with("7,")) {
    }
    std::istringstream names{head}, cells{row};
    std::string name, value;
    while (std::getline(names, name, ',') && std::getline(cells, value, ',') && name != column) {
    }
    return value;
  };
  EXPECT_EQ(cell("group_supported"), "held");
  EXPECT_EQ(cell("held_by_supported"), "see its group");
  EXPECT_EQ(cell("factor_of_safety_supported"), "");
  t.result.group_support->left = *t.result.key_groups;
  EXPECT_EQ(cell("group_supported"), "not_held");
  EXPECT_TRUE(block().contains("not_held"));
  t.result.group_support->left.groups[0].verdict = assembly::Verdict::in_doubt;
  EXPECT_EQ(cell("group_supported"), "in_doubt");
  const stability::KeyGroup& below = t.result.group_support->below.groups[0];
  EXPECT_EQ(t.result.group_support->net_left_of(below), std::nullopt);
  std::vector<stability::KeyGroup>& left = t.result.group_support->left.groups;
  left[0].verdict = assembly::Verdict::unsafe;
  left[0].net = newtons(1.5e3);
  left.push_back({.batch = 1, .blocks = {topology::BlockId{9U}}, .net = newtons(2.5e3)});
  left.push_back({.batch = 1, .blocks = {topology::BlockId{8U}}, .net = newtons(7e3)});
  EXPECT_TRUE(supported_groups_csv(t.result).contains(",,4000,")) << supported_groups_csv(t.result);
  EXPECT_TRUE(section(report_html(t.page), "support").contains("Out of balance"));
  t.result.group_support.reset();
  EXPECT_EQ(cell("group_supported"), "");
  EXPECT_EQ(cell("factor_of_safety_supported"), "0.849");
}

// Names of figures under a condition end with it, behind the unit.
TEST(HtmlStability, ForcesPassedOnAreInKilonewtons) {
  for (const auto& [name, unit] :
       {std::pair{"net_force_n_transferred", "kN"}, {"required_pressure_pa_supported", "kPa"}}) {
    ASSERT_NE(unit_of(name), nullptr);
    EXPECT_EQ(unit_of(name)->unit, unit);
  }
  EXPECT_EQ(unit_of("factor_of_safety_clamped"), nullptr);
  EXPECT_EQ(heading_of("net_force_n_transferred"), "Net force transferred (kN)");
  Tunnel t;
  t.analysis.force_transfer = true;
  for (stability::Judgement& j : t.analysis.judgements) {
    j.transferred = stability::Transferred{.mode = j.mode, .key = true, .net = newtons(912e3)};
  }
  EXPECT_TRUE(section(report_html(t.page), "keys").contains(">912</td>"));
}

// With gravity aslant the weight has to be drawn along it: drawn straight down, the difference stood there as a load
// that nobody gave.
TEST(HtmlStability, WeightIsDrawnAlongGravity) {
  Tunnel t;
  stability::Judgement& falling = t.analysis.judgements[0];
  falling.direction = {0.6, 0, -0.8};
  falling.driving = falling.weight;
  falling.resistance = newtons(0);
  falling.pressing.clear();
  const auto drawing = [&] {
    const std::string why = section(report_html(t.page), "why");
    const std::string block = why.substr(why.find("<details id=\"why-3\""));
    return block.substr(0, block.find("equal area"));
  };
  EXPECT_NE(drawing().find(">Q</text>"), std::string::npos);  // gravity straight down: something else pulls aside
  t.result.stability = scene::StabilitySettings{.loads = {.body = stability::Loads::make({6, 0, -8}).value()}};
  const std::string along = drawing();
  EXPECT_EQ(along.find(">Q</text>"), std::string::npos);
  EXPECT_NE(along.find(">W</text>"), std::string::npos);
  EXPECT_NE(along.find("M132,132L132,242\" stroke=\"#555\""), std::string::npos);  // down the page, full length
}

// A friction circle that touches the rim must not cross the net to the other side.
TEST(HtmlStability, FrictionCirclesAreNotTornAtTheRim) {
  Tunnel t;
  const double degree = std::numbers::pi / 180;
  for (int degrees = 5; degrees < 90; degrees += 5) {
    t.set_friction(std::tan(degrees * degree));
    // A plane as steep as leaves its pole this far above the rim, dipping any way.
    topology::BlockComplex::Data data = t.complex.data();
    for (topology::Face& face : data.faces) {
      const double trend = 15 * degrees * degree;
      face.outward = {-std::cos(degrees * degree) * std::sin(trend), -std::cos(degrees * degree) * std::cos(trend),
                      -std::sin(degrees * degree)};
    }
    const topology::BlockComplex turned{std::move(data)};
    t.page.complex = &turned;
    const std::string why = section(report_html(t.page), "why");
    const std::regex path{R"re(<path fill="none" d="M([^"]*)" stroke="#D55E00")re"};
    std::size_t circles = 0;
    for (std::sregex_iterator it{why.begin(), why.end(), path}, end; it != end; ++it) {
      ++circles;
      std::string points = (*it)[1];
      std::ranges::replace(points, 'L', ' ');
      std::ranges::replace(points, ',', ' ');
      std::istringstream in{points};
      double x = 0, y = 0, px = 0, py = 0;
      for (bool first = true; in >> x >> y; first = false) {
        if (!first) {
          EXPECT_LT(std::hypot(x - px, y - py), 30) << degrees;
        }
        px = x;
        py = y;
      }
    }
    EXPECT_GT(circles, 0U);
  }
}

// The net of a block: its planes, free surfaces dashed, friction circle and direction of motion, in both projections.
TEST(HtmlStability, NetsShowFreeSurfacesFrictionAndDirection) {
  const Tunnel t;
  const std::string why = section(report_html(t.page), "why");
  const std::string sliding = why.substr(why.find("<details id=\"why-7\""));
  std::size_t nets = 0;
  for (std::size_t at = sliding.find("Stereonet of the block"); at != std::string::npos;
       at = sliding.find("Stereonet of the block", at + 1)) {
    const std::string net = sliding.substr(at, sliding.find("</svg>", at) - at);
    std::size_t free = 0;
    for (const topology::FaceId id : t.complex.blocks()[topology::BlockId{7U}].faces) {
      free += t.complex.faces()[id].role == topology::Role::free ? 1U : 0U;
    }
    EXPECT_EQ(count(net, "stroke-dasharray=\"4 3\""), free);
    EXPECT_EQ(count(net, "stroke=\"#0072B2\""), 6 - free);
    EXPECT_GE(count(net, "stroke=\"#D55E00\""), 1U);                     // friction circle
    EXPECT_EQ(count(net, "stroke=\"#009E73\" stroke-width=\"3\""), 1U);  // where it goes
    ++nets;
  }
  EXPECT_EQ(nets, 2U);
}

// Bars of the tornado: the input that matters most on top, each from its lower to its upper factor of safety.
TEST(HtmlStability, SensitivityIsATornado) {
  Tunnel t;
  stability::Sensitivity row{.block = topology::BlockId{7U}, .share = 0.2, .base = 0.7};
  row.friction = {0.5, 0.9};
  row.cohesion = {0.65, 0.75};
  row.water = {0.8, 0.6};
  t.result.sensitivity = {row};
  const std::string why = section(report_html(t.page), "why");
  EXPECT_EQ(count(why, "aria-label=\"Sensitivity of the factor of safety\""), 1U);
  const std::string drawing = why.substr(why.find("Sensitivity of the factor of safety"));
  EXPECT_EQ(count(drawing.substr(0, drawing.find("</svg>")), "<rect "), 3U);
  const std::size_t friction = drawing.find(">friction<"), water = drawing.find(">water<"),
                    cohesion = drawing.find(">cohesion<");
  EXPECT_LT(friction, water);
  EXPECT_LT(water, cohesion);
  EXPECT_NE(drawing.find("x=\"90\" y=\"6\" width=\"300\""), std::string::npos);    // 0.5 to 0.9: all of the width
  EXPECT_NE(drawing.find("x=\"165\" y=\"32\" width=\"150\""), std::string::npos);  // 0.6 to 0.8
  t.result.sensitivity.clear();
  EXPECT_EQ(count(section(report_html(t.page), "why"), "Sensitivity of the factor of safety"), 0U);
}

TEST(HtmlStability, TurningBlocksAreMarkedInTheTable) {
  const Tunnel t;
  const std::string keys = section(report_html(t.page), "keys");
  EXPECT_NE(keys.find("<th>Topples?</th>"), std::string::npos);
  EXPECT_EQ(count(keys, ">topples</b></td>"), 1U);
  EXPECT_EQ(t.result.figures.key_blocks->turning, 1U);
}

TEST(HtmlStability, SupportShowsBlocksBodiesAndLoadCases) {
  const Tunnel t;
  const std::string support = section(report_html(t.page), "support");
  EXPECT_EQ(count(support, "<tr data-block=\"3\">"), 1U);
  EXPECT_NE(support.find("<table id=\"combined\">"), std::string::npos);
  EXPECT_NE(support.find("3, 7</td>"), std::string::npos);
  EXPECT_NE(support.find("<table id=\"support-cases\">"), std::string::npos);
  EXPECT_NE(support.find("quake &lt;1&gt;</td><td>no</td><td>5</td><td>2</td>"), std::string::npos);
}

TEST(HtmlStability, ThePatternFoundHasItsSpacingRingsAndShareThatFails) {
  Tunnel t;
  scene::DesignResult found{.length = 3, .found = true, .scale = 1.5, .bolts = 132, .spot_bolts = 7, .cost = 396};
  found.spacing = {3.75, 4.5};
  found.rings = 22;
  found.offsets = 40;
  found.failing = 7;
  found.failing_share = {0.07, 0.33};
  found.governing = 12;
  found.groups = {.count = 3, .not_held = 1, .in_doubt = 1};
  t.result.designs = {found, scene::DesignResult{.length = 2}};
  const std::string support = section(report_html(t.page), "support");
  EXPECT_NE(
      support.find("<tr><td>3</td><td>3.75 × 4.5</td><td>22</td><td>132</td><td>7</td><td>396</td><td>1 of 3, 1 in "
                   "doubt</td><td>7 of 40 (7 to 33 %)</td><td>12</td></tr>"),
      std::string::npos)
      << support;
  EXPECT_NE(support.find("none passes"), std::string::npos);
}

TEST(HtmlStability, LargestKeyBlocksHaveATable) {
  Tunnel t;
  const std::string maximum = section(report_html(t.page), "maximum");
  EXPECT_NE(maximum.find("A, B, C &amp; D</td><td>A, C &amp; D</td><td>roof</td><td data-v=\"1\">1</td>"
                         "<td data-v=\"12.5\">12.5</td>"),
            std::string::npos);
  // What they are bounds of is said.
  EXPECT_NE(maximum.find("between two joints of one set are not among them"), std::string::npos);
  t.result.maximum_blocks.clear();
  EXPECT_TRUE(section(report_html(t.page), "maximum").empty());
}

// Every point of a filled outline lies on the side of each plane that its code names, or on the plane.
TEST(HtmlStability, JointPyramidsAreDrawnOnTheirSides) {
  Tunnel t;
  scene::MaximumRow row = t.result.maximum_blocks.front();
  t.result.maximum_blocks.clear();
  for (std::uint32_t code = 0; code < 8; ++code) {
    row.block.block.code = code;
    t.result.maximum_blocks.push_back(row);
  }
  const std::string net = section(report_html(t.page), "maximum");
  EXPECT_EQ(count(net, "aria-label=\"Joint pyramids\""), 1U);
  for (const std::string_view code : {"000", "100", "010", "110", "001", "101", "011", "111"}) {
    EXPECT_EQ(count(net, std::string{">"}.append(code).append("</text>")), 1U) << code;
    const std::size_t from = net.find(std::string{"data-code=\""}.append(code).append("\" d=\"M"));
    ASSERT_NE(from, std::string::npos);
    std::string points = net.substr(from + 20, net.find('Z', from) - from - 20);
    std::ranges::replace(points, 'L', ' ');
    std::ranges::replace(points, ',', ' ');
    std::istringstream in{points};
    std::size_t inside = 0;
    for (double px = 0, py = 0; in >> px >> py;) {
      const double x = (px - 245) / 100, y = (245 - py) / 100, r2 = x * x + y * y;
      if (r2 > 400) continue;  // so far out that two digits say little
      const geometry::Vec3 d{2 * x / (1 + r2), 2 * y / (1 + r2), (r2 - 1) / (1 + r2)};
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_GT((code[i] == '0' ? 1 : -1) * dot(d, row.block.upward[i]), -1e-3) << code;
      }
      ++inside;
    }
    EXPECT_GT(inside, 60U) << code;
  }
  // Only the one that holds straight up is filled outside its outline.
  EXPECT_EQ(count(net, "M0,0H490V490H0Z"), 1U);
}

TEST(HtmlStability, WithoutSupportThereIsNoSuchSection) {
  Tunnel t;
  t.result.support.reset();
  t.result.figures.support.reset();
  EXPECT_TRUE(section(report_html(t.page), "support").empty());
}

TEST(HtmlStability, BoltsAreInTheView) {
  const Tunnel t;
  const View3d view = pack_view(t.complex, &t.analysis, 1'000'000'000, &t.support);
  const auto json = nlohmann::json::parse(view.json);
  // Two bolts of six floats; the view's middle is (1.5, 1.5, 1.5), so the first collar is (-0.5, 0.5, 1.5).
  ASSERT_EQ(json["bolts"].get<std::string>().size(), 64U);
  EXPECT_EQ(json["bolts"].get<std::string>().substr(0, 16), "AAAAvwAAAD8AAMA/");
  EXPECT_EQ(json["boltStatus"], "AAM=");
  EXPECT_EQ(json["boltServes"], "AwAAAP////8=");
  const std::string html = report_html(t.page);
  EXPECT_NE(html.find("data.bolts"), std::string::npos);             // and the page draws them
  EXPECT_NE(html.find("getElementById('why-'"), std::string::npos);  // a click shows why a block moves
  EXPECT_FALSE(nlohmann::json::parse(pack_view(t.complex, &t.analysis, 1'000'000).json).contains("bolts"));
}

template <class T>
std::string packed(std::vector<T> values) {
  std::string out;
  append_base64(out, std::as_bytes(std::span{values}));
  return out;
}

TEST(HtmlStability, FacesInTheViewKnowTheSetOfTheirJoint) {
  const Tunnel t;
  ViewSets sets{.names = {"A", "B \"steep\""}, .of = {}};
  std::vector<std::uint16_t> expected;
  for (const topology::BlockId id : t.complex.blocks().ids()) {
    for (const topology::FaceId face : t.complex.blocks()[id].faces) {
      const auto joint = t.complex.faces()[face].joint;
      if (joint && joint->index() >= sets.of.size()) sets.of.resize(joint->index() + 1);
      expected.push_back(joint ? static_cast<std::uint16_t>(joint->index() % 2) : std::uint16_t{65535});
    }
  }
  ASSERT_GT(sets.of.size(), 1U);
  for (std::size_t j = 0; j < sets.of.size(); ++j) sets.of[j] = static_cast<std::uint16_t>(j % 2);
  const auto json = nlohmann::json::parse(pack_view(t.complex, nullptr, 1'000'000, nullptr, nullptr, &sets).json);
  EXPECT_EQ(json["setNames"], nlohmann::json(sets.names));
  EXPECT_EQ(json["faceSet"].get<std::string>().size(), packed(expected).size());
  const auto one = nlohmann::json::parse(pack_view(t.complex, nullptr, 1, nullptr, nullptr, &sets).json);
  ASSERT_EQ(one["faces"].get<std::string>().size(), 8U);  // one block
  std::vector<std::uint16_t> first;
  const std::string id = one["id"];
  for (const topology::BlockId block : t.complex.blocks().ids()) {
    if (packed<std::uint32_t>({block.value()}) != id) continue;
    for (const topology::FaceId face : t.complex.blocks()[block].faces) {
      const auto joint = t.complex.faces()[face].joint;
      first.push_back(joint ? static_cast<std::uint16_t>(joint->index() % 2) : std::uint16_t{65535});
    }
  }
  EXPECT_EQ(one["faceSet"], packed(first));
  EXPECT_FALSE(nlohmann::json::parse(pack_view(t.complex, nullptr, 1'000'000).json).contains("setNames"));
}

TEST(HtmlStability, KeyGroupsComeFirstInTheViewWithTheirMotions) {
  const Tunnel t;
  const auto last = static_cast<std::uint32_t>(t.complex.blocks().size() - 1);
  stability::KeyGroups groups;
  groups.groups.push_back({.batch = 1, .blocks = {topology::BlockId{last}}, .rates = {{{1, 2, 3}, {4, 5, 6}}}});
  const auto first = nlohmann::json::parse(pack_view(t.complex, nullptr, 1, nullptr, &groups).json);
  EXPECT_EQ(first["id"], packed<std::uint32_t>({last}));
  groups.groups.push_back({.batch = 2, .blocks = {topology::BlockId{0U}}});  // in doubt: moves nowhere
  const auto json = nlohmann::json::parse(pack_view(t.complex, nullptr, 1'000'000, nullptr, &groups).json);
  EXPECT_EQ(json["groupSizes"], packed<std::uint32_t>({1, 1}));
  EXPECT_EQ(json["groupBlocks"], packed<std::uint32_t>({last, 0}));
  // The view's middle is (1.5, 1.5, 1.5).
  const auto at = [&](std::uint32_t block) {
    return t.complex.blocks()[topology::BlockId{block}].centroid - geometry::Vec3{1.5, 1.5, 1.5};
  };
  std::vector<float> motions;
  for (const geometry::Vec3& v : {at(last), {1, 2, 3}, {4, 5, 6}, at(0), {}, {}}) {
    for (const double c : {v.x, v.y, v.z}) motions.push_back(static_cast<float>(c));
  }
  EXPECT_EQ(json["groupMotions"], packed(motions));
  EXPECT_FALSE(pack_view(t.complex, nullptr, 1'000'000).json.contains("group"));
}

TEST(StabilityTables, RowsOfTheFilesBesideKeyBlocks) {
  Tunnel t;
  t.result.support_cases = {{"a,b", t.support}};
  const std::string blocks = support_blocks_csv(t.result);
  EXPECT_TRUE(blocks.contains("\nbase,3,falling,1.5,"));
  EXPECT_TRUE(blocks.contains("\n\"a,b\",3,falling,1.5,"));
  EXPECT_TRUE(combined_blocks_csv(t.result).contains("\nbase,0,3;7,0,1,wedge,1,0,0,0,0,,,0,0\n"));
  EXPECT_TRUE(maximum_blocks_csv(t.result).contains("\nA,B,C & D,101,roof,0,0,12.5,"));
  t.result.support.reset();
  const std::string keys = key_blocks_csv(t.complex, t.result);
  EXPECT_TRUE(keys.contains(",faces,joints,topples,turns,x_m,"));
  EXPECT_TRUE(keys.contains("9,,0,sliding,1,1000,0,0,-1,800,1.2,6,7,1,1,"));
}

// What bolts did in motion stands beside what the check says of them, and only where they acted.
TEST(StabilityTables, BoltsThatActedInMotion) {
  Tunnel t;
  const std::string before = bolts_csv(t.result);
  EXPECT_TRUE(before.contains(",motion_force_n,motion_lengthened_m,motion_broken_s,outside_m\n")) << before;
  scene::MotionResult& motion = t.result.motion.emplace();
  motion.supported = true;
  EXPECT_EQ(bolts_csv(t.result), before);
  motion.bolts = {{.bolt = 1, .largest = newtons(2500), .lengthened = metres(0.25), .broken_at = Time::from_si(1.5)}};
  const std::string after = bolts_csv(t.result);
  const std::size_t second = before.rfind('\n', before.size() - 2);
  EXPECT_EQ(after.substr(0, second), before.substr(0, second));
  EXPECT_TRUE(after.ends_with(",2500,0.25,1.5,0\n")) << after;
  EXPECT_TRUE(motion_section(motion).contains("1 tie blocks that are let go, 1 of them broke; largest force 2.5 kN"));
}

// Of motion that was refused there are no figures: nothing ran, and why.
TEST(StabilityTables, RefusedMotionHasNoFigures) {
  const scene::MotionResult refused{.stopped_why = "refused: a < b", .refused = true};
  const std::string section = motion_section(refused);
  EXPECT_TRUE(section.contains("Nothing ran; refused: a &lt; b.</p></section>")) << section;
  EXPECT_FALSE(section.contains("<table"));
}

}  // namespace
}  // namespace cleave::report::html_stability_test
