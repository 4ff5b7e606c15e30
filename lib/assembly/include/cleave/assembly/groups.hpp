#pragma once

#include <cstdint>
#include <expected>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "cleave/assembly/assembly.hpp"

namespace cleave::assembly {

// ---- Factors --------------------------------------------------------------------------------------------------------

/// The unique rate of motion nearest to free fall, in the metric of the masses, that contacts of the associated law
/// (opening tan(friction)/F times the slip) let through: zero when forces in all contacts can hold the loads.
struct Projection {
  Motion motion;
  std::vector<double> speed;  ///< of each body, as a share of the largest free fall
  double largest = 0;         ///< of `speed`
  bool settled = false;       ///< rates are as exact as rounding lets them be
};
/// With strengths over `factor`; infinity: without strength.
[[nodiscard]] Projection project(const Assembly& assembly, double factor);

/// Forces in the contacts, N: at each point and then at each bond, normal and two tangents as vectors.
struct ContactForces {
  std::vector<std::vector<geometry::Vec3>> at_points, at_bonds;
};
/// Forces that hold the loads at strengths over `factor` (infinity: without strength), every point pressed by
/// `prestress` times the largest load at least. They may lack balance: check them.
[[nodiscard]] ContactForces holding_forces(const Assembly& assembly, double factor, double prestress = 0);

/// What cohesion is worth at a face to which something stands at this small angle (sine): nothing at none, all from one
/// degree on. So nothing jumps where a wall stands exactly along the resultant, or the motion exactly along a wall.
[[nodiscard]] double cohesion_share(double sine);
/// That of a contact pressed by these forces at its points, N: against the load of its lighter body; all where that has
/// none.
[[nodiscard]] double pressed_cohesion(const Assembly& assembly, const Contact& contact,
                                      std::span<const geometry::Vec3> at_points);

/// The largest F at which strengths/F still admit balance: above it motion is certain whatever the law of flow, the
/// initial stress or the stiffness. Infinite above 10^4, 0 below 10^-4.
struct StaticFactor {
  double factor = 0;
  double lower = 0;  ///< largest F at which forces were found
  bool settled = true;
};
[[nodiscard]] StaticFactor static_factor(const Assembly& assembly);

/// What the search for motion from rest under Coulomb's law found at one strength.
enum class FromRest : std::uint8_t {
  moves,      ///< a solution that moves, all conditions checked
  rests,      ///< only solutions at rest were found: no proof that there is no other
  unsettled,  ///< neither
};
struct Start {
  FromRest found = FromRest::unsettled;
  Motion motion;              ///< accelerations, m/s2 and 1/s2
  std::vector<double> speed;  ///< of each body, as a share of the largest free fall
  double residual = 1;        ///< largest violation of the conditions, relative
  ContactForces forces = {};  ///< of the state it ended in; of a part of a larger search left out
};
/// Follows the branch of motion from frictionless contacts down to strengths over `factor`.
[[nodiscard]] Start start_from_rest(const Assembly& assembly, double factor);

/// The factor of safety of an assembly: the least F at which the Coulomb problem from rest, strengths over F, has a
/// solution that moves. An upper estimate: no search proves that there is no motion below.
struct MovingFactor {
  double factor = 0;    ///< infinite when nothing moves without friction, 0 when it moves at any
  bool settled = true;  ///< just below, a state at rest was found; false: nothing that could be checked
};
/// `up`: what `static_factor` found.
[[nodiscard]] MovingFactor moving_factor(const Assembly& assembly, double up);

// ---- Their certificate ----------------------------------------------------------------------------------------------

/// Why a certificate was refused.
struct Refused {
  double driving = 0;  ///< what had to be more
  double charge = 0;   ///< than this
};

/// Proof that an assembly does not stay at rest at strengths over `factor`, whatever the law of flow, the initial
/// stress, the stiffness or the order of loading: rates at which the loads do more work than the contacts can take up.
/// Each point of a contact is taken to press with `most` at the utmost. Made by the check alone.
class MotionCertificate final {
 public:
  [[nodiscard]] double factor() const noexcept { return factor_; }
  [[nodiscard]] const Motion& motion() const noexcept { return motion_; }
  [[nodiscard]] double driving() const noexcept { return driving_; }  ///< W, rounded down
  [[nodiscard]] double charge() const noexcept { return charge_; }    ///< W, rounded up
  [[nodiscard]] double most() const noexcept { return most_; }        ///< N, where a contact does not state its own

 private:
  friend std::expected<MotionCertificate, Refused> check_motion(const Assembly&, double, const Motion&, double);
  MotionCertificate(double factor, Motion motion, double driving, double charge, double most)
      : factor_{factor}, motion_{std::move(motion)}, driving_{driving}, charge_{charge}, most_{most} {}
  double factor_;
  Motion motion_;
  double driving_, charge_, most_;
};
/// Shares no code with the solver; intervals rounded outwards, normals and points widened by their own rounding.
/// `most`: over the largest load.
[[nodiscard]] std::expected<MotionCertificate, Refused> check_motion(const Assembly& assembly, double factor,
                                                                     const Motion& motion, double most = 1e3);

/// Proof that forces hold an assembly at strengths over `factor`: they lie so far inside what the contacts carry that
/// what they lack of balance can be made up. With `factor` infinite no motion lets the loads do work: the assembly
/// stays under every law of friction. Otherwise it is no proof that it stays.
class RestCertificate final {
 public:
  [[nodiscard]] double factor() const noexcept { return factor_; }
  [[nodiscard]] double margin() const noexcept { return margin_; }  ///< N: least distance to what contacts carry
  [[nodiscard]] double repair() const noexcept { return repair_; }  ///< N: what balance takes at most

