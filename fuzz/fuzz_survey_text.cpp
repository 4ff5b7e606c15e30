/// Any bytes as a survey, with one file of data behind a line "#file NAME": statistics or a list of problems. What was
/// estimated is finite and lies in its interval, and the sets can be taken into a scene.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <expected>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cleave/core/assert.hpp"
#include "cleave/field_data/survey_file.hpp"
#include "cleave/scene3d/scene.hpp"
#include "fuzz_target.hpp"

namespace {

using cleave::scene::FileRefusal;
using cleave::scene::LoadedFile;
using cleave::scene::Problem;

/// Reads the files of the list and no others.
cleave::scene::ReadFile only(std::vector<std::pair<std::string, std::string>> files) {
  return [files = std::move(files)](const std::string& name) -> std::expected<LoadedFile, FileRefusal> {
    for (const auto& [own, content] : files) {
      if (own == name) return LoadedFile{content, name};
    }
    return std::unexpected(FileRefusal{"the file does not exist", "check the name"});
  };
}

void check(const cleave::survey::Estimate& e) {
  if (!e.value) return;
  CLEAVE_ASSERT(std::isfinite(*e.value));
  CLEAVE_ASSERT(!(e.low > *e.value) && !(e.high < *e.value));
}

}  // namespace

CLEAVE_FUZZ_TARGET(bytes) {
  constexpr std::size_t longest = 8'000;
  if (bytes.size() > longest) return;
  const std::string text{bytes.begin(), bytes.end()};
  constexpr std::string_view mark = "\n#file ";
  const std::size_t at = text.find(mark);
  std::vector<std::pair<std::string, std::string>> files;
  if (at != std::string::npos) {
    const std::size_t name = at + mark.size(), end = std::min(text.find('\n', name), text.size());
    files.emplace_back(text.substr(name, end - name), text.substr(std::min(end + 1, text.size())));
  }
  const auto survey = cleave::scene::parse_survey(text.substr(0, at), "survey.toml", only(std::move(files)));
  if (!survey) {
    CLEAVE_ASSERT(!survey.error().empty());
    for (const Problem& problem : survey.error()) CLEAVE_ASSERT(!problem.what.empty() && !problem.key.empty());
    return;
  }
  const auto result = cleave::survey::analyse(survey->input);
  for (const auto& window : result.windows) {
    for (const auto& e : window.estimates) check(e);
  }
  for (const auto& line : result.lines) check(line.frequency);
  for (const auto& set : result.sets) {
    if (set.p32) check(*set.p32);
  }
  const auto sets = cleave::scene::sets_file(*survey, result);
  auto with = sets.files;
  with.emplace_back("sets.toml", sets.toml);
  const auto scene = cleave::scene::parse(
      "schema = 1\ninclude = [\"sets.toml\"]\n[domain]\nbox = { min = [0, 0, 0], max = [1, 1, 1] }\n", "scene.toml",
      only(std::move(with)));
  if (!scene) {
    for (const Problem& problem : scene.error()) std::fputs((describe(problem) + "\n").c_str(), stderr);
  }
  CLEAVE_ASSERT(scene.has_value());
}
