#include "cleave/report/key_blocks.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <limits>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cleave/exchange/text.hpp"
#include "hand_made.hpp"
#include "key_groups.hpp"

namespace cleave::report {
namespace {

using namespace testing;

const std::string header =
    "block,batch,key,mode,volume_m3,weight_n,direction_x,direction_y,direction_z,net_force_n,factor_of_safety,faces,"
    "joints";
const std::string places = ",x_m,y_m,z_m,location,chainage_m,free_area_m2,sets,clock,depth_m,extent_m\n";

scene::RunResult result_of(stability::Analysis analysis) {
  scene::RunResult result = scene::empty_result();
  result.analysis = std::move(analysis);
  return result;
}

TEST(KeyBlocksCsv, HeaderIsTheContracts) { EXPECT_EQ(key_blocks_csv(grid(1), result_of({})), header + places); }

const std::string results_md = CLEAVE_SOURCE_DIR "/docs/results.md";

struct Docs {
  std::string before, tables, after;
};
/// docs/results.md, cut at the tables of columns.
Docs columns_of_docs() {
  std::ifstream file{results_md, std::ios::binary};
  const std::string text{std::istreambuf_iterator<char>{file}, {}};
  const std::size_t from = text.find('\n', text.find("<!-- columns: ")) + 1, to = text.find("<!-- end of columns -->");
  if (from > to || to == std::string::npos) return {};
  return {text.substr(0, from), text.substr(from, to - from), text.substr(to)};
}

/// `file.csv:column` of the tables of docs/results.md, in order.
std::vector<std::string> columns_in(const std::string& tables) {
  std::vector<std::string> names;
  std::istringstream lines{tables};
  std::string file;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("### ")) file = line.substr(4);
    if (!line.starts_with("| `")) continue;
    const std::string cell = line.substr(2, line.find(" | ", 2) - 2);
    for (std::size_t from = cell.find('`'); from != std::string::npos; from = cell.find('`', from + 1)) {
      const std::size_t to = cell.find('`', from + 1);
      names.push_back(file + ":" + cell.substr(from + 1, to - from - 1));
      from = to;
    }
  }
  return names;
}

// docs/results.md says which columns there are, and in which order.
TEST(KeyBlocksCsv, EveryPartBringsItsColumns) {
  scene::RunResult result = result_of({.force_transfer = true, .rotation = stability::RotationCheck::flag});
  result.support.emplace();
  result.field_stress.emplace();
  const std::string csv = key_blocks_csv(grid(1), result);
  EXPECT_TRUE(csv.starts_with(header + ",key_transferred,")) << csv;
  std::string documented;
  for (const std::string& name : columns_in(columns_of_docs().tables)) {
    const std::string_view file = "key_blocks.csv:";
    if (name.starts_with(file)) documented += (documented.empty() ? "" : ",") + name.substr(file.size());
  }
  EXPECT_EQ(csv, documented + "\n");
}

