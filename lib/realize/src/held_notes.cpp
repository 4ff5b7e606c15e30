#include "held_notes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "cleave/core/text.hpp"
#include "group_notes.hpp"

namespace cleave::scene {
namespace {

using stability::Judgement;
using topology::BlockId;

constexpr double infinite = std::numeric_limits<double>::infinity();

const Judgement* judgement_of(const stability::Analysis& analysis, BlockId id) {
  const auto at = std::ranges::lower_bound(analysis.judgements, id, {}, &Judgement::block);
  return at != analysis.judgements.end() && at->block == id ? &*at : nullptr;
}

/// "1 block (477.6 m3)"
template <class Rows>
std::string counted_blocks(const Rows& rows) {
  double volume = 0;
  for (const auto& row : rows) volume += row.volume.si();
  return fmt::format("{} ({:.4g} m3)", counted(rows.size(), "block", "blocks"), volume);
}

/// "the least factor of safety is 1.2 (block 3)"; of what moves only together with others none is known.
template <class Rows>
std::string least_factor_words(const Rows& rows) {
  const auto least = std::ranges::min_element(rows, {}, [](const auto& row) { return row.factor_of_safety; });
  if (!std::isfinite(least->factor_of_safety)) return "they would move together, their factor was not asked";
  return fmt::format("the least factor of safety is {:.4g} (block {})", least->factor_of_safety, least->block.value());
}

/// Whether joints at open blocks, or at their neighbours, are parallel but for next to nothing.
bool close_by_little(const topology::BlockComplex& complex) {
  constexpr double rounding = 1e-8;  // so far such joints count as parallel anyway
  std::vector<topology::PlaneId> planes;
  const auto add = [&](const topology::Block& block) {
    for (const topology::FaceId face : block.faces) {
      if (complex.faces()[face].role == topology::Role::joint) planes.push_back(complex.faces()[face].plane);
    }
  };
  for (const topology::Block& block : complex.blocks()) {
    if (!block.free || block.fixed) continue;
    planes.clear();
    add(block);
    for (const topology::FaceId face : block.faces) {
      for (const topology::Patch& patch : complex.patches(complex.faces()[face])) {
        if (patch.neighbour && !complex.blocks()[*patch.neighbour].fixed) add(complex.blocks()[*patch.neighbour]);
      }
    }
    std::ranges::sort(planes);
    planes.erase(std::ranges::unique(planes).begin(), planes.end());
    for (std::size_t i = 0; i < planes.size(); ++i) {
      const auto a = complex.planes()[planes[i]].unit_normal();
      for (std::size_t k = i + 1; k < planes.size(); ++k) {
        const auto b = complex.planes()[planes[k]].unit_normal();
        const double sine = norm(cross(geometry::Vec3{a[0], a[1], a[2]}, geometry::Vec3{b[0], b[1], b[2]}));
        if (sine > rounding && sine < stability::slight_taper) return true;
      }
    }
  }
  return false;
}

}  // namespace

HeldNotes::Row HeldNotes::row_of(const JudgedState& state, BlockId block, double factor) {
  const topology::Block& own = state.complex->complex().blocks()[block];
  return {.block = block, .centroid = own.centroid, .volume = own.volume, .factor_of_safety = factor};
}

HeldNotes::Rows HeldNotes::rows_of(const JudgedState& state, const stability::DomainHeld& held, double factor) {
  Rows rows;
  for (const BlockId id : held.blocks) {
    const auto alone = std::ranges::find(held.alone, id, &stability::DomainHeld::Alone::block);
    rows.push_back(row_of(state, id, alone != held.alone.end() ? factor * alone->factor_of_safety : infinite));
  }
  return rows;
}

HeldNotes::Rows HeldNotes::rows_of(const JudgedState& state, const std::vector<stability::Barred>& barred,
                                   double factor) {
  Rows rows;
  for (const stability::Barred& row : in_no_group(barred, *state.groups)) {
    rows.push_back(row_of(state, row.block, factor * row.factor_of_safety));
  }
  return rows;
}

/// Blocks of groups that move between parallel joints, and not between joints that close on them by next to nothing.
HeldNotes::Rows HeldNotes::wedged_together(const JudgedState& state, const stability::Settings& with,
                                           double factor) const {
  const std::optional<stability::KeyGroups>& groups = *state.groups;
  Rows rows;
  if (!groups || groups->too_many || !close_by_little(state.complex->complex())) return rows;
  std::vector<BlockId> known;
  const auto add = [](const stability::KeyGroups& from, std::vector<BlockId>& to) {
    for (const stability::KeyGroup& group : from.groups) to.insert(to.end(), group.blocks.begin(), group.blocks.end());
  };
  add(factor > 1 ? stability::find_key_groups(*state.complex, with, most_) : *groups, known);
  for (const stability::Batch& batch : state.analysis->batches) {
    known.insert(known.end(), batch.blocks.begin(), batch.blocks.end());
  }
  for (const stability::Barred& row : stability::held_by_taper(*state.complex, with, *state.analysis)) {
    known.push_back(row.block);
  }
  std::ranges::sort(known);
  stability::Settings parallel = with;
  parallel.taper_ignored = stability::slight_taper;
  for (const stability::KeyGroup& group : stability::find_key_groups(*state.complex, parallel, most_).groups) {
    // Single blocks were asked by themselves.
    if (group.verdict == assembly::Verdict::in_doubt || group.blocks.size() < 2) continue;
    for (const BlockId id : group.blocks) {
      if (std::ranges::binary_search(known, id)) continue;
      rows.push_back(row_of(state, id, group.factors ? factor * group.least_factor() : infinite));
    }
  }
  return rows;
}

/// `with`: strengths over `factor`.
HeldNotes::Rows HeldNotes::kept_by(Reason reason, const JudgedState& state, const stability::Settings& with,
                                   double factor) const {
  const topology::AuditedComplex& complex = *state.complex;
  const stability::Analysis& analysis = *state.analysis;
  Rows rows;
  switch (reason) {
    case Reason::border: {
      rows = rows_of(state,
                     state.border_at_target != nullptr ? *state.border_at_target
                                                       : held_by_border(complex, with, analysis, state.groups),
                     factor);
      break;
    }
    case Reason::taper: rows = rows_of(state, stability::held_by_taper(complex, with, analysis), factor); break;
    case Reason::taper_together: rows = wedged_together(state, with, factor); break;
    case Reason::within:
      for (const auto& row : stability::held_from_within(complex, with, analysis)) {
        rows.push_back(row_of(state, row.block, factor * row.factor_of_safety));
      }
      break;
    case Reason::lesser:
      if (*state.groups && !(*state.groups)->too_many) break;  // they were judged together
      rows = rows_of(state, stability::barred_by_lesser(complex, with, analysis), factor);
      break;
    case Reason::turns:
    case Reason::own: break;
  }
  // What misses the target in its own right is no matter of these.
  std::erase_if(rows, [&](const Row& row) {
    const Judgement* own = judgement_of(analysis, row.block);
    return own != nullptr && stability::moves(own->mode) && own->factor_of_safety < factor;
  });
  return rows;
}

/// Though they cannot slide; those of groups are told of with these.
HeldNotes::Rows HeldNotes::turning(const JudgedState& state) {
  Rows rows;
  if (state.analysis->rotation != stability::RotationCheck::flag) return rows;
  for (const Judgement& j : state.analysis->judgements) {
    if (j.rotation && j.rotation->turns) rows.push_back(row_of(state, j.block, infinite));
  }
  if (state.place == JudgedState::Place::base || !*state.groups) return rows;
  for (const stability::KeyGroup& group : (*state.groups)->groups) {
    std::erase_if(rows, [&](const Row& row) { return std::ranges::binary_search(group.blocks, row.block); });
  }
  return rows;
}

HeldNotes::Rows HeldNotes::fresh(Reason reason, bool at_target, Rows rows) {
  std::erase_if(rows, [&](const Row& own) {
    return std::ranges::any_of(known_, [&](const Known& k) {
      return k.reason == reason && (at_target || !k.at_target) && same_block(own, k.row);
    });
  });
  for (const Row& row : rows) known_.push_back({reason, at_target, row});
  return rows;
}

/// Where the notes of the run tell of it.
bool HeldNotes::told(Reason reason, JudgedState::Place place) {
  using enum JudgedState::Place;
  if (reason == Reason::taper_together) return false;
  if (place == base) return true;
  return (reason == Reason::taper && place != stage_under_load) || (reason == Reason::border && place == load);
}

std::string HeldNotes::words(Reason reason, const Rows& rows, const JudgedState& state) {
  const bool one = rows.size() == 1;
  const std::string blocks = counted_blocks(rows), least = least_factor_words(rows);
  const std::string_view stay = one ? "stays" : "stay";
  switch (reason) {
    case Reason::border:
      return fmt::format(
          "{} at free faces {} held only by sides of the domain that are not free and {} not counted as key blocks: "
          "without those {}; enlarge the domain, or name these sides in `free`",
          blocks, one ? "is" : "are", one ? "is" : "are", least);
    case Reason::taper:
      return fmt::format(
          "{} at free faces {} only because joints close on {} by less than {:g} mm a metre: were those parallel, {}; "
          "count on no such taper",
          blocks, stay, one ? "it" : "them", 1e3 * stability::slight_taper, least);
    case Reason::taper_together:
      return fmt::format(
          "{} at free faces {} only because joints close on {} by less than {:g} mm a metre: between parallel ones "
          "{} would move together, {}; count on no such taper",
          blocks, stay, one ? "it" : "them", 1e3 * stability::slight_taper, one ? "it" : "they", least);
    case Reason::within:
      return fmt::format("{} {} only because of what lies wholly inside: as one body with that {}", blocks, stay,
                         least);
    case Reason::lesser:
      return fmt::format(
          "{} at free faces {} only because of neighbours that are smaller or removable: without those {}; whether "
          "they are pushed out was not asked: {}",
          blocks, stay, least,
          *state.groups ? "too many blocks are near free faces to be judged together" : "see `groups`");
    case Reason::turns:
      return fmt::format(
          "{} would turn or topple though {} cannot slide (block {}{}); counted as key blocks only with rotation = "
          "\"decide\"",
          blocks, one ? "it" : "they", rows.front().block.value(), one ? "" : ", ...");
    case Reason::own: break;
  }
  std::unreachable();
}

void HeldNotes::as_it_is(const JudgedState& state) {
  using enum Reason;
  for (const Reason reason : {border, taper, taper_together, within, lesser, turns}) {
    Rows rows = reason == turns                             ? turning(state)
                : reason == border && state.held != nullptr ? rows_of(state, *state.held, 1)
                                                            : kept_by(reason, state, state.settings, 1);
    if (state.target && reason != lesser && reason != turns) count_not_asked(rows);
    rows = fresh(reason, false, std::move(rows));
    if (rows.empty() || told(reason, state.place)) continue;
    notes_->push_back(state.where + words(reason, rows, state));
  }
}

/// What reaches it only by what may not be there.
void HeldNotes::at_target(const JudgedState& state) {
  const double target = state.target->sliding;
  if (!(target > 1)) return;
  const stability::Settings with = with_strengths_over(state.settings, target);
  const auto tell = [&](Reason reason, std::string_view what) {
    Rows rows = kept_by(reason, state, with, target);
    if (reason != Reason::lesser) count_not_asked(rows);
    rows = fresh(reason, true, std::move(rows));
    if (rows.empty()) return;
    notes_->push_back(
        fmt::format("{}{} at free faces {} the target of {:g} for sliding only because of {}: without "
                    "{} {}{}",
                    state.where, counted_blocks(rows), rows.size() == 1 ? "reaches" : "reach", target, what,
                    reason != Reason::border && reason != Reason::lesser ? "that" : "those", least_factor_words(rows),
                    scene_->support ? "; the support is not asked to hold such" : ""));
  };
  tell(Reason::border, "sides of the domain that are not free");
  tell(Reason::taper, fmt::format("a taper of its joints by less than {:g} mm a metre", 1e3 * stability::slight_taper));
  tell(Reason::taper_together,
       fmt::format("a taper of joints by less than {:g} mm a metre, on which they close together",
                   1e3 * stability::slight_taper));
  tell(Reason::within, "what lies wholly inside");
  tell(Reason::lesser, "neighbours that are smaller or removable");
}

/// Where no support asks for it.
void HeldNotes::below_target(const JudgedState& state) {
  const std::optional<stability::KeyGroups>& groups = *state.groups;
  if (groups && !groups->too_many) {
    if (state.below_target != nullptr && *state.below_target) {
      add_below_target_note(**state.below_target, *groups, state.target->sliding, state.where, *notes_);
    }
    return;
  }
  Rows rows;
  for (const Judgement& j : state.analysis->judgements) {
    if (j.key || !below(j, *state.target)) continue;
    rows.push_back(row_of(state, j.block, j.factor_of_safety));
  }
  rows = fresh(Reason::own, false, std::move(rows));
  if (rows.empty()) return;
  notes_->push_back(fmt::format("{}{} that {} not move {} below the target (falling {:g}, sliding {:g}): {}",
                                state.where, counted_blocks(rows), rows.size() == 1 ? "does" : "do",
                                rows.size() == 1 ? "is" : "are", state.target->falling, state.target->sliding,
                                least_factor_words(rows)));
}

void HeldNotes::count_not_asked(const Rows& rows) {
  for (const Row& row : rows) {
    const auto known = std::ranges::find_if(not_asked_, [&](const Row& other) { return same_block(row, other); });
    if (known == not_asked_.end()) {
      not_asked_.push_back(row);
    } else {
      known->factor_of_safety = std::min(known->factor_of_safety, row.factor_of_safety);
    }
  }
}

NotAsked HeldNotes::not_asked() const {
  NotAsked out{.count = not_asked_.size()};
  for (const Row& row : not_asked_) {
    out.volume += row.volume;
    out.lowest_factor_of_safety = std::min(out.lowest_factor_of_safety, row.factor_of_safety);
  }
  return out;
}

void HeldNotes::look(const JudgedState& state) {
  as_it_is(state);
  if (!state.target) return;
  at_target(state);
  if (!scene_->support) below_target(state);
}

std::optional<Targets> targets_under(const Scene& scene, const LoadCase* load) {
  if (load != nullptr && load->target) return load->target;
  if (scene.stability->target) return scene.stability->target;
  if (!scene.support) return std::nullopt;
  return Targets{.falling = scene.support->plan.target_falling, .sliding = scene.support->plan.target_sliding};
}

stability::DomainHeld held_by_border(const topology::AuditedComplex& complex, const stability::Settings& settings,
                                     const stability::Analysis& analysis,
                                     const std::optional<stability::KeyGroups>* groups) {
  stability::DomainHeld held = stability::domain_held(complex, settings, analysis);
  if (groups != nullptr && *groups && !(*groups)->too_many) {
    (void)stability::add_held_together(complex, settings, analysis, **groups, held);
  }
  return held;
}

HeldAtTarget held_at_target(const topology::AuditedComplex& complex, const stability::Settings& with,
                            const stability::Analysis& analysis, const std::optional<stability::KeyGroups>* groups,
                            const stability::DomainHeld& border, double target) {
  HeldAtTarget out{.border = {border.blocks.size(), border.volume}, .tapered = {}};
  auto tapered = stability::held_by_taper(complex, with, analysis);
  if (groups != nullptr) tapered = in_no_group(std::move(tapered), *groups);
  for (const stability::Barred& row : tapered) {
    const Judgement* own = judgement_of(analysis, row.block);
    if (own != nullptr && stability::moves(own->mode) && own->factor_of_safety < target) continue;
    ++out.tapered.count;
    out.tapered.volume += row.volume;
  }
  return out;
}

}  // namespace cleave::scene
