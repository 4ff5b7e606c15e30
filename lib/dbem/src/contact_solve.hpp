#pragma once

#include "contact_search.hpp"

namespace cleave::dbem {

/// The impulses of a step between what touches, and where they lead. Changes nothing of the world.
struct ContactSolve : ContactSearch {
  // assembly.cpp
  /// What is left of a velocity after a step, and how much of an impulse given over it, by the damping in proportion to
  /// mass.
  struct Damped {
    double kept, felt;
  };
  [[nodiscard]] Damped damped_over(double step) const;
  [[nodiscard]] Rows rows_of(const std::vector<ContactCandidate>& list, const Island& island, const State& at) const;
  /// Sides of each body that moves, bodies numbered as met.
  struct SidesOfBodies {
    std::vector<std::optional<std::uint32_t>> number;  // by body
    std::vector<std::vector<std::uint32_t>> of;        // sides, by number
    // The modes' part of every pair of sides of a body as one product, rows (n, t) of its sides one after the other.
    std::vector<Eigen::MatrixXd> bending;  // by number; empty without modes
    std::vector<Eigen::Index> place;       // in that matrix, by side
  };
  [[nodiscard]] SidesOfBodies sides_of(const Rows& rows, double theta, double step, bool rigid_only) const;
  [[nodiscard]] BlockMatrix delassus(const Rows& rows, double theta, double step, double felt, bool rigid_only) const;
  /// Nothing when a body of the group bends and its modes are not left out (`stiffened`).
  [[nodiscard]] std::optional<RigidForm> rigid_form(const Rows& rows, const Island& island, double felt,
                                                    bool stiffened) const;
  /// Velocity of each contact (n, t) under the velocities of a state.
  [[nodiscard]] Vec2 velocity_of(const Rows& rows, std::size_t contact, const State& at) const;
  void add_impulse(const Rows& rows, std::size_t contact, Vec2 p, double theta, double step, State& at) const {
    add_impulse(rows, contact, p, std::array{theta, theta}, step, at);
  }
  /// With the theta of either body.
  void add_impulse(const Rows& rows, std::size_t contact, Vec2 p, std::array<double, 2> theta, double step,
                   State& at) const;
  [[nodiscard]] double mode_inverse(std::size_t body, std::size_t mode, double theta, double step) const;
  /// Force of each contact of a group in the step before, 0 where there was none.
  [[nodiscard]] std::vector<Vec2> warm_start(const std::vector<ContactCandidate>& list, const Island& island) const;
  /// The velocity `free` of a contact, changed by what its spring, its bounce or its gap allows in the step.
  [[nodiscard]] Vec2 with_gap(Vec2 free, Vec2 old, const ContactCandidate& touch, Vec2 force, const Island& island,
                              double thick, double step) const;
  [[nodiscard]] ContactProblem problem_of(const std::vector<ContactCandidate>& list, const Island& island,
                                          const Rows& rows, const State& before, const State& free, double step,
                                          std::vector<Vec2>& viscous) const;
  void free_motion(const State& before, const std::vector<double>& theta, double step, State& free) const;
  /// theta of each group: 1 where something hits or a body is marked.
  void mark_impacts(const std::vector<ContactCandidate>& list, std::vector<Island>& islands, double step,
                    const std::vector<std::uint8_t>& implicit, std::vector<Rows>& made) const;
  /// Mean over a step from `at`: at half its turn, with the mean of what changes in time.
  [[nodiscard]] Vec2 force_on(const State& at, std::size_t body, double step, double& torque,
                              std::vector<double>* modal) const;
  void predict(const State& before, double step, std::size_t body, State& mid) const;

  // impact.cpp
  [[nodiscard]] bool bounces(const Island& island, const ContactCandidate& touch, double closing, double step) const;
  [[nodiscard]] double until_first_bounce(const std::vector<ContactCandidate>& list, const Island& island,
                                          const Rows& rows, const ContactSolution& found, double step) const;

  // step.cpp, energy.cpp
  /// `known`: impulses of a round before, about which the problem is then regularised; empty: none.
  [[nodiscard]] ContactSolution solve_island(const std::vector<ContactCandidate>& list, Island& island,
                                             const Rows& rows, const State& free, double step, std::size_t cut,
                                             const std::vector<Vec2>& known, Work& work) const;
  /// Restitution that brings in energy.
  [[nodiscard]] bool gives_back_too_much(const std::vector<ContactCandidate>& list, const Island& island,
                                         const Rows& rows, const State& free, double step,
                                         const ContactSolution& found) const;
  /// Work of the impulses on the velocities they leave behind, over the energy of the group: never positive for an
  /// exact answer of the implicit rule. 0 for other rules, and where contacts give back or are springs.
  [[nodiscard]] double energy_brought_in(const std::vector<ContactCandidate>& list, const Island& island,
                                         const Rows& rows, const ContactSolution& found, const State& after) const;
};

/// Moves bodies that overlap apart, and finds the contacts through which they came to.
struct Parting : ContactSolve {
  /// False: nothing could be parted.
  bool separate_overlaps(Attempt& out, Work& work) const;
  bool part_group(Island& island, Attempt& out, Work& work) const;
  /// `gaps` of the group's contacts.
  [[nodiscard]] ContactProblem parting_problem(const Island& island, const Rows& rows,
                                               const std::vector<double>& gaps) const;
  void keep_angular_momentum(const Island& island, double turned, State& at) const;
  double slow_down(const Island& island, const Rows& rows, double wanted, State& at) const;
  bool add_missed(const Attempt& out, const std::vector<Clash>& clashes, std::vector<ContactCandidate>& list) const;
  bool add_crossed(const Attempt& out, std::vector<ContactCandidate>& list) const;
  [[nodiscard]] double shortened_by_springs(const Attempt& out, BodyPair pair) const;
};

}  // namespace cleave::dbem
