#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "cleave/report/write.hpp"

namespace cleave::report {
namespace {

namespace fs = std::filesystem;

class WriteFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::temp_directory_path() / ("cleave_write_" + std::string{info->name()} + std::to_string(::getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  static std::string read(const fs::path& path) {
    std::ifstream in{path, std::ios::binary};
    return {std::istreambuf_iterator<char>{in}, {}};
  }
  std::size_t entries() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator{folder_}, fs::directory_iterator{}));
  }
  fs::path folder_;
};

TEST_F(WriteFileTest, ReplacesAFileAsAWhole) {
  ASSERT_TRUE(write_file(folder_ / "a.txt", "first"));
  ASSERT_TRUE(write_file(folder_ / "a.txt", "second"));
  EXPECT_EQ(read(folder_ / "a.txt"), "second");
  EXPECT_EQ(entries(), 1U);  // no temporary file stays
}

TEST_F(WriteFileTest, MissingFolderAndFolderInTheWayAreNamed) {
  const auto missing = write_file(folder_ / "no" / "a.txt", "x");
  ASSERT_FALSE(missing);
  EXPECT_TRUE(std::holds_alternative<CannotCreate>(missing.error()));
  EXPECT_NE(describe(missing.error()).find("a.txt"), std::string::npos);
  fs::create_directories(folder_ / "taken" / "inside");
  const auto taken = write_file(folder_ / "taken", "x");
  ASSERT_FALSE(taken);
  EXPECT_TRUE(std::holds_alternative<CannotCreate>(taken.error()));
  EXPECT_EQ(entries(), 1U);
}

TEST_F(WriteFileTest, ReadOnlyPlaceIsNamed) {
  const auto result = write_file("/proc/cleave_report.html", "x");  // refused even to the superuser
  ASSERT_FALSE(result);
  EXPECT_TRUE(std::holds_alternative<CannotCreate>(result.error()));
}

// A file size limit stands in for a full disk: the write itself fails half-way.
TEST_F(WriteFileTest, NoRoomLeavesNothingUnderAFinalName) {
  ASSERT_TRUE(write_file(folder_ / "a.txt", "old"));
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit small = before;
  small.rlim_cur = 4096;
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const auto replaced = write_file(folder_ / "a.txt", std::string(100'000, 'x'));
  const auto fresh = write_file(folder_ / "b.txt", std::string(100'000, 'x'));
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, handler);
  ASSERT_FALSE(replaced);
  ASSERT_FALSE(fresh);
  EXPECT_TRUE(std::holds_alternative<NoSpace>(replaced.error()));
  EXPECT_NE(describe(fresh.error()).find("b.txt"), std::string::npos);
  EXPECT_EQ(read(folder_ / "a.txt"), "old");
  EXPECT_EQ(entries(), 1U);
}

}  // namespace
}  // namespace cleave::report
