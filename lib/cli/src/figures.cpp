#include "figures.hpp"
#include "cleave/core/version.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cleave::cli {
namespace {

/// m3, whole where digits after the point say nothing: 64000000, not 6.4e+07.
std::string volume_text(double m3) { return m3 >= 1e5 ? fmt::format("{:.0f}", m3) : fmt::format("{:.6g}", m3); }

std::string block_lines(const scene::BlockFigures& blocks, const topology::Certificate& certificate) {
  return fmt::format(
      "blocks       {} ({} concave, {} slivers), volume {} m3\n"
      "certificate  passed: volume error {:.1e}, face vectors {:.1e}\n",
      blocks.count, blocks.concave, blocks.slivers, volume_text(certificate.volume.si()),
      certificate.volume_relative_error, certificate.face_vector_max_relative);
}

std::string certificate_line(const topology::Certificate& c) {
  return fmt::format(
      "certificate  DID NOT PASS: {} Euler violations, {} open shells, {} unpaired patches, volume error {:.1e}\n",
      c.euler_violations, c.open_shells, c.unpaired_patches, c.volume_relative_error);
}

std::string excavation_lines(const std::vector<scene::ExcavationFigures>& excavations) {
  std::string text;
  constexpr std::size_t shown = 8;
  for (std::size_t i = 0; i < std::min(shown, excavations.size()); ++i) {
    text += fmt::format("{:<12} {}, {} m3\n", i == 0 ? "excavated" : "", excavations[i].name,
                        volume_text(excavations[i].volume.si()));
  }
  if (excavations.size() > shown) text += fmt::format("             and {} more\n", excavations.size() - shown);
  return text;
}

std::string key_block_lines(const scene::KeyBlockFigures& key) {
  std::string text = fmt::format("key blocks   {} in {} batches, volume {} m3\n", key.count, key.batches.size(),
                                 volume_text(key.volume_m3));
  constexpr std::size_t shown = 8;
  for (std::size_t i = 0; i < std::min(shown, key.batches.size()); ++i) {
    const scene::BatchFigures& batch = key.batches[i];
    text += fmt::format("  batch {:<4}  {} blocks, {:.6g} m3\n", batch.batch, batch.count, batch.volume_m3);
  }
  if (key.domain_held && key.domain_held->count > 0) {
    text += fmt::format("  not counted: {} that only a side of the domain holds, {} m3\n", key.domain_held->count,
                        volume_text(key.domain_held->volume.si()));
  }
  if (key.batches.size() > shown) text += fmt::format("  and {} more batches\n", key.batches.size() - shown);
  return text;
}

/// kN, or that no force is enough.
std::string force_text(double newtons) {
  return std::isfinite(newtons) ? fmt::format("{:.4g} kN", newtons / 1000) : "no force is enough";
}

std::string design_line(const scene::DesignResult& design) {
  const std::string spacing = fmt::format("{:.4g} x {:.4g} m", design.spacing[0], design.spacing[1]);
  const std::string governs = design.governing ? fmt::format("; block {} governs", *design.governing) : "";
  if (!design.found) {
    return fmt::format("  bolts of {:g} m: no pattern found, down to {}{}\n", design.length, spacing, governs);
  }
  return fmt::format("  bolts of {:g} m: {} at {}{}{}; fails at {} of {} random offsets [{:.1f}, {:.1f} %]{}\n",
                     design.length, design.bolts, spacing,
                     design.rings > 0 ? fmt::format(" in {} rings", design.rings) : "",
                     design.spot_bolts > 0 ? fmt::format(" beside {} spot", design.spot_bolts) : "", design.failing,
                     design.offsets, 100 * design.failing_share[0], 100 * design.failing_share[1], governs);
}

std::string support_lines(const scene::SupportFigures& support, const std::vector<scene::DesignResult>& designs) {
  std::string text = fmt::format(
      "support      {}: {} blocks below their target, {} held by bolts, {} by shotcrete, {} by both, {} not held\n"
      "  {} bolts, {} stitched bodies ({} failing); required {}, missing {}\n",
      support.passes ? "passes" : "DOES NOT PASS", support.blocks, support.held_by_bolts, support.held_by_shotcrete,
      support.held_by_both, support.not_held, support.bolts, support.combined, support.combined_failing,
      force_text(support.required_force_n), force_text(support.missing_force_n));
  if (support.groups && support.groups->count > 0) {
    text += fmt::format("  {} groups of blocks below their target, {} not held, {} in doubt\n", support.groups->count,
                        support.groups->not_held, support.groups->in_doubt);
  }
  for (const scene::DesignResult& design : designs) text += design_line(design);
  return text;
}

std::string motion_line(const scene::MotionResult& motion) {
  return fmt::format("motion       {} of {} blocks moved, {:.4g} s{}, {} steps, residual {:.1e}, energy error {:.1e}\n",
                     motion.moved(), motion.blocks.size(), motion.end.si(), motion.at_rest ? " (at rest)" : "",
                     motion.steps, motion.residual, motion.energy_error);
}

}  // namespace

std::string figures_of(const scene::RunResult& result) {
  std::string text =
      fmt::format("{}\njoints       {}, seed {}\n", result.title, result.figures.input.joints, result.seed);
  const scene::Figures& figures = result.figures;
  text += excavation_lines(figures.input.excavations);
  text += figures.blocks ? block_lines(*figures.blocks, result.certificate()) : certificate_line(result.certificate());
  if (figures.key_blocks) text += key_block_lines(*figures.key_blocks);
  for (const scene::CaseFigures& load : figures.load_cases) {
    text += fmt::format("  under {}: {} blocks, {:.6g} m3, lowest factor of safety {:.4g}\n", load.name,
                        load.figures.count, load.figures.volume_m3, load.figures.lowest_factor_of_safety);
  }
  if (figures.support) text += support_lines(*figures.support, result.designs);
  if (result.motion) text += motion_line(*result.motion);
  text += fmt::format("time         {:.2f} s, {:.2f} s of CPU, {:.0f} MB, {} threads\n", result.cost.wall_s,
                      result.cost.cpu_s, result.cost.peak_rss_mb, result.cost.threads);
  return text;
}

std::string log_of(const scene::RunResult& result) {
  std::string text =
      fmt::format("cleave " CLEAVE_VERSION "\nscene {} (sha256 {})\n", result.scene_file, result.scene_sha256);
  for (const scene::InputFile& file : result.files) {
    text += fmt::format("file {} ({} bytes, sha256 {})\n", file.name, file.bytes, file.sha256);
  }
  text += "\nplan\n";
  text += describe(result.plan);
  text += "\ncost\n";
  for (const scene::StageCost& cost : result.cost.stages) {
    text += fmt::format("  {:<12} {:>10.3f} s {:>10.3f} s of CPU {:>8.0f} MB\n", name_of(cost.stage), cost.wall_s,
                        cost.cpu_s, cost.peak_rss_mb);
  }
  text += "\nresult\n" + figures_of(result);
  if (!result.notes.empty()) text += "\nnotes\n";
  for (const std::string& note : result.notes) text += "  " + note + "\n";
  return text;
}

}  // namespace cleave::cli
