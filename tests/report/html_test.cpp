#include "html.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <vector>

#include "drawings.hpp"
#include "hand_made.hpp"
#include "svg.hpp"
#include "view3d.hpp"

namespace cleave::report {
namespace {

using namespace testing;

struct Example {
  topology::BlockComplex complex = grid(3);
  scene::RunResult result = scene::empty_result();

  Example() {
    result.analysis = stability::Analysis{
        .judgements = {judgement(3, stability::Mode::falling, 1, 0), judgement(7, stability::Mode::sliding, 2, 0.7)},
        .batches = {{.number = 1, .blocks = {topology::BlockId{3U}}, .volume = cubic_metres(1)},
                    {.number = 2, .blocks = {topology::BlockId{7U}}, .volume = cubic_metres(1)}},
        .stopped_at_max_batches = false};
    result.title = "Tunnel <script>alert(1)</script> & co";
    result.figures.blocks = scene::count_blocks(complex, "0123abcd");
    result.complex.error().passed = true;
    result.figures.key_blocks = scene::count_key_blocks(*result.analysis);
    result.plan.steps = {{.step = scene::Step::cut, .run = true, .why = "always"},
                         {.step = scene::Step::contact, .run = false, .why = "no bodies"}};
    result.cost.steps = {{.step = scene::Step::cut, .wall_s = 0.5, .cpu_s = 0.4, .peak_rss_mb = 12}};
    result.figures.input.joints = 2;
    result.scene_file = "tunnel.toml";
    result.notes = {"joint 7 lies outside the domain"};
    result.sets = IdVector<scene::SetId, scene::SetInfo>{{{"A", 1}, {"B", 1}}};
    for (const std::uint32_t set : {0U, 1U}) result.joints.push_back(joint({0.5, 0.2 * set, 0.5}, set));
  }
  [[nodiscard]] Page page() const { return {result, &complex}; }
};

// No source of anything may lie outside the file.
TEST(Html, AsksTheNetworkForNothing) {
  const Example e;
  const std::string html = report_html(e.page());
  const std::size_t code = html.find("<script>");
  const std::string page = html.substr(0, code);
  EXPECT_EQ(page.find("http://"), std::string::npos);
  EXPECT_EQ(page.find("https://"), std::string::npos);
  const std::regex source{"(src|href|srcset|data|action|poster)\\s*=\\s*[\"'](?!data:|#)"};
  EXPECT_FALSE(std::regex_search(page, source));
  EXPECT_EQ(html.find("@import"), std::string::npos);
  EXPECT_EQ(html.find("url(http"), std::string::npos);
  EXPECT_NE(html.find("default-src 'none'"), std::string::npos);  // and the browser would refuse
}

TEST(Html, UserTextIsEscaped) {
  const Example e;
  const std::string html = report_html(e.page());
  EXPECT_EQ(html.find("<script>alert(1)"), std::string::npos);
  EXPECT_NE(html.find("Tunnel &lt;script&gt;alert(1)&lt;/script&gt; &amp; co"), std::string::npos);
}

TEST(Html, HoldsEverySectionAndTheSameBytesTwice) {
  const Example e;
  const Page page = e.page();
  const std::string html = report_html(page);
  for (const char* id :
       {"id=\"view\"", "id=\"keys\"", "id=\"net\"", "id=\"blocks\"", "id=\"plan\"", "id=\"cost\"", "id=\"inputs\""}) {
    EXPECT_NE(html.find(id), std::string::npos) << id;
  }
  EXPECT_NE(html.find("no bodies"), std::string::npos);
  EXPECT_NE(html.find("joint 7 lies outside"), std::string::npos);
  EXPECT_NE(html.find("REVISION=\"111\""), std::string::npos);
  EXPECT_NE(html.find("OrbitControls"), std::string::npos);
  // Each script uses those before it.
  std::size_t at = 0;
  for (const char* script : {"const tables = (", "id=\"data\"", "REVISION=\"111\"",
                             "OrbitControls = ", "const view3d = (", "if (!view3d) return;"}) {
    const std::size_t found = html.find(script, at);
    ASSERT_NE(found, std::string::npos) << script;
    at = found;
  }
  EXPECT_EQ(html, report_html(page));
}

/// Numbers of the blocks in the rows of the table of key blocks.
std::vector<std::string> rows_of(const std::string& html) {
  std::vector<std::string> rows;
  const std::size_t end = html.find("</table>", html.find("id=\"keys\""));
  for (std::size_t at = html.find("id=\"keys\""); (at = html.find("<tr data-block=\"", at)) < end; ++at) {
    rows.push_back(html.substr(at + 16, html.find('"', at + 16) - at - 16));
  }
  return rows;
}

/// The first figures of the page.
std::string cards_of(const std::string& html) {
  const std::size_t begin = html.find("<section class=\"cards\"");
  return html.substr(begin, html.find("</section>", begin) - begin);
}

// "Key blocks 0" alone must not be all that the first screen says.
TEST(Html, FirstFiguresSpeakOfGroupsOfTheBorderAndOfNotes) {
  Example e;
  std::string cards = cards_of(report_html(e.page()));
  EXPECT_TRUE(cards.contains("<a href=\"#notes\">1</a>")) << cards;
  EXPECT_TRUE(report_html(e.page()).contains("id=\"notes\""));
  EXPECT_FALSE(cards.contains("Key groups"));
  EXPECT_FALSE(cards.contains("border"));

  using assembly::Verdict;
  e.result.key_groups = stability::KeyGroups{.groups = {{.verdict = Verdict::certain, .volume = cubic_metres(2)},
                                                        {.verdict = Verdict::unsafe, .volume = cubic_metres(3)},
                                                        {.verdict = Verdict::in_doubt, .volume = cubic_metres(4)}}};
  e.result.figures.groups = scene::count_key_groups(*e.result.key_groups);
  e.result.figures.key_blocks->domain_held = scene::DomainHeldFigures{4, cubic_metres(12.5), 0.25};
  cards = cards_of(report_html(e.page()));
  EXPECT_TRUE(cards.contains("Key groups</span><strong><a href=\"#groups\">2</a>")) << cards;
  EXPECT_TRUE(cards.contains("5 m³ that move, together or alone; 1 in doubt")) << cards;
  EXPECT_TRUE(cards.contains("border</span><strong><a href=\"#notes\">4</a>")) << cards;
  EXPECT_TRUE(cards.contains("12.5 m³ that would move without it, 25 % of the free area")) << cards;
  EXPECT_LT(cards.find("Key groups"), cards.find("Certificate"));

  e.result.figures.groups = scene::count_key_groups({.too_many = true});
  EXPECT_TRUE(cards_of(report_html(e.page())).contains("<strong>not judged</strong>"));
}

// Nothing moves by weight alone, and blocks do under water: the first screen says so, and whose figures it shows.
TEST(Html, FirstFiguresSpeakOfTheCaseUnderWhichMostMoves) {
  Example e;
  EXPECT_FALSE(cards_of(report_html(e.page())).contains("base case"));
  scene::Figures& figures = e.result.figures;
  figures.load_cases = {{.name = "water & ice", .figures = {.count = 9, .volume_m3 = 11.2, .batches = {}}}};
  figures.load_cases.front().groups = scene::KeyGroupFigures{.judged = true, .count = 1, .in_doubt = 2};
  figures.groups = scene::KeyGroupFigures{.judged = true};
  figures.governing_case = "base";
  std::string cards = cards_of(report_html(e.page()));
  EXPECT_TRUE(cards.contains("Key blocks, base case</span>")) << cards;
  EXPECT_TRUE(cards.contains("Key groups, base case</span>")) << cards;
  EXPECT_FALSE(cards.contains("under")) << cards;
  figures.governing_case = "water & ice";
  cards = cards_of(report_html(e.page()));
  EXPECT_TRUE(cards.contains("Key blocks under water &amp; ice</span><strong><a href=\"#load-cases\">9</a></strong>"))
      << cards;
  EXPECT_TRUE(cards.contains("11.2 m³; 1 key group, 2 in doubt")) << cards;
}

// What acts under each case is an input like any other: an engineer who signs the page must find its figures.
TEST(Html, LoadsOfEachCaseStandWithTheirFigures) {
  using stability::Actions;
  Example e;
  e.result.stability = scene::StabilitySettings{};
  scene::StabilitySettings& settings = *e.result.stability;
  settings.target = scene::Targets{.falling = 1.5, .sliding = 1.25};
  settings.loads.actions =
      Actions::make({.joint_pressure = {std::nullopt, 50e3}, .surcharges = {{.pressure = pascals(20e3)}}}).value();
  scene::LoadCase& water = settings.cases.emplace_back(scene::LoadCase{.name = "flood", .loads = {}});
  water.loads.actions = Actions::make({.water = stability::WaterTable{.level = 15, .on_free_faces = true}}).value();
  scene::LoadCase& quake = settings.cases.emplace_back(scene::LoadCase{.name = "quake", .loads = {}});
  quake.loads.body = stability::Loads::make({0, 0, -9.81}, {0.15, 0, 0}).value();
  quake.loads.actions = Actions::make({.points = {{.at = {1, 2, 3}, .force = {0, 0, -4000}}},
                                       .lines = {{.from = {0, 0, 1}, .to = {1, 0, 1}, .per_metre = {0, 0, -7000}}}})
                            .value();
  quake.target = scene::Targets{.falling = 1.2, .sliding = 1.1};
  const std::string html = report_html(e.page());
  for (const char* const text :
       {"water of 50 kPa in joints of B, on free faces 20 kPa against the rock; required factors of safety 1.5 "
        "(falling), "
        "1.25 (sliding)",
        "Load case flood", "water table at 15 m, standing on free faces too; required factors of safety 1.5 (falling)",
        "Load case quake",
        "seismic force / weight (0.15, 0, 0), force (0, 0, −4) kN at (1, 2, 3), force (0, 0, −7) "
        "kN/m from (0, 0, 1) to (1, 0, 1); required factors of safety 1.2 (falling), 1.1 (sliding)"}) {
    EXPECT_TRUE(html.contains(text)) << text;
  }
}

// The largest net force first, then those that stay, by their factor; what is smaller than a litre waits behind a mark.
TEST(Html, KeyBlocksStandBySeverity) {
  Example e;
  auto& judgements = e.result.analysis->judgements;
  judgements.clear();
  const auto add = [&](std::uint32_t block, bool key, double net, double factor) {
    judgements.push_back(judgement(block, stability::Mode::sliding, key ? std::optional{1U} : std::nullopt, factor));
    judgements.back().net = newtons(net);
  };
  add(1, false, -5, 3);
  add(2, true, 100, 0.9);
  add(5, true, 900, 0.95);
  add(6, false, -800, 1.2);
  add(8, true, 500, 0.1);
  const std::string html = report_html(e.page());
  EXPECT_EQ(rows_of(html), (std::vector<std::string>{"5", "8", "2", "6", "1"}));
  EXPECT_LT(html.find("id=\"why-5\""), html.find("id=\"why-8\""));
  EXPECT_FALSE(html.contains("id=\"why-6\""));
  EXPECT_FALSE(html.contains("<input type=\"checkbox\" id=\"show-micro\">"));  // every cube is of 1 m3

  HandMade small;
  small.block(box_faces({0, 0, 0}, {0.09, 0.1, 0.1}, Role::free), box_counts, true);
  small.block(box_faces({1, 0, 0}, {1.11, 0.1, 0.1}, Role::free), box_counts, true);
  judgements = {judgement(0, stability::Mode::falling, 1, 0), judgement(1, stability::Mode::falling, 1, 0)};
  e.complex = std::move(small).complex();
  const std::string two = report_html(e.page());
  EXPECT_TRUE(two.contains("show 1 block below a litre"));
  EXPECT_TRUE(two.contains("<tr data-block=\"0\" class=\"micro\">"));
  EXPECT_TRUE(two.contains("<tr data-block=\"1\" class=\"\">"));
}

// A square tunnel of 2 m along y, rock of one block a side: what lies left of the axis is drawn above the crown.
TEST(Html, WallsOfATunnelAreUnrolled) {
  Example e;
  HandMade made{{5e5, 7e6, 100}};  // places are relative to this
  const auto wall = [&](geometry::Vec3 low, geometry::Vec3 high, std::size_t side) {
    auto faces = box_faces(low, high, Role::joint);
    faces[side].role = Role::free;
    faces[side].excavation = 0;
    made.block(faces, box_counts, true);
  };
  wall({-2, 0, -1}, {-1, 10, 1}, 1);  // left, its east face is free
  wall({1, 0, -1}, {2, 10, 1}, 0);    // right
  wall({-1, 0, 1}, {1, 4, 2}, 4);     // roof, two blocks
  wall({-1, 4, 1}, {1, 10, 2}, 4);
  wall({-1, 10, -1}, {1, 11, 1}, 2);  // the heading: no wall
  e.complex = std::move(made).complex();
  e.result.analysis->judgements = {judgement(0, stability::Mode::sliding, 1, 0.5),
                                   judgement(1, stability::Mode::sliding, 2, 0.5)};
  e.result.excavations = {{"drift", 1,
                           scene::TunnelLine{.axis = {{5e5, 7e6, 100}, {5e5, 7e6 + 10, 100}},
                                             .up = {0, 0, 1},
                                             .outline = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}}}};
  const std::string html = report_html(e.page());
  const std::size_t begin = html.find("id=\"unrolled\"");
  ASSERT_NE(begin, std::string::npos);
  const std::string map = html.substr(begin, html.find("</section>", begin) - begin);
  EXPECT_TRUE(map.contains("drift, perimeter 8 m"));
  // 10 m over 896 pixels: the left wall lies from 1 m to 3 m from the crown, the strip's middle.
  const double scale = 896 / 10.0, crown = 10 + 4 * scale;
  const auto at = [&](double chainage, double around) {
    return detail::fixed(78 + scale * chainage) + "," + detail::fixed(crown + scale * around);
  };
  // A path with these four corners and no others; any may be the first, in either sense.
  const auto path = [&](const std::string& filled, double from, double to, double low, double high) {
    std::vector<std::string> corners{at(from, low), at(to, low), at(to, high), at(from, high)};
    for (int sense = 0; sense < 2; ++sense, std::ranges::reverse(corners)) {
      for (int turn = 0; turn < 4; ++turn, std::ranges::rotate(corners, corners.begin() + 1)) {
        if (map.contains(filled + "\" d=\"M" + corners[0] + 'L' + corners[1] + 'L' + corners[2] + 'L' + corners[3] +
                         "z\"")) {
          return true;
        }
      }
    }
    return false;
  };
  EXPECT_TRUE(path("fill=\"" + batch_colour(1), 0, 10, -3, -1));  // left wall
  EXPECT_TRUE(path("fill=\"" + batch_colour(2), 0, 10, 1, 3));    // right wall
  EXPECT_TRUE(path("pic-rock", 0, 4, -1, 1));                     // roof
  EXPECT_TRUE(path("pic-rock", 4, 10, -1, 1));
  for (const char* number : {">0</text>", ">1</text>"}) {  // once each
    EXPECT_TRUE(map.contains(number));
    EXPECT_EQ(map.find(number), map.rfind(number));
  }
  // Four faces of walls, none of the heading.
  std::size_t faces = 0;
  for (std::size_t i = 0; (i = map.find("class=\"pic-trace\"", i)) != std::string::npos; ++i) ++faces;
  EXPECT_EQ(faces, 4U);
}

// A block's picture is the same wherever the rock lies.
TEST(Html, PictureOfABlockDoesNotDependOnTheOrigin) {
  const auto picture = [](geometry::Vec3 origin) {
    HandMade made{origin};
    auto faces = box_faces({0, 0, 0}, {1, 2, 3}, Role::joint);
    faces[4].role = Role::free;
    made.block(faces, box_counts, true);
    return block_picture(std::move(made).complex(), judgement(0, stability::Mode::falling, 1, 0));
  };
  const std::string near = picture({0, 0, 0});
  EXPECT_TRUE(near.contains("pic-hidden") && near.contains("pic-wall") && near.contains("pic-key"));
  EXPECT_EQ(near, picture({1024, 4096, -512}));  // powers of two: the same roundings
}

TEST(Html, WithoutBlocksThereIsStillAReport) {
  scene::RunResult result = scene::empty_result();
  result.title = "Failed";
  result.plan.steps = {{.step = scene::Step::cut, .run = true, .why = "always"}};
  const std::string html = report_html({result});
  EXPECT_NE(html.find("not passed"), std::string::npos);
  EXPECT_EQ(html.find("id=\"view\""), std::string::npos);
  EXPECT_LT(html.size(), 100'000U);  // and three.js is left out, with what draws by it
  EXPECT_EQ(html.find("view3d"), std::string::npos);
  EXPECT_NE(html.find("const tables = ("), std::string::npos);
}

TEST(View3d, EstimateBoundsTheSize) {
  for (const int n : {2, 6, 10}) {
    const auto complex = grid(n);
    std::size_t estimate = 0;
    for (const topology::BlockId id : complex.blocks().ids()) estimate += view_bytes(complex, id);
    const View3d view = pack_view(complex, nullptr, 1'000'000'000);
    EXPECT_LE(view.json.size(), estimate + 2000);
    EXPECT_GE(static_cast<double>(view.json.size()), 0.5 * static_cast<double>(estimate));
    EXPECT_EQ(view.shown, view.total);
  }
}

// 5,000 blocks of the usual shapes take a small part of the budget; a budget that does not hold all keeps the key
// blocks.
TEST(View3d, BudgetKeepsWhatMoves) {
  const Example e;
  const View3d view = pack_view(e.complex, &*e.result.analysis, 3 * view_bytes(e.complex, topology::BlockId{0U}));
  EXPECT_EQ(view.shown, 3U);
  EXPECT_EQ(view.total, 27U);
  const auto json = nlohmann::json::parse(view.json);
  EXPECT_EQ(json["id"], "AwAAAAcAAAAAAAAA");  // 3, 7, then 0
  EXPECT_EQ(json["batch"], "AQACAAAA");
  EXPECT_LT(view_bytes(e.complex, topology::BlockId{0U}) * 5000, view_budget_bytes / 2);
}

}  // namespace
}  // namespace cleave::report
