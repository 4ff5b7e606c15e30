#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "cleave/realize/places.hpp"
#include "cleave/stability/block_theory.hpp"
#include "judge.hpp"

namespace cleave::scene {
namespace {

using geometry::Vec3;

/// The mean normal of a set: that of its law where it is drawn at random, else of its measured joints (the longest
/// axis of their poles does not care which way each normal looks; here they all look up, and a sum is enough).
std::optional<Vec3> mean_normal(const Scene& scene, const SampledScene& drawn, SetId set) {
  for (const RandomSet& random : scene.joint_sets) {
    if (random.set == set) return random.law.mean_normal();
  }
  std::optional<Vec3> first;
  Vec3 sum;
  for (const JointInfo& joint : drawn.joints) {
    if (joint.set != set || joint.origin != JointOrigin::measured) continue;
    if (!first) first = joint.normal;
    sum += geometry::dot(joint.normal, *first) < 0 ? -joint.normal : joint.normal;
  }
  if (!first || !(geometry::norm(sum) > 0)) return std::nullopt;
  sum = geometry::normalized(sum);
  return sum.z < 0 ? -sum : sum;
}

}  // namespace

void judge_maximum_blocks(const Scene& scene, Realization& made) {
  if (!scene.stability->maximum_blocks) return;
  const MaximumBlockSettings& wanted = *scene.stability->maximum_blocks;
  std::vector<SetId> sets = wanted.sets;
  if (sets.empty()) {
    for (const JointInfo& joint : made.joints) sets.push_back(joint.set);
    for (const RandomSet& random : scene.joint_sets) sets.push_back(random.set);  // of no joint drawn here, too
    std::ranges::sort(sets);
    sets.erase(std::ranges::unique(sets).begin(), sets.end());
  }
  std::vector<stability::TheoryPlane> planes;
  std::vector<SetId> used;
  for (const SetId set : sets) {
    const auto normal = mean_normal(scene, made, set);
    if (!normal) continue;
    const auto direction = stability::direction_of(*normal);
    if (!direction) continue;
    planes.push_back({*direction, wanted.medians[set]});
    used.push_back(set);
  }
  const TunnelLine& line = *scene.excavations[wanted.excavation].tunnel;
  const geometry::SectionFrame section = geometry::section_frames(line.axis, line.up).front();
  const stability::ConvexTunnel tunnel{
      .axis = section.along, .right = section.right, .up = section.up, .outline = line.outline};
  const Targets target = scene.stability->target.value_or(Targets{});
  const stability::TheoryLoads loads{.rock = scene.rock.mass,
                                     .body = scene.stability->loads.body,
                                     .partial = scene.stability->partial,
                                     .target_falling = target.falling,
                                     .target_sliding = target.sliding};
  const geometry::North north = geometry::North::degrees(scene.north);
  for (auto& block : stability::maximum_key_blocks(planes, tunnel, loads, {wanted.trace, wanted.size})) {
    const Vec3 apex = block.block.apex[0] * section.right + block.block.apex[1] * section.up;
    MaximumRow row{.sets = {}, .block = block, .where = std::string{location_of(section, apex, north)}};
    row.position = position_of(section, apex, north);
    for (std::size_t i = 0; i < 3; ++i) row.sets[i] = scene.sets[used[block.planes[i]]].name;
    made.maximum_blocks.push_back(std::move(row));
  }
}

}  // namespace cleave::scene
