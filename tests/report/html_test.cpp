#include "html.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <vector>

#include "hand_made.hpp"
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
    result.plan.stages = {{.stage = scene::Stage::cut, .run = true, .why = "always"},
                          {.stage = scene::Stage::contact, .run = false, .why = "no bodies"}};
    result.cost.stages = {{.stage = scene::Stage::cut, .wall_s = 0.5, .cpu_s = 0.4, .peak_rss_mb = 12}};
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
  const std::regex source{"(src|href|srcset|data|action|poster)\\s*=\\s*[\"'](?!data:)"};
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

TEST(Html, WithoutBlocksThereIsStillAReport) {
  scene::RunResult result = scene::empty_result();
  result.title = "Failed";
  result.plan.stages = {{.stage = scene::Stage::cut, .run = true, .why = "always"}};
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
