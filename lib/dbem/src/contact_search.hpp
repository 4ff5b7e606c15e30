#pragma once

#include "world_state.hpp"

namespace cleave::dbem {

/// What touches what, or may within a step; what overlaps; what rests together.
struct ContactSearch : JointState {
  double seen_step = 0;  // the step `touches` were found for
  double limit = std::numeric_limits<double>::infinity();
  std::vector<Box2> fat;
  std::vector<BodyPair> pairs;
  Sweep sweep;  // of the check for overlaps
  std::vector<ContactCandidate> touches;
  std::vector<CornerChoice> choices;  // corners that may come to touch, the motion tells on which line
  std::vector<std::uint16_t> calm;
  std::vector<std::uint32_t> sleep_group;
  std::uint32_t groups = 0;

  [[nodiscard]] Drift drift(const State& at, const ContactKey& pair, double step) const;
  void rebuild_pairs(const State& at, const std::vector<Box2>& box, double step);
  /// Contacts at a state for a step of this length; also the longest step that misses none.
  void find(const State& at, const std::vector<Vec2>& all, const std::vector<Box2>& box, double step,
            std::vector<ContactCandidate>& out, std::vector<CornerChoice>& undecided, double& longest);
  /// Corners that carried a force on one of their lines go on with it.
  void settle_choices();
  /// What touches now, for a step of this length.
  void look(double step);
  [[nodiscard]] std::vector<Island> islands_of(const std::vector<ContactCandidate>& list) const;
  /// Wakes the groups that something awake touches closer than this share of the smaller feature.
  bool wake(const std::vector<ContactCandidate>& list, double closer);
  /// Every pair of bodies that overlap by more than rounding; tells the deepest in the report.
  [[nodiscard]] std::vector<Clash> clashes_of(Attempt& out);
};

}  // namespace cleave::dbem
