#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/scene3d/scene.hpp"

namespace cleave::scene::test {

/// Files by name; any other name is refused.
using Files = std::map<std::string, std::string>;

inline ReadFile from(const Files& files) {
  return [files](const std::string& name) -> std::expected<LoadedFile, FileRefusal> {
    const auto it = files.find(name);
    if (it == files.end()) return std::unexpected(FileRefusal{"the file does not exist", "check the name"});
    return LoadedFile{it->second, name};
  };
}

inline std::expected<Scene, std::vector<Problem>> parse_text(std::string_view text, const Files& files = {}) {
  return parse(text, "s.toml", from(files));
}

/// All messages of a scene that must be wrong.
inline std::vector<std::string> errors_of(std::string_view text, const Files& files = {}) {
  std::vector<std::string> lines;
  const auto scene = parse_text(text, files);
  if (scene) return {"the scene was taken"};
  for (const Problem& problem : scene.error()) lines.push_back(describe(problem));
  return lines;
}

/// The one message of a scene with one mistake.
inline std::string error_of(std::string_view text, const Files& files = {}) {
  const auto lines = errors_of(text, files);
  std::string all;
  for (const std::string& line : lines) all += line + "\n";
  if (lines.size() == 1) return lines.front();
  return "not one message but:\n" + all;
}

inline Scene scene_of(std::string_view text, const Files& files = {}) {
  auto scene = parse_text(text, files);
  if (!scene) {
    for (const Problem& problem : scene.error()) ADD_FAILURE() << describe(problem);
  }
  return std::move(scene).value();
}

/// A scene that is right, to which a test adds one mistake.
inline constexpr std::string_view box = "[domain]\nbox = { min = [0, 0, 0], max = [8, 8, 6] }\n";

inline std::string with_box(std::string_view more) { return std::string{box} + std::string{more}; }

/// The text of an example that is called as its folder.
inline std::string example(const std::string& name) {
  std::ifstream file{std::string{CLEAVE_SOURCE_DIR} + "/examples/" + name + "/" + name + ".toml"};
  EXPECT_TRUE(file.is_open());
  return {std::istreambuf_iterator<char>{file}, {}};
}

}  // namespace cleave::scene::test
