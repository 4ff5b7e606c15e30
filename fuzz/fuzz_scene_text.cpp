// Any bytes as a scene file: a scene or a list of problems, never a crash, whatever the text. No file is touched: the text may
// bring one file along, behind a line "#file NAME", and all other names are refused.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "cleave/scene/parse.hpp"
#include "cleave/scene/plan.hpp"

namespace {

using cleave::scene::Problem;

void require(bool holds) {
  if (!holds) std::abort();
}

struct Input {
  std::string_view scene;
  std::string_view name;
  std::string_view file;
};

Input split(std::string_view text) {
  constexpr std::string_view mark = "\n#file ";
  const std::size_t at = text.find(mark);
  if (at == std::string_view::npos) return {text, {}, {}};
  const std::string_view rest = text.substr(at + mark.size());
  const std::size_t end = rest.find('\n');
  if (end == std::string_view::npos) return {text.substr(0, at), rest, {}};
  return {text.substr(0, at), rest.substr(0, end), rest.substr(end + 1)};
}

void check_problem(const Problem& problem) {
  require(!problem.file.empty() && problem.line >= 1 && !problem.key.empty() && !problem.what.empty());
  for (const char c : describe(problem)) require(static_cast<unsigned char>(c) >= 0x20 && c != 0x7F);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t longest = 20'000;  // bounds the work: each joint set costs some thousand evaluations
  if (size > longest) return 0;
#ifdef __clang__
#pragma clang unsafe_buffer_usage begin
#endif
  const std::string text{reinterpret_cast<const char*>(data), size};
#ifdef __clang__
#pragma clang unsafe_buffer_usage end
#endif
  const Input input = split(text);
  const cleave::scene::ReadFile only_own =
      [&](const std::string& name) -> std::expected<cleave::scene::LoadedFile, cleave::scene::FileRefusal> {
    if (name == input.name) return cleave::scene::LoadedFile{std::string{input.file}, name};
    return std::unexpected(cleave::scene::FileRefusal{"the file does not exist", "check the name"});
  };
  const auto scene = cleave::scene::parse(input.scene, "scene.toml", only_own);
  if (!scene) {
    require(!scene.error().empty());
    for (const Problem& problem : scene.error()) check_problem(problem);
    return 0;
  }
  for (const Problem& note : scene->notes) check_problem(note);
  const double volume = scene->domain.volume().si();
  require(std::isfinite(volume) && volume > 0);
  for (const auto& joint : scene->joints) require(joint.set.index() < scene->sets.size() && joint.line >= 1);
  require(make_plan(*scene).stages.size() == cleave::scene::all_stages.size());
  // The same text is the same scene.
  const auto again = cleave::scene::parse(input.scene, "scene.toml", only_own);
  require(again && again->sha256 == scene->sha256 && again->joints.size() == scene->joints.size());
  return 0;
}
