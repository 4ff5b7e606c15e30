#include "cleave/scene/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "cleave/dfn/sample.hpp"
#include "cleave/scene/plan_stages.hpp"
#include "cleave/scene3d/bounds.hpp"
#include "cleave/scene3d/key_tables.hpp"
#include "cleave/scene3d/scene.hpp"

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

std::string why_write(const OutputSettings& output, bool stability, bool motion) {
  std::string files = "summary.json, log.txt";
  if (output.vtu) files += ", blocks.vtu";
  if (output.csv && stability) files += ", key_blocks.csv";
  if (motion && output.csv) files += ", motion.csv";
  if (motion && output.vtu) files += ", motion_NNNN.vtu, motion.pvd";
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

using geometry::Vec3;

/// The section of a plane through the middle of a body over its mean section, at most about (a cube across its
/// diagonal: 1.5).
constexpr double whole = 1.5;

/// What a joint shares with the body at most, m2: its own area, and the mean section of a box of sides `side`
/// parallel to it (volume over width), times `whole`.
double area_of(const MeasuredJoint& joint, Vec3 side) {
  const auto section = [&](Vec3 normal) {
    const double width = std::abs(normal.x) * side.x + std::abs(normal.y) * side.y + std::abs(normal.z) * side.z;
    return side.x * side.y * side.z * norm(normal) / width;
  };
  if (const auto* plane = std::get_if<topology::PersistentJoint>(&joint.geometry))
    return whole * section(plane->normal);
  double area = 0;
  for (const geometry::Polygon& polygon : std::get<topology::Joint>(joint.geometry).polygons) {
    const auto corners = polygon.corners();
    Vec3 twice{0, 0, 0};
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
      twice = twice + cross(corners[i] - corners[0], corners[i + 1] - corners[0]);
    }
    if (norm(twice) > 0) area += std::min(norm(twice) / 2, whole * section(twice));
  }
  return area;
}

/// Joints, and a bracket of the number of blocks: at least 1; at most what independent isotropic planes of the same
/// area in a volume make, as of all directions these have the most vertices.
SizeEstimate estimate(const Scene& scene) {
  SizeEstimate size;
  size.joints = static_cast<double>(scene.joints.size());
  const Box box = box_of(scene.domain);
  const Vec3 side = box.max - box.min;
  const double volume = side.x * side.y * side.z;
  const double surface = 2 * (side.x * side.y + side.y * side.z + side.z * side.x);
  const double breadth = (side.x + side.y + side.z) / 2;  // mean over directions
  double per_volume = 0;                                  // area of joints in a volume, 1/m
  for (const MeasuredJoint& joint : scene.joints) per_volume += area_of(joint, side) / volume;
  for (const RandomSet& set : scene.joint_sets) {
    const double draws = dfn::expected_draws(set.law, {box.min, box.max});
    size.joints += draws;
    const dfn::JointSetSpec& spec = set.law.spec();
    if (const auto* count = std::get_if<dfn::Count>(&spec.intensity)) {
      const double section = whole * volume / breadth;
      const bool planes = std::holds_alternative<dfn::Persistent>(spec.shape);
      const double area = planes ? section : std::min(section, set.law.mean_area());
      per_volume += static_cast<double>(count->joints) * area / volume;
    } else {
      // Their number is Poisson's: two standard deviations more.
      per_volume += set.law.expected_p32(volume) * (1 + 2 / std::sqrt(std::max(1.0, draws)));
    }
  }
  // Each vertex is the lowest point of one cell, and so is the lowest point of each cell that has it on the boundary:
  // so cells are 1 + planes that meet the body + lines that do + vertices in it (Miles 1972).
  const double s = per_volume, pi = std::numbers::pi;
  const double isotropic = 1 + s * breadth + pi / 8 * s * s * surface / 4 + pi / 48 * s * s * s * volume;
  const double n = size.joints, pairs = n * std::max(0.0, n - 1) / 2, triples = pairs * std::max(0.0, n - 2) / 3;
  size.blocks_high = std::min(1 + n + pairs + triples, 1.5 * isotropic);
  size.memory_mb = 20 + 0.003 * n + 0.005 * size.blocks_high;
  size.seconds = 0.05 + 5e-5 * n + 4e-5 * size.blocks_high;
  return size;
}

/// Expected seconds of CPU of a stage.
double seconds_of(Stage stage, const SizeEstimate& size) {
  if (stage == Stage::draw) return 1e-5 * size.joints;
  if (stage == Stage::cut) return 4e-5 * size.joints + 2.4e-5 * size.blocks_high;
  if (stage == Stage::audit) return 1.6e-5 * size.blocks_high;
  return 0;
}

struct Decision {
  bool run;
  std::string why;
};

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
  if (scene.monte_carlo) return {false, "not in ensembles"};
  return {true, fmt::format("stress around \"{}\" (section by boundary elements) on its key blocks",
                            scene.excavations[scene.field_stress->excavation].name)};
}

Decision decide_motion(const Scene& scene) {
  if (!scene.motion) return {false, "no [[body]] and no [motion]"};
  if (scene.monte_carlo) return {false, "not in ensembles; cleave replay shows one realization"};
  std::string_view which = "every block that no side of the domain holds";
  if (scene.motion->release == Release::batches) which = "key blocks";
  if (scene.motion->release == Release::groups) which = "key blocks and key groups";
  if (scene.motion->release == Release::stage) which = "key blocks, stage by stage";
  return {true, fmt::format("{} in motion, {} {:g} s", which, scene.motion->to_rest ? "to rest or" : "for",
                            scene.motion->duration.si())};
}

Decision decide(const Scene& scene, Stage stage) {
  const bool stability = scene.stability.has_value();
  const std::size_t sets = scene.joint_sets.size();
  switch (stage) {
    case Stage::read:
      return {true,
              scene.files.empty() ? "the scene" : "the scene and " + count_of(scene.files.size(), "file", "files")};
    case Stage::draw:
      return {sets > 0, sets > 0 ? count_of(sets, "random joint set", "random joint sets") : "no [[joint_set]]"};
    case Stage::cut: return {true, why_cut(scene)};
    case Stage::audit: return {true, "every block system is certified"};
    case Stage::stability: return {stability, why_stability(scene)};
    case Stage::support: return {scene.support && stability, why_support(scene)};
    case Stage::monte_carlo: return {scene.monte_carlo.has_value(), why_monte_carlo(scene)};
    case Stage::elastic: return decide_elastic(scene);
    case Stage::contact: return decide_motion(scene);
    case Stage::write:
      return {true, scene.monte_carlo ? "summary.json, log.txt, realizations.csv, copies of the scene"
                                      : why_write(scene.output, stability, scene.motion.has_value())};
    case Stage::report: return {scene.output.report, scene.output.report ? "report.html" : "output.report = false"};
  }
  std::unreachable();
}

}  // namespace

Plan make_plan(const Scene& scene) {
  Plan plan{.stages = {}, .estimate = estimate(scene)};
  const double runs = scene.monte_carlo ? static_cast<double>(scene.monte_carlo->realizations) : 1;
  for (const Stage stage : all_stages) {
    auto [run, why] = decide(scene, stage);
    const double seconds = run ? runs * seconds_of(stage, plan.estimate) : 0;
    plan.stages.push_back({.stage = stage, .run = run, .why = std::move(why), .inputs = {}, .seconds = seconds});
  }
  plan.estimate.seconds *= runs;
  add_inputs(scene_keys(), scene.given, plan);
  return plan;
}

}  // namespace cleave::scene
