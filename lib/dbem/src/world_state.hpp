#pragma once

#include "world_parts.hpp"

namespace cleave::dbem {

/// Bodies and how they move now.
struct WorldState {
  std::vector<Body> bodies;
  Laws laws;
  WorldOptions options;
  Vec2 anchor;
  std::vector<Shape> shapes;
  std::vector<std::size_t> first_corner, first_mode;
  double height = 0;
  State state;
  std::vector<Vec2> start_x;
  double time = 0;
  double next_step = 0;
  std::vector<Vec2> corners;
  std::vector<Box2> boxes;
  std::vector<std::uint8_t> asleep;

  [[nodiscard]] std::size_t size() const { return shapes.size(); }
  [[nodiscard]] bool idle(std::size_t b) const { return shapes[b].fixed || asleep[b] != 0; }
  [[nodiscard]] bool still(std::size_t b) const;  // fixed and not moving
  [[nodiscard]] std::size_t corner_count(std::size_t b) const { return first_corner[b + 1] - first_corner[b]; }
  [[nodiscard]] std::span<const Vec2> corners_of(const std::vector<Vec2>& all, std::size_t b) const {
    return std::span{all}.subspan(first_corner[b], corner_count(b));
  }
  [[nodiscard]] Placed placed(const std::vector<Vec2>& all, const std::vector<Box2>& box, std::size_t b) const {
    return {static_cast<std::uint32_t>(b), corners_of(all, b), shapes[b].sharp, box[b], shapes[b].convex};
  }
  void place(const State& at, std::size_t body, std::vector<Vec2>& all) const;
  void place_all(const State& at, std::vector<Vec2>& all, std::vector<Box2>& box) const;
  [[nodiscard]] double speed_bound(const State& at, std::size_t body) const;
  [[nodiscard]] double kinetic_of(const State& at) const;
  [[nodiscard]] double potential_of(const State& at) const;
};

/// What lies between bodies: laws of joints, bonds that hold or broke, rough faces, bolts.
struct JointState : WorldState {
  std::vector<CachedContact> memory;
  std::vector<Bond> bonds;
  std::vector<BondKey> bond_keys;
  std::vector<JointSection> sections;
  std::vector<Mated> mated;   // sorted
  std::vector<double> rides;  // of each body, how far joints can lift it; empty: nothing dilates
  // In the step that is being tried: sections that tear, and bonds that are lost. Empty: none.
  std::vector<std::uint8_t> torn_now;
  std::vector<Loss> lost_now;
  std::vector<Tie> ties;
  std::vector<std::array<BoundaryPoint, 2>> tie_places;  // nearest to their ends
  std::vector<Bar> bars;                                 // by tie

  [[nodiscard]] const JointLaw& law_of(const ContactCandidate& t) const;
  [[nodiscard]] Loss lost(std::uint32_t bond) const { return lost_now.empty() ? Loss::none : lost_now[bond]; }
  [[nodiscard]] std::optional<std::uint32_t> bond_at(const ContactCandidate& t) const;
  [[nodiscard]] const Bond* bond_of(const ContactCandidate& t) const;
  /// Of the bond that holds, or what is left of one, N/m.
  [[nodiscard]] double cohesion_of(const ContactCandidate& t) const;
  /// Coefficient on the face that the contact lies on.
  [[nodiscard]] double friction_of(const ContactCandidate& t, const Bond* bond) const;
  /// What a contact carries from the step before, by its name or by those it may have had then; nothing where it was
  /// open. `taken` by others: 1, by place in `memory`; empty: nothing is.
  [[nodiscard]] std::optional<std::size_t> remembered(const ContactCandidate& t,
                                                      const std::vector<std::uint8_t>& taken) const;
  /// Of the springs in the joint at a contact, normal and tangential, m2/N; 0: rigid. What is pressed does not get
  /// stiffer until it opens: its springs would give back more than they took.
  [[nodiscard]] Vec2 compliance_of(const ContactCandidate& t) const;
  /// Of a closed stretch of `length` that begins at a contact and runs along `along` (a unit vector): the share of it
  /// that the contact stands for.
  [[nodiscard]] double share_of(const ContactCandidate& t, Vec2 along, double length) const;
  /// Gap and normal of a contact of rough faces that have slipped; others stay as they are.
  void ride(ContactCandidate& touch, const State& at) const;
  [[nodiscard]] double ride_between(std::size_t a, std::size_t b) const {
    return rides.empty() ? 0.0 : std::min(rides[a], rides[b]);
  }
  [[nodiscard]] double elastic_of(const State& at, const std::vector<CachedContact>& forces) const;

  // ties.cpp
  /// Of the bar, on the first body and on the second, about `anchor`.
  [[nodiscard]] std::pair<Vec2, Vec2> tie_ends(std::size_t tie, const State& at) const;
  [[nodiscard]] ContactCandidate touch_of_tie(std::size_t tie, const State& at) const;
  /// Bars that are there, of bodies that do not both rest.
  [[nodiscard]] std::vector<ContactCandidate> bars_at(const State& at) const;
  /// s; infinite: none is to come.
  [[nodiscard]] double until_next_tie() const;
  [[nodiscard]] double elastic_of_ties() const;
};

}  // namespace cleave::dbem