 private:
  friend std::expected<RestCertificate, Refused> check_rest(const Assembly&, double, const ContactForces&);
  RestCertificate(double factor, double margin, double repair) : factor_{factor}, margin_{margin}, repair_{repair} {}
  double factor_, margin_, repair_;
};
[[nodiscard]] std::expected<RestCertificate, Refused> check_rest(const Assembly& assembly, double factor,
                                                                 const ContactForces& forces);

// ---- Groups of an assembly ------------------------------------------------------------------------------------------

enum class Verdict : std::uint8_t {
  certain,          ///< moves whatever the initial stress and the law of flow: a certificate was checked
  unsafe,           ///< may move: only locked-in or wedging forces could hold it
  in_doubt,         ///< the search did not settle, or the two factors lie more than 5 % apart
  no_motion_found,  ///< no solution that moves was found: no proof that it stands
  stands,           ///< stays under every law of friction: a certificate was checked
};
/// "certain", "unsafe", "in_doubt", "no_motion_found", "stands".
[[nodiscard]] std::string_view name(Verdict verdict) noexcept;

/// An assembly at strengths as given, with its factors.
struct Judged {
  Verdict verdict = Verdict::in_doubt;
  StaticFactor up;
  MovingFactor moving;
  Motion motion;  ///< of `certain` and `unsafe` from rest, else of the proof; m/s2 and 1/s2
  std::optional<MotionCertificate> moves;
  std::optional<RestCertificate> stands;
};
[[nodiscard]] Judged judge(const Assembly& assembly);

/// Blocks that move together, others taken to be fixed.
struct Group {
  std::vector<std::uint32_t> bodies;  ///< ascending
  Verdict verdict = Verdict::in_doubt;
  /// Of `bodies`, one after the other, from rest under Coulomb's law; zero when in doubt, and for a body of a certain
  /// group that moves only as its proof does.
  Motion motion;
  std::optional<MotionCertificate> proof;
  StaticFactor up;
  MovingFactor moving;
  /// Where it was found in translation: with moments, at strengths as they count in translation.
  std::optional<MovingFactor> turning = {};
  /// At which the heaviest of several bodies starts to move, of both the lesser: that of the group or more, then to
  /// 1e-3. A crumb beside it may move at less.
  std::optional<double> heaviest = {};
  /// In doubt as it rests, but would move with a little less strength, or where cohesion breaks bit by bit.
  bool weaker = false;
  bool factors = true;  ///< false: not asked for, or the group is too large, and they say no more than the verdict
};
struct Groups {
  std::vector<Group> groups;  ///< certain, unsafe and in doubt, by first body
  std::size_t held = 0;       ///< bodies of islands that stand without friction
};
/// What is asked for: which bodies move; what is in doubt as well; factors too, which take most of the time where
/// groups are small.
enum class Ask : std::uint8_t { motion, verdicts, factors };
/// All groups of one state; the same for any number of threads, which is at least 1. `among`, one a body where it is
/// not empty: only groups with a body that is marked there are asked for, and others may be missing.
[[nodiscard]] Groups find_groups(const Assembly& assembly, Ask ask = Ask::factors, unsigned threads = 1,
                                 std::span<const std::uint8_t> among = {});

/// What small sets of bodies do without ties: asked once where the same blocks are looked at under many supports.
/// Threads may share it.
class UntiedSets final {
 public:
  /// Whether an assembly without ties was not found at rest.
  [[nodiscard]] bool may_move(const Assembly& assembly);

 private:
  std::mutex lock_;
  std::map<std::vector<double>, bool> known_;  ///< by all numbers of an assembly
};

/// Single bodies, and pairs of neighbours, that move while all others are taken to be fixed, by first body. Where the
/// assembly as a whole was found at rest, its other bodies hold them with forces that hang on how it came to rest (two
/// that would slide clamp a third between them): unsafe at least. `open` and `taken`, one a body: bodies marked in
/// `open` are looked at, with their neighbours; none that is marked in `taken`. Ties pull at what opens and push
/// nothing: what rests without them is not looked at with them. `untied`: where that is known from. `among`: as of
/// `find_groups`.
[[nodiscard]] std::vector<Group> find_small_groups(const Assembly& assembly, std::span<const std::uint8_t> open,
                                                   std::span<const std::uint8_t> taken, Ask ask = Ask::factors,
                                                   unsigned threads = 1, UntiedSets* untied = nullptr,
                                                   std::span<const std::uint8_t> among = {});

}  // namespace cleave::assembly
