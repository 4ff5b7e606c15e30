#include "run_notes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace cleave::scene {
namespace {

/// A length a little above, in two digits.
double rounded_up(double length) {
  const double unit = std::pow(10.0, std::floor(std::log10(length)) - 1);
  return std::ceil(1.05 * length / unit) * unit;
}

/// A length a little below, in two digits.
double rounded_down(double length) {
  const double unit = std::pow(10.0, std::floor(std::log10(length)) - 1);
  return std::floor(0.95 * length / unit) * unit;
}

/// "joint crown (scene.toml:14)", "joint 7 (scene.toml:14)", "joint 7 (A #3)".
std::string name_of(topology::JointId id, const Scene& scene, const Realization& made) {
  const bool named = id.index() < scene.joints.size() && !scene.joints[id.index()].name.empty();
  return fmt::format("joint {} ({})", named ? scene.joints[id.index()].name : std::to_string(id.value()),
                     made.joints[id].source);
}

void add_cut_notes(const Scene& scene, const Realization& made, std::vector<std::string>& notes) {
  const topology::CutReport& report = made.cut;
  const std::size_t joints = made.joints.size();
  if (const topology::CoarseSnap& coarse = report.coarse_snap; coarse.polygons > 0) {
    notes.push_back(fmt::format(
        "snap is too coarse for {}: the shortest side, of {}, is {:.2g} m, and corners nearer than twice the snap "
        "become "
        "one or pass each other, so there may be other blocks than those meant; a snap of {:.2g} keeps them all",
        coarse.polygons == 1 ? "a polygon" : fmt::format("{} polygons", coarse.polygons),
        name_of(coarse.joint, scene, made), coarse.shortest.si(), rounded_down(coarse.shortest.si() / 2)));
  }
  if (const topology::NearMisses& near = report.near_misses; near.sides > 0) {
    notes.push_back(fmt::format(
        "{} of joints {} another polygon by less than 1e-6 of the domain without touching it, by {:.2g} m at most "
        "({} and {}): the rock is not divided there; snap = {:.2g} would close that",
        near.sides == 1 ? "a side" : fmt::format("{} sides", near.sides), near.sides == 1 ? "misses" : "miss",
        near.largest.si(), name_of(near.joint, scene, made),
        near.other ? name_of(*near.other, scene, made) : std::string{"a side of the domain or an excavation"},
        rounded_up(near.largest.si())));
  }
  if (report.joints_outside > 0) {
    notes.push_back(fmt::format("{} of {} joints lie outside the rock and cut nothing", report.joints_outside, joints));
  }
  if (!report.dangling.empty()) {
    notes.push_back(
        fmt::format("{} of {} joints end inside the rock and separate nothing", report.dangling.size(), joints));
  }
}

void add_micro_note(const topology::BlockComplex& complex, const MicroBlocks& limits, std::vector<std::string>& notes) {
  if (limits.policy == MicroBlockPolicy::keep) return;
  const auto found = micro_blocks(complex, limits);
  if (found.empty()) return;
  double volume = 0;
  for (const topology::BlockId b : found) volume += complex.blocks()[b].volume.si();
  notes.push_back(fmt::format("{} of {} blocks are micro-blocks ({:.3g} m3 in all){}", found.size(),
                              complex.blocks().size(), volume,
                              limits.policy == MicroBlockPolicy::exclude ? ": left out of stability" : ""));
}

/// Blocks that translation leaves in place, but no statics does.
void add_rotation_note(const stability::Analysis& analysis, std::vector<std::string>& notes) {
  std::size_t turning = 0;
  std::string first;
  for (const stability::Judgement& j : analysis.judgements) {
    if (!j.rotation || !j.rotation->turns) continue;
    ++turning;
    if (turning <= 10) first += (first.empty() ? "" : ", ") + std::to_string(j.block.value());
  }
  if (turning == 0) return;
  notes.push_back(fmt::format("{} {} would turn or topple though {} cannot slide: {}{}{}", turning,
                              turning == 1 ? "block" : "blocks", turning == 1 ? "it" : "they", first,
                              turning > 10 ? ", ..." : "",
                              analysis.rotation == stability::RotationCheck::decide
                                  ? "; counted as key blocks"
                                  : "; counted as key blocks only with rotation = \"decide\""));
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

void add_stage_support_notes(const SequenceResult& sequence, std::vector<std::string>& notes) {
  for (const StageResult& row : sequence.stages) {
    if (!row.support) continue;
    const std::string where = fmt::format("after stage {}: ", row.stage);
    if (row.support->too_many) notes.push_back(too_many_with_support(where));
    if (row.support->groups && !row.support->groups->all_held()) {
      const SupportedGroupFigures& groups = *row.support->groups;
      notes.push_back(
          fmt::format("{}the support installed by then does not hold {} of {} {} of blocks below the target ({:.4g} "
                      "m3), {} in doubt: see sequence in summary.json",
                      where, groups.not_held, groups.count, groups.count == 1 ? "group" : "groups",
                      groups.not_held_volume.si(), groups.in_doubt));
    }
    if (row.support->not_held == 0 && row.support->combined_failing == 0) continue;
    notes.push_back(
        fmt::format("after stage {} the support installed by then leaves {} of {} blocks and {} stitched bodies below "
                    "the required factors of safety: see sequence in summary.json",
                    row.stage, row.support->not_held, row.support->blocks, row.support->combined_failing));
  }
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

std::string note_on(const WindowInfo& window) {
  return fmt::format(
      "only key blocks were asked for: of the rock only the box from ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, "
      "{:.6g}) "
      "was cut; {} of its blocks go on outside it and are shown as far as it goes",
      window.min.x, window.min.y, window.min.z, window.max.x, window.max.y, window.max.z, window.truncated);
}

}  // namespace

std::string too_many_with_support(std::string_view where) {
  return std::string{where} +
         "support: at strengths over the target more blocks are near free faces than are judged together: whether it "
         "holds groups of blocks was not asked";
}

KeyGroupFigures count_key_groups(const stability::KeyGroups& groups) {
  KeyGroupFigures figures{.judged = !groups.too_many};
  for (const stability::KeyGroup& group : groups.groups) {
    const bool doubt = group.verdict == assembly::Verdict::in_doubt;
    figures.certain += group.verdict == assembly::Verdict::certain ? 1U : 0U;
    figures.unsafe += group.verdict == assembly::Verdict::unsafe ? 1U : 0U;
    figures.in_doubt += doubt ? 1U : 0U;
    if (doubt) continue;
    ++figures.count;
    figures.volume_m3 += group.volume.si();
    if (!group.factors) continue;
    figures.factor = std::min(figures.factor, group.factor_move);
    figures.least_factor = std::min(figures.least_factor, group.least_factor());
  }
  return figures;
}

void add_below_target(const stability::KeyGroups& found, KeyGroupFigures& figures) {
  figures.below_target = 0;
  for (const stability::KeyGroup& group : found.groups) {
    if (group.verdict == assembly::Verdict::in_doubt) continue;
    ++*figures.below_target;
    figures.below_target_volume += group.volume;
  }
}

namespace {
constexpr std::string_view see_groups = ": see key_groups.csv";
}  // namespace

namespace {

/// What the search for groups did not look at.
void add_unasked_notes(const stability::KeyGroups& groups, std::string_view where, std::vector<std::string>& notes) {
  if (groups.too_many) {
    notes.push_back(fmt::format(
        "{}key groups: {} blocks near free faces are too many to be judged together; only single blocks were "
        "judged, and what they say holds for each alone (groups = \"decide\" judges up to {})",
        where, groups.blocks, stability::most_together.blocks));
  }
  if (groups.without_moments) {
    notes.push_back(
        fmt::format("{}key groups: {} blocks near free faces were judged together in translation only; groups = "
                    "\"decide\" looks at "
                    "moments too",
                    where, groups.blocks));
  }
  if (groups.cut_off) {
    notes.push_back(fmt::format(
        "{}key groups: one that moves touches more blocks than are judged together; more may move than it says",
        where));
  }
}

}  // namespace

void add_moving_group_notes(const stability::KeyGroups& groups, const stability::Analysis& analysis,
                            std::string_view where, std::vector<std::string>& notes) {
  std::size_t beyond = 0, doubt = 0;
  double volume = 0, in_doubt = 0, least = std::numeric_limits<double>::infinity();
  for (const stability::KeyGroup& group : groups.groups) {
    if (group.verdict == assembly::Verdict::in_doubt) {
      ++doubt;
      in_doubt += group.volume.si();
      continue;
    }
    const bool known = std::ranges::all_of(group.blocks, [&](topology::BlockId id) {
      const auto it = std::ranges::lower_bound(analysis.judgements, id, {}, &stability::Judgement::block);
      return it != analysis.judgements.end() && it->block == id && it->key;
    });
    if (known) continue;
    ++beyond;
    volume += group.volume.si();
    least = std::min(least, group.least_factor());
  }
  if (beyond > 0) {
    notes.push_back(
        fmt::format("{}{} key {} ({:.4g} m3) of blocks that do not all move by themselves, least factor of "
                    "safety {:.3g}{}",
                    where, beyond, beyond == 1 ? "group" : "groups", volume, least, see_groups));
  }
  if (doubt > 0) {
    notes.push_back(fmt::format("{}{} {} of blocks ({:.4g} m3) could not be decided together: in doubt, not stable{}",
                                where, doubt, doubt == 1 ? "group" : "groups", in_doubt, see_groups));
  }
  add_unasked_notes(groups, where, notes);
  if (groups.at_the_edge && beyond + doubt > 0) {
    notes.push_back(
        fmt::format("{}key groups reach the edge of the box that was cut: what lies beyond was taken to stay, so that "
                    "more may move; [output] blocks = \"all\" takes it in",
                    where));
  }
}

namespace {

/// What support leaves of groups below their target. `where`: the load case, before each note.
void add_group_support_notes(const stability::GroupSupport& groups, std::string_view where,
                             std::vector<std::string>& notes) {
  const SupportedGroupFigures f = count_supported_groups(groups);
  if (f.not_held > 0) {
    notes.push_back(
        fmt::format("{}the support does not hold {} {} of blocks ({:.4g} m3) that move together below their target: "
                    "see supported_groups.csv",
                    where, f.not_held, f.not_held == 1 ? "group" : "groups", f.not_held_volume.si()));
  }
  if (f.in_doubt > 0) {
    notes.push_back(fmt::format(
        "{}whether the support holds {} {} of blocks could not be decided, or lies within 5 % of the target: in "
        "doubt, not held: see supported_groups.csv",
        where, f.in_doubt, f.in_doubt == 1 ? "group" : "groups"));
  }
  if (groups.below.without_moments || groups.left.without_moments) {
    notes.push_back(
        fmt::format("{}support: {} blocks at strengths over the target were judged together in translation only: "
                    "whether it holds what turns or topples was not asked; groups = \"decide\" asks",
                    where, groups.below.blocks));
  }
  if (groups.below.cut_off || groups.left.cut_off) {
    notes.push_back(
        fmt::format("{}support: a group that moves at strengths over the target touches more blocks than are judged "
                    "together; more may have to be held than supported_groups.csv says",
                    where));
  }
  if (groups.below.at_the_edge || groups.left.at_the_edge) {
    notes.push_back(
        fmt::format("{}support: groups that move at strengths over the target reach the edge of the box that was cut: "
                    "what lies beyond was taken to stay, so that more may have to be held; [output] blocks = \"all\" "
                    "takes it in",
                    where));
  }
}

/// Groups that a pattern which was found leaves.
void add_design_notes(const std::vector<DesignResult>& designs, std::vector<std::string>& notes) {
  for (const DesignResult& design : designs) {
    if (!design.found || !design.groups || design.groups->all_held()) continue;
    const SupportedGroupFigures& groups = *design.groups;
    notes.push_back(fmt::format(
        "no pattern of bolts of {:g} m holds {} of {} {} of blocks that move together below their target, and {} {} in "
        "doubt: the one found holds single blocks and stitched bodies",
        design.length, groups.not_held, groups.count, groups.count == 1 ? "group" : "groups", groups.in_doubt,
        groups.in_doubt == 1 ? "is" : "are"));
  }
}

/// What groups in doubt do as rigid blocks that start from rest.
void add_let_go_note(const std::vector<std::optional<LetGo>>& outcomes, std::vector<std::string>& notes) {
  const auto count = [&](LetGo what) { return std::ranges::count(outcomes, std::optional{what}); };
  const auto moved = count(LetGo::moved), stayed = count(LetGo::stayed);
  const auto other = count(LetGo::stopped) + count(LetGo::not_tried);
  if (moved + stayed + other == 0) return;
  notes.push_back(
      fmt::format("groups in doubt, let go from rest as rigid blocks in motion for 0.2 s: {} moved, {} stayed, "
                  "{} could not be tried; a group that stayed is no proof: see let_go in key_groups.csv",
                  moved, stayed, other));
}

/// Of the final state under the loads of the base case, with what was not looked at.
void add_group_notes(const stability::KeyGroups& groups, const stability::Analysis& analysis, bool unasked,
                     std::vector<std::string>& notes) {
  add_moving_group_notes(groups, analysis, "", notes);
  if (unasked && (groups.too_many || !groups.groups.empty())) {
    notes.push_back(
        "the support was checked block by block and for stitched bodies: whether it holds groups of blocks was not "
        "asked");
  }
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
      "{} not counted as key blocks{}: what lies beyond is unknown; enlarge the domain, or name these sides in `free`",
      where, held.blocks.size(), one ? "block" : "blocks", place, one ? "is" : "are", one ? "a side" : "sides",
      one ? "is" : "are", one ? "is" : "are",
      held.together == 0 ? "" : fmt::format("; {} of them would move only together with others", held.together)));
}

/// Bolts that hold on to what only a side of the domain holds.
void add_anchor_note(const stability::SupportResult& support, std::vector<std::string>& notes) {
  if (support.held_by_border.empty()) return;
  const std::size_t count = support.held_by_border.size();
  notes.push_back(fmt::format(
      "bolts go through {} {} that only a side of the domain holds ({}{}): they count as rock that stays, so that what "
      "is bolted to them alone may move with them; enlarge the domain",
      count, count == 1 ? "block" : "blocks", support.held_by_border.front().value(), count > 1 ? ", ..." : ""));
}

/// Groups below the target where no support asks for them.
void add_below_target_note(const Realization& made, const StabilitySettings& settings,
                           std::vector<std::string>& notes) {
  if (!made.groups_below_target || !made.key_groups) return;
  KeyGroupFigures figures;
  add_below_target(*made.groups_below_target, figures);
  if (*figures.below_target <= count_key_groups(*made.key_groups).count) return;
  notes.push_back(fmt::format(
      "{} {} of blocks ({:.4g} m3) would move at strengths over the target of {:g} for sliding, {} "
      "at strengths as they are",
      *figures.below_target, *figures.below_target == 1 ? "group" : "groups", figures.below_target_volume.si(),
      settings.target->sliding, count_key_groups(*made.key_groups).count));
}

void add_group_factor_note(const std::optional<stability::FactorTogether>& found, std::vector<std::string>& notes) {
  if (!found) {
    notes.emplace_back("group_factor: too many blocks near free faces to be judged together");
    return;
  }
  const std::string stands = found->stands > 0 ? fmt::format("strengths over {:.3g} all stands", found->stands)
                                               : "at no strengths up to tenfold is all clear of doubt";
  const std::size_t count = found->blocks.size();
  const std::string over = found->moves > 0 ? fmt::format("over {:.3g}", found->moves) : "even tenfold";
  const std::string moves =
      count == 0 ? "nothing moves at strengths over 10"
                 : fmt::format("{} {} {}, block {}{}", over, count, count == 1 ? "block moves" : "blocks move",
                               found->blocks.front().value(), count > 1 ? ", ..." : "");
  notes.push_back("all blocks near free faces together, of the base case when all is excavated, without support: " +
                  stands + ", " + moves + (found->without_moments ? "; in translation only: there are too many" : ""));
}

/// Groups at strengths over a target, where less was looked at than at strengths as they are.
void add_target_notes(const Realization& made, std::vector<std::string>& notes) {
  if (made.groups_below_target) {
    add_unasked_notes(*made.groups_below_target, "at strengths over the target: ", notes);
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

/// What removes rock never lies outside by 100 %.
std::string percent_outside(double share) {
  return share > 0.9995 && share < 1 ? fmt::format("all but {:.2g} %", 100 * (1 - share))
                                     : fmt::format("{:.3g} %", 100 * share);
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

void add_excavation_notes(const std::vector<ExcavationInfo>& excavations, std::vector<std::string>& notes) {
  const auto lies_outside = [](const ExcavationInfo& info) { return info.outside_share.value_or(0) > 0; };
  const auto outside = std::ranges::count_if(excavations, lies_outside);
  if (outside == 1) {
    const auto info = std::ranges::find_if(excavations, lies_outside);
    notes.push_back(fmt::format("{}: {} of it lies outside the domain; it removes {:.6g} m3 of rock", info->name,
                                percent_outside(*info->outside_share), info->taken.removed.si()));
  } else if (outside > 1) {
    const auto share = [](const ExcavationInfo& info) { return info.outside_share.value_or(0); };
    const auto most = std::ranges::max_element(excavations, {}, share);
    double removed = 0;
    for (const ExcavationInfo& info : excavations) removed += lies_outside(info) ? info.taken.removed.si() : 0;
    notes.push_back(
        fmt::format("{} openings lie partly outside the domain, up to {} of one ({}); they remove {:.6g} m3 of "
                    "rock: the list of excavations has the share of each",
                    outside, percent_outside(*most->outside_share), most->name, removed));
  }
  for (const ExcavationInfo& info : excavations) {
    if (info.taken.inside.si() > 0 && !(info.taken.removed.si() > 0)) {
      notes.push_back(fmt::format("{}: removes no rock that the openings before it have left", info.name));
    }
  }
}

std::vector<std::string> notes_of(const Scene& scene, const Realization& made) {
  const std::optional<stability::Analysis>& analysis = made.analysis;
  const std::optional<FieldStressResult>& clamped = made.field_stress;
  std::vector<std::string> notes;
  for (const Problem& note : scene.notes) notes.push_back(describe(note));
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
  for (const CaseSupport& load : made.support_cases) {
    if (!load.support.passes()) {
      notes.push_back(
          fmt::format("load case {}: the support does not reach the required factors of safety: see support_blocks.csv",
                      load.name));
    }
  }
  if (analysis) add_cohesion_note(*analysis, notes);
  if (analysis) add_rotation_note(*analysis, notes);
  add_enclosed_notes(made.held_from_within, notes);
  add_barred_note(made.barred, made.key_groups && made.key_groups->too_many, notes);
  if (made.domain_held) add_border_note(*made.domain_held, "", notes);
  for (const CaseResult& load : made.load_cases) {
    const bool more = load.domain_held && (!made.domain_held || load.domain_held->blocks != made.domain_held->blocks);
    if (more) add_border_note(*load.domain_held, fmt::format("load case {}: ", load.name), notes);
  }
  if (made.support) add_anchor_note(*made.support, notes);
  if (made.support && scene.stability->groups == stability::GroupsCheck::off) {
    notes.emplace_back(
        "support: with groups = \"off\" it was not asked whether it holds blocks that move together, nor whether a "
        "bolt "
        "carries all blocks it goes through at once");
  }
  if (scene.stability) add_below_target_note(made, *scene.stability, notes);
  if (scene.stability && scene.stability->group_factor && analysis) add_group_factor_note(made.group_factor, notes);
  add_target_notes(made, notes);
  if (made.sequence && analysis) add_stage_note(*made.sequence, *analysis, notes);
  if (made.window && made.window->truncated > 0 && analysis && analysis->rotation == stability::RotationCheck::flag) {
    notes.push_back("blocks that go on outside the box that was cut are not asked whether they turn");
  }
  if (clamped && !clamped->reached) {
    notes.push_back(fmt::format("field stress: displacements of the section still change by {:.1e} (asked: {:.1e})",
                                clamped->error, scene.field_stress->tolerance));
  }
  if (clamped && clamped->held > 0) {
    notes.push_back(fmt::format("field stress: {} unstable {} held by the stress across {} joints; without it {}",
                                clamped->held, clamped->held == 1 ? "block is" : "blocks are",
                                clamped->held == 1 ? "its" : "their", clamped->held == 1 ? "it falls" : "they fall"));
  }
  if (clamped && clamped->undecided > 0) {
    notes.push_back(fmt::format(
        "field stress: {} nearer than two widths to another opening, a heading or the ground: the section of the "
        "tunnel says nothing of the stress there, and no factor with it is given",
        clamped->undecided == 1 ? "1 block that would move is"
                                : fmt::format("{} blocks that would move are", clamped->undecided)));
  }
  for (const CaseResult& load : made.load_cases) {
    std::size_t leaving = 0, base = 0;
    for (const stability::Batch& batch : load.analysis.batches) leaving += batch.blocks.size();
    for (const stability::Batch& batch : analysis->batches) base += batch.blocks.size();
    if (leaving != base) {
      notes.push_back(fmt::format("load case {}: {} key blocks, {} in the base case", load.name, leaving, base));
    }
  }
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
