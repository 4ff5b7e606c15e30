#pragma once

#include "contact_solve.hpp"

/// The world in layers, each of which sees only what is below it: what is there (`world_state.hpp`), what touches
/// (`contact_search.hpp`), what follows in a step (`contact_solve.hpp`), and here how it is made and what it keeps.
namespace cleave::dbem {

struct World::Impl : Parting {
  std::size_t calm_steps = 0;
  std::vector<Contact> contacts;
  Energy energy;
  double start_energy = 0;
  std::vector<Vec2> last_change;         // of velocity over the last step, for the error of position
  std::uint32_t slip_ends_in_a_row = 0;  // steps that were ended so
  std::vector<std::uint8_t> hint;        // steps for which a body's group stays with the implicit rule

  // ---- made: world.cpp, dilation.cpp, sections.cpp, ties.cpp
  void place_at_start();
  void stretch_at_start();
  void make_mated();
  void add_mated(Mated side);
  void make_bonds();
  void add_bond(const ContactCandidate& t, const Bond& bond);
  void make_water();
  /// A force on a body as it lies at the start, that moves and turns with it.
  void push_at(std::uint32_t body, Vec2 point, Vec2 force);
  [[nodiscard]] std::optional<WorldError> make_ties();
  void install_ties();

  // ---- accepted: step.cpp, sections.cpp, sleep.cpp
  struct Failure {
    double residual = 0;
    std::string reason;
    std::optional<double> redo = {};  // not a failure: with this share of the step; 1: with what woke
    bool clash = false;               // by bodies that would share space
    bool slip_ends = false;           // `redo` ends the step where slip comes to its end
  };
  /// Steps from `step` down until one holds.
  [[nodiscard]] std::expected<StepReport, StepError> try_steps(double step, std::size_t shortened);
  void choose_next_step(const StepReport& report);
  /// Marks the sections that do not carry what the contacts ask of them; false: none.
  bool tear_sections(const std::vector<ContactCandidate>& list, const Attempt& out,
                     const std::vector<ContactSolution>& solutions, double step);
  void accept(Attempt&& done);
  /// After a step: bonds that broke, and those of which nothing is left.
  void weaken(const Attempt& done);
  void fall_asleep();
};

}  // namespace cleave::dbem
