// Lines of the terminal name declared figures: each line with all its figures, and without.

#include <gtest/gtest.h>

#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "figures.hpp"
#include "say.hpp"

namespace cleave::cli {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

scene::RunResult result() {
  scene::RunResult r = scene::empty_result();
  r.title = "Tunnel";
  r.seed = 7;
  r.figures.input.joints = 12;
  for (int k = 1; k <= 10; ++k) {
    r.figures.input.excavations.push_back({.name = "cut " + std::to_string(k), .volume = cubic_metres(64e6)});
  }
  return r;
}

scene::KeyBlockFigures key_blocks() {
  scene::KeyBlockFigures key{.count = 3, .volume_m3 = 1.25, .batches = {}};
  for (std::uint32_t k = 1; k <= 9; ++k) key.batches.push_back({.batch = k, .count = 2, .volume_m3 = 1.0 / 3});
  key.domain_held = scene::DomainHeldFigures{.count = 4, .volume = cubic_metres(2.5), .share = 0.1};
  return key;
}

bool holds(const std::string& text, const std::string& line) { return text.find(line) != std::string::npos; }

TEST(TerminalTest, BlocksAndKeyBlocks) {
  scene::RunResult r = result();
  r.figures.blocks = scene::BlockFigures{.count = 1200, .volume_m3 = 123456.7, .concave = 5, .slivers = 2, .hash = {}};
  r.figures.key_blocks = key_blocks();
  r.figures.load_cases = {{"quake", {.count = 2, .volume_m3 = 0.5, .batches = {}, .lowest_factor_of_safety = 0.75}}};
  const std::string text = figures_of(r);
  EXPECT_TRUE(
      text.starts_with("Tunnel\njoints       12, seed 7\nexcavated    cut 1, 64000000 m3\n"
                       "             cut 2, 64000000 m3\n"))
      << text;
  EXPECT_TRUE(holds(text, "             cut 8, 64000000 m3\n             and 2 more\n")) << text;
  EXPECT_TRUE(holds(text,
                    "\nblocks       1200 (5 concave, 2 slivers), volume 123457 m3\n"
                    "certificate  passed: volume error 0.0e+00, face vectors 0.0e+00\n"))
      << text;
  EXPECT_TRUE(holds(text,
                    "\nkey blocks   3 in 9 batches, volume 1.25 m3\n"
                    "  batch 1     2 blocks, 0.333333 m3\n"))
      << text;
  EXPECT_TRUE(holds(text,
                    "  not counted: 4 that only a side of the domain holds, 2.5 m3\n  and 1 more batches\n"
                    "  under quake: 2 blocks, 0.5 m3, lowest factor of safety 0.75\n"))
      << text;
  EXPECT_TRUE(holds(text, "\ntime         0.00 s, 0.00 s of CPU, 0 MB, 1 threads\n")) << text;
  EXPECT_FALSE(holds(text, "with groups"));
  EXPECT_FALSE(holds(text, "governs"));
}

// What moves only together stands beside the key blocks, not in a note alone.
TEST(TerminalTest, WhatMovesInGroups) {
  scene::RunResult r = result();
  r.figures.blocks = scene::BlockFigures{.hash = {}};
  r.figures.key_blocks = key_blocks();
  const auto moving = [](double factor) {
    return stability::KeyGroup{.batch = 1, .verdict = assembly::Verdict::unsafe, .factor_move = factor};
  };
  r.figures.groups = scene::count_key_groups({.groups = {moving(0.5), moving(0.75), {.batch = 1}}});
  r.figures.groups->factor_of_largest = 0.875;
  r.figures.groups->in_all = scene::InAll{.count = 5, .volume = cubic_metres(40)};
  scene::CaseFigures quake{"quake", {.count = 2, .volume_m3 = 0.5, .batches = {}, .lowest_factor_of_safety = 0.75}};
  quake.groups = scene::KeyGroupFigures{.judged = true, .count = 1, .in_doubt = 3};
  quake.groups->in_all = scene::InAll{.count = 2, .volume = cubic_metres(0.5)};
  r.figures.load_cases = {quake};
  r.figures.governing_case = "base";
  const std::string text = figures_of(r);
  EXPECT_TRUE(holds(
      text,
      " batches\n  with groups: 5 blocks, 40 m3 in all; 2 groups, least factor 0.5, largest block 0.875; 1 in doubt\n"
      "  under quake: 2 blocks, 0.5 m3, lowest factor of safety 0.75\n"
      "  with groups: 2 blocks, 0.5 m3 in all; 1 group; 3 in doubt\n"
      "  governs: base\n"))
      << text;
}

TEST(TerminalTest, ACertificateThatDidNotPass) {
  scene::RunResult r = result();
  topology::Certificate certificate;
  certificate.euler_violations = 2;
  certificate.open_shells = 1;
  certificate.unpaired_patches = 6;
  certificate.volume_relative_error = 0.25;
  r.complex = std::unexpected(certificate);
  r.figures.blocks.reset();
  EXPECT_TRUE(holds(figures_of(r),
                    "\ncertificate  DID NOT PASS: 2 Euler violations, 1 open shells, 6 unpaired patches, "
                    "volume error 2.5e-01\n"))
      << figures_of(r);
}

TEST(TerminalTest, SupportAndMotion) {
  scene::RunResult r = result();
  r.figures.support =
      scene::SupportFigures{.targets = {.falling = 1.5, .sliding = 2},
                            .blocks = 10,
                            .held_by_bolts = 1,
                            .held_by_shotcrete = 2,
                            .held_by_both = 3,
                            .not_held = 4,
                            .key_blocks_behind = 2,
                            .bolts = 50,
                            .combined = 6,
                            .combined_failing = 5,
                            .required_force_n = 1234.5,
                            .missing_force_n = infinity,
                            .groups = scene::SupportedGroupFigures{.count = 8, .not_held = 7, .in_doubt = 1}};
  r.motion =
      scene::MotionResult{.at_rest = true, .end = seconds(1.5), .steps = 40, .residual = 1e-6, .energy_error = 1e-3};
  const std::string text = figures_of(r);
  EXPECT_TRUE(holds(
      text,
      "\nsupport      DOES NOT PASS: 10 blocks below their target by themselves (falling 1.5, sliding 2): 1 held by "
      "bolts, 2 by shotcrete, 3 by both, 4 not held\n  2 more key blocks lie behind them and stay where they are held\n"
      "  50 bolts, 6 stitched bodies (5 failing); required by these blocks 1.234 kN, missing no force is enough\n  8 "
      "groups of blocks below their target, 7 not held, 1 in doubt\n"))
      << text;
  EXPECT_TRUE(holds(text,
                    "\nmotion       0 of 0 blocks moved, 1.5 s (at rest), 40 steps, residual 1.0e-06, energy error "
                    "1.0e-03\n"))
      << text;
  EXPECT_NE(log_of(r).find("\nresult\n" + text), std::string::npos);
  // One is no more than one.
  scene::RunResult one = result();
  one.figures.support = scene::SupportFigures{
      .block_by_block = true, .blocks = 1, .held_by_bolts = 1, .key_blocks_behind = 1, .bolts = 1, .combined = 1};
  EXPECT_EQ(verdict_of(one), "");
  EXPECT_TRUE(holds(figures_of(one),
                    ": 1 block below its target by itself (falling 1.5, sliding 1.3): 1 held by bolts, 0 by shotcrete, "
                    "0 by both, 0 not held\n  1 more key block lies behind it and stays where it is held\n"
                    "  1 bolt, 1 stitched body (0 failing); required by this block 0 kN, missing 0 kN\n"))
      << figures_of(one);
  one.figures.support->held_in_failing_groups = 1;
  EXPECT_TRUE(holds(figures_of(one),
                    " 0 not held\n  of those held, 1 lies in a group of blocks that is not, or in doubt: see "
                    "supported_groups.csv\n"))
      << figures_of(one);
  // Where motion was refused no block was let go: it is not that none moved.
  r.motion = scene::MotionResult{.stopped_why = "refused: blocks overlap at the start", .refused = true};
  const std::string refused = figures_of(r);
  EXPECT_TRUE(holds(refused, "\nmotion       nothing ran; refused: blocks overlap at the start\n")) << refused;
  EXPECT_FALSE(refused.contains("blocks moved"));
}

// What passes in the end may fail on the way there, or under load: the first line says so.
TEST(TerminalTest, SupportThatDoesNotPassEverywhere) {
  scene::RunResult r = result();
  using enum scene::GroupsJudged;
  scene::GroupsJudged judged = yes;
  const auto line = [&](bool passes, std::vector<std::uint32_t> stages, const std::vector<std::string>& cases) {
    r.figures.support =
        scene::SupportFigures{.block_by_block = passes, .groups_judged = judged, .failing_stages = std::move(stages)};
    r.figures.support_cases.clear();
    for (const std::string& name : cases) {
      r.figures.support_cases.push_back({name, {.block_by_block = name == "calm", .groups_judged = judged}});
    }
    const std::string text = figures_of(r);
    const std::size_t at = text.find("support      ");
    // So does the last line of all, which is there in that case alone.
    const std::string last = verdict_of(r);
    const std::string_view word = judged == too_many && passes ? "NOT JUDGED" : "DOES NOT PASS";
    EXPECT_EQ(last.empty(), !text.contains(word)) << last;
    EXPECT_TRUE(last.empty() || (last.starts_with("verdict: the support ") && last.contains(word))) << last;
    return text.substr(at, text.find(':', at) - at);
  };
  EXPECT_EQ(line(true, {}, {}), "support      passes");
  EXPECT_EQ(line(true, {}, {"calm"}), "support      passes");
  EXPECT_EQ(line(true, {}, {"calm", "quake"}), "support      passes without load, DOES NOT PASS under quake");
  EXPECT_EQ(line(true, {1}, {}), "support      passes when all is excavated, DOES NOT PASS after stage 1");
  EXPECT_EQ(line(true, {1, 3}, {"quake"}),
            "support      passes without load when all is excavated, DOES NOT PASS under quake, after stages 1, 3");
  EXPECT_EQ(line(false, {1}, {"quake"}), "support      DOES NOT PASS");
  judged = not_asked;
  EXPECT_EQ(line(true, {}, {}), "support      passes block by block");
  EXPECT_EQ(line(true, {}, {"quake"}), "support      passes block by block without load, DOES NOT PASS under quake");
  // What it is not asked to hold is no part of that.
  r.figures.support->not_asked = {.count = 1, .volume = cubic_metres(477.6), .lowest_factor_of_safety = 1.198};
  EXPECT_TRUE(
      figures_of(r).contains("passes block by block without load, DOES NOT PASS under quake, but for 1 block "
                             "(477.6 m3, least factor 1.2) that it is not asked to hold, see the notes:"));
  judged = too_many;
  EXPECT_EQ(line(true, {}, {}), "support      passes block by block, GROUPS OF BLOCKS NOT JUDGED");
  // Crumbs and what others press on are told apart.
  r.figures.support->small_blocks = 2;
  r.figures.support->small_not_held = 1;
  r.figures.support->small_required_force_n = 2.36e5;
  r.figures.support->passed_on_blocks = 3;
  r.figures.support->passed_on_required_force_n = 6.8e4;
  EXPECT_TRUE(
      holds(figures_of(r),
            "\n  of these 2 with less free face than `spot_area`: 1 not held, required 236 kN\n"
            "  of these 3 only for what other blocks pass to them: 0 not held, required 68 kN; hold the others\n"))
      << figures_of(r);
  // What a load asks for may be more than what the base case does.
  r.figures.support_cases = {
      {"quake",
       {.targets = {.sliding = 1.1}, .blocks = 3, .not_held = 1, .required_force_n = 6.315e6, .missing_force_n = 1e3}}};
  EXPECT_TRUE(holds(figures_of(r),
                    "\n  under quake: 3 blocks below their target (1.5, 1.1), 1 not held; required by these blocks "
                    "6315 kN, missing 1 kN\n"))
      << figures_of(r);
  EXPECT_EQ(line(false, {}, {}), "support      DOES NOT PASS");
}

struct Row {
  std::optional<double> volume;
};
template <class V>
void fields(V& v, const Row& x) {
  v("volume_m3", x.volume);
}

TEST(TerminalTest, ANameThatIsNotDeclaredIsAnError) {
  EXPECT_EQ(say("{volume_m3} {volume_m3:.1f}", Row{2.25}), "2.25 2.2");
  EXPECT_THROW(static_cast<void>(say("{volume}", Row{2.25})), fmt::format_error);
  EXPECT_THROW(static_cast<void>(say("{volume_m3}", Row{})), fmt::format_error);
}

}  // namespace
}  // namespace cleave::cli