TEST(KeyGroupsCsv, LoadCasesAndStagesFollowTheBaseCase) {
  const auto one = [](std::uint32_t block) {
    return stability::KeyGroups{.groups = {{.batch = 1, .blocks = {topology::BlockId{block}}, .factors = false}}};
  };
  scene::RunResult result = result_of({});
  result.key_groups = one(3);
  result.load_cases.push_back({.name = "quake", .analysis = {}, .groups = one(4)});
  result.load_cases.push_back({.name = "calm", .analysis = {}, .groups = {}});
  scene::StageResult& stage = result.sequence.emplace().stages.emplace_back();
  stage.stage = 2;
  stage.groups = one(5);
  stage.groups->groups[0].weaker = true;
  result.let_go = {scene::LetGo::moved};
  const std::string csv = key_groups_csv(result);
  EXPECT_TRUE(csv.contains("\n1,1,in_doubt,3,0,,,0,0,0,0,,,moved,,,,,,,,,,,undecided,\n")) << csv;
  EXPECT_TRUE(csv.contains("\n1,1,in_doubt,4,0,,,0,0,0,0,quake,,,,,,,,,,,,,undecided,\n")) << csv;
  EXPECT_TRUE(csv.contains("\n1,1,in_doubt,5,0,,,0,0,0,0,,2,,,,,,,,,,,,weaker,\n")) << csv;
  EXPECT_LT(csv.find(",3,0"), csv.find(",4,0"));
  EXPECT_LT(csv.find(",4,0"), csv.find(",5,0"));
  // With moments, of what translation alone moves: the lesser of both is the group's.
  result.key_groups->groups[0] = {.batch = 1,
                                  .verdict = assembly::Verdict::unsafe,
                                  .blocks = {topology::BlockId{3U}},
                                  .factor_up = 2,
                                  .factor_move = 0.94,
                                  .factor_turning = 0.89};
  EXPECT_TRUE(key_groups_csv(result).contains("\n1,1,unsafe,3,0,2,0.94,0,0,0,0,,,moved,,,,,,,,,0.89,,,\n"));
  EXPECT_TRUE(key_groups_section(result).contains(">With moments</th>"));
  EXPECT_FALSE(key_groups_section(result).contains("Its largest block"));
  // The largest block of several may start at more.
  stability::KeyGroup several = result.key_groups->groups[0];
  several.blocks.push_back(topology::BlockId{6U});
  several.volume = cubic_metres(7);
  several.factor_of_largest = 0.915;
  result.key_groups->groups.push_back(several);
  EXPECT_TRUE(key_groups_csv(result).contains(",0.89,0.915,,\n"));
  EXPECT_TRUE(key_groups_section(result).contains(">Its largest block</th>"));
  EXPECT_TRUE(key_groups_section(result).contains(">0.915</td>"));
  EXPECT_EQ(scene::count_key_groups(*result.key_groups).factor_of_largest, 0.915);
  several.volume = cubic_metres(6);
  several.factor_of_largest = 0.5;
  result.key_groups->groups.push_back(several);
  EXPECT_EQ(scene::count_key_groups(*result.key_groups).factor_of_largest, 0.915);
  result.key_groups->groups.resize(1);
  const scene::KeyGroupFigures figures = scene::count_key_groups(*result.key_groups);
  EXPECT_EQ(figures.factor, 0.94);
  EXPECT_EQ(figures.least_factor, 0.89);
  EXPECT_EQ(figures.factor_of_largest, std::nullopt);
  result.key_groups = one(3);
  // Only groups of the rock that the page shows can be picked in it.
  const std::string table = key_groups_section(result);
  EXPECT_TRUE(table.contains("data-group=\"1\""));
  EXPECT_EQ(table.find("data-group", table.find("data-group") + 1), std::string::npos);
  EXPECT_TRUE(table.contains("Load case") && table.contains("After stage")) << table;
  result.load_cases.clear();
  result.sequence.reset();
  EXPECT_FALSE(key_groups_section(result).contains("Load case"));
}

// A tunnel along y, seen by blocks whose free faces look in different ways.
TEST(KeyBlocksCsv, SaysWhereABlockIs) {
  const auto roles = [](std::size_t free) {
    auto faces = box_faces({0, 0, 0}, {1, 1, 1}, Role::joint);
    for (FaceSpec& face : faces) face.joint = 0;
    faces[free].role = Role::free;
    faces[free].joint.reset();
    faces[free].excavation = 0;
    return faces;
  };
  HandMade made{{10, 20, 30}};
  stability::Analysis analysis;
  for (std::uint32_t side = 0; side < 6; ++side) {  // west east south north bottom top
    made.block(roles(side), box_counts, true);
    analysis.judgements.push_back(judgement(side, stability::Mode::falling, 1, 0));
  }
  scene::RunResult result = result_of(analysis);
  result.excavations = {
      {"tunnel", 1, scene::TunnelLine{.axis = {{10, 5, 30}, {10, 50, 30}}, .up = {0, 0, 1}, .outline = {}}}};
  result.joints.push_back(joint({0, 0, 1}, 0));
  result.sets = IdVector<scene::SetId, scene::SetInfo>{{{"A, bedding", 1}}};
  const std::string csv = key_blocks_csv(std::move(made).complex(), result);
  // A block that sees the tunnel to its west lies to the right of it, looking along the axis.
  for (const char* row : {"\n0,", "\n1,", "\n2,", "\n3,", "\n4,", "\n5,"}) EXPECT_TRUE(csv.contains(row));
  // The cube of 1 m reaches 1 m behind its free face, and its corners lie sqrt(3) m apart.
  const std::pair<const char*, const char*> expected[] = {
      {"right wall", "3:00"}, {"left wall", "9:00"}, {"face", ""}, {"face", ""}, {"roof", "12:00"}, {"floor", "6:00"}};
  std::size_t at = csv.find('\n');
  for (const auto& [location, clock] : expected) {
    const std::string row = csv.substr(at + 1, csv.find('\n', at + 1) - at - 1);
    EXPECT_TRUE(
        row.ends_with(std::string{",10,20,30,"} + location + ",15,1,\"A, bedding\"," + clock + ",1,1.7320508075688772"))
        << row;
    at = csv.find('\n', at + 1);
  }
}

