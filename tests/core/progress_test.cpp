#include "cleave/core/progress.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "cleave/core/parallel.hpp"

namespace cleave {
namespace {

/// A reporter with a clock that stands still until told.
struct Bench {
  explicit Bench(ProgressStyle style)
      : progress{style, [this](std::string_view line) { lines.emplace_back(line); }, [this] { return now; }} {}
  void at(double seconds) {
    now = seconds;
    progress.tick();
  }
  double now = 0.0;
  std::vector<std::string> lines;
  Progress progress;
};

TEST(ProgressTest, ALogGetsOneLineEveryTenSeconds) {
  Bench b{ProgressStyle::lines};
  b.progress.begin("cut", 200);
  b.progress.advance(50);
  for (int tenths = 0; tenths <= 250; ++tenths) b.at(tenths / 10.0);
  b.progress.end();
  EXPECT_EQ(b.lines, (std::vector<std::string>{"cut: 25 %, 30 s left\n", "cut: 25 %, 1 min 00 s left\n"}));
}

// What an earlier run did took no time of this one.
TEST(ProgressTest, WhatWasThereBeforeSaysNothingOfTheTimeLeft) {
  Bench b{ProgressStyle::lines};
  b.progress.begin("monte_carlo", 1000);
  b.progress.found(899);
  b.progress.advance();
  b.at(10.0);
  b.progress.advance(9);
  b.at(20.0);
  EXPECT_EQ(b.lines, (std::vector<std::string>{"monte_carlo: 90 %, 16 min 40 s left\n",
                                               "monte_carlo: 91 %, 3 min 02 s left\n"}));
}

TEST(ProgressTest, ATerminalGetsOneLineThatIsWipedAtTheEnd) {
  Bench b{ProgressStyle::terminal};
  b.progress.begin("draw");
  b.at(0.1);
  EXPECT_TRUE(b.lines.empty());
  b.at(0.3);
  b.progress.note("mean 3.2");
  b.at(4000.0);
  b.progress.end();
  EXPECT_EQ(b.lines,
            (std::vector<std::string>{"\r\x1b[Kdraw: 0 s", "\r\x1b[Kdraw: 1 h 06 min (mean 3.2)", "\r\x1b[K"}));
}

TEST(ProgressTest, QuietIsSilent) {
  Bench b{ProgressStyle::quiet};
  b.progress.begin("cut", 2);
  b.progress.advance();
  b.at(100.0);
  b.progress.end();
  EXPECT_TRUE(b.lines.empty());
  EXPECT_EQ(progress_style_of_stderr(true), ProgressStyle::quiet);
}

TEST(ProgressTest, CountsFromManyThreads) {
  Bench b{ProgressStyle::lines};
  b.progress.begin("realizations", 4000);
  parallel_for(3000, ThreadLimit{4}, [&](std::size_t) { b.progress.advance(); });
  b.at(30.0);
  EXPECT_EQ(b.lines, (std::vector<std::string>{"realizations: 75 %, 10 s left\n"}));
}

TEST(ProgressTest, ANewStageStartsAgainAndNothingIsSaidBetweenStages) {
  Bench b{ProgressStyle::lines};
  b.progress.begin("read", 1);
  b.progress.advance();
  b.progress.end();
  b.at(15.0);
  EXPECT_TRUE(b.lines.empty());
  b.progress.begin("cut", 10);
  b.at(16.0);
  EXPECT_EQ(b.lines, (std::vector<std::string>{"cut: 1 s\n"}));
}

TEST(ProgressTest, ItsOwnThreadStopsWithIt) {  // a hang or a race here is the failure
  Progress progress{ProgressStyle::lines};
  progress.begin("cut", 3);
  progress.advance();
}

TEST(ProgressTest, WhoeverAsksSeesTheStage) {
  Bench b{ProgressStyle::quiet};
  EXPECT_FALSE(b.progress.seen());
  b.progress.begin("cut", 10);
  b.progress.advance(4);
  const auto seen = b.progress.seen();
  ASSERT_TRUE(seen);
  EXPECT_EQ(seen->stage, "cut");
  EXPECT_EQ(seen->done, 4);
  EXPECT_EQ(seen->total, 10);
  b.progress.end();
  EXPECT_FALSE(b.progress.seen());
}

TEST(ProgressTest, StopEndsTheRunAtItsNextStepOrStage) {
  Bench b{ProgressStyle::quiet};
  b.progress.begin("steps", 10);
  b.progress.advance();
  b.progress.stop();
  EXPECT_THROW(b.progress.advance(), Stopped);
  EXPECT_THROW(b.progress.begin("report"), Stopped);
}

}  // namespace
}  // namespace cleave
