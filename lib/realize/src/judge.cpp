#include "judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "cleave/core/assert.hpp"

namespace cleave::scene {
namespace {

/// Blocks at the edge of what was cut must be known to stay at all targets.
double largest_target(const StabilitySettings& wanted) {
  double out = wanted.target ? std::max(1.0, wanted.target->sliding) : 1.0;
  for (const LoadCase& load : wanted.cases) out = std::max(out, load.target ? load.target->sliding : 1.0);
  return out;
}

stability::Actions actions_of(const SampledScene& drawn, const LoadSet& loads) {
  stability::Actions actions = loads.actions;
  if (loads.flow && drawn.flow_water) {
    stability::FlowWater water = *drawn.flow_water;
    water.unit_weight = *loads.flow;
    actions = actions.with_flow(std::move(water));
  }
  if (loads.water_level) actions = actions.with_water_level(loads.water_level->quantile(drawn.water_quantile));
  if (actions.spec().joint_pressure.empty()) return actions;
  std::vector<std::size_t> sets;
  for (const JointInfo& joint : drawn.joints) sets.push_back(joint.set.index());
  return actions.with_pressures_of(sets);
}

}  // namespace

stability::Settings settings_of(const Scene& scene, const SampledScene& drawn, const LoadSet& loads) {
  const StabilitySettings& wanted = *scene.stability;
  stability::StrengthTable strengths{drawn.joints.empty() ? stability::JointStrength::none()
                                                          : drawn.joints[topology::JointId{0U}].strength};
  for (const topology::JointId joint : drawn.joints.ids()) strengths.set(joint, drawn.joints[joint].strength);
  stability::Settings settings{.rock = scene.rock.mass,
                               .strengths = std::move(strengths),
                               .loads = loads.body.with_seismic_times(drawn.seismic_factor),
                               .partial = wanted.partial,
                               .only_key_blocks = scene.output.only_key_blocks,
                               .least_factor = largest_target(wanted),
                               .actions = actions_of(drawn, loads)};
  hand_over(wanted, settings);
  return settings;
}

stability::Settings settings_of(const Scene& scene, const SampledScene& drawn) {
  return settings_of(scene, drawn, scene.stability->loads);
}

stability::Settings settings_on(const topology::BlockComplex& complex, const Scene& scene, const SampledScene& drawn,
                                const LoadSet& loads) {
  stability::Settings settings = settings_of(scene, drawn, loads);
  if (scene.micro_blocks.policy == MicroBlockPolicy::exclude) {
    settings.left_out = micro_blocks(complex, scene.micro_blocks);
  }
  return settings;
}

std::vector<topology::BlockId> micro_blocks(const topology::BlockComplex& complex, const MicroBlocks& limits) {
  std::vector<topology::BlockId> found;
  for (const topology::BlockId id : complex.blocks().ids()) {
    const topology::Block& block = complex.blocks()[id];
    const bool micro = limits.thickness || limits.volume
                           ? (limits.thickness && block.thickness.si() < limits.thickness->si()) ||
                                 (limits.volume && block.volume.si() < limits.volume->si())
                           : block.sliver;
    if (micro) found.push_back(id);
  }
  return found;
}

SequenceResult judge_stages(const Scene& scene, const topology::SequentialCut& cut,
                            const topology::StageBlocks& final_state, const Judge& judge) {
  CLEAVE_ASSERT(!scene.support || scene.sequence->fallen == Fallen::put_back);
  std::vector<std::uint32_t> stages;
  std::vector<std::string> names;
  for (const Excavation& excavation : scene.excavations) {
    stages.push_back(excavation.stage);
    names.push_back(excavation.name);
  }
  return run_sequence(cut, final_state, *scene.sequence, stages, names, judge);
}

std::vector<Problem> misplaced_loads(const Scene& scene, const SampledScene& drawn,
                                     const topology::BlockComplex& complex) {
  const StabilitySettings& wanted = *scene.stability;
  std::vector<Problem> problems;
  const auto look = [&](const LoadSet& loads, const std::string& where) {
    for (const stability::Misplaced& m : stability::misplaced(complex, actions_of(drawn, loads))) {
      using enum stability::Misplaced::Kind;
      if (m.kind == surcharge) {
        if (scene.sequence) continue;  // what it loads may be taken out by a later stage
        problems.push_back(
            {scene.shown, loads.line, fmt::format("{}surcharge[{}]", where, m.index + 1),
             "loads nothing: no free face lies there",
             "name a face of the domain that is free, or the excavation whose wall it is, or correct "
             "`within`; where an opening goes along a face of the domain, the wall is that of the opening"});
        continue;
      }
      const bool at_point = m.kind == point;
      problems.push_back({scene.shown, loads.line,
                          fmt::format("{}{}[{}]", where, at_point ? "point" : "line", m.index + 1),
                          at_point ? fmt::format("lies {:.3g} m off the nearest free face", m.off.si())
                                   : fmt::format("{:.3g} m of it lie on no free face", m.off.si()),
                          "forces act on free faces: move it onto one"});
    }
  };
  look(wanted.loads, "stability.");
  // What a case takes over from the base case comes first in its lists and was reported there.
  for (const LoadCase& load : wanted.cases) {
    if (problems.empty()) look(load.loads, "load " + load.name + ".");
  }
  return problems;
}

std::string hash_of_key_blocks(const topology::BlockComplex& complex, const stability::Analysis& analysis) {
  std::vector<topology::BlockId> leaving;
  for (const stability::Batch& batch : analysis.batches) {
    leaving.insert(leaving.end(), batch.blocks.begin(), batch.blocks.end());
  }
  return topology::canonical_hash(complex, leaving);
}

}  // namespace cleave::scene