// What only the border holds: by itself with its motion, together with others without.
TEST(BorderBlocksCsv, HasEveryBlockOfEveryCase) {
  HandMade made{{10, 20, 30}};
  for (int block = 0; block < 2; ++block) {
    auto faces = box_faces({0, 0, 0}, {1, 1, 1}, Role::joint);
    for (FaceSpec& face : faces) face.joint = 0;
    made.block(faces, box_counts, true);
  }
  scene::RunResult result = result_of({});
  result.joints.push_back(joint({0, 0, 1}, 0));
  result.sets = IdVector<scene::SetId, scene::SetInfo>{{{"bedding", 1}}};
  const topology::BlockId first{0U}, second{1U};
  result.domain_held = stability::DomainHeld{.blocks = {first, second},
                                             .alone = {{.block = second,
                                                        .mode = stability::Mode::sliding,
                                                        .direction = {0, 0, -1},
                                                        .net = newtons(5),
                                                        .factor_of_safety = 0.5}},
                                             .together = 1};
  result.load_cases.push_back(
      {.name = "quake", .analysis = {}, .domain_held = stability::DomainHeld{.blocks = {first}}});
  result.load_cases.push_back({.name = "calm", .analysis = {}});
  const std::string csv = border_blocks_csv(std::move(made).complex(), result);
  EXPECT_TRUE(
      csv.starts_with("case,block,alone,mode,volume_m3,direction_x,direction_y,direction_z,net_force_n,"
                      "factor_of_safety,x_m,y_m,z_m,location,"))
      << csv;
  const std::string place = ",10,20,30,,,0,bedding,,";
  EXPECT_TRUE(csv.contains("\nbase,0,0,,1,,,,," + place)) << csv;
  EXPECT_TRUE(csv.contains("\nbase,1,1,sliding,1,0,0,-1,5,0.5" + place)) << csv;
  EXPECT_TRUE(csv.contains("\nquake,0,0,,1,,,,," + place)) << csv;
  EXPECT_EQ(std::ranges::count(csv, '\n'), 4) << csv;
}

// Where there is no tunnel: the face of a cut, level ground above it and below, what overhangs.
TEST(KeyBlocksCsv, PlacesAtCutsAndAtSidesOfTheDomain) {
  constexpr std::uint32_t west = 0, east = 1, bottom = 4, top = 5;
  const std::optional<std::uint32_t> domain{}, slope = 0, bench = 1, cavern = 2;
  struct Free {
    std::uint32_t side;
    std::optional<std::uint32_t> excavation;
  };
  const std::vector<std::pair<std::vector<Free>, std::string>> cases{
      {{{east, slope}}, "slope"},
      {{{east, bench}, {west, domain}}, "bench"},
      {{{east, slope}, {top, domain}}, "crest"},
      {{{east, bench}, {top, bench}}, "crest"},  // a berm above it
      {{{east, domain}, {top, domain}}, "crest"},
      {{{top, slope}}, "floor"},
      {{{top, domain}}, "ground"},
      {{{bottom, cavern}}, "roof"},
      {{{east, cavern}}, "face"},
      {{{east, domain}}, "face"},
      {{{bottom, cavern}, {east, cavern}, {west, cavern}}, "face"},  // what has most area
  };
  HandMade made;
  stability::Analysis analysis;
  for (std::uint32_t block = 0; block < cases.size(); ++block) {
    auto faces = box_faces({0, 0, 0}, {1, 1, 1}, Role::joint);
    for (const Free& free : cases[block].first) {
      faces[free.side].role = Role::free;
      faces[free.side].excavation = free.excavation;
    }
    made.block(faces, box_counts, true);
    analysis.judgements.push_back(judgement(block, stability::Mode::falling, 1, 0));
  }
  scene::RunResult result = result_of(analysis);
  result.excavations = {
      {"cut", 1, {}, {}, {}, "slope"}, {"pit bench 1", 1, {}, {}, {}, "bench"}, {"cavern", 1, {}, {}, {}}};
  const std::string csv = key_blocks_csv(std::move(made).complex(), result);
  for (std::size_t block = 0; block < cases.size(); ++block) {
    const std::size_t at = csv.find("\n" + std::to_string(block) + ",");
    ASSERT_NE(at, std::string::npos);
    const std::string row = csv.substr(at + 1, csv.find('\n', at + 1) - at - 1);
    EXPECT_TRUE(row.contains("," + cases[block].second + ",,")) << row;
  }
}

