/// Very small lattice scenes, degenerate on purpose, through the cutter and its certificate, with one relation each,
/// chosen by a byte: many a second, where `fuzz_cut` looks at all relations and asks the oracle.

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <string>

#include "block_summary.hpp"
#include "fuzz_target.hpp"
#include "integer_scene.hpp"
#include "keep_readable.hpp"
#include "scene_to_toml.hpp"

namespace cleave::testing {
namespace {

/// The scene said in another way; its blocks are the same.
IntegerScene said_otherwise(IntegerScene scene, std::uint8_t how) {
  switch (how % 6) {
    case 0: std::ranges::reverse(scene.joints); return scene;
    case 1: return translated(std::move(scene), {5, -3, 7});
    case 2: return axes_rotated(std::move(scene));
    case 3: return axes_swapped(std::move(scene));
    case 4:
      for (IntegerPolygon& joint : scene.joints) std::ranges::rotate(joint, joint.begin() + 1);
      return scene;
    default:
      if (!scene.joints.empty()) scene.joints.push_back(scene.joints.front());
      return scene;
  }
}

}  // namespace
}  // namespace cleave::testing

CLEAVE_FUZZ_TARGET(bytes) {
  using namespace cleave::testing;
  const std::uint8_t how = bytes.empty() ? std::uint8_t{0} : bytes.front();
  const IntegerScene scene =
      integer_scene_from_bytes(bytes.empty() ? bytes : bytes.subspan(1), {.max_joints = 4, .max_excavations = 1});
  const auto text = [&](const std::string& problem) { return scene_to_toml(scene, problem); };
  cleave::support::keep_readable([&] { return text("found by fuzz_blocks"); });  // before the cut may abort
  const FastCut plain = fast_cut(scene);
  std::string problem = plain.problem;
  if (problem.empty()) {
    const FastCut other = fast_cut(said_otherwise(scene, how));
    problem = !other.problem.empty()                ? other.problem
              : agree(plain.summary, other.summary) ? ""
                                                    : "not the same blocks when said otherwise";
  }
  if (problem.empty()) return;
  std::fputs(text(problem).c_str(), stderr);
  std::abort();
}
