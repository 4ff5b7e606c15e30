#include "run_notes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "crumbs.hpp"
#include "cut_notes.hpp"
#include "group_notes.hpp"
#include "load_notes.hpp"
#include "support_notes.hpp"

namespace cleave::scene {
namespace {

/// Mapped joints that no joint of their set shows as they were mapped.
void add_mapped_note(const Scene& scene, const MappedResult& mapped, std::vector<std::string>& notes) {
  const std::uint64_t all = mapped.joints.size(), missed = all - mapped.honoured();
  if (missed == 0) return;
  const MappedJointResult* worst = nullptr;
  for (const MappedJointResult& joint : mapped.joints) {
    if (!joint.honours && (worst == nullptr || joint.misfit > worst->misfit)) worst = &joint;
  }
  const std::string row = from_scene(scene, worst->rows.front());
  const std::string how =
      !std::isfinite(worst->misfit.si())         ? fmt::format("{} misses a pick, or shows one too many", row)
      : worst->misfit > scene.mapped->seen.error ? fmt::format("the farthest: {}, {:.3g} m", row, worst->misfit.si())
                                                 : fmt::format("of {} its set has hardly such joints", row);
  notes.push_back(
      fmt::format("{} of {} mapped {} not honoured within {:g} m and by the laws of {}; {}; see "
                  "mapped_joints.csv",
                  missed, all, all == 1 ? "joints is" : "joints are", scene.mapped->seen.error.si(),
                  missed == 1 ? "its set" : "their sets", how));
}

/// What was said of the scene as it was read, sets of which nothing was drawn, and mapped joints that are not shown.
std::vector<std::string> notes_of_input(const Scene& scene, const Realization& made) {
  std::vector<std::string> notes = notes_of(scene);
  for (const RandomSet& set : scene.joint_sets) {
    const bool drawn = std::ranges::any_of(made.joints, [&](const JointInfo& joint) {
      return joint.set == set.set && joint.origin == JointOrigin::drawn;
    });
    if (drawn) continue;
    notes.push_back(
        fmt::format("no joint was drawn of the set {} (line {} of the scene): the blocks are those of rock without it; "
                    "check its intensity and size, in metres",
                    scene.sets[set.set].name, set.line));
  }
  if (made.mapped) add_mapped_note(scene, *made.mapped, notes);
  return notes;
}

/// Blocks that translation leaves in place, but no statics does.
void add_rotation_note(const stability::Analysis& analysis, std::vector<std::string>& notes) {
  std::size_t turning = 0, from_rest = 0;
  std::string first;
  for (const stability::Judgement& j : analysis.judgements) {
    if (!j.rotation || !j.rotation->turns) continue;
    ++turning;
    from_rest += j.rotation->from_rest ? 1U : 0U;
    if (turning <= 10) first += (first.empty() ? "" : ", ") + std::to_string(j.block.value());
  }
  if (turning == 0) return;
  notes.push_back(fmt::format("{} {} would turn or topple though {} cannot slide: {}{}{}", turning,
                              turning == 1 ? "block" : "blocks", turning == 1 ? "it" : "they", first,
                              turning > 10 ? ", ..." : "",
                              analysis.rotation == stability::RotationCheck::decide
                                  ? "; counted as key blocks, with factors and net forces that are those of "
                                    "translation: above 1, and below 0"
                                  : "; counted as key blocks only with rotation = \"decide\""));
  if (from_rest > 0) {
    notes.back() += fmt::format(
        "; {} of them {} from rest by a search, though forces exist that would hold {}: a search may miss such a "
        "motion",
        from_rest, from_rest == 1 ? "turns" : "turn", from_rest == 1 ? "it" : "them");
  }
}

/// Blocks that only what lies inside them keeps in place: never left unsaid, for they are not in the batches.
void add_enclosed_notes(const std::vector<stability::InterlockedByInclusion>& rows, std::vector<std::string>& notes) {
  constexpr std::size_t most = 10;
  for (std::size_t i = 0; i < std::min(rows.size(), most); ++i) {
    const stability::InterlockedByInclusion& row = rows[i];
    notes.push_back(fmt::format(
        "block {} is not in the batches only because {} {} wholly inside it: as one body {}, factor of safety {:.3g}, "
        "net force {:.4g} kN",
        row.block.value(),
        row.inside.size() == 1 ? fmt::format("block {}", row.inside[0].value())
                               : fmt::format("{} blocks", row.inside.size()),
        row.inside.size() == 1 ? "lies" : "lie",
        row.mode == stability::Mode::falling ? std::string{"they fall"} : fmt::format("they move ({})", name(row.mode)),
        row.factor_of_safety, row.net.si() / 1000));
  }
  if (rows.size() > most) notes.push_back(fmt::format("and {} more blocks like that", rows.size() - most));
}

/// Blocks that slide along joints whose cohesion nothing presses into use.
void add_cohesion_note(const stability::Analysis& analysis, std::vector<std::string>& notes) {
  std::size_t blocks = 0;
  double largest = 0;
  for (const stability::Judgement& j : analysis.judgements) {
    if (!j.key || !(j.cohesion_left_out.si() > 0)) continue;
    ++blocks;
    largest = std::max(largest, j.cohesion_left_out.si());
  }
  if (blocks == 0) return;
  notes.push_back(fmt::format(
      "{} key {} along joints with cohesion on which nothing presses (vertical joints, say), up to {:.3g} kN of it: it "
      "is not counted; cohesion_on_parallel_faces = true counts it",
      blocks, blocks == 1 ? "block moves" : "blocks move", largest / 1000));
}

/// Blocks that nothing but a side of the domain holds. `where`: the load case, before the note.
void add_border_note(const stability::DomainHeld& held, std::string_view where, std::vector<std::string>& notes) {
  if (held.blocks.empty()) return;
  const bool one = held.blocks.size() == 1;
  // Blocks beside others that have left have no part of the faces that were free at first.
  const std::string place = held.free_area.si() > 0
                                ? fmt::format("at free faces ({:.4g} m3, {:.3g} % of the free area)", held.volume.si(),
                                              100 * held.free_area.si() / held.all_free.si())
                                : fmt::format("({:.4g} m3) beside {} that {} left", held.volume.si(),
                                              one ? "a block" : "blocks", one ? "has" : "have");
  notes.push_back(fmt::format(
      "{}{} {} {} {} held only by {} of the domain that {} not free and "
      "{} not counted as key blocks{}: what lies beyond is unknown; enlarge the domain, or name these sides in `free`; "
      "see border_blocks.csv",
      where, held.blocks.size(), one ? "block" : "blocks", place, one ? "is" : "are", one ? "a side" : "sides",
      one ? "is" : "are", one ? "is" : "are",
      held.together == 0 ? "" : fmt::format("; {} of them would move only together with others", held.together)));
}

void add_border_notes(const Realization& made, std::vector<std::string>& notes) {
  if (made.domain_held) add_border_note(*made.domain_held, "", notes);
  for (const CaseResult& load : made.load_cases) {
    const bool more = load.domain_held && (!made.domain_held || load.domain_held->blocks != made.domain_held->blocks);
    if (more) add_border_note(*load.domain_held, fmt::format("load case {}: ", load.name), notes);
  }
}

/// Key blocks of a stage that later stages take away, or that nothing in the last state tells of.
void add_stage_note(const SequenceResult& sequence, const stability::Analysis& analysis,
                    std::vector<std::string>& notes) {
  std::uint64_t at_the_end = 0;
  for (const stability::Batch& batch : analysis.batches) at_the_end += batch.blocks.size();
  std::uint64_t most = 0;
  std::size_t stage = 0;
  for (std::size_t k = 0; k < sequence.stages.size(); ++k) {
    if (sequence.stages[k].key_blocks.count <= most) continue;
    most = sequence.stages[k].key_blocks.count;
    stage = k;
  }
  if (most <= at_the_end) return;
  notes.push_back(fmt::format("stage {} of the excavation has {} key {}, {} when all is out: see `sequence`", stage + 1,
                              most, most == 1 ? "block" : "blocks", at_the_end));
}

/// Blocks that a joint holds which closes on them by next to nothing. `where`: the load case or stage, before it.
void add_taper_note(const std::vector<stability::Barred>& tapered, std::string_view where,
                    std::vector<std::string>& notes) {
  if (tapered.empty()) return;
  const auto least = std::ranges::min_element(tapered, {}, &stability::Barred::factor_of_safety);
  double volume = 0;
  for (const stability::Barred& row : tapered) volume += row.volume.si();
  const bool one = tapered.size() == 1;
  notes.push_back(fmt::format(
      "{}{} ({:.4g} m3) at free faces {} only because joints close on {} by less than {:g} mm a metre: were those "
      "parallel, the least factor of safety would be {:.3g} (block {}); count on no such taper",
      where, one ? "1 block" : fmt::format("{} blocks", tapered.size()), volume, one ? "stays" : "stay",
      one ? "it" : "them", 1e3 * stability::slight_taper, least->factor_of_safety, least->block.value()));
}

/// In the base case, and what load cases and stages have beside it.
void add_taper_notes(const Realization& made, std::vector<std::string>& notes) {
  const std::vector<stability::Barred> base = in_no_group(made.tapered, made.key_groups);
  add_taper_note(base, "", notes);
  for (const CaseResult& load : made.load_cases) {
    auto more = in_no_group(load.tapered, load.groups);
    std::erase_if(more, [&](const auto& row) {
      return std::ranges::find(base, row.block, &stability::Barred::block) != base.end();
    });
    add_taper_note(more, fmt::format("load case {}: ", load.name), notes);
  }
  if (!made.sequence) return;
  for (const StageResult& row : made.sequence->stages) {
    auto more = in_no_group(row.tapered, row.groups);
    // Blocks of another state have other numbers.
    std::erase_if(more, [&](const auto& own) {
      return std::ranges::any_of(base, [&](const auto& other) {
        return std::abs((own.volume - other.volume).si()) <= 1e-9 * own.volume.si() &&
               std::abs(own.factor_of_safety - other.factor_of_safety) <= 1e-9;
      });
    });
    add_taper_note(more, fmt::format("after stage {}: ", row.stage), notes);
  }
}

/// What stays in place by something that may not be counted on.
void add_held_notes(const Realization& made, std::vector<std::string>& notes) {
  add_enclosed_notes(made.held_from_within, notes);
  add_barred_note(made.barred, made.key_groups && made.key_groups->too_many, notes);
  add_crumb_notes(made.held_by_crumbs, {}, "", notes);
  add_taper_notes(made, notes);
  add_border_notes(made, notes);
}

/// What the stress of the rock holds, and where it is not known.
void add_field_stress_notes(const FieldStressResult& clamped, const FieldStressSettings& asked,
                            std::vector<std::string>& notes) {
  if (!clamped.reached) {
    notes.push_back(
        fmt::format("field stress: displacements of the section still change by {:.1e} (asked: {:.1e}) with its finest "
                    "elements: the stress is known no better than that; where it will do, state a tolerance above it",
                    clamped.error, asked.tolerance));
  }
  if (clamped.held > 0) {
    notes.push_back(fmt::format("field stress: {} unstable {} held by the stress across {} joints; without it {}",
                                clamped.held, clamped.held == 1 ? "block is" : "blocks are",
                                clamped.held == 1 ? "its" : "their", clamped.held == 1 ? "it falls" : "they fall"));
  }
  if (clamped.undecided > 0) {
    notes.push_back(fmt::format(
        "field stress: {} nearer than two widths to another opening, a heading or the ground: the section of the "
        "tunnel says nothing of the stress there, and no factor with it is given",
        clamped.undecided == 1 ? "1 block that would move is"
                               : fmt::format("{} blocks that would move are", clamped.undecided)));
  }
}

}  // namespace

void add_barred_note(const std::vector<stability::Barred>& barred, bool too_many, std::vector<std::string>& notes) {
  if (barred.empty()) return;
  const auto least = std::ranges::min_element(barred, {}, &stability::Barred::factor_of_safety);
  double volume = 0;
  for (const stability::Barred& row : barred) volume += row.volume.si();
  notes.push_back(fmt::format(
      "{} ({:.4g} m3) at free faces {} only because of neighbours that are smaller or removable: without those the "
      "least factor of safety is {:.3g} (block {}); whether they are pushed out was not asked: {}",
      barred.size() == 1 ? "1 block" : fmt::format("{} blocks", barred.size()), volume,
      barred.size() == 1 ? "stays" : "stay", least->factor_of_safety, least->block.value(),
      too_many ? "too many blocks are near free faces to be judged together" : "see `groups`"));
}

std::vector<std::string> notes_of(const Scene& scene, const Realization& made) {
  const std::optional<stability::Analysis>& analysis = made.analysis;
  std::vector<std::string> notes = notes_of_input(scene, made);
  if (made.window) {
    notes.push_back(note_on(*made.window));
  } else {
    add_cut_notes(scene, made, notes);
  }
  if (made.complex) add_micro_note(made.complex->complex(), scene.micro_blocks, notes);
  if (analysis && analysis->stopped_at_max_batches) {
    notes.push_back(
        fmt::format("stopped after max_batches = {} batches: more blocks may move", scene.stability->max_batches));
  }
  if (made.support && !made.support->passes()) {
    notes.push_back(
        "the support does not reach the required factors of safety: see bolts.csv and the columns of key_blocks.csv");
  }
  if (made.sequence) add_stage_support_notes(*made.sequence, notes);
  if (made.sequence) add_stage_case_notes(*made.sequence, notes);
  for (const CaseSupport& load : made.support_cases) {
    if (!load.support.passes()) {
      notes.push_back(
          fmt::format("load case {}: the support does not reach the required factors of safety: see support_blocks.csv",
                      load.name));
    }
  }
  if (analysis) add_cohesion_note(*analysis, notes);
  if (analysis) add_rotation_note(*analysis, notes);
  add_held_notes(made, notes);
  if (analysis && made.complex) add_lifted_notes(scene, made, notes);
  if (analysis && made.complex) add_sign_notes(scene, made, notes);
  if (analysis && made.complex) add_case_notes(scene, made, notes);
  add_support_notes(scene, made, notes);
  if (made.groups_below_target && made.key_groups) {
    add_below_target_note(*made.groups_below_target, *made.key_groups, scene.stability->target->sliding, "", notes);
  }
  if (scene.stability && scene.stability->group_factor && analysis) add_group_factor_note(made.group_factor, notes);
  add_target_notes(made, notes);
  if (made.sequence && analysis) add_stage_note(*made.sequence, *analysis, notes);
  if (made.window && made.window->truncated > 0 && analysis && analysis->rotation == stability::RotationCheck::flag) {
    notes.push_back("blocks that go on outside the box that was cut are not asked whether they turn");
  }
  if (made.field_stress) add_field_stress_notes(*made.field_stress, *scene.field_stress, notes);
  if (analysis) add_case_counts(made, notes);
  if (made.key_groups) {
    add_group_notes(*made.key_groups, *analysis, made.support.has_value() && !made.group_support, notes);
  }
  add_let_go_note(made.let_go, notes);
  if (made.group_support) add_group_support_notes(*made.group_support, "", notes);
  for (const CaseSupport& load : made.support_cases) {
    if (load.groups) add_group_support_notes(*load.groups, fmt::format("load case {}: ", load.name), notes);
  }
  add_design_notes(made.designs, notes);
  return notes;
}

}  // namespace cleave::scene