// The centroid is that of all by volume; the rest that of the block with most free area.
TEST(KeyGroupsCsv, SaysWhereAGroupIs) {
  const auto roles = [](double size, std::optional<std::size_t> free, std::uint32_t joint) {
    auto faces = box_faces({0, 0, 0}, {size, size, size}, Role::joint);
    for (FaceSpec& face : faces) face.joint = joint;
    if (free) {
      faces[*free].role = Role::free;
      faces[*free].joint.reset();
      faces[*free].excavation = 0;
    }
    return faces;
  };
  HandMade made{{10, 20, 30}};
  made.block(roles(0.5, 0, 1), box_counts, true);             // to the right of the tunnel, 0.25 m2 of it
  made.block(roles(1, 4, 0), box_counts, true);               // 1 m2 of roof
  made.block(roles(0.5, std::nullopt, 0), box_counts, true);  // behind
  scene::RunResult result = result_of({});
  result.excavations = {
      {"tunnel", 1, scene::TunnelLine{.axis = {{10, 5, 30}, {10, 50, 30}}, .up = {0, 0, 1}, .outline = {}}}};
  result.joints.push_back(joint({0, 0, 1}, 0));
  result.joints.push_back(joint({0, 0, 1}, 1));
  result.sets = IdVector<scene::SetId, scene::SetInfo>{{{"A", 1}, {"B", 1}}};
  const auto of = [](std::vector<topology::BlockId> blocks) {
    return stability::KeyGroup{.batch = 1, .blocks = std::move(blocks), .factors = false};
  };
  result.key_groups =
      stability::KeyGroups{.groups = {of({topology::BlockId{0U}, topology::BlockId{1U}, topology::BlockId{2U}}),
                                      of({topology::BlockId{2U}})}};
  const auto complex = std::move(made).complex();
  const std::string csv = key_groups_csv(result, &complex);
  EXPECT_TRUE(csv.contains(",10,20,30,roof,15,12:00,1.25,A;B,,,undecided,\n")) << csv;
  EXPECT_TRUE(csv.contains(",10,20,30,,,,0,A,,,undecided,\n")) << csv;
  const std::string table = key_groups_section(result, &complex);
  EXPECT_TRUE(table.contains("roof, 12:00, chainage 15 m")) << table;
}

// A flat tetrahedron over its free base: its apex lies half a metre above the inside of the base, farther from its
// edges.
TEST(KeyBlocksCsv, DepthIsMeasuredFromTheFreeFace) {
  const geometry::Vec3 a{0, 0, 0}, b{4, 0, 0}, c{0, 4, 0}, apex{1, 1, 0.5};
  std::vector<FaceSpec> faces{{.loops = {{a, c, b}}, .role = Role::free},
                              {.loops = {{a, b, apex}}, .role = Role::joint},
                              {.loops = {{b, c, apex}}, .role = Role::joint},
                              {.loops = {{c, a, apex}}, .role = Role::joint}};
  HandMade made;
  made.block(faces, {4, 6, 4, 4, 1, 0}, true);
  stability::Analysis analysis;
  analysis.judgements = {judgement(0, stability::Mode::falling, 1, 0)};
  const std::string csv = key_blocks_csv(std::move(made).complex(), result_of(analysis));
  EXPECT_TRUE(csv.ends_with(",roof,,8,,,0.5," + number(4 * std::sqrt(2.0)) + "\n")) << csv;
}

