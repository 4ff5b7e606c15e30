#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "clash.hpp"
#include "cleave/dbem/world.hpp"
#include "work.hpp"

namespace cleave::dbem {

/// Nearest point of a polygon's boundary.
struct BoundaryPoint {
  std::size_t edge = 0;
  double share = 0;  // along it
  double distance = 0;
};
[[nodiscard]] BoundaryPoint nearest_on(std::span<const Vec2> corners, Vec2 p);

/// Gaps and penetrations below this share of the smaller body's smallest feature count as touching.
constexpr double contact_depth = 1e-9;

/// What does not change about a body.
struct Shape {
  Vec2 local_centroid;        // in the coordinates of Body::outline
  std::vector<Vec2> corners;  // about the centroid, undeformed
  std::vector<std::uint8_t> sharp;
  bool convex = true;
  double mass = 0, inertia = 0;
  double inverse_x = 0, inverse_y = 0, inverse_spin = 0;  // 0 where held
  double radius = 0;                                      // of the farthest corner
  double feature = 0;  // smallest distance of a corner to an edge it does not belong to
  std::size_t modes = 0;
  bool timed = false;  // carries forces of its own
  bool fixed = false;  // no freedom at all
  struct LoadPlace {   // of a point force on the outline
    std::size_t edge;
    double share;
  };
  std::vector<LoadPlace> load_places;
};

struct State {
  std::vector<Vec2> x;  // centroids, about Impl::anchor
  std::vector<double> angle;
  std::vector<Vec2> v;
  std::vector<double> spin;
  std::vector<double> e, de;  // modal amplitudes and rates of all bodies
};

struct TouchKey {
  std::uint32_t i, vertex, j, edge;
  friend auto operator<=>(const TouchKey&, const TouchKey&) = default;
};
inline TouchKey key_of(const Touch& t) { return {t.i, t.vertex, t.j, t.edge}; }

/// What a contact carries from step to step.
struct CachedContact {
  TouchKey key;
  Vec2 force;       // N/m
  Vec2 compliance;  // m2/N, normal and tangential
  Vec2 point, normal;
};

struct Bond {
  double cohesion;        // N/m
  double tension;         // N/m
  double residual;        // N/m, cohesion that is left when it broke by slip
  std::uint32_t section;  // of the joint it lies on
  double at;              // along it, from its middle, m
  bool broken = false;
  bool opened = false;  // nothing is left
};
/// How a bond is lost in a step.
enum class Loss : std::uint8_t { none, by_slip, torn };
/// A closed stretch of a joint between two bodies: bends as one.
struct JointSection {
  double length;   // m
  double tension;  // Pa
};
/// A corner at a body: what bonds are found by.
struct BondKey {
  std::uint32_t body, vertex, other;
  std::uint32_t bond;
  friend auto operator<=>(const BondKey&, const BondKey&) = default;
};

/// A side that fitted another body's rough side at the start.
struct Mated {
  std::uint32_t body, edge, other;
  friend auto operator<=>(const Mated&, const Mated&) = default;
};

/// What a tie carries from step to step.
struct Bar {
  double rest = 0;     // length without force, m
  double force = 0;    // N/m
  double plastic = 0;  // m, in `rest`
  bool installed = false, broken = false, yielding = false;
};

/// A group of bodies joined by contacts.
struct Island {
  std::vector<std::uint32_t> touches;
  std::vector<std::uint32_t> bodies;
  double theta = 0.5;
  bool impact = false;
  double rebound = 1;  // share of the restitution that is asked for
};

/// One side of a contact: body, arm from the place its impulse acts on to the contact point, modal rows.
struct Side {
  std::uint32_t body;
  Vec2 arm;
  double turn_n, turn_t;  // arm x n, arm x t, signed
  Vec2 n, t;              // signed
  std::size_t modal = 0;  // of the n row in Rows::modal, the t row follows
};
struct Rows {
  std::vector<Side> sides;    // two a contact: body of the corner, body of the edge
  std::vector<double> modal;  // unscaled
};

/// Two bodies that share space.
struct Clash {
  BodyPair pair;
  double depth;    // m
  double allowed;  // by the tolerance and by springs in their joints, m
};

/// A trial step.
struct Attempt {
  State state;
  std::vector<Vec2> corners;
  std::vector<Box2> boxes;
  std::vector<Touch> touches;  // at the end of the step
  std::vector<CornerChoice> choices;
  std::vector<CachedContact> memory;
  std::vector<Contact> contacts;
  std::vector<std::uint32_t> broken, closed;  // bonds that break; broken ones whose contact stays closed
  std::vector<Bar> bars;
  double friction = 0, work = 0, projected = 0, yielded = 0;
  std::vector<Island> islands;
  StepReport report;
  double limit = std::numeric_limits<double>::infinity();  // of the next step, by gaps
};

struct World::Impl {
  std::vector<Body> bodies;
  Laws laws;
  WorldOptions options;
  Vec2 anchor;
  std::vector<Shape> shapes;
  std::vector<std::size_t> first_corner, first_mode;
  double height = 0;
  double weight = 0;
  State state;
  std::vector<Vec2> start_x;
  double time = 0;
  double next_step = 0;
  std::size_t calm_steps = 0;
  double seen_step = 0;  // the step `touches` were found for
  double limit = std::numeric_limits<double>::infinity();
  std::vector<Vec2> corners;
  std::vector<Box2> boxes, fat;
  std::vector<BodyPair> pairs;
  Sweep sweep;  // of the check for overlaps
  std::vector<Touch> touches;
  std::vector<CornerChoice> choices;  // corners that may come to touch, the motion tells on which line
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
  std::vector<std::uint8_t> asleep;
  std::vector<std::uint16_t> calm;
  std::vector<std::uint32_t> sleep_group;
  std::uint32_t groups = 0;
  std::vector<Contact> contacts;
  Energy energy;
  double start_energy = 0;
  std::vector<Vec2> last_change;  // of velocity over the last step, for the error of position

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

