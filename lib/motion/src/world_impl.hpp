#pragma once

#include <expected>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cleave/core/parallel.hpp"
#include "cleave/motion/world.hpp"
#include "overlap.hpp"
#include "solver.hpp"
#include "touch.hpp"

namespace cleave::motion {

/// What of a body never changes.
struct Shape {
  Vec3 centroid = {};  ///< at the start
  double mass = 0, volume = 0;
  Symmetric inertia = {};  ///< axes of the start
  double radius = 0, size = 0, thickness = 0;
  std::uint32_t first_cell = 0, last_cell = 0;
};

struct State {
  Vec3 shift;  ///< of the centroid since the start
  Turn turn;
  Vec3 v, momentum;  ///< momentum: angular, axes of the body
};

/// Where pressure acts that is linear over a patch and nowhere a pull: the corners of its core (kern), one for each
/// side of its hull, with their shares of its area, which balance about its middle. Empty where the patch is none.
struct Core {
  std::vector<Bond::Share> corners;
  std::vector<Vec3> hull;
};
[[nodiscard]] Core core_of(const std::vector<Bond::Share>& patch, Vec3 normal);

struct BondState {
  Bond bond;  ///< points and normal as at the start
  Core core;
  double pull = 0;  ///< the tension that counts, by area
  bool broken = false;
  std::vector<Vec3> impulse = {};  ///< of its points, of the last step, scene axes
};

/// A point of a bond as it is now. Strengths by time.
struct BondPoint {
  Vec3 at_start;
  double friction = 0, cohesion = 0, tension = 0;
  bool shear = false;  ///< cohesion alone
};

struct TieRecord {
  Tie tie;
  double length = 0;  ///< m, at the start
  double force = 0;   ///< N, in the last step
  double lengthened = 0;
  bool broken = false;
  bool gives = false;  ///< in this step
};

struct LoadRecord {
  Load load;
  bool gone = false;
};
/// Force, N, and moment about the centroid, Nm.
struct Wrench {
  Vec3 force, moment;
};

/// Contact points and bodies that hang together.
struct Island {
  std::vector<std::uint32_t> bodies;
  std::vector<std::uint32_t> touches;                          ///< into the list of touches
  std::vector<std::pair<std::uint32_t, std::uint32_t>> bonds;  ///< bond and share
  std::vector<std::uint32_t> ties = {};
  bool leans = false;  ///< on something fixed
};

/// Which bodies touch.
struct TouchingPairs {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs = {};  ///< sorted, the smaller number first
  std::vector<std::uint32_t> count = {};                            ///< by body
};
[[nodiscard]] TouchingPairs touching_pairs(const std::vector<Touch>& list, std::size_t bodies);

struct Attempt {
  std::vector<State> state;
  std::vector<Touch> touches;
  TouchingPairs before, pairs;  ///< of the last step; of this one
  std::vector<Contact> contacts;
  std::vector<std::uint32_t> broken;
  std::vector<std::uint8_t> locked;  ///< by body: its group may be
  std::vector<std::uint32_t> torn;   ///< bonds whose tension gave
  std::vector<std::vector<Vec3>> bond_impulse;
  std::vector<TieRecord> ties;
  std::vector<std::uint32_t> freed;  ///< bodies of ties that broke
  StepReport report;
  double work = 0, friction = 0, scheme = 0, projected = 0, gain = 0, loads = 0;
  Vec3 given;  ///< momentum, by loads and walls
};

struct World::Impl {
  std::shared_ptr<const std::vector<Cell>> cells;
  std::vector<std::uint32_t> cell_body;
  std::vector<Shape> shapes;
  std::vector<std::uint8_t> held;  ///< never moves
  std::vector<Surface> surfaces;
  std::vector<BondState> bonds;
  std::vector<std::uint8_t> torn;  ///< by bond: it has no tension (any more)
  std::vector<TieRecord> ties;
  std::vector<LoadRecord> loads;
  std::vector<std::vector<std::uint32_t>> loads_on;  ///< by body
  std::optional<StillWater> water;
  WorldOptions options;
  double extent = 0;

  double now = 0, last_step = 0;
  Vec3 pull;  ///< m/s2, in this step: gravity, and the ground's acceleration the other way
  std::vector<State> state;
  std::vector<Touch> touches;  ///< of the last step, with impulses
  std::vector<Contact> contacts;
  std::vector<std::uint8_t> asleep, quiet, implicit, locked;
  std::vector<Placed> placed;
  Energy energy;
  Vec3 expected;  ///< momentum, by all forces so far
  double largest_momentum = 0, momentum_off = 0;

