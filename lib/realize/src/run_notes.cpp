#include "run_notes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "crumbs.hpp"
#include "cut_notes.hpp"
#include "group_notes.hpp"
#include "holds_at_border.hpp"
#include "judge.hpp"

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
                                  ? "; counted as key blocks, with factors and net forces that are those of "
                                    "translation: above 1, and below 0"
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

/// Of the support of a stage, or of one under a load. `where`: before the note.
void add_stage_groups_notes(const std::optional<SupportedGroupFigures>& groups, bool too_many, const std::string& where,
                            std::vector<std::string>& notes) {
  if (too_many) notes.push_back(too_many_with_support(where));
  if (!groups || groups->all_held()) return;
  notes.push_back(
      fmt::format("{}the support installed by then does not hold {} of {} {} of blocks below the target ({:.4g} m3), "
                  "{} in doubt: see sequence in summary.json",
                  where, groups->not_held, groups->count, groups->count == 1 ? "group" : "groups",
                  groups->not_held_volume.si(), groups->in_doubt));
}

void add_stage_support_notes(const SequenceResult& sequence, std::vector<std::string>& notes) {
  for (const StageResult& row : sequence.stages) {
    if (!row.support) continue;
    const std::string after = fmt::format("after stage {}", row.stage);
    add_stage_groups_notes(row.support->groups, row.support->too_many, after + ": ", notes);
    for (const StageCase& under : row.cases) {
      add_stage_groups_notes(under.supported_groups, under.too_many,
                             fmt::format("{}, load case {}: ", after, under.name), notes);
      if (under.not_held.value_or(0) == 0 && under.combined_failing.value_or(0) == 0) continue;
      notes.push_back(
          fmt::format("after stage {}, load case {}: the support installed by then leaves {} {} and {} stitched bodies "
                      "below the required factors of safety",
                      row.stage, under.name, *under.not_held, *under.not_held == 1 ? "block" : "blocks",
                      under.combined_failing.value_or(0)));
    }
    if (row.support->spot_bolts > 0 && &row != &sequence.stages.back()) {
      notes.push_back(fmt::format(
          "after stage {} {} put in for what stands then: see after_stage in bolts.csv", row.stage,
          row.support->spot_bolts == 1 ? "1 spot bolt is" : fmt::format("{} spot bolts are", row.support->spot_bolts)));
    }
    if (row.support->not_held == 0 && row.support->combined_failing == 0) continue;
    notes.push_back(
        fmt::format("after stage {} the support installed by then leaves {} of {} blocks and {} stitched bodies below "
                    "the required factors of safety: see sequence in summary.json",
                    row.stage, row.support->not_held, row.support->blocks, row.support->combined_failing));
  }
}

/// Blocks that move, ascending.
std::vector<topology::BlockId> moving(const stability::Analysis& analysis) {
  std::vector<topology::BlockId> out;
  for (const stability::Batch& batch : analysis.batches)
    out.insert(out.end(), batch.blocks.begin(), batch.blocks.end());
  std::ranges::sort(out);
  return out;
}

