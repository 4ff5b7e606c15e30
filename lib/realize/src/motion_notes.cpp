#include "motion_notes.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "motion_loads.hpp"

namespace cleave::scene {
namespace {

using topology::BlockId;

bool holds_when_opened(const Realization& made) {
  return std::ranges::any_of(made.joints, [](const auto& joint) {
    return joint.strength.cohesion().si() > 0 || joint.strength.tension().si() > 0;
  });
}

/// The first three, and how many more.
std::string listed(std::vector<std::string> named) {
  constexpr std::size_t most = 3;
  const std::size_t more = named.size() - std::min(most, named.size());
  named.resize(named.size() - more);
  return fmt::format("{}{}", fmt::join(named, ", "), more > 0 ? fmt::format(" and {} more", more) : "");
}

/// "block 3 at block 7": standing blocks that other rock bars at an edge or a corner, where the verdict knows nothing
/// that bars.
std::string barred_at_tips(const std::vector<StandingBlock>& standing, const MotionResult& result) {
  std::vector<std::string> named;
  for (const auto& [own, rock] : result.at_tips) {
    if (!std::ranges::binary_search(standing, own, {}, &StandingBlock::block)) continue;
    named.push_back(fmt::format("block {} at block {}", own.value(), rock.value()));
  }
  if (named.empty()) return {};
  return fmt::format(
      "; rock beside their way bars them at an edge or a corner alone ({}), which is sharp and does not break here, "
      "and "
      "would be crushed",
      listed(std::move(named)));
}

/// What else than locked forces may let blocks stand against their verdict, each with "; " before it.
std::string other_reasons(const Scene& scene, const Realization& made, const MotionResult& result) {
  std::string why;
  if (holds_when_opened(made)) why += "; cohesion and tension of faces that open act until they part";
  if (const std::string out = left_out_of(scene.stability->loads, *scene.motion); !out.empty()) {
    why += "; loads of the verdict that motion leaves out: " + out;
  }
  if (result.loads && result.loads->drained > 0) why += "; water that has drained holds them no more";
  if (reduces_strength(*scene.stability)) why += "; partial factors of the verdict, which motion leaves out";
  if (!result.bolts.empty()) why += "; bolts hold what they lean on";
  return why;
}

/// Which blocks stand against their verdict, and why they can.
void add_standing_note(const Scene& scene, const Realization& made, const std::vector<StandingBlock>& standing,
                       MotionResult& result) {
  if (standing.empty() || !result.converged) return;
  std::vector<std::string> named;
  for (const auto& [block, factor] : standing) {
    named.push_back(fmt::format("block {} (factor of safety {:.4g})", block.value(), factor));
  }
  const auto locked = std::ranges::count_if(result.blocks, [&](const MotionBlock& b) {
    return b.locked && std::ranges::binary_search(standing, b.block, {}, &StandingBlock::block);
  });
  std::string why = locked > 0 ? fmt::format("; forces locked between blocks may hold {} of them", locked) : "";
  why += barred_at_tips(standing, result) + other_reasons(scene, made, result);
  if (!result.at_rest) why += "; or they are slow, and the run is short";
  result.notes.push_back(
      fmt::format("motion: {} key {}, alone or in groups, did not move by a millimetre: {}. The verdict stays, motion "
                  "is no proof{}",
                  standing.size(), standing.size() == 1 ? "block" : "blocks", listed(std::move(named)),
                  why.empty() ? why : why.replace(0, 1, ":")));
}

/// What stands at the end by locked forces, or may: found by the search for other answers, or by the verdict.
void add_locked_note(MotionResult& result) {
  if (result.may_be_locked == 0) return;
  std::vector<std::string> named;
  for (const MotionBlock& block : result.blocks) {
    if (block.locked) named.push_back(fmt::format("block {}", block.block.value()));
  }
  result.notes.push_back(fmt::format(
      "motion: up to {} blocks at a time were in groups that forces locked between them may hold; an answer that moves "
      "was looked for and goes first, but not every one may have been found{}",
      result.may_be_locked,
      named.empty() ? ""
                    : fmt::format(". At the end {} so, and {} not shown to be safe: {}",
                                  named.size() == 1 ? "one stands" : fmt::format("{} stand", named.size()),
                                  named.size() == 1 ? "is" : "are", listed(named))));
}

void add_rest_notes(const Scene& scene, MotionResult& result) {
  if (result.at_rest || !result.converged || result.blocks.empty()) return;
  const MotionSettings& motion = *scene.motion;
  const bool ground_moves = motion.ground && result.end < motion.ground->end();
  const bool for_ever = ground_moves && !std::isfinite(motion.ground->end().si());
  const std::string remedy = for_ever       ? "the ground moves for ever"
                             : ground_moves ? fmt::format("the ground moves until {:g} s; set a longer motion.duration",
                                                          motion.ground->end().si())
                                            : "set a longer motion.duration";
  if (motion.to_rest) {
    result.notes.push_back(fmt::format("motion: not at rest after {:g} s; ", result.end.si()) + remedy);
  } else if (result.moved() == 0) {
    result.notes.push_back(
        fmt::format("motion: in {:g} s no block moved by a millimetre, but they are not at rest: ", result.end.si()) +
        remedy);
  }
}

}  // namespace

bool reduces_strength(const StabilitySettings& settings) {
  return settings.partial.friction() != 1 || settings.partial.cohesion() != 1 || settings.partial.weight() != 1;
}

std::vector<StandingBlock> standing_blocks(const Realization& made, const MotionResult& result) {
  std::map<BlockId, double> factor;
  const auto add = [&](BlockId block, double own) {
    const auto [at, fresh] = factor.try_emplace(block, own);
    if (!fresh) at->second = std::min(at->second, own);
  };
  if (made.analysis) {
    for (const stability::Judgement& own : made.analysis->judgements) {
      if (own.key) add(own.block, own.factor_of_safety);
    }
  }
  if (made.key_groups) {
    for (const stability::KeyGroup& group : made.key_groups->groups) {
      if (group.verdict != assembly::Verdict::certain && group.verdict != assembly::Verdict::unsafe) continue;
      for (const BlockId block : group.blocks) add(block, group.least_factor());
    }
  }
  std::vector<StandingBlock> out;
  for (const MotionBlock& block : result.blocks) {
    const auto at = factor.find(block.block);
    if (at != factor.end() && !block.moved && !block.left && block.bolts == 0) out.push_back({at->first, at->second});
  }
  std::ranges::sort(out, {}, &StandingBlock::block);
  return out;
}

void mark_locked(const Scene& scene, const Realization& made, MotionResult& result) {
  const std::vector<StandingBlock> standing = standing_blocks(made, result);
  result.key_blocks_standing = standing.size();
  // m/s: what begins to move is faster before it has come far enough to be seen.
  constexpr double still = 1e-4;
  const bool otherwise = !result.converged || !other_reasons(scene, made, result).empty();
  for (MotionBlock& block : result.blocks) {
    if (otherwise || !(result.at_rest || block.fastest < still)) continue;
    if (!std::ranges::binary_search(standing, block.block, {}, &StandingBlock::block)) continue;
    if (std::ranges::find(result.at_tips, block.block, &MotionTip::block) != result.at_tips.end()) continue;
    block.locked = true;
  }
  result.may_be_locked = std::max(result.may_be_locked, result.locked());
}

void add_motion_notes(const Scene& scene, const Realization& made, double accepted, MotionResult& result) {
  std::vector<std::string>& notes = result.notes;
  if (result.blocks.empty()) notes.emplace_back("motion: no block is let go");
  if (!result.converged) notes.push_back("motion: " + result.stopped_why + "; the state reached is in the result");
  if (const std::uint64_t left = result.left(); left > 0) {
    notes.push_back(fmt::format("motion: {} {} left the domain and {} followed no further; the fastest at {:.3g} m/s",
                                left, left == 1 ? "block" : "blocks", left == 1 ? "was" : "were",
                                result.fastest_left()));
  }
  add_rest_notes(scene, result);
  if (result.rough_steps > 0) {
    notes.push_back(
        fmt::format("motion: in {} of {} steps no answer met the contact law to {:g}; the best one was taken, residual "
                    "up to {:.2g}, "
                    "a miss of at most {:.2g} m/s",
                    result.rough_steps, result.steps, accepted, result.residual, result.missed_speed));
  }
  add_locked_note(result);
  add_standing_note(scene, made, standing_blocks(made, result), result);
  add_load_notes(scene, result);
  if (reduces_strength(*scene.stability)) {
    notes.emplace_back("motion: blocks in motion have their strength and weight as they are, without partial factors");
  }
}

}  // namespace cleave::scene