  // geometry.cpp
  void place(const State& at, std::size_t body, std::vector<Vec2>& all) const;
  void place_at_start();
  void place_all(const State& at, std::vector<Vec2>& all, std::vector<Box2>& box) const;
  [[nodiscard]] Drift drift(const State& at, const TouchKey& pair, double step) const;
  [[nodiscard]] double speed_bound(const State& at, std::size_t body) const;
  void rebuild_pairs(const State& at, const std::vector<Box2>& box, double step);
  /// Contacts at a state for a step of this length; also the longest step that misses none.
  void find(const State& at, const std::vector<Vec2>& all, const std::vector<Box2>& box, double step,
            std::vector<Touch>& out, std::vector<CornerChoice>& undecided, double& limit);
  /// Corners that carried a force on one of their lines go on with it.
  void settle_choices();
  /// What touches now, for a step of this length.
  void look(double step);

  // assembly.cpp
  /// What is left of a velocity after a step, and how much of an impulse given over it, by the damping in proportion to
  /// mass.
  struct Damped {
    double kept, felt;
  };
  [[nodiscard]] Damped damped_over(double step) const;
  [[nodiscard]] std::vector<Island> islands_of(const std::vector<Touch>& list) const;
  [[nodiscard]] Rows rows_of(const std::vector<Touch>& list, const Island& island, const State& at) const;
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
  [[nodiscard]] std::vector<Vec2> warm_start(const std::vector<Touch>& list, const Island& island) const;
  [[nodiscard]] std::optional<std::uint32_t> bond_at(const Touch& t) const;
  [[nodiscard]] const Bond* bond_of(const Touch& t) const;
  /// Of the bond that holds, or what is left of one, N/m.
  [[nodiscard]] double cohesion_of(const Touch& t) const;
  [[nodiscard]] const JointLaw& law_of(const Touch& t) const;
  /// Of the springs in the joint at a contact, normal and tangential, m2/N; 0: rigid.
  [[nodiscard]] Vec2 compliance_of(const Touch& t) const;
  /// The velocity `free` of a contact, changed by what its spring, its bounce or its gap allows in the step.
  [[nodiscard]] Vec2 with_gap(Vec2 free, Vec2 old, const Touch& touch, Vec2 force, const Island& island, double thick,
                              double step) const;
  [[nodiscard]] ContactProblem problem_of(const std::vector<Touch>& list, const Island& island, const Rows& rows,
                                          const State& before, const State& free, double step,
                                          std::vector<Vec2>& viscous) const;
  void free_motion(const State& before, const std::vector<double>& theta, double step, State& free) const;
  /// theta of each group: 1 where something hits or a body is marked.
  void mark_impacts(const std::vector<Touch>& list, std::vector<Island>& islands, double step,
                    const std::vector<std::uint8_t>& implicit, std::vector<Rows>& made) const;
  /// Mean over a step from `at`: at half its turn, with the mean of what changes in time.
  [[nodiscard]] Vec2 force_on(const State& at, std::size_t body, double step, double& torque,
                              std::vector<double>* modal) const;
  void predict(const State& before, double step, std::size_t body, State& mid) const;

  // dilation.cpp
  void make_mated();
  void add_mated(Mated side);
  /// Gap and normal of a contact of rough faces that have slipped; others stay as they are.
  void ride(Touch& touch, const State& at) const;
  [[nodiscard]] double ride_between(std::size_t a, std::size_t b) const {
    return rides.empty() ? 0.0 : std::min(rides[a], rides[b]);
  }
  /// Coefficient on the face that the contact lies on.
  [[nodiscard]] double friction_of(const Touch& t, const Bond* bond) const;