  [[nodiscard]] bool moves(std::uint32_t b) const { return held[b] == 0 && asleep[b] == 0; }
  /// m/s2, no less than any pull.
  [[nodiscard]] double strongest() const {
    return norm(options.gravity) + (options.ground.mean ? options.ground.peak.si() : 0);
  }
  [[nodiscard]] Vec3 centroid(const State& s, std::uint32_t b) const { return shapes[b].centroid + s.shift; }
  [[nodiscard]] Vec3 spin(const State& s, std::uint32_t b) const {
    return s.turn * solve(shapes[b].inertia, s.momentum);
  }

  // step.cpp
  struct Failure {
    double residual = 0;
    std::string reason;
    std::vector<std::uint32_t> bodies = {};
  };
  [[nodiscard]] double longest_step(double at_most) const;
  [[nodiscard]] std::optional<Failure> attempt(double step, double tolerate, Attempt& out);
  void accept(Attempt& done);
  [[nodiscard]] StepReport close(Attempt& done);
  [[nodiscard]] double kinetic_of(std::uint32_t b) const;
  void count_energy();
  [[nodiscard]] std::vector<Island> islands_of(const std::vector<Touch>& list) const;
  [[nodiscard]] Group group_of(const Island& island, const std::vector<Touch>& list, const std::vector<State>& mid,
                               double step, double rebound) const;
  [[nodiscard]] double theta_of(std::uint32_t b) const;
  /// Drift to where the kick is given; `travel`: how far bodies may come in the step.
  [[nodiscard]] std::vector<State> predict(double step, std::vector<double>& travel) const;
  /// As if there were no contacts, with a clean report.
  void let_fall(const std::vector<State>& mid, double step, Attempt& out) const;
  struct Solved {
    Group group;
    Solution found;
    bool rebounds = false;
  };
  [[nodiscard]] Solved solve_island(const Island& island, const Attempt& so_far, const std::vector<State>& mid,
                                    double step, double tolerate) const;
  /// Whether these bodies were a group of the last step that touched the same bodies, at rest: then whether it may be
  /// locked.
  [[nodiscard]] std::optional<bool> as_before(const Island& island, const Attempt& so_far) const;
  /// Impulses of contacts, and bonds that broke.
  void note_contacts(const Island& island, const Solved& solved, const std::vector<State>& mid, double step,
                     Attempt& out) const;
  /// All groups. False when some take another rule of the step from now on.
  [[nodiscard]] std::expected<bool, Failure> solve_all(const std::vector<State>& mid, double step, double tolerate,
                                                       Attempt& out);
  /// False when the group gained energy by the mean rule and is to be done again.
  [[nodiscard]] bool close_island(const Island& island, const Solved& solved, const std::vector<State>& mid,
                                  double step, Attempt& out) const;
  struct Balance {
    double work = 0, scheme = 0, friction = 0, gain = 0;  ///< gain: 0 where it is rounding
    Vec3 from_walls;
  };
  [[nodiscard]] Balance gain_of(const Island& island, const Group& group, const Solution& found,
                                const std::vector<State>& mid, double step) const;
  void drift_body(State& s, std::uint32_t b, double h) const;
  void sleep_and_wake(const Attempt& done);
  void wake_touched();

  // bonds.cpp
  void add_bond(Bond bond);
  [[nodiscard]] bool pulls(std::uint32_t bond) const { return !bonds[bond].broken && torn[bond] == 0; }
  /// How many points it has: while it pulls those of its core and, for more cohesion than the apex needs, its shares.
  [[nodiscard]] std::uint32_t points_of(std::uint32_t bond) const;
  [[nodiscard]] BondPoint point_of(std::uint32_t bond, std::uint32_t number) const;
  /// Point and normal now.
  [[nodiscard]] std::pair<Vec3, Vec3> place_of(std::uint32_t bond, Vec3 at_start, const std::vector<State>& s) const;
  /// What it bears in a step, and what it bore in the last one.
  void set_law(std::uint32_t bond, std::uint32_t number, Vec3 normal, double step, Point& p) const;
  /// Drops touches on patches that pull: nothing presses there but the points of the bond.
  void drop_bonded(std::vector<Touch>& list, const std::vector<State>& s) const;
  /// What one of its points carried, and whether it gave. `slip`: opening and slip.
  void note_bond(std::uint32_t bond, std::uint32_t number, const Eigen::Vector3d& impulse, const Eigen::Vector3d& slip,
                 const std::vector<State>& mid, double step, Attempt& out) const;

