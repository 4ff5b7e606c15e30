#include <gtest/gtest.h>
#include <sched.h>
#include <signal.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include "interrupt.hpp"
#include "watched_folder.hpp"

// What an interrupt leaves behind, whenever it comes.
namespace cleave::cli {
namespace {

namespace fs = std::filesystem;

/// Whether every other thread of this process waits for something.
bool others_wait() {
  for (const auto& task : fs::directory_iterator{"/proc/self/task"}) {
    if (task.path().filename() == std::to_string(::getpid())) continue;
    std::ifstream file{task.path() / "stat"};
    std::string text;
    std::getline(file, text);
    const std::size_t name_ends = text.rfind(')');
    if (name_ends == std::string::npos || text.substr(name_ends, 3) != ") S") return false;
  }
  return true;
}

/// Sends SIGTERM to this process and comes back when the watch has taken it and waits: for the work that is guarded.
/// Never, when it leaves the program.
void interrupt_now() {
  ::kill(::getpid(), SIGTERM);
  sigset_t pending;
  do {
    ::sched_yield();
    ::sigpending(&pending);
  } while (sigismember(&pending, SIGTERM) == 1 || !others_wait());
}

class InterruptTest : public testing::Test {
 protected:
  InterruptTest() : folder_{fs::temp_directory_path() / ("cleave-interrupt-" + std::to_string(::getpid()))} {
    fs::create_directories(folder_);
  }
  ~InterruptTest() override { fs::remove_all(folder_); }
  [[nodiscard]] fs::path out() const { return folder_ / "out"; }
  [[nodiscard]] bool empty() const { return fs::is_empty(folder_); }

 private:
  fs::path folder_;
};

TEST_F(InterruptTest, BetweenTheFolderAndItsOwnerLeavesNothing) {
  const auto run = [&] {
    InterruptWatch watch;
    const WatchedFolder folder{watch, [&] {
                                 auto made = OutFolder::prepare(out());
                                 interrupt_now();
                                 return made;
                               }};
    while (true) ::pause();
  };
  EXPECT_EXIT(run(), testing::ExitedWithCode(130), "interrupted; nothing was written");
  EXPECT_TRUE(empty());
}

TEST_F(InterruptTest, DuringTheWorkLeavesNothing) {
  const auto run = [&] {
    InterruptWatch watch;
    const WatchedFolder folder{watch, [&] { return OutFolder::prepare(out()); }};
    interrupt_now();
    while (true) ::pause();
  };
  EXPECT_EXIT(run(), testing::ExitedWithCode(130), "interrupted; nothing was written");
  EXPECT_TRUE(empty());
}

TEST_F(InterruptTest, AFolderThatIsNotPublishedGoesWithItsOwner) {
  InterruptWatch watch;
  {
    WatchedFolder folder{watch, [&] { return OutFolder::prepare(out()); }};
    ASSERT_TRUE(folder->has_value());
    EXPECT_FALSE(empty());
  }
  EXPECT_TRUE(empty());
  {
    WatchedFolder folder{watch, [&] { return OutFolder::prepare(out()); }};
    ASSERT_TRUE((*folder)->publish().has_value());
  }
  EXPECT_TRUE(fs::is_directory(out()));
}

}  // namespace
}  // namespace cleave::cli