TEST(KeyBlocksCsv, RowsAreTheRemovableBlocksThatWouldMoveWithoutFriction) {
  HandMade made;
  auto faces = box_faces({0, 0, 0}, {0.5, 0.5, 0.5}, Role::joint);
  faces[0].joint = 12;
  faces[1].joint = 3;
  faces[2].joint = 3;
  for (int i = 0; i < 5; ++i) made.block(faces, box_counts, true);
  const auto complex = std::move(made).complex();
  stability::Analysis analysis;
  analysis.judgements = {judgement(0, stability::Mode::falling, 1, 0),
                         judgement(1, stability::Mode::stable, std::nullopt, 5),
                         judgement(2, stability::Mode::tapered, std::nullopt, 5),
                         judgement(3, stability::Mode::wedge, std::nullopt, std::numeric_limits<double>::infinity()),
                         judgement(4, stability::Mode::lifting, 2, 0.1)};
  const std::string csv = key_blocks_csv(complex, result_of(analysis));
  EXPECT_EQ(csv.substr(header.size() + places.size()),
            "0,1,1,falling,0.125,1000,0,0,-1,800,0,6,3;12,0,0,0,,,0,,,,0.8660254037844386\n"
            "3,,0,wedge,0.125,1000,0,0,-1,800,inf,6,3;12,0,0,0,,,0,,,,0.8660254037844386\n"
            "4,2,1,lifting,0.125,1000,0,0,-1,800,0.1,6,3;12,0,0,0,,,0,,,,0.8660254037844386\n");
}

TEST(KeyBlocksCsv, ColumnsAfterForceTransferFollow) {
  stability::Analysis analysis;
  analysis.force_transfer = true;
  analysis.judgements = {judgement(0, stability::Mode::sliding, 1, 0.5),
                         judgement(1, stability::Mode::wedge, std::nullopt, 2)};
  analysis.judgements[0].transferred = stability::Transferred{.mode = stability::Mode::wedge,
                                                              .key = true,
                                                              .direction = {1, 0, 0},
                                                              .net = newtons(900),
                                                              .factor_of_safety = 0.25,
                                                              .passed = newtons(900)};
  const std::string csv = key_blocks_csv(grid(2), result_of(analysis));
  EXPECT_EQ(
      csv,
      header +
          ",key_transferred,mode_transferred,direction_x_transferred,direction_y_transferred,direction_z_transferred,"
          "net_force_n_transferred,factor_of_safety_transferred,passed_n_transferred,untransferred_n,"
          "lost_n_transferred" +
          places +
          "0,1,1,sliding,1,1000,0,0,-1,800,0.5,6,7,1,wedge,1,0,0,900,0.25,900,0,0,0,0,0,,,0,,,,1.7320508075688772\n"
          "1,,0,wedge,1,1000,0,0,-1,800,2,6,7,0,wedge,0,0,-1,800,2,0,0,0,0,0,1,,,0,,,,1.7320508075688772\n");
}

// docs/results.md holds what the columns say of themselves; CLEAVE_GOLDEN=1 in the environment writes it anew, unless a
// column that users have would go or change its place among the others.
TEST(KeyBlocksCsv, DocsListEveryColumn) {
  const Docs docs = columns_of_docs();
  if (std::getenv("CLEAVE_GOLDEN") != nullptr) {
    ASSERT_TRUE(keeps(columns_in(docs.tables), columns_in(columns_of_tables())))
        << "take a column that shall go, or move, out of docs/results.md first";
    std::ofstream{results_md, std::ios::binary} << docs.before << columns_of_tables() << docs.after;
    return;
  }
  EXPECT_EQ(docs.tables, columns_of_tables());
}

}  // namespace
}  // namespace cleave::report