  // ties.cpp
  [[nodiscard]] std::pair<Vec3, Vec3> ends_of(const TieRecord& tie, const std::vector<State>& s) const;
  /// What it may come apart before it pulls, m; below 0: it is drawn too long.
  [[nodiscard]] double slack_of(const TieRecord& tie, const std::vector<State>& s) const;
  static void set_tie(const TieRecord& tie, double slack, double step, Point& p);
  /// What it carried, and whether it gives. `room`: speed at which it comes to be longer than its ends are apart, m/s.
  void note_tie(std::uint32_t number, const Group& group, const Point& p, double impulse, double room, double step,
                Attempt& out) const;
  /// Those that gave are as long now as their ends are apart, and gone where that is too much.
  void lengthen_ties(Attempt& out) const;
  /// Wakes what hangs on something that moves; whether there was any.
  [[nodiscard]] bool wake_tied();

  // loads.cpp
  void add_load(const Load& load);
  /// Where the point of a load is on its body, and where that of the other is, or was.
  [[nodiscard]] std::pair<Vec3, Vec3> points_of(const Load& load, const std::vector<State>& s) const;
  /// The force on its body as it is turned now.
  [[nodiscard]] Vec3 force_of(const Load& load, const std::vector<State>& s) const;
  [[nodiscard]] Wrench lift_of(std::uint32_t b, const State& s) const;
  [[nodiscard]] Wrench loads_of(std::uint32_t b, const std::vector<State>& s) const;
  /// Change of velocity and spin in a step by all that acts on a body but contacts.
  [[nodiscard]] Vector6 kick_of(std::uint32_t b, const std::vector<State>& mid, double step) const;
  /// m/s2, no less than any point of a body is accelerated by, as it is now, but by contacts.
  [[nodiscard]] double hurry_of(std::uint32_t b) const;
  /// Of the loads along the way of each body in a step.
  [[nodiscard]] double work_of_loads(const std::vector<State>& mid, const std::vector<State>& after, double step) const;
  /// Those whose points have come apart act no more; what they held may move.
  void end_loads(std::vector<std::uint32_t>& freed);

  // contacts.cpp
  void place_all(const std::vector<State>& s, bool everything);
  [[nodiscard]] std::vector<std::pair<std::uint32_t, std::uint32_t>> near_pairs(
      const std::vector<double>& travel) const;
  [[nodiscard]] std::vector<Touch> touches_of(const std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs,
                                              const std::vector<double>& travel, bool strict) const;
  /// A border between two cells of one body is no skin: nothing touches what is covered.
  [[nodiscard]] bool is_covered(const std::vector<Touch>& own) const;
  void recall(std::vector<Touch>& list, double step) const;
  /// Touches that overlap in the end state and that the list does not know, as they were at the kick.
  [[nodiscard]] std::vector<Touch> missed(const std::vector<Touch>& list, const std::vector<Touch>& at_end,
                                          const std::vector<State>& mid, const std::vector<State>& end) const;
  /// What is near and what touches or overlaps where bodies are placed.
  struct Look {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    std::vector<Touch> touches;
  };
  [[nodiscard]] Look look() const;
  [[nodiscard]] double deepest_overlap(const std::vector<std::pair<std::uint32_t, std::uint32_t>>& near,
                                       std::vector<std::uint32_t>& pair) const;

  // parting.cpp
  /// Moves the bodies of a group; what that brings in of energy.
  [[nodiscard]] double move_apart(const Island& island, const Solution& moved, std::vector<State>& s) const;
  [[nodiscard]] double turn_all(const Island& island, Vec3 angular, std::vector<State>& s) const;
  /// Moves bodies apart that overlap, and together what hangs on ties that are too long, as far as there is room; what
  /// that brings in of energy. `seen`: of this state; then of where they have come to.
  [[nodiscard]] double part(std::vector<State>& s, const std::vector<TieRecord>& tied, Look& seen, double& deepest);
};

[[nodiscard]] Matrix6 mass_matrix(const Shape& shape, Turn turn);

}  // namespace cleave::motion
