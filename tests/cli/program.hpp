#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

namespace cleave::cli::test {

namespace fs = std::filesystem;

inline std::string text_of(const fs::path& path) {
  std::ifstream file{path, std::ios::binary};
  return {std::istreambuf_iterator<char>{file}, std::istreambuf_iterator<char>{}};
}
inline void write_text(const fs::path& path, std::string_view text) {
  std::ofstream file{path, std::ios::binary};
  file << text;
}

struct Ended {
  int code = -1;  ///< exit code; -1 when a signal ended it
  std::string out, err;
};

/// A folder of its own for each test, and the program called in it as a user would.
class ProgramTest : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    std::string name =
        std::string{"cleave-"} + info->test_suite_name() + "-" + info->name() + "-" + std::to_string(::getpid());
    std::ranges::replace(name, '/', '_');
    folder_ = fs::temp_directory_path() / name;
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] const fs::path& folder() const { return folder_; }
  [[nodiscard]] fs::path path(std::string_view name) const { return folder_ / name; }
  void write(std::string_view name, std::string_view text) const { write_text(folder_ / name, text); }
  [[nodiscard]] std::string read(std::string_view name) const { return text_of(folder_ / name); }
  [[nodiscard]] bool exists(std::string_view name) const { return fs::exists(folder_ / name); }
  /// Names in the folder, sorted: shows what a call left behind.
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> result;
    for (const auto& entry : fs::directory_iterator{folder_}) result.push_back(entry.path().filename().string());
    std::ranges::sort(result);
    return result;
  }

  /// Runs a shell line in the folder; "cleave" in it is the program.
  [[nodiscard]] Ended shell(const std::string& line) const {
    const fs::path out = folder_.string() + ".out", err = folder_.string() + ".err";
    const std::string whole = "cd '" + folder_.string() + "' && cleave() { '" CLEAVE_PROGRAM "' \"$@\"; } && ( " +
                              line + " ) >'" + out.string() + "' 2>'" + err.string() + "'";
    const int status = std::system(whole.c_str());
    Ended ended{WIFEXITED(status) ? WEXITSTATUS(status) : -1, text_of(out), text_of(err)};
    fs::remove(out);
    fs::remove(err);
    return ended;
  }
  [[nodiscard]] Ended cleave(const std::string& arguments) const { return shell("cleave " + arguments); }

 private:
  fs::path folder_;
};

inline constexpr std::string_view small_scene = R"toml(schema = 1
title = "small"
[domain]
box = { min = [0, 0, 0], max = [8, 8, 6] }
[[joint_set]]
name = "A"
orientation = { dip = 45, dip_direction = 90, distribution = "fisher", kappa = 5 }
size = { distribution = "constant", mean = 12 }
intensity = { count = 8 }
[joints.default]
friction = 20
[rock]
density = 2700
[stability]
free = ["top", "east"]
)toml";

/// The same with 12 joints: more of its realizations have key blocks.
inline std::string crowded_scene() {
  std::string text{small_scene};
  constexpr std::string_view count = "count = 8";
  return text.replace(text.find(count), count.size(), "count = 12");
}

}  // namespace cleave::cli::test