  // sections.cpp
  void make_bonds();
  void make_water();
  /// A force on a body as it lies at the start, that moves and turns with it.
  void push_at(std::uint32_t body, Vec2 point, Vec2 force);
  void add_bond(const Touch& t, const Bond& bond);
  [[nodiscard]] Loss lost(std::uint32_t bond) const { return lost_now.empty() ? Loss::none : lost_now[bond]; }
  /// After a step: bonds that broke, and those of which nothing is left.
  void weaken(const Attempt& done);
  /// Marks the sections that do not carry what the contacts ask of them; false: none.
  bool tear_sections(const std::vector<Touch>& list, const Attempt& out, const std::vector<ContactSolution>& solutions,
                     double step);

  // ties.cpp
  [[nodiscard]] std::optional<WorldError> make_ties();
  /// Of the bar, on the first body and on the second, about `anchor`.
  [[nodiscard]] std::pair<Vec2, Vec2> tie_ends(std::size_t tie, const State& at) const;
  [[nodiscard]] Touch touch_of_tie(std::size_t tie, const State& at) const;
  /// Bars that are there, of bodies that do not both rest.
  [[nodiscard]] std::vector<Touch> bars_at(const State& at) const;
  void install_ties();
  /// s; infinite: none is to come.
  [[nodiscard]] double until_next_tie() const;
  [[nodiscard]] double elastic_of_ties() const;

  // step.cpp
  struct Failure {
    double residual = 0;
    std::string reason;
    std::optional<double> redo = {};  // not a failure: with this share of the step; 1: with what woke
    bool clash = false;               // by bodies that would share space
    bool slip_ends = false;           // `redo` ends the step where slip comes to its end
  };
  /// Work of the impulses on the velocities they leave behind, over the energy of the group: never positive for an
  /// exact answer of the implicit rule. 0 for other rules, and where contacts give back or are springs.
  [[nodiscard]] double energy_brought_in(const std::vector<Touch>& list, const Island& island, const Rows& rows,
                                         const ContactSolution& found, const State& after) const;
  /// `known`: impulses of a round before, about which the problem is then regularised; empty: none.
  [[nodiscard]] ContactSolution solve_island(const std::vector<Touch>& list, Island& island, const Rows& rows,
                                             const State& free, double step, std::size_t cut,
                                             const std::vector<Vec2>& known, Work& work) const;
  /// Restitution that brings in energy.
  [[nodiscard]] bool gives_back_too_much(const std::vector<Touch>& list, const Island& island, const Rows& rows,
                                         const State& free, double step, const ContactSolution& found) const;
  /// Steps from `step` down until one holds.
  [[nodiscard]] std::expected<StepReport, StepError> try_steps(double step, std::size_t shortened);
  void choose_next_step(const StepReport& report);
  [[nodiscard]] bool bounces(const Island& island, const Touch& touch, double closing, double step) const;
  [[nodiscard]] double until_first_bounce(const std::vector<Touch>& list, const Island& island, const Rows& rows,
                                          const ContactSolution& found, double step) const;
  std::uint32_t slip_ends_in_a_row = 0;  // steps that were ended so
  std::vector<std::uint8_t> hint;        // steps for which a body's group stays with the implicit rule
  void accept(Attempt&& done);

  // parting.cpp
  /// False: nothing could be parted.
  bool project(Attempt& out, Work& work) const;
  bool part_group(Island& island, Attempt& out, Work& work) const;
  /// `gaps` of the group's contacts.
  [[nodiscard]] ContactProblem parting_problem(const Island& island, const Rows& rows,
                                               const std::vector<double>& gaps) const;
  void keep_angular_momentum(const Island& island, double turned, State& at) const;
  double slow_down(const Island& island, const Rows& rows, double wanted, State& at) const;
  bool add_missed(const Attempt& out, const std::vector<Clash>& clashes, std::vector<Touch>& list) const;
  bool add_crossed(const Attempt& out, std::vector<Touch>& list) const;
  /// Every pair of bodies that overlap by more than rounding; tells the deepest in the report.
  [[nodiscard]] std::vector<Clash> clashes_of(Attempt& out);
  [[nodiscard]] double shortened_by_springs(const Attempt& out, BodyPair pair) const;

  // sleep.cpp
  /// Wakes the groups that something awake touches closer than this share of the smaller feature.
  bool wake(const std::vector<Touch>& list, double closer);
  void fall_asleep();

  // energy.cpp
  [[nodiscard]] double kinetic_of(const State& at) const;
  [[nodiscard]] double elastic_of(const State& at, const std::vector<CachedContact>& forces) const;
  [[nodiscard]] double potential_of(const State& at) const;
};

}  // namespace cleave::dbem
