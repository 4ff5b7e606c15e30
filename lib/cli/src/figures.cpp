#include "figures.hpp"

#include "cleave/core/text.hpp"
#include "cleave/core/version.hpp"
#include "say.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace cleave::cli {
namespace {

std::string block_lines(const scene::RunResult& result) {
  const topology::Certificate& certificate = result.certificate();
  const scene::Figures& figures = result.figures;
  if (!figures.blocks) {
    return say("certificate  DID NOT PASS: {euler_violations} Euler violations, {open_shells} open shells, "
               "{unpaired_patches} unpaired patches",
               certificate) +
           fmt::format(", volume error {:.1e}\n", certificate.volume_relative_error);
  }
  return say("blocks       {count} ({concave} concave, {slivers} slivers), volume {volume_m3} m3\n"
             "certificate  passed: volume error {volume_relative_error:.1e}",
             group([&](auto& v) { scene::block_fields(v, figures.blocks, certificate, {}); })) +
         say(", face vectors {face_vector_max_relative:.1e}\n", certificate);
}

constexpr std::size_t shown = 8;

/// A line for each of the first rows.
template <class Row>
std::string lines_of(const std::vector<Row>& rows, std::string_view first, std::string_view other) {
  std::string text;
  for (std::size_t i = 0; i < std::min(shown, rows.size()); ++i) text += say(i == 0 ? first : other, rows[i]);
  return text;
}
std::string more_than_shown(std::size_t rows, std::string_view before, std::string_view after) {
  return rows > shown ? fmt::format("{}and {} more{}\n", before, rows - shown, after) : std::string{};
}

std::string key_block_lines(const scene::KeyBlockFigures& key) {
  constexpr std::string_view batch = "  batch {batch:<4}  {count} blocks, {volume_m3:.6g} m3\n";
  std::string text = say("key blocks   {count} in {batches} batches, volume {volume_m3} m3\n", key) +
                     lines_of(key.batches, batch, batch);
  if (key.domain_held && key.domain_held->count > 0) {
    text += say("  not counted: {domain_held} that only a side of the domain holds, {domain_held_volume_m3} m3\n", key);
  }
  return text + more_than_shown(key.batches.size(), "  ", " batches");
}

/// What moves alone or together, where that is more than key blocks.
std::string group_line(const std::optional<scene::KeyGroupFigures>& groups) {
  if (!groups || !groups->in_all || (groups->count == 0 && groups->in_doubt == 0)) return {};
  std::string text = say("  with groups: {in_all_count} blocks, {in_all_volume_m3:.6g} m3 in all; {count} ", *groups) +
                     (groups->count == 1 ? "group" : "groups");
  if (std::isfinite(groups->least_factor)) text += say(", least factor {factor_with_moments:.3g}", *groups);
  if (groups->factor_of_largest > groups->least_factor) text += say(", largest block {factor_of_largest:.3g}", *groups);
  return text + say("; {in_doubt} in doubt\n", *groups);
}

std::string design_line(const scene::DesignResult& design) {
  const std::string spacing = fmt::format("{:.4g} x {:.4g} m", design.spacing[0], design.spacing[1]);
  const std::string governs =
      design.governing ? fmt::format("; block {}, {:.3g} m3, {}", *design.governing, design.governing_volume.si(),
                                     design.found && design.failing == 0 ? "has the least margin" : "governs")
                       : "";
  if (!design.found) {
    return fmt::format("  bolts of {:g} m: no pattern found, down to {}{}\n", design.length, spacing, governs);
  }
  const std::string groups = design.groups && !design.groups->all_held()
                                 ? fmt::format("; does not hold {} of {} groups, {} in doubt", design.groups->not_held,
                                               design.groups->count, design.groups->in_doubt)
                                 : "";
  return fmt::format("  bolts of {:g} m: {} at {}{}{}{}; fails at {} of {} random offsets [{:.1f}, {:.1f} %]{}{}\n",
                     design.length, design.bolts, spacing, design.at_widest ? " (the widest tried)" : "",
                     design.rings ? fmt::format(" in {} rings", *design.rings) : "",
                     design.spot_bolts > 0 ? fmt::format(" beside {} spot", design.spot_bolts) : "", design.failing,
                     design.offsets, 100 * design.failing_share[0], 100 * design.failing_share[1], groups, governs);
}

std::string support_verdict(const scene::SupportFigures& support, const std::vector<scene::SupportCaseFigures>& cases) {
  const bool unjudged = support.groups_judged == scene::GroupsJudged::too_many;
  if (!support.passes()) {
    return unjudged && support.block_by_block && support.turning_not_held == 0
               ? "passes block by block, GROUPS OF BLOCKS NOT JUDGED"
               : "DOES NOT PASS";
  }
  const scene::FailsElsewhere elsewhere = scene::fails_elsewhere(support, cases);
  std::string not_asked;
  if (support.not_asked.count > 0) {
    const double least = support.not_asked.lowest_factor_of_safety;
    not_asked = fmt::format(", but for {} ({:.4g} m3{}) that it is not asked to hold, see the notes",
                            counted(support.not_asked.count, "block", "blocks"), support.not_asked.volume.si(),
                            std::isfinite(least) ? fmt::format(", least factor {:.3g}", least) : "");
  }
  return fmt::format("passes{}{}{}{}{}{}",
                     support.groups_judged == scene::GroupsJudged::not_asked ? " block by block" : "",
                     elsewhere.passes.empty() ? "" : " ", elsewhere.passes,
                     elsewhere.fails.empty() ? "" : ", DOES NOT PASS ", elsewhere.fails, not_asked);
}

std::string support_lines(const scene::SupportFigures& support, const std::vector<scene::DesignResult>& designs,
                          const std::vector<scene::SupportCaseFigures>& cases) {
  const auto all = group([&](auto& v) { scene::support_fields(v, support, {}, designs, {}); });
  const bool one = support.blocks == 1;
  std::string text =
      fmt::format("support      {}: {} below {} target by {} ", support_verdict(support, cases),
                  counted(support.blocks, "block", "blocks"), one ? "its" : "their", one ? "itself" : "themselves") +
      say("(falling {target_falling:g}, sliding {target_sliding:g}): {held_by_bolts} held by bolts, "
          "{held_by_shotcrete} by shotcrete, {held_by_both} by both, {not_held} not held\n",
          all);
  if (support.held_in_failing_groups > 0) {
    text += fmt::format("  of those held, {} in a group of blocks that is not, or in doubt: see supported_groups.csv\n",
                        counted(support.held_in_failing_groups, "lies", "lie"));
  }
  if (support.key_blocks_behind > 0) {
    text += fmt::format("  {} {} behind {} and {} where {} held\n",
                        counted(support.key_blocks_behind, "more key block", "more key blocks"),
                        support.key_blocks_behind == 1 ? "lies" : "lie", one ? "it" : "them",
                        support.key_blocks_behind == 1 ? "stays" : "stay", one ? "it is" : "they are");
  }
  if (support.turning > 0) {
    text += fmt::format("  {} only {}: {} not held, or not judged with moments\n",
                        counted(support.turning, "more key block", "more key blocks"),
                        support.turning == 1 ? "turns" : "turn", support.turning_not_held);
  }
  text += fmt::format("  {}, {} ({} failing); ", counted(support.bolts, "bolt", "bolts"),
                      counted(support.combined, "stitched body", "stitched bodies"), support.combined_failing) +
          (support.only_groups() ? "forces and pressures are of single blocks, and only groups are below their target\n"
           : one                 ? say("required by this block {required_force_n}, missing {missing_force_n}\n", all)
                 : say("required by these blocks {required_force_n}, missing {missing_force_n}\n", all));
  if (support.small_blocks > 0) {
    text +=
        say("  of these {small_blocks} with less free face than `spot_area`: {small_not_held} not held, required "
            "{small_required_force_n}\n",
            all);
  }
  if (support.passed_on_blocks > 0) {
    text +=
        say("  of these {passed_on_blocks} only for what other blocks pass to them: {passed_on_not_held} not held, "
            "required {passed_on_required_force_n}; hold the others\n",
            all);
  }
  for (const scene::SupportCaseFigures& load : cases) {
    text += fmt::format("  under {}: {} below {} target ", load.name, counted(load.figures.blocks, "block", "blocks"),
                        load.figures.blocks == 1 ? "its" : "their") +
            say("({target_falling:g}, {target_sliding:g}), {not_held} not held", load) +
            (load.figures.only_groups()
                 ? ", only groups\n"
                 : say("; required by these blocks {required_force_n}, missing {missing_force_n}\n", load));
  }
  if (support.groups && support.groups->count > 0) {
    text += fmt::format("  {} of blocks below {} target, ", counted(support.groups->count, "group", "groups"),
                        support.groups->count == 1 ? "its" : "their") +
            say("{not_held} not held, {in_doubt} in doubt\n", *support.groups);
  }
  for (const scene::DesignResult& design : designs) text += design_line(design);
  return text;
}

/// " (at rest)", and what stands against its verdict.
std::string rest_of(const scene::MotionResult& motion) {
  std::vector<std::string> said;
  if (motion.at_rest) said.emplace_back("at rest");
  if (motion.key_blocks_standing > 0) said.push_back(say("{key_blocks_standing} key blocks stand", motion));
  if (motion.locked() > 0) said.push_back(say("{standing_by_locked_forces} stand by locked forces, or may", motion));
  return said.empty() ? "" : fmt::format(" ({})", fmt::join(said, ", "));
}

std::string motion_line(const scene::MotionResult& motion) {
  if (motion.refused) return fmt::format("motion       nothing ran; {}\n", motion.stopped_why);
  return say("motion       {moved} of {released} blocks moved, {end_s:.4g} s", motion) + rest_of(motion) +
         say(", {steps} steps, residual {residual:.1e}, energy error {relative_error:.1e}\n", motion) +
         (motion.bolts.empty() ? ""
                               : say("  {acting} bolts act, {broken} broke, at most {largest_force_n}\n", motion)) +
         (motion.left() == 0 ? ""
                             : say("  {left} blocks left the domain, at most {fastest_left_m_s:.3g} m/s\n", motion));
}

std::string mapped_line(const scene::MappedResult& mapped) {
  return say("mapped       {honoured} of {joints} joints honoured, {random_joints_taken_out} random ones taken out\n",
             mapped);
}

std::string flow_line(const scene::FlowResult& flow) {
  return say("water        joints hang together in {clusters} clusters", flow) +
         (flow.flow
              ? say(", inflow {inflow_m3_s:.4g} m3/s, between {inflow_low_m3_s:.4g} and {inflow_high_m3_s:.4g}\n", flow)
              : std::string{"\n"});
}

}  // namespace

