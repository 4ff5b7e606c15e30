/// Small lattice scenes made large, with copies of joints a little beside themselves: what comes out is what the oracle
/// finds in rationals.

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>

#include "block_summary.hpp"
#include "byte_source.hpp"
#include "fuzz_target.hpp"
#include "integer_scene.hpp"
#include "keep_readable.hpp"
#include "scene_to_toml.hpp"

CLEAVE_FUZZ_TARGET(bytes) {
  using namespace cleave::testing;
  cleave::support::ByteSource source{bytes.first(std::min<std::size_t>(bytes.size(), 12))};
  IntegerScene scene =
      integer_scene_from_bytes(bytes.subspan(std::min<std::size_t>(bytes.size(), 12)), {.max_joints = 4});
  const std::int32_t times = 1 << source.up_to(24);
  const auto grow = [times](IntegerPoint& p) { p = times * p; };
  grow(scene.min);
  grow(scene.max);
  for (IntegerPolygon& joint : scene.joints) std::ranges::for_each(joint, grow);
  for (IntegerSolid& solid : scene.excavations) std::ranges::for_each(solid.vertices, grow);
  if (scene.domain) std::ranges::for_each(scene.domain->vertices, grow);
  for (std::size_t copies = scene.joints.empty() ? 0 : source.up_to(2); copies > 0; --copies) {
    IntegerPolygon copy = scene.joints[source.up_to(scene.joints.size() - 1)];
    const auto some = [&] { return static_cast<std::int32_t>(source.between(-3, 3)); };
    const IntegerPoint by{some(), some(), some()};
    for (IntegerPoint& p : copy) p = p + by;
    scene.joints.push_back(std::move(copy));
  }
  cleave::support::keep_readable([&] { return scene_to_toml(scene, "found by fuzz_near"); });
  const std::string problem = difference_from_oracle(scene);
  if (problem.empty()) return;
  const std::string text = scene_to_toml(scene, problem);
  cleave::support::keep_readable([&] { return text; });
  std::fputs(text.c_str(), stderr);
  std::abort();
}
