#pragma once

#include <optional>
#include <vector>

#include "world_impl.hpp"

namespace cleave::dbem {

/// Whether a step is ended where slip comes to its end.
struct SlipEnds {
  bool followed = false;
  double within = 0;  ///< length of the step that was tried first, s, of one that was shortened so; else 0
};

/// One try of a step: groups of touching bodies, the impulses between them, where these lead, and whether that may be
/// believed. Done again with the contacts that come up on the way. Changes nothing of the world but what it remembers
/// for later tries (`hint`, `torn_now`, `lost_now`), and what it wakes.
class Trial final {
 public:
  Trial(World::Impl& world, double step, std::size_t cut, Work& work, const SlipEnds& slip_ends, Attempt& out);
  /// Nothing: `out` is a step that holds.
  [[nodiscard]] std::optional<World::Impl::Failure> run();

 private:
  using Failure = World::Impl::Failure;

  /// Groups, their rules in time, and the geometry that impulses act on.
  void divide();
  [[nodiscard]] std::optional<Failure> solve();
  [[nodiscard]] std::optional<Failure> solve_group(std::size_t group);
  /// The answer of the round before, where the same contacts are asked the same.
  [[nodiscard]] const ContactSolution* found_before(std::size_t group) const;
  /// Impulses of the round before of these contacts; empty when there are none.
  [[nodiscard]] std::vector<Vec2> impulses_before(const Island& island) const;
  /// Bonds that do not carry what they are asked for: the step is solved again without them.
  [[nodiscard]] bool bonds_gave_way();
  /// Share of the step at which the first slip comes to its end, above 1 where a step that should end with it is too
  /// short; 1: none does, or none that matters.
  [[nodiscard]] double until_slip_ends() const;
  [[nodiscard]] double until_slip_ends(std::size_t group) const;
  /// The mean rule lets a contact that opens and shuts again within a step, or slip that turns round, bring in energy
  /// of the order of (g step)^2: such groups are done again by the implicit rule, which cannot.
  [[nodiscard]] bool mean_rule_gained();
  [[nodiscard]] std::optional<Failure> move();
  [[nodiscard]] std::optional<Failure> error_of_position() const;
  /// What touches and overlaps now; fails where something wakes.
  [[nodiscard]] std::optional<Failure> look();
  [[nodiscard]] bool contacts_came_up();

  // ties.cpp
  /// Bars that pull in this step.
  void pull_ties();
  /// Those that yield, on the motion without contacts.
  void pull_with_capacity(const State& mid);
  /// Bars that were asked for more than they carry: they yield or break, and the step is solved again.
  [[nodiscard]] bool ties_gave_way();
  /// Bars that were thought to yield and are loaded less.
  [[nodiscard]] bool ties_hold_again();
  void break_bar(std::uint32_t tie);
  void note_tie(std::size_t group, std::size_t contact);
  void note_yielding();

  void note_contacts();
  void note_contact(std::size_t group, std::size_t contact);
  /// From the velocities before and after the step.
  [[nodiscard]] double friction_work(std::size_t group, std::size_t contact, Vec2 old, Vec2 now) const;
  /// Of bodies whose velocity is given.
  void note_given_work(const Rows& rows, std::size_t contact, Vec2 impulse);
  /// Work of the loads other than gravity, and what is left over at each body.
  void note_loads();
  void part();
  [[nodiscard]] std::optional<Failure> judge_overlaps() const;

  World::Impl& w_;
  double step_;
  std::size_t cut_;
  Work& work_;
  SlipEnds slip_ends_;
  Attempt& out_;
  std::vector<ContactCandidate> list_;   // at the start of the step
  std::vector<ContactCandidate> moved_;  // where impulses act
  std::vector<Rows> rows_;               // of each group
  std::vector<ContactSolution> solutions_;
  std::vector<std::vector<Vec2>> start_forces_;  // of contacts at the end of the step before, group by group
  std::vector<Clash> clashes_;
  std::vector<double> theta_;  // of each body
  std::vector<std::uint8_t> implicit_;
  std::vector<std::uint32_t> pulling_;  // ties that yield
  std::vector<std::uint8_t> settled_;   // ties that do so whatever comes of it
  State free_;                          // without contacts
  // Of the round before, by the first contact of the group.
  std::vector<Island> groups_before_;
  std::vector<ContactSolution> solutions_before_;
  std::vector<std::uint32_t> group_of_;
  std::vector<Vec2> impulse_before_;  // of each contact; empty in the first round
};

}  // namespace cleave::dbem
