/// Small lattice scenes, degenerate on purpose, through the cutter and its certificate. The blocks fill the rock, do
/// not depend on the order of joints and corners, on repeated joints, on the place in space or the names of the axes;
/// a window shows the
/// blocks of the whole scene; and with few joints they are those of the oracle, exactly.

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

CLEAVE_FUZZ_TARGET(bytes) {
  using namespace cleave::testing;
  const IntegerScene scene = integer_scene_from_bytes(bytes, {.max_joints = 10, .max_excavations = 2});
  cleave::support::keep_readable(
      [&] { return scene_to_toml(scene, "found by fuzz_cut"); });  // before the cut may abort
  std::string problem = broken_invariance(scene);
  if (problem.empty()) problem = broken_window(scene);
  if (problem.empty()) problem = broken_network(scene);
  if (problem.empty() && scene.joints.size() <= 5) problem = difference_from_oracle(scene);
  if (problem.empty()) return;
  const std::string text = scene_to_toml(scene, problem);
  cleave::support::keep_readable([&] { return text; });
  std::fputs(text.c_str(), stderr);
  std::abort();
}
