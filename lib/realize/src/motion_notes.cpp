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

/// "block 3 at block 7": standing blocks that other rock bars at an edge or a corner, where the verdict knows nothing
/// that bars.
std::string barred_at_tips(const std::vector<StandingBlock>& standing, const MotionResult& result) {
  std::vector<std::string> named;
  for (const auto& [own, rock] : result.at_tips) {
    if (!std::ranges::binary_search(standing, own, {}, &StandingBlock::block)) continue;
    named.push_back(fmt::format("block {} at block {}", own.value(), rock.value()));
  }
  if (named.empty()) return {};
  constexpr std::size_t most = 3;
  const std::size_t more = named.size() - std::min(most, named.size());
  named.resize(named.size() - more);
  return fmt::format(
      "rock beside their way bars them at an edge or a corner alone ({}{}), which is sharp and does not break here, "
      "and "
      "would be crushed",
      fmt::join(named, ", "), more > 0 ? fmt::format(" and {} more", more) : "");
}

/// Which blocks stand against their verdict, and why they can.
void add_standing_note(const Scene& scene, const Realization& made, const std::vector<StandingBlock>& standing,
                       MotionResult& result) {
  if (standing.empty() || !result.converged) return;
  constexpr std::size_t most = 3;
  std::vector<std::string> named;
  for (std::size_t k = 0; k < std::min(most, standing.size()); ++k) {
    named.push_back(fmt::format("block {} (factor of safety {:.4g})", standing[k].block.value(), standing[k].factor));
  }
  const std::string tips = barred_at_tips(standing, result);
  std::string why = tips.empty() ? "" : tips + "; ";
  why += "forces locked between blocks may hold them";
  if (holds_when_opened(made)) why += ", and cohesion and tension of faces that open act until they part";
  if (!result.at_rest) why += "; or they are slow, and the run is short";
  if (const std::string out = left_out_of(scene.stability->loads, *scene.motion); !out.empty()) {
    why += "; loads of the verdict that motion leaves out: " + out;
  }
  if (result.loads && result.loads->drained > 0) why += "; water that has drained holds them no more";
  if (reduces_strength(*scene.stability)) why += "; partial factors of the verdict, which motion leaves out";
  if (!result.bolts.empty()) why += "; bolts hold what they lean on";
  result.notes.push_back(fmt::format(
      "motion: {} key {}, alone or in groups, did not move by a millimetre: {}{}. The verdict stays, motion is no "
      "proof: {}",
      standing.size(), standing.size() == 1 ? "block" : "blocks", fmt::join(named, ", "),
      standing.size() > most ? fmt::format(" and {} more", standing.size() - most) : "", why));
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
  if (result.may_be_locked > 0) {
    notes.push_back(fmt::format(
        "motion: up to {} blocks at a time were in groups that forces locked between them may hold; an answer that "
        "moves was looked for and goes first, but not every one may have been found",
        result.may_be_locked));
  }
  add_standing_note(scene, made, standing_blocks(made, result), result);
  add_load_notes(scene, result);
  if (reduces_strength(*scene.stability)) {
    notes.emplace_back("motion: blocks in motion have their strength and weight as they are, without partial factors");
  }
}

}  // namespace cleave::scene