/// What moves under a load in a stage before the last, and not without it.
void add_stage_case_notes(const SequenceResult& sequence, std::vector<std::string>& notes) {
  for (const StageResult& row : sequence.stages) {
    if (&row == &sequence.stages.back()) break;
    if (row.cases.empty()) continue;
    const std::vector<topology::BlockId> without = moving(*row.analysis);
    for (const StageCase& under : row.cases) {
      std::size_t more = 0;
      Volume volume;
      for (const topology::BlockId block : moving(under.analysis)) {
        if (std::ranges::binary_search(without, block)) continue;
        ++more;
        volume += (*row.complex)->complex().blocks()[block].volume;
      }
      if (more == 0) continue;
      notes.push_back(fmt::format("after stage {}, load case {}: {} ({:.4g} m3) that would not without the load",
                                  row.stage, under.name,
                                  more == 1 ? "1 block moves" : fmt::format("{} blocks move", more), volume.si()));
    }
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

/// Key blocks that water lifts out of free faces below its level: what drains the face may drain the joint, too.
void add_lifted_note(const stability::Analysis& analysis, const LoadSet& loads, const topology::BlockComplex& complex,
                     std::string_view where, std::vector<std::string>& notes) {
  if (loads.dry()) return;
  std::size_t count = 0;
  Volume volume;
  for (const stability::Judgement& j : analysis.judgements) {
    if (!j.key || j.mode != stability::Mode::lifting) continue;
    ++count;
    volume += complex.blocks()[j.block].volume;
  }
  if (count == 0) return;
  notes.push_back(
      note_on_lifted(where, fmt::format("{} key {} ({:.4g} m3)", count, count == 1 ? "block" : "blocks", volume.si())));
}

void add_lifted_notes(const Scene& scene, const Realization& made, std::vector<std::string>& notes) {
  const topology::BlockComplex& complex = made.complex->complex();
  add_lifted_note(*made.analysis, scene.stability->loads, complex, "", notes);
  for (std::size_t k = 0; k < made.load_cases.size(); ++k) {
    const CaseResult& load = made.load_cases[k];
    add_lifted_note(load.analysis, scene.stability->cases[k].loads, complex, fmt::format("load case {}: ", load.name),
                    notes);
  }
}

/// What key blocks of all batches lack, one by one; what turns may lack nothing along its way.
Force net_force_of(const stability::Analysis& analysis) {
  Force sum{};
  for (const stability::Judgement& j : analysis.judgements) {
    if (j.key && j.net > Force{}) sum += j.net;
  }
  return sum;
}

/// Whether the same blocks move together, or are in doubt, at the same factor.
bool same_groups(const std::optional<stability::KeyGroups>& a, const std::optional<stability::KeyGroups>& b) {
  if (!a || !b) return true;
  return std::ranges::equal(a->groups, b->groups, [](const stability::KeyGroup& x, const stability::KeyGroup& y) {
    return x.blocks == y.blocks && x.verdict == y.verdict && x.factor_move == y.factor_move;
  });
}

/// Cases that change nothing, and earthquakes that push the rock where it is held: what a wrong sign, or a depth in
/// place of a level, looks like.
void add_case_notes(const Scene& scene, const Realization& made, std::vector<std::string>& notes) {
  const stability::Analysis& base = *made.analysis;
  const LoadSet& loads = scene.stability->loads;
  const auto same = [](const stability::Judgement& a, const stability::Judgement& b) {
    return a.block == b.block && a.factor_of_safety == b.factor_of_safety && a.driving.si() == b.driving.si();
  };
  for (std::size_t k = 0; k < made.load_cases.size(); ++k) {
    const CaseResult& load = made.load_cases[k];
    const LoadCase& stated = scene.stability->cases[k];
    const LoadSet& own = stated.loads;
    if (!base.judgements.empty() && std::ranges::equal(load.analysis.judgements, base.judgements, same) &&
        same_groups(load.groups, made.key_groups)) {
      const auto& water = own.actions.spec().water;
      const bool wet = water && (!loads.actions.spec().water || loads.actions.spec().water->level != water->level);
      if (stated.target && !wet) continue;  // it may be there for its targets
      notes.push_back(fmt::format(
          "load case {} changes the factor of safety of no block{}", load.name,
          wet ? fmt::format(": its water (table = {:g}) reaches no joint of theirs; the table is a level in the "
                            "coordinates of the scene, not a depth",
                            water->level)
              : ""));
      continue;
    }
    if (own.body.seismic() == loads.body.seismic()) continue;
    const double before = count_key_blocks(base).lowest_factor_of_safety;
    const double after = count_key_blocks(load.analysis).lowest_factor_of_safety;
    constexpr std::string_view sign = "`seismic` is the direction in which the rock is pushed; check its sign";
    if (after > before) {
      notes.push_back(
          fmt::format("load case {}: with its earthquake the lowest factor of safety is {:.4g}, more than {:.4g} in "
                      "the base case: {}",
                      load.name, after, before, sign));
    } else if (const Force needed = net_force_of(load.analysis), less = net_force_of(base); needed < less) {
      notes.push_back(fmt::format(
          "load case {}: with its earthquake all that moves lacks {:.4g} kN, less than {:.4g} kN in the base case: {}",
          load.name, needed.si() / 1000, less.si() / 1000, sign));
    }
  }
}

void add_border_notes(const Realization& made, std::vector<std::string>& notes) {
  if (made.domain_held) add_border_note(*made.domain_held, "", notes);
  for (const CaseResult& load : made.load_cases) {
    const bool more = load.domain_held && (!made.domain_held || load.domain_held->blocks != made.domain_held->blocks);
    if (more) add_border_note(*load.domain_held, fmt::format("load case {}: ", load.name), notes);
  }
}

/// Earthquakes and surcharges of the base case that a wrong sign turns into what holds the rock.
void add_sign_notes(const Scene& scene, const Realization& made, std::vector<std::string>& notes) {
  if (made.window) return;
  const topology::AuditedComplex& complex = *made.complex;
  const LoadSet& loads = scene.stability->loads;
  if (loads.body.seismic() != geometry::Vec3{}) {
    stability::Settings calm = settings_on(complex.complex(), scene, made, loads);
    calm.loads = calm.loads.with_seismic_times(0);
    calm.rotation = stability::RotationCheck::off;
    const double before = count_key_blocks(stability::analyse(complex, calm)).lowest_factor_of_safety;
    const double after = count_key_blocks(*made.analysis).lowest_factor_of_safety;
    if (after > before * (1 + 1e-9)) {
      notes.push_back(
          fmt::format("with the earthquake of [stability] the lowest factor of safety is {:.4g}, more than {:.4g} "
                      "without it: `seismic` is the direction in which the rock is pushed; check its sign",
                      after, before));
    }
  }
  const auto pulling = [&](const LoadSet& own) {
    std::vector<std::pair<std::size_t, std::string>> found;  // where it does first
    const auto add = [&](const topology::BlockComplex& state, const std::string& when) {
      for (const std::size_t i : stability::pulling_surcharges(state, own.actions)) {
        if (std::ranges::find(found, i, [](const auto& f) { return f.first; }) == found.end())
          found.emplace_back(i, when);
      }
    };
    add(complex.complex(), "");
    if (!made.sequence) return found;
    for (const StageResult& row : made.sequence->stages) {
      if (row.complex && *row.complex) add((*row.complex)->complex(), fmt::format("after stage {}: ", row.stage));
    }
    return found;
  };
  const auto look = [&](const LoadSet& own, std::size_t known, const std::string& where) {
    for (const auto& [i, when] : pulling(own)) {
      // What a case takes over from the base case comes first in its lists and was said there.
      if (i < known) continue;
      notes.push_back(fmt::format(
          "{}{}surcharge[{}] pulls at the faces it acts on: `traction` is the force on the rock, z upward, and "
          "a weight on level ground has a negative z; check its sign",
          where, when, i + 1));
    }
  };
  look(loads, 0, "");
  for (const LoadCase& load : scene.stability->cases) {
    look(load.loads, loads.actions.spec().surcharges.size(), "load case " + load.name + ": ");
  }
}

/// Key blocks that only turn and that nothing was asked to hold. `where`: the load case, before the note.
void add_turning_note(const stability::SupportResult& support, const std::optional<stability::GroupSupport>& groups,
                      std::string_view where, std::vector<std::string>& notes) {
  std::size_t unasked = 0;
  for (const stability::OnlyTurns& turning : support.turning) {
    const bool asked = groups && !groups->below.without_moments && !groups->left.without_moments &&
                       std::ranges::any_of(groups->below.groups, [&](const stability::KeyGroup& group) {
                         return std::ranges::binary_search(group.blocks, turning.block);
                       });
    unasked += turning.held || asked ? 0U : 1U;
  }
  if (unasked == 0) return;
  const bool one = unasked == 1;
  notes.push_back(
      fmt::format("{}{} that only turn{} {} with the support in translation alone, in which {} at rest: whether it "
                  "holds {} is not known, and it does not pass; groups = \"decide\" judges moments too",
                  where, one ? "1 key block" : fmt::format("{} key blocks", unasked), one ? "s" : "",
                  one ? "was judged" : "were judged", one ? "it is" : "they are", one ? "it" : "them"));
}

/// Bolts that grip where nothing is known of the rock.
void add_outside_note(const stability::SupportResult& support, std::vector<std::string>& notes) {
  std::size_t count = 0;
  double outside = 0, most = 0;
  for (const stability::BoltResult& bolt : support.bolts) {
    if (!(bolt.outside > Length{})) continue;
    ++count;
    outside += bolt.outside.si();
    most = std::max(most, bolt.outside.si());
  }
  if (count == 0) return;
  notes.push_back(fmt::format(
      "{} of {} bolts {} the domain through a side that is not free: {:.3g} m of {}{} lie outside and grip as rock "
      "that goes on there would; where air or an opening is there instead, enlarge the domain; see outside_m in "
      "bolts.csv",
      count, support.bolts.size(), count == 1 ? "leaves" : "leave", outside, count == 1 ? "it" : "them",
      count == 1 ? "" : fmt::format(", up to {:.3g} m of one,", most)));
}

/// Bolts that are not in the rock at all.
void add_off_note(const stability::SupportResult& support, std::vector<std::string>& notes) {
  const auto off =
      std::ranges::count_if(support.bolts, [](const auto& b) { return b.status == stability::BoltStatus::off; });
  if (off == 0) return;
  notes.push_back(fmt::format(
      "{} of {} bolts {} off the rock: they point away from it, their heads stand where nothing is left or at the very "
      "end of the domain, or the axis of their tunnel goes on outside it; they hold nothing; see bolts.csv",
      off, support.bolts.size(), off == 1 ? "is" : "are"));
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

}  // namespace

std::string note_on_lifted(std::string_view where, std::string_view how_many) {
  return fmt::format(
      "{}water lifts {}: it presses in the joints behind them, not on their free faces; where the rock is drained, "
      "state a lower level of the water, or `pressures`; where the opening is flooded, free_faces = true",
      where, how_many);
}

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

namespace {
/// What stays in place by something that may not be counted on.
void add_held_notes(const Realization& made, std::vector<std::string>& notes) {
  add_enclosed_notes(made.held_from_within, notes);
  add_barred_note(made.barred, made.key_groups && made.key_groups->too_many, notes);
  add_crumb_notes(made.held_by_crumbs, {}, "", notes);
  add_taper_notes(made, notes);
  add_border_notes(made, notes);
}
}  // namespace

namespace {
/// What bolts and shotcrete hold on to, and what they were not asked to hold.
void add_support_notes(const Realization& made, std::vector<std::string>& notes) {
  if (!made.support) return;
  add_holds_at_border_notes(made, notes);
  add_turning_note(*made.support, made.group_support, "", notes);
  for (const CaseSupport& load : made.support_cases) {
    add_turning_note(load.support, load.groups, fmt::format("load case {}: ", load.name), notes);
  }
  add_outside_note(*made.support, notes);
  // Beyond what was cut on demand rock is not known.
  if (!made.window) add_off_note(*made.support, notes);
}
}  // namespace

std::vector<std::string> notes_of(const Scene& scene, const Realization& made) {
  const std::optional<stability::Analysis>& analysis = made.analysis;
  const std::optional<FieldStressResult>& clamped = made.field_stress;
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
  add_support_notes(made, notes);
  if (made.support && scene.stability->groups == stability::GroupsCheck::off) {
    notes.emplace_back(
        "support: with groups = \"off\" it was not asked whether it holds blocks that move together, nor whether a "
        "bolt "
        "carries all blocks it goes through at once");
  }
  if (made.groups_below_target && made.key_groups) {
    add_below_target_note(*made.groups_below_target, *made.key_groups, scene.stability->target->sliding, "", notes);
  }
  if (scene.stability && scene.stability->group_factor && analysis) add_group_factor_note(made.group_factor, notes);
  add_target_notes(made, notes);
  if (made.sequence && analysis) add_stage_note(*made.sequence, *analysis, notes);
  if (made.window && made.window->truncated > 0 && analysis && analysis->rotation == stability::RotationCheck::flag) {
    notes.push_back("blocks that go on outside the box that was cut are not asked whether they turn");
  }
  if (clamped && !clamped->reached) {
    notes.push_back(
        fmt::format("field stress: displacements of the section still change by {:.1e} (asked: {:.1e}) with its finest "
                    "elements: the stress is known no better than that; where it will do, state a tolerance above it",
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
