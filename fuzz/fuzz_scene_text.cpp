// Any bytes as a scene file: a scene or a list of problems, never a crash, whatever the text. No file is touched: the
// text may bring one file along, behind a line "#file NAME", and all other names are refused.

#include <cmath>
#include <cstddef>
#include <expected>
#include <string>
#include <string_view>

#include "cleave/core/assert.hpp"
#include "cleave/realize/run.hpp"
#include "cleave/scene3d/scene.hpp"
#include "fuzz_target.hpp"

namespace {

using cleave::scene::Problem;

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
  CLEAVE_ASSERT(!problem.file.empty() && problem.line >= 1 && !problem.key.empty() && !problem.what.empty());
  for (const char c : describe(problem)) CLEAVE_ASSERT(static_cast<unsigned char>(c) >= 0x20 && c != 0x7F);
}

}  // namespace

CLEAVE_FUZZ_TARGET(bytes) {
  constexpr std::size_t longest = 20'000;  // bounds the work: each joint set costs some thousand evaluations
  if (bytes.size() > longest) return;
  const std::string text{bytes.begin(), bytes.end()};
  const Input input = split(text);
  const cleave::scene::ReadFile only_own =
      [&](const std::string& name) -> std::expected<cleave::scene::LoadedFile, cleave::scene::FileRefusal> {
    if (name == input.name) return cleave::scene::LoadedFile{std::string{input.file}, name};
    return std::unexpected(cleave::scene::FileRefusal{"the file does not exist", "check the name"});
  };
  const auto scene = cleave::scene::parse(input.scene, "scene.toml", only_own);
  if (!scene) {
    CLEAVE_ASSERT(!scene.error().empty());
    for (const Problem& problem : scene.error()) check_problem(problem);
    return;
  }
  for (const Problem& note : scene->notes) check_problem(note);
  const double volume = scene->domain.volume().si();
  CLEAVE_ASSERT(std::isfinite(volume) && volume > 0);
  for (const auto& joint : scene->joints) CLEAVE_ASSERT(joint.set.index() < scene->sets.size() && joint.line >= 1);
  CLEAVE_ASSERT(make_plan(*scene).steps.size() + (scene->flow ? 0U : 1U) == cleave::scene::all_steps.size());
  // The same text is the same scene.
  const auto again = cleave::scene::parse(input.scene, "scene.toml", only_own);
  CLEAVE_ASSERT(again && again->sha256 == scene->sha256 && again->joints.size() == scene->joints.size());
}
