/// Runs a fuzz target once on each stored input: `replay_NAME FILE_OR_FOLDER...`. Needs no fuzzer, so every compiler
/// and every test run replays the corpora and the inputs that once failed.

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <string>
#include <vector>

#include "fuzz_target.hpp"

namespace {

namespace fs = std::filesystem;

std::vector<fs::path> files_below(const fs::path& place) {
  if (fs::is_regular_file(place)) return {place};
  std::vector<fs::path> files;
  if (fs::is_directory(place)) {
    for (const auto& entry : fs::recursive_directory_iterator{place}) {
      if (entry.is_regular_file()) files.push_back(entry.path());
    }
  }
  std::ranges::sort(files);
  return files;
}

}  // namespace

int main(int argc, char** argv) {
  CLEAVE_UNCHECKED_BEGIN
  const std::span arguments{argv + 1, static_cast<std::size_t>(argc - 1)};
  CLEAVE_UNCHECKED_END
  LLVMFuzzerTestOneInput(nullptr, 0);
  std::size_t count = 0;
  for (const char* place : arguments) {
    for (const fs::path& file : files_below(place)) {
      std::printf("%s\n", file.c_str());  // before the run: if it crashes, this is the last line
      std::fflush(stdout);
      std::ifstream in{file, std::ios::binary};
      const std::string text{std::istreambuf_iterator<char>{in}, {}};
      if (!in) {
        std::fprintf(stderr, "error: cannot read %s\n", file.c_str());
        return 1;
      }
      const std::vector<std::uint8_t> bytes(text.begin(), text.end());
      LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
      ++count;
    }
  }
  std::printf("%zu inputs replayed\n", count);
  if (count == 0) std::fprintf(stderr, "error: no input found; a replay of nothing shows nothing\n");
  return count == 0 ? 1 : 0;
}
