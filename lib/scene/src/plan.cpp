#include "cleave/scene/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "bounds.hpp"
#include "cleave/dfn/sample.hpp"

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

std::string why_write(const OutputSettings& output, bool stability) {
  std::string files = "summary.json, log.txt";
  if (output.vtu) files += ", blocks.vtu";
  if (output.csv && stability) files += ", key_blocks.csv";
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

/// Joints, and a bracket of the number of blocks: at least 1; at most what so many planes through the whole domain
/// would make.
SizeEstimate estimate(const Scene& scene) {
  SizeEstimate size;
  size.joints = static_cast<double>(scene.joints.size());
  const Box box = box_of(scene.domain);
  for (const RandomSet& set : scene.joint_sets) size.joints += dfn::expected_draws(set.law, {box.min, box.max});
  const double n = size.joints;
  // Cells of n random planes in a convex body: 1 + n + p2 C(n,2) + p3 C(n,3), with p2, p3 of isotropic planes in a
  // cube (Santalo 1976) as a round figure.
  size.blocks_high =
      1 + n + 0.52 * n * std::max(0.0, n - 1) / 2 + 0.116 * n * std::max(0.0, n - 1) * std::max(0.0, n - 2) / 6;
  const double likely = std::min(size.blocks_high, 1e7);
  size.memory_mb = 20 + 0.002 * n + 0.012 * likely;
  size.seconds = 0.05 + 1e-4 * n + 1.2e-4 * likely;
  return size;
}

}  // namespace

std::string_view name_of(Stage stage) noexcept {
  switch (stage) {
    case Stage::read: return "read";
    case Stage::draw: return "draw";
    case Stage::cut: return "cut";
    case Stage::audit: return "audit";
    case Stage::stability: return "stability";
    case Stage::support: return "support";
    case Stage::monte_carlo: return "monte_carlo";
    case Stage::elastic: return "elastic";
    case Stage::contact: return "contact";
    case Stage::write: return "write";
    case Stage::report: return "report";
  }
  std::unreachable();
}

bool Plan::runs(Stage stage) const noexcept {
  return std::ranges::any_of(stages,
                             [&](const PlannedStage& planned) { return planned.stage == stage && planned.run; });
}

Plan make_plan(const Scene& scene) {
  Plan plan;
  const bool stability = scene.stability.has_value();
  const bool drawn = !scene.joint_sets.empty();
  const std::size_t given = scene.joints.size();
  const auto add = [&](Stage stage, bool run, std::string why) { plan.stages.push_back({stage, run, std::move(why)}); };
  for (const Stage stage : all_stages) {
    switch (stage) {
      case Stage::read:
        add(stage, true,
            scene.files.empty() ? "the scene" : "the scene and " + count_of(scene.files.size(), "file", "files"));
        break;
      case Stage::draw:
        add(stage, drawn,
            drawn ? count_of(scene.joint_sets.size(), "random joint set", "random joint sets") : "no [[joint_set]]");
        break;
      case Stage::cut:
        add(stage, true,
            given == 0 && !drawn ? "no joints: the domain less the excavations"
            : drawn && given == 0
                ? "the drawn joints"
                : count_of(given, "given joint", "given joints") + (drawn ? " and the drawn ones" : ""));
        if (scene.output.only_key_blocks) {
          plan.stages.back().why += !stability       ? "; all of the rock, as there is no free face to start from"
                                    : scene.sequence ? "; all of the rock, as it is taken out in stages"
                                                     : "; only near free faces, as only key blocks are asked for";
        }
        break;
      case Stage::audit: add(stage, true, "every block system is certified"); break;
      case Stage::stability: add(stage, stability, why_stability(scene)); break;
      case Stage::support: add(stage, scene.support && stability, why_support(scene)); break;
      case Stage::monte_carlo:
        add(stage, scene.monte_carlo.has_value(),
            !scene.monte_carlo ? "no [monte_carlo]: one run"
            : scene.monte_carlo->stop
                ? fmt::format("up to {} realizations, until {} is known to {:.3g} %", scene.monte_carlo->realizations,
                              scene.monte_carlo->stop->quantity, 100 * scene.monte_carlo->stop->relative_half_width)
                : fmt::format("{} realizations", scene.monte_carlo->realizations));
        break;
      case Stage::elastic:
        add(stage, scene.field_stress && stability,
            !scene.field_stress ? "no [[body]] and no [field_stress]"
            : !stability        ? "nothing is free, so no block is clamped"
                                : fmt::format("stress around \"{}\" (section by boundary elements) on its key blocks",
                                              scene.excavations[scene.field_stress->excavation].name));
        break;
      case Stage::contact: add(stage, false, "no [[body]]"); break;
      case Stage::write: add(stage, true, why_write(scene.output, stability)); break;
      case Stage::report:
        add(stage, scene.output.report, scene.output.report ? "report.html" : "output.report = false");
        break;
    }
  }
  plan.estimate = estimate(scene);
  if (scene.monte_carlo) plan.estimate.seconds *= static_cast<double>(scene.monte_carlo->realizations);
  return plan;
}

}  // namespace cleave::scene
