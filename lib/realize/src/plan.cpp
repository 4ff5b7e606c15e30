#include "cleave/scene/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/dfn/sample.hpp"
#include "cleave/realize/run.hpp"
#include "cleave/scene/plan_steps.hpp"
#include "cleave/scene3d/bounds.hpp"
#include "cleave/scene3d/key_tables.hpp"
#include "cleave/scene3d/scene.hpp"
#include "cut_estimate.hpp"

namespace cleave::scene {
namespace {

std::string count_of(std::size_t n, std::string_view one, std::string_view many) {
  return fmt::format("{} {}", n, n == 1 ? one : many);
}

std::string why_stability(const Scene& scene) {
  if (!scene.stability) return "no excavation and no free face";
  std::string why;
  if (!scene.excavations.empty()) why = count_of(scene.excavations.size(), "excavation", "excavations");
  if (!scene.free_domain_tags.empty()) {
    why += why.empty() ? "" : " and ";
    why += count_of(scene.free_domain_tags.size(), "free face", "free faces");
    why += " of the domain";
  }
  if (scene.sequence) {
    why += fmt::format(" in {} stages", scene.sequence->stages.size());
    if (!scene.sequence->orders.empty()) why += fmt::format(", {} orders", scene.sequence->orders.size() + 1);
  }
  why += scene.stability->force_transfer ? "; with force transfer" : "; without force transfer";
  return why;
}

std::string why_write(const Scene& scene) {
  const OutputSettings& output = scene.output;
  const bool stability = scene.stability.has_value(), motion = scene.motion.has_value();
  std::string files = "summary.json, log.txt";
  if (output.vtu) files += ", blocks.vtu";
  if (output.csv && stability) files += ", key_blocks.csv";
  if (motion && output.csv) files += ", motion.csv";
  if (motion && output.vtu) files += ", motion_NNNN.vtu, motion.pvd";
  if (motion) files += ", motion.state";
  if (scene.mapped && output.csv) files += ", mapped_joints.csv";
  if (scene.flow && output.csv) files += ", flow_joints.csv";
  if (scene.flow && output.vtu) files += ", flow.vtu";
  if (scene.flow && scene.flow->pflotran)
    files += ", flow_mesh.uge and what goes with it (two to three times the triangles of flow.vtu)";
  for (const SectionSpec& section : output.sections) {
    files += section.name.empty() ? ", section.toml" : ", section_" + section.name + ".toml";
  }
  for (const std::string& name : output.exports) files += ", blocks as " + name;
  return files;
}

std::string why_support(const Scene& scene) {
  if (!scene.support) return "no [support]";
  if (!scene.stability) return "nothing is free, so nothing needs support";
  return count_of(scene.support->plan.bolts.size(), "bolt", "bolts") +
         (scene.support->plan.shotcrete ? " and shotcrete" : "") + (scene.support->design ? "; with a search" : "");
}

/// The program alone.
constexpr double program_mb = 16, program_s = 0.008;

/// Random joints that are drawn, kept or not.
double draws_of(const Scene& scene) {
  const Box box = box_of(scene.domain);
  double draws = 0;
  for (const RandomSet& set : scene.joint_sets) draws += dfn::expected_draws(set.law, {box.min, box.max});
  return draws;
}

/// Expected seconds of CPU of a step of one realization; 0 for those whose cost the joints do not tell.
double seconds_of(Step step, const Scene& scene, const CutEstimate& cut) {
  constexpr double section_by_boundary_elements = 0.4, a_bolt = 4e-4, a_joint_with_water = 2e-3;
  switch (step) {
    case Step::draw: return 1.5e-7 * draws_of(scene) + 1e-6 * cut.joints;
    case Step::cut: return cut.cut_s();
    case Step::audit: return cut.audit_s();
    case Step::stability: return 3e-6 * cut.blocks;
    case Step::write: return 0.002 + (scene.output.vtu ? 3.5e-6 * cut.blocks : 0);
    case Step::report: return 0.002 + 1.5e-6 * cut.blocks;
    case Step::support: return a_bolt * static_cast<double>(scene.support->plan.bolts.size());
    case Step::elastic: return section_by_boundary_elements;
    case Step::flow: return a_joint_with_water * cut.joints;
    case Step::read:
    case Step::monte_carlo:
    case Step::contact: return 0;
  }
  std::unreachable();
}

/// Of walls of excavations and free sides in the domain, m2.
double free_area_of(const Scene& scene) {
  const Box box = box_of(scene.domain);
  const auto add = [&](const geometry::Solid& solid, const geometry::SolidFace& face) {
    std::vector<geometry::Vec3> corners;
    for (const std::uint32_t corner : face.corners) corners.push_back(solid.vertices()[corner]);
    return norm(area_within(std::move(corners), box));
  };
  double area = 0;
  for (const Excavation& excavation : scene.excavations) {
    for (const geometry::SolidFace& face : excavation.solid.faces()) area += add(excavation.solid, face);
  }
  for (const geometry::SolidFace& face : scene.domain.faces()) {
    if (std::ranges::find(scene.free_domain_tags, face.tag) != scene.free_domain_tags.end())
      area += add(scene.domain, face);
  }
  return area;
}

/// Blocks within a few layers of free faces; sizes differ, so that more small ones lie there.
double near_free_faces(const Scene& scene, const CutEstimate& cut) {
  constexpr double layers = 6;
  const double size = std::cbrt(scene.domain.volume().si() / std::max(1.0, cut.blocks));
  return std::min(cut.blocks, layers * free_area_of(scene) / (size * size));
}

/// What a run asks of blocks together, over what it does of one state with target and support: groups and what the
/// border holds of them, that once more at the target, and the support.
double asked_together(const Scene& scene) {
  constexpr double own = 0.5, at_target = 0.35, with_support = 0.15, a_factor = 0.15, a_pattern = 0.1, a_case = 0.7;
  const StabilitySettings& wanted = *scene.stability;
  const auto stages = static_cast<double>(scene.sequence ? scene.sequence->stages.size() : 0);
  const double cases = 1 + a_case * static_cast<double>(wanted.cases.size());
  const double state = own + (wanted.target || scene.support ? at_target : 0) + (scene.support ? with_support : 0);
  if (scene.monte_carlo) {
    const double states = scene.support ? cases * (1 + stages) : cases;
    return wanted.decides_by_groups() ? static_cast<double>(scene.monte_carlo->realizations) * states * state : 0;
  }
  double asked = cases * (1 + stages) * state + (wanted.group_factor ? 20 * a_factor : 0);
  if (scene.support && scene.support->design) {
    const DesignSettings& design = *scene.support->design;
    asked += a_pattern * static_cast<double>(design.lengths.size()) * (8.0 * design.phases + design.offsets);
  }
  return asked;
}

/// What judging blocks together took in tunnels of 60 to 3,000 blocks near free faces. Where they are too many to be
/// judged with moments more of them hardly take longer; of all at most as many as are judged together count.
void add_together(const Scene& scene, const CutEstimate& cut, SizeEstimate& estimate) {
  if (!scene.stability || scene.stability->groups == stability::GroupsCheck::off) return;
  constexpr double a_block = 0.05, without_moments = 0.03;
  const bool decides = scene.stability->decides_by_groups();
  const stability::Together most = decides ? stability::most_together : stability::most_noted;
  const auto limit = static_cast<double>(most.blocks), turning = static_cast<double>(most.turning);
  const double near = std::min(near_free_faces(scene, cut), limit);
  const double counted = std::min(near, turning) + without_moments * std::max(0.0, near - turning);
  estimate.together = Time::from_si(asked_together(scene) * a_block * counted);
  if (cut.blocks > limit) estimate.most_together = limit;
}

struct Decision {
  bool run;
  std::string why;
};

std::string why_draw(const Scene& scene) {
  const std::size_t sets = scene.joint_sets.size();
  if (sets == 0) return "no [[joint_set]]";
  const std::string why = count_of(sets, "random joint set", "random joint sets");
  if (!scene.mapped) return why;
  return why + fmt::format(", with {}", count_of(scene.mapped->seen.joints.size(), "mapped joint", "mapped joints"));
}

std::string why_cut(const Scene& scene) {
  const std::size_t given = scene.joints.size();
  const bool drawn = !scene.joint_sets.empty();
  std::string why = given == 0 && !drawn ? "no joints: the domain less the excavations"
                    : given == 0
                        ? "the drawn joints"
                        : count_of(given, "given joint", "given joints") + (drawn ? " and the drawn ones" : "");
  if (!scene.output.only_key_blocks) return why;
  return why + (!scene.stability ? "; all of the rock, as there is no free face to start from"
                : scene.sequence ? "; all of the rock, as it is taken out in stages"
                                 : "; only near free faces, as only key blocks are asked for");
}

std::string why_monte_carlo(const Scene& scene) {
  if (!scene.monte_carlo) return "no [monte_carlo]: one run";
  const MonteCarloSettings& wanted = *scene.monte_carlo;
  if (!wanted.stop) return fmt::format("{} realizations", wanted.realizations);
  return fmt::format("up to {} realizations, until {} is known to {:.3g} %", wanted.realizations, wanted.stop->quantity,
                     100 * wanted.stop->relative_half_width);
}

Decision decide_elastic(const Scene& scene) {
  if (!scene.field_stress) return {false, "no [[body]] and no [field_stress]"};
  if (!scene.stability) return {false, "nothing is free, so no block is clamped"};
  std::string names;
  for (const std::uint32_t tunnel : scene.field_stress->tunnels) {
    names += fmt::format("{}\"{}\"", names.empty() ? "" : ", ", scene.excavations[tunnel].name);
  }
  return {true, fmt::format("stress around {} ({} by boundary elements{}) on {} key blocks", names,
                            scene.field_stress->tunnels.size() == 1 ? "a section" : "sections",
                            scene.monte_carlo ? ", once for all realizations" : "",
                            scene.field_stress->tunnels.size() == 1 ? "its" : "their")};
}

Decision decide_motion(const Scene& scene) {
  if (!scene.motion) return {false, "no [[body]] and no [motion]"};
  std::string_view which = "every block that no side of the domain holds";
  if (scene.motion->release == Release::batches) which = "key blocks";
  if (scene.motion->release == Release::groups) which = "key blocks and key groups";
  if (scene.motion->release == Release::stage) which = "key blocks, stage by stage";
  return {true, fmt::format("{} in motion, {} {:g} s{}", which, scene.motion->to_rest ? "to rest or" : "for",
                            scene.motion->duration.si(), scene.motion->ground ? "; the ground moves" : "")};
}

Decision decide_flow(const Scene& scene) {
  if (!scene.flow) return {false, "no [flow]"};
  return {true, scene.flow->flows() ? "which joints hang together, and steady flow in them"
                                    : "which joints hang together; no level, so no flow"};
}

Decision decide(const Scene& scene, Step step) {
  const bool stability = scene.stability.has_value();
  const std::size_t sets = scene.joint_sets.size();
  switch (step) {
    case Step::read:
      return {true,
              scene.files.empty() ? "the scene" : "the scene and " + count_of(scene.files.size(), "file", "files")};
    case Step::draw: return {sets > 0, why_draw(scene)};
    case Step::cut: return {true, why_cut(scene)};
    case Step::audit: return {true, "every block system is certified"};
    case Step::stability: return {stability, why_stability(scene)};
    case Step::support: return {scene.support && stability, why_support(scene)};
    case Step::monte_carlo: return {scene.monte_carlo.has_value(), why_monte_carlo(scene)};
    case Step::elastic: return decide_elastic(scene);
    case Step::contact:
      if (!scene.motion || !scene.monte_carlo) return decide_motion(scene);
      return {false, "not in ensembles; cleave replay shows one realization"};
    case Step::flow: return decide_flow(scene);
    case Step::write:
      return {true,
              scene.monte_carlo ? "summary.json, log.txt, realizations.csv, copies of the scene" : why_write(scene)};
    case Step::report: return {scene.output.report, scene.output.report ? "report.html" : "output.report = false"};
  }
  std::unreachable();
}

}  // namespace

Plan make_plan(const Scene& scene) {
  Plan plan;
  for (const Step step : all_steps) {
    if (step == Step::flow && !scene.flow) continue;
    auto [run, why] = decide(scene, step);
    plan.steps.push_back({.step = step, .run = run, .why = std::move(why)});
  }
  add_inputs(scene_keys(), scene.given, plan);
  return plan;
}

Plan plan_of_realization(const Scene& scene) {
  Plan plan = make_plan(scene);
  for (PlannedStep& planned : plan.steps) {
    if (planned.step != Step::contact) continue;
    auto [run, why] = decide_motion(scene);
    planned.run = run;
    planned.why = std::move(why);
  }
  return plan;
}

std::expected<Plan, std::vector<Problem>> make_costed_plan(const Scene& scene) {
  CLEAVE_TRY(const SampledScene drawn, sample(scene));
  const CutEstimate cut = estimate_cut(drawn);
  Plan plan = make_plan(scene);
  plan.estimate = {.joints = cut.joints,
                   .blocks_low = cut.blocks_low,
                   .blocks_high = cut.blocks_high,
                   .memory_mb = program_mb + cut.memory_mb(),
                   .seconds = program_s};
  add_together(scene, cut, plan.estimate);
  const double runs = scene.monte_carlo ? static_cast<double>(scene.monte_carlo->realizations) : 1;
  for (PlannedStep& planned : plan.steps) {
    if (!planned.run) continue;
    const bool once = planned.step == Step::write || planned.step == Step::report;
    planned.seconds = (once ? 1 : runs) * seconds_of(planned.step, scene, cut);
    plan.estimate.seconds += planned.seconds;
  }
  return plan;
}

}  // namespace cleave::scene
