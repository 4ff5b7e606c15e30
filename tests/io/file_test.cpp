#include "cleave/io/file.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "cleave/io/joint_csv.hpp"
#include "cleave/io/mesh.hpp"

namespace cleave::io {
namespace {

/// A folder of its own that goes with the test.
class FileTest : public ::testing::Test {
 protected:
  FileTest() {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() /
              (std::string{"cleave_io_"} + info->name() + "_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  ~FileTest() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::string& name, std::string_view bytes) {
    std::ofstream{folder_ / name, std::ios::binary} << bytes;
    return folder_ / name;
  }
  std::filesystem::path folder_;
};

TEST_F(FileTest, BytesAreReadAsTheyAre) {
  const std::string bytes{"a\r\n\0b\xff", 6};
  EXPECT_EQ(read_file(write("bytes", bytes)).value(), bytes);
  EXPECT_EQ(read_file(write("empty", "")).value(), "");
}

TEST_F(FileTest, FaultsNameTheFile) {
  const auto missing = read_file(folder_ / "missing.obj");
  ASSERT_FALSE(missing.has_value());
  EXPECT_EQ(missing.error().fault, ReadFault::cannot_open);
  EXPECT_NE(describe(missing.error()).find("missing.obj: there is no such file; "), std::string::npos);
  EXPECT_EQ(read_file(folder_).error().fault, ReadFault::not_a_file);
  EXPECT_EQ(read_file("/dev/zero").error().fault, ReadFault::not_a_file);
  EXPECT_EQ(read_file(folder_ / "a" / "b").error().fault, ReadFault::cannot_open);
}

TEST_F(FileTest, HugeFilesAreRefusedUnread) {
  const auto path = write("huge.obj", "");
  std::filesystem::resize_file(path, (std::uintmax_t{4} << 30U) + 1);  // sparse: takes no space
  EXPECT_EQ(read_file(path).error().fault, ReadFault::too_large);
  EXPECT_EQ(read_mesh(path).error().fault, ReadFault::too_large);
}

TEST_F(FileTest, UnreadableFilesAreRefused) {
  const auto path = write("closed.csv", "dip\n");
  std::filesystem::permissions(path, std::filesystem::perms::none);
  if (std::ifstream{path}) GTEST_SKIP() << "this user may read everything";
  EXPECT_EQ(read_file(path).error().fault, ReadFault::cannot_open);
  EXPECT_EQ(read_joint_csv(path).error().at(0).fault, ReadFault::cannot_open);
}

TEST_F(FileTest, TheExtensionTellsTheFormatOfAMesh) {
  const std::string_view obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  EXPECT_EQ(read_mesh(write("a.obj", obj)).value().faces(), 1U);
  EXPECT_EQ(read_mesh(write("a.OBJ", obj)).value().faces(), 1U);
  EXPECT_EQ(read_mesh(write("a.txt", obj)).error().fault, ReadFault::unknown_format);
  EXPECT_EQ(read_mesh(write("b.obj", "")).error().fault, ReadFault::empty);
  EXPECT_EQ(read_mesh(write("b.stl", "")).error().fault, ReadFault::empty);
  EXPECT_EQ(read_mesh(write("b.ply", "")).error().fault, ReadFault::empty);
  EXPECT_EQ(read_mesh(folder_ / "none.stl").error().fault, ReadFault::cannot_open);
}

}  // namespace
}  // namespace cleave::io