/// Volumes whole where digits after the point say nothing: 64000000, not 6.4e+07.
std::string text_of(SaidFigure figure) {
  if (figure.name.ends_with("_n")) {
    return std::isfinite(figure.value) ? fmt::format("{:.4g} kN", figure.value / 1000) : "no force is enough";
  }
  return figure.value >= 1e5 ? fmt::format("{:.0f}", figure.value) : fmt::format("{:.6g}", figure.value);
}

std::string verdict_of(const scene::RunResult& result) {
  const scene::Figures& figures = result.figures;
  if (!figures.support) return {};
  const scene::SupportFigures& support = *figures.support;
  const bool passes = support.passes() && scene::fails_elsewhere(support, figures.support_cases).fails.empty();
  return passes ? std::string{}
                : fmt::format("verdict: the support {}\n", support_verdict(support, figures.support_cases));
}

std::string cost_line(const scene::RunCost& cost) {
  return say("time         {wall_s:.2f} s, {cpu_s:.2f} s of CPU, {peak_rss_mb:.0f} MB, {threads} threads\n", cost);
}

std::string figures_of(const scene::RunResult& result) {
  const scene::Figures& figures = result.figures;
  std::string text =
      result.title + "\n" + say("joints       {joints}", figures.input) + fmt::format(", seed {}\n", result.seed);
  if (result.mapped) text += mapped_line(*result.mapped);
  text += lines_of(figures.input.excavations, "excavated    {name}, {volume_m3} m3\n",
                   "             {name}, {volume_m3} m3\n") +
          more_than_shown(figures.input.excavations.size(), "             ", "");
  text += block_lines(result);
  if (figures.key_blocks) {
    text += key_block_lines(*figures.key_blocks) + group_line(figures.groups);
  }
  for (const scene::CaseFigures& load : figures.load_cases) {
    text += say("  under {name}: {count} blocks, {volume_m3:.6g} m3", load) +
            (std::isfinite(load.figures.lowest_factor_of_safety)
                 ? say(", lowest factor of safety {lowest_factor_of_safety:.4g}\n", load)
                 : std::string{"\n"}) +
            group_line(load.groups);
  }
  if (figures.governing_case) text += fmt::format("  governs: {}\n", *figures.governing_case);
  if (figures.support) text += support_lines(*figures.support, result.designs, figures.support_cases);
  if (result.motion) text += motion_line(*result.motion);
  if (result.flow) text += flow_line(*result.flow);
  return text + cost_line(result.cost);
}

std::string log_of(const scene::RunResult& result) {
  std::string text =
      fmt::format("cleave " CLEAVE_VERSION "\nscene {} (sha256 {})\n", result.scene_file, result.scene_sha256);
  for (const scene::InputFile& file : result.files) {
    text += say("file {path} ({bytes} bytes, sha256 {sha256})\n", file);
  }
  text += "\nplan\n";
  text += describe(result.plan);
  text += "\ncost\n";
  for (const scene::StepCost& cost : result.cost.steps) {
    text += say("  {stage:<12} {wall_s:>10.3f} s {cpu_s:>10.3f} s of CPU {peak_rss_mb:>8.0f} MB\n", cost);
  }
  text += "\nresult\n" + figures_of(result);
  if (!result.notes.empty()) text += "\nnotes\n";
  for (const std::string& note : result.notes) text += "  " + note + "\n";
  return text;
}

}  // namespace cleave::cli
