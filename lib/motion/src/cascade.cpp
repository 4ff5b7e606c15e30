#include "cascade.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "growth.hpp"
#include "interior.hpp"
#include "judge.hpp"
#include "newton.hpp"

namespace cleave::motion {
namespace {

using Eigen::Vector3d;

/// One try after the other, keeping the best answer.
class Cascade {
 public:
  Cascade(const Group& group, const SolverOptions& options)
      : group_{group}, options_{options}, scaled_{group}, newton_{scaled_}, interior_{scaled_} {
    best_.impulse.assign(group.points.size(), Vector3d::Zero());
    if (scaled_.unit > 0) run();
  }
  Solution take() && { return std::move(best_); }

 private:
  [[nodiscard]] bool done() const { return tried_ && best_.report.residual <= options_.accept; }
  [[nodiscard]] std::size_t factors() const { return newton_.factors() + interior_.factors(); }
  [[nodiscard]] bool spent() const { return factors() >= budget_; }

  Unknowns start() const {
    Unknowns x;
    for (std::size_t k = 0; k < group_.points.size(); ++k) {
      x.emplace_back(group_.points[k].start / scaled_.elements[k].scale);
    }
    return x;
  }
  /// Friction no larger than its bound.
  Unknowns held_by_law(Unknowns x) const {
    for (std::size_t k = 0; k < x.size(); ++k) {
      const Scaled::Element& e = scaled_.elements[k];
      x[k][0] = e.shear ? 0 : std::min(e.most, std::max(x[k][0], -e.tension));
      const double bound = std::max(0.0, e.mu * x[k][0] + e.cohesion), length = x[k].tail<2>().norm();
      if (length > bound) x[k].tail<2>() *= bound / length;
    }
    return x;
  }
  Unknowns none() const { return Unknowns(group_.points.size(), Vector3d::Zero()); }

  /// Its residual; kept when it is the best so far.
  double look_at(const Unknowns& x, Method method) {
    std::vector<Vector3d> impulse;
    for (std::size_t k = 0; k < x.size(); ++k) impulse.emplace_back(x[k] * scaled_.elements[k].scale);
    Response response = respond(group_, impulse);
    const Judged judged = judge(group_, impulse, response);
    if (tried_ && !(judged.residual < best_.report.residual)) return judged.residual;
    tried_ = true;
    best_.report.residual = judged.residual;
    best_.report.missed_speed = judged.missed;
    best_.report.method = method;
    best_.impulse = std::move(impulse);
    best_.velocity = std::move(response.velocity);
    return judged.residual;
  }

  void coulomb(Unknowns x, Method method, const Newton::Schedule& schedule) {
    (void)newton_.solve({.law = Law::coulomb}, x, schedule);
    look_at(x, method);
  }

  /// From forces that are near.
  void nearby(const Unknowns& x, Method method) {
    for (const double rough : {1e-3, 1e-5}) {
      if (!done()) coulomb(x, method, {.rough = rough, .fine = std::min(rough, 1e-6)});
    }
  }

  void proximal(double fall) {
    coulomb(none(), Method::proximal, {.rough = 1, .fine = 1e-7, .fall = fall, .recentrings = 3, .last = 6});
  }

  /// Sweeps to come near, Newton from there.
  void by_sweeps(Unknowns x) {
    Progress progress;
    for (int round = 0; round < 40 && !done() && !spent() && progress.goes_on(best_.report.residual); ++round) {
      sweep(scaled_, x, 100);
      look_at(x, Method::sweeps);
      if (done()) return;
      nearby(x, Method::sweeps);
    }
  }

  /// Interior points come near where Newton's iteration gets lost, as under a hundred blocks that begin to topple.
  /// Then Newton; then proximal points at a weight that neither rounding nor slow modes spoil.
  void by_interior() {
    for (const bool coupled : {true, false}) {
      for (const double weight : {1e-9, 0.0}) {
        if (done()) return;
        Unknowns x = none();
        const double left = interior_.solve(x, {.weight = weight, .coupled = coupled});
        look_at(x, Method::interior);
        if (!(left < 1e-2) && is_large()) continue;  // far from any answer: Newton's iteration would get lost
        for (const double rough : {1e-1, 1e-3, 1e-5, 1e-7}) {
          if (done()) return;
          Unknowns near = x;
          const double fall = rough > 1e-2 ? 0.3 : 0.1;
          (void)newton_.solve({.law = Law::coulomb}, near,
                              {.rough = rough, .fine = std::min(rough, 1e-6), .fall = fall});
          look_at(near, Method::interior);
          settle();
        }
        if (is_large()) by_slip(slips(x), x, 1e-5, 4, 6);
      }
    }
  }

  /// From an answer that is nearly good enough, by points at one weight.
  void settle(double weight = 3e-7) {
    if (done() || !(best_.report.residual < 1e-6)) return;
    Unknowns x;
    for (std::size_t k = 0; k < best_.impulse.size(); ++k) {
      x.emplace_back(best_.impulse[k] / scaled_.elements[k].scale);
    }
    coulomb(std::move(x), best_.report.method, {.rough = weight, .fine = weight, .last = 60, .finest = weight});
  }

  /// Ends rounds that get no nearer.
  struct Progress {
    double least = std::numeric_limits<double>::infinity();
    int idle = 0;
    [[nodiscard]] bool stalls() const { return idle >= 3; }
    bool goes_on(double residual) {
      idle = residual < 0.7 * least ? 0 : idle + 1;
      least = std::min(least, residual);
      return idle <= 10;
    }
  };

  std::vector<double> slips(const Unknowns& x) const {
    std::vector<double> out;
    for (const Vector3d& u : velocities(x)) out.push_back(u.tail<2>().norm());
    return out;
  }

  /// Groups in which proximal points take hundreds of factors for one convex programme.
  [[nodiscard]] bool is_large() const { return group_.mass.size() > 40; }
  /// Interior points for them: quick, but right in the speeds of heavy bodies only.
  [[nodiscard]] bool by_points() const { return is_large() && !exact_ && !yields_; }

  /// Whether Newton's iteration may go on from an answer with this residual: in large groups it gets lost from far.
  [[nodiscard]] bool is_near(double residual) const { return !by_points() || residual < 5e-3; }

  /// The slip given, the rest is one convex programme. Interior points solve it in some 25 factors however many points
  /// there are; where they do not, and in small groups, proximal points from `x`. Returns what velocities may be off.
  double cone(const Programme& programme, Unknowns& x, const Newton::Schedule& schedule, double goal) {
    if (by_points()) {
      Unknowns inner = none();
      const double left =
          interior_.solve(inner, {.weight = 1e-9, .goal = goal, .coupled = false, .given = programme.given});
      if (left < std::max(10 * goal, 1e-6)) {
        x = std::move(inner);
        return left;
      }
    }
    return newton_.solve(programme, x, schedule);
  }

  /// Forces without friction.
  Unknowns smooth(double finest) {
    Unknowns x = none();
    if (by_points()) {
      std::vector<double> friction;
      std::vector<std::uint8_t> shear;
      for (auto& e : scaled_.elements) {
        friction.push_back(std::exchange(e.mu, 0));
        shear.push_back(std::exchange(e.shear, false) ? 1 : 0);
      }
      const std::vector<double> still(x.size(), 0);
      const double left = interior_.solve(x, {.weight = 1e-9, .goal = 1e-8, .coupled = false, .given = still});
      for (std::size_t k = 0; k < friction.size(); ++k) {
        scaled_.elements[k].mu = friction[k];
        scaled_.elements[k].shear = shear[k] != 0;
      }
      if (left < 1e-6) return x;
      x = none();
    }
    (void)newton_.solve({.law = Law::frictionless}, x, {.fine = 1e-5, .last = 4, .finest = finest});
    return x;
  }

  /// The slip given, the rest is one convex programme; the slip is then renewed. From the slip without friction:
  /// forces that only lock blocks between one another, and hold as well as not, are not found; from none they are.
  enum class From : std::uint8_t { frictionless, rest };
  void by_slip(From from, double finest, int last) {
    const bool slides = from == From::frictionless;
    by_slip(slides ? slips(smooth(1e-5)) : std::vector<double>(group_.points.size(), 0), none(), finest, last, 60);
  }
  void by_slip(std::vector<double> first, Unknowns x, double finest, int last, int most) {
    Programme programme{.law = Law::cone, .given = std::move(first)};
    Progress progress;
    double off = std::numeric_limits<double>::infinity();
    for (int round = 0; round < most && !done() && !spent() && progress.goes_on(off); ++round) {
      const double hidden =
          cone(programme, x, {.rough = round == 0 ? 1e-1 : 1e-3, .fine = 1e-5, .last = last, .finest = finest}, 1e-8);
      off = look_at(x, Method::convex);
      if (done()) return;
      const std::vector<double> slip = slips(x);
      for (std::size_t k = 0; k < x.size(); ++k) {
        const double renewed = round < 20 ? slip[k] : 0.5 * (programme.given[k] + slip[k]);
        programme.given[k] = slip[k] > 30 * hidden ? renewed : 0;
      }
      if (is_near(off)) nearby(x, Method::convex);
      // Interior points are right in the speeds of heavy bodies only: what is left of the rest may be theirs.
      if (by_points() && progress.stalls()) {
        exact_ = true;
        progress = {};
      }
    }
  }

  /// The bounds of friction given, the rest is one convex programme; the bounds are then renewed.
  void by_bounds(double finest) {
    Unknowns x = none();
    Programme programme{.law = Law::tresca, .given = std::vector<double>(x.size(), 0)};
    Progress progress;
    for (int round = 0; round < 60 && !done() && !spent() && progress.goes_on(best_.report.residual); ++round) {
      (void)newton_.solve(programme, x, {.rough = round == 0 ? 1e-1 : 1e-3, .fine = 1e-5, .last = 4, .finest = finest});
      for (std::size_t k = 0; k < x.size(); ++k) {
        const Scaled::Element& e = scaled_.elements[k];
        const double bound = std::max(0.0, e.mu * x[k][0] + e.cohesion);
        programme.given[k] = round < 20 ? bound : 0.5 * (programme.given[k] + bound);
      }
      nearby(x, Method::convex);
    }
  }

  std::vector<Vector3d> velocities(const Unknowns& x) const {
    Eigen::VectorXd v = Eigen::VectorXd::Zero(6 * static_cast<Eigen::Index>(scaled_.bodies));
    for (std::size_t k = 0; k < x.size(); ++k) scaled_.add(scaled_.elements[k], x[k], v);
    std::vector<Vector3d> out;
    for (const auto& e : scaled_.elements) out.push_back(scaled_.relative(e, v));
    return out;
  }

  void run() {
    bool warm = false;
    for (const Point& p : group_.points) warm = warm || !p.start.isZero();
    if (warm && group_.settled) look_at(held_by_law(start()), Method::newton);
    // What it misses adds up to a speed, step by step: once it is looked at more closely the group goes to sleep.
    const double by_far = std::min(5e-8, 0.3 * options_.accept);
    const auto is_met = [&] {
      return tried_ && best_.report.residual <= by_far && best_.report.missed_speed <= group_.still;
    };
    // A group at rest is mostly off by what one step at a small weight puts right.
    if (warm && group_.settled && !is_met()) {
      coulomb(start(), Method::newton, {.rough = 1e-6, .fine = 1e-6, .last = 1, .finest = 1e-6});
    }
    if (warm && !is_met()) coulomb(start(), Method::newton, {.rough = 1e-4, .fine = 1e-6});
    if (warm && done() && group_.settled) {
      best_.report.may_be_locked = *group_.settled;
      best_.report.iterations = factors();
      return;
    }
    // Without friction Newton's iteration comes home from none. Dear rounds of convex programmes come second in large
    // groups. Elsewhere what moves is looked for in motion first.
    const bool first = is_large() && std::ranges::any_of(group_.points, [](const Point& p) { return p.mu > 0; });
    if (!done() && first) by_interior();
    if (!done()) coulomb(none(), Method::newton, {});
    if (!done()) by_slip(From::frictionless, 1e-5, 4);
    if (is_large() && !yields_) {
      exact_ = true;
      if (!done()) {
        budget_ = factors() + options_.patience;
        by_slip(From::frictionless, 1e-5, 4);
      }
    }
    if (!done() && !options_.locking) by_slip(From::frictionless, 1e-8, 8);
    if (!done() && options_.locking && !first) by_interior();
    if (!done() && !spent() && options_.locking) by_slip(From::rest, 1e-5, 4);
    if (!done() && best_.report.residual < 1e-4 && options_.locking) by_slip(From::rest, 1e-8, 8);
    if (!done() && !spent()) by_sweeps(warm ? start() : none());
    for (const double finest : {1e-5, 1e-10}) {
      if (!options_.locking) break;
      if (!done() && !spent()) by_bounds(finest);
      if (!done() && !spent()) by_slip(From::rest, 0.1 * finest, 8);
    }
    if (!done() && !spent()) proximal(0.1);
    if (!done() && !spent()) proximal(1.0 / 3);
    // What is left is rounding, more or less of it by the weight.
    for (const double weight : {1e-7, 1e-6, 3e-8, 3e-6}) settle(weight);
    const bool usable = done() || best_.report.residual <= options_.tolerate;
    if (usable && options_.prefer_motion) prefer_motion();
    best_.report.iterations = factors();
  }

  /// Kinetic energy over the one that bodies have without contacts.
  [[nodiscard]] double motion_of(const std::vector<Vector6>& velocity) const {
    double kept = 0, free = 0;
    for (std::size_t b = 0; b < velocity.size(); ++b) {
      kept += velocity[b].dot(group_.mass[b] * velocity[b]);
      free += group_.free[b].dot(group_.mass[b] * group_.free[b]);
    }
    return free > 0 ? kept / free : 0;
  }

  [[nodiscard]] std::vector<Vector6> velocities_of(const Unknowns& x) const {
    std::vector<Vector3d> impulse;
    for (std::size_t k = 0; k < x.size(); ++k) impulse.emplace_back(x[k] * scaled_.elements[k].scale);
    return respond(group_, impulse).velocity;
  }

  /// 1: a body that stands and would move without contacts, and friction may be why.
  [[nodiscard]] std::vector<std::uint8_t> standing_in(const std::vector<Vector6>& velocity) const {
    double fastest = 0;
    for (const Vector6& v : group_.free) fastest = std::max(fastest, v.norm());
    std::vector<std::uint8_t> out(group_.mass.size(), 0);
    for (const Point& p : group_.points) {
      if (!(p.mu > 0)) continue;
      for (const std::optional<std::uint32_t> b : {std::optional{p.body}, p.other}) {
        if (!b || group_.free[*b].norm() <= 1e-6 * fastest) continue;
        if (velocity[*b].norm() <= 1e-6 * fastest) out[*b] = 1;
      }
    }
    return out;
  }

  /// Whether those that stand do so for sure as long as all farther than their neighbours press as they do: then they
  /// are looked at alone, by the same search. No: not known.
  [[nodiscard]] bool stand_among_neighbours(std::vector<std::uint8_t> in) const {
    const std::vector<std::uint8_t> stands = in;
    for (const Point& p : group_.points) {
      if (p.other && (stands[p.body] != 0 || stands[*p.other] != 0)) in[p.body] = in[*p.other] = 1;
    }
    Group own;
    std::vector<std::uint32_t> number(in.size(), 0);
    for (std::size_t b = 0; b < in.size(); ++b) {
      if (in[b] == 0) continue;
      number[b] = static_cast<std::uint32_t>(own.mass.size());
      own.mass.push_back(group_.mass[b]);
      own.free.push_back(group_.free[b]);
    }
    if (2 * own.mass.size() > in.size()) return false;  // no less than all of it
    for (std::size_t k = 0; k < group_.points.size(); ++k) {
      Point p = group_.points[k];
      const bool first = in[p.body] != 0, second = p.other && in[*p.other] != 0;
      const bool within = first && (second || !p.other);
      if (within) {
        p.body = number[p.body];
        if (p.other) p.other = number[*p.other];
        p.start = best_.impulse[k];
        own.points.push_back(p);
        continue;
      }
      const auto press = [&](std::uint32_t body, const auto& rows) {
        own.free[number[body]] += group_.mass[body].ldlt().solve(rows * best_.impulse[k]);
      };
      if (first) press(p.body, p.on_body);
      if (second) press(*p.other, p.on_other);
    }
    SolverOptions how = options_;
    how.locking = true;
    const Solution found = best_answer(own, how);
    if (found.report.residual > options_.accept || found.report.may_be_locked) return false;
    double fastest = 0, off = 0;
    for (const Vector6& v : group_.free) fastest = std::max(fastest, v.norm());
    for (std::size_t b = 0; b < in.size(); ++b) {
      if (stands[b] != 0) off = std::max(off, found.velocity[number[b]].norm());
    }
    return off <= 1e-5 * fastest;
  }

  /// Coulomb's problem may have several answers. One in which bodies stand counts only where the search from motion,
  /// friction followed up from none, ends in no other one that keeps more of the motion.
  void prefer_motion() {
    std::vector<std::uint8_t> stands = standing_in(best_.velocity);
    if (std::ranges::count(stands, 1) == 0 || stand_among_neighbours(std::move(stands))) return;
    exact_ = false;
    Unknowns free = smooth(1e-8);
    // Interior points leave some rounding of their own: what is near is looked at with the last digits.
    if (is_large() && motion_of(velocities_of(free)) <= motion_of(best_.velocity) + 1e-4) {
      (void)newton_.solve({.law = Law::frictionless}, free, {.rough = 1e-3, .fine = 1e-5, .last = 4, .finest = 1e-8});
    }
    if (motion_of(velocities_of(free)) <= motion_of(best_.velocity) + barely) return;  // stands without friction
    Solution standing = std::move(best_);
    const double still = motion_of(standing.velocity);
    bool found = search_from_motion(free, still);
    if (!is_large() && rank_of(still) < 2) found = !by_single_bodies(standing) && found;
    const int rank = rank_of(still);
    standing.report.may_be_locked = rank > 0 || !found;
    if (rank > 0) {
      best_.report.may_be_locked = true;
    } else {
      best_ = std::move(standing);
    }
  }

  /// What the best answer counts beside one that keeps so much of the motion: 2 where it moves, 1 where it is rough and
  /// moves: what stands by the other would be safe by mistake; else 0.
  [[nodiscard]] int rank_of(double still) const {
    if (!tried_) return 0;
    const double gained = motion_of(best_.velocity) - still;
    if (done() && gained > barely) return 2;
    return best_.report.residual <= options_.tolerate && gained > 0.1 ? 1 : 0;
  }

  /// Other answers than one at rest that keeps so much of the motion, by one way after the other until one moves. False
  /// where a way ended neither at rest nor in an answer.
  bool search_from_motion(const Unknowns& free, double still) {
    bool settled = true;
    int rank = 0;
    best_ = {};
    best_.impulse.assign(group_.points.size(), Vector3d::Zero());
    tried_ = false;
    const auto search = [&](auto&& way) {
      if (rank == 2) return;
      Solution before = best_;
      const bool tried = std::exchange(tried_, false);
      budget_ = factors() + options_.patience;
      settled = way() && settled;
      if (const int own = rank_of(still); own > rank || !tried) {
        rank = own;
      } else {
        best_ = std::move(before);
        tried_ = tried;
      }
    };
    if (!is_large()) search([&] { return by_growing_friction(free, still); });
    search([&] {
      by_rising_friction(free);
      if (done() || !by_points()) return done();
      exact_ = true;
      budget_ = factors() + options_.patience;
      by_rising_friction(smooth(1e-8));
      return done();
    });
    if (is_large()) search([&] { return by_growing_friction(free, still); });
    return settled;
  }

  /// Sweeps while friction grows come near an answer that moves where convex programmes get lost; then Newton. False
  /// where they move and lead to no answer.
  bool by_growing_friction(Unknowns x, double still) {
    const Moves moves = [&](const Unknowns& at) { return motion_of(velocities_of(at)) > still + barely; };
    (void)grow_friction(scaled_, x, moves);
    return make_exact(std::move(x), moves, is_large() ? 2 : 10);
  }

  /// From forces that sweeps found, as long as they move. Whether they came to rest or led to an answer.
  bool make_exact(Unknowns x, const Moves& moves, int rounds) {
    for (int round = 0; round < rounds; ++round) {
      look_at(x, Method::sweeps);
      if (done() || !moves(x)) return true;
      for (const double rough : {1e-2, 1e-3, 1e-5}) {
        Unknowns near = x;
        (void)newton_.solve({.law = Law::coulomb}, near, {.rough = rough, .fine = std::min(rough, 1e-6)});
        if (moves(near)) look_at(near, Method::sweeps);
        if (done()) return true;
      }
      sweep(scaled_, x, 200);
    }
    return false;
  }

  /// Bodies that stand, but would move if all others went on as they do: their neighbours hold them by what hangs on
  /// how they came to rest. From such motion the whole is sought; true where there is some.
  bool by_single_bodies(const Solution& standing) {
    const double still = motion_of(standing.velocity);
    const Moves moves = [&](const Unknowns& at) { return motion_of(velocities_of(at)) > still + barely; };
    const std::vector<std::uint8_t> stands = standing_in(standing.velocity);
    bool any = false;
    for (std::uint32_t b = 0; b < stands.size() && rank_of(still) < 2; ++b) {
      if (stands[b] == 0) continue;
      const Alone own = alone(group_, b, standing.velocity);
      const Unknowns impulse = moving_alone(own.group);
      if (impulse.empty()) continue;
      any = true;
      Unknowns x;
      for (std::size_t k = 0; k < standing.impulse.size(); ++k) {
        x.emplace_back(standing.impulse[k] / scaled_.elements[k].scale);
      }
      for (std::size_t k = 0; k < impulse.size(); ++k) {
        x[own.from[k]] = impulse[k] / scaled_.elements[own.from[k]].scale;
      }
      // What stood may be the better answer by its residual: it must not hide one that moves.
      Solution before = best_;
      const int rank = rank_of(still);
      const bool tried = std::exchange(tried_, false);
      (void)make_exact(std::move(x), moves, 3);
      if (rank_of(still) <= rank) {
        best_ = std::move(before);
        tried_ = tried;
      }
    }
    return any;
  }

  /// The slip of one share of the friction is where the next one starts.
  void by_rising_friction(Unknowns x) {
    std::vector<double> friction;
    for (const auto& e : scaled_.elements) friction.push_back(e.mu);
    Programme programme{.law = Law::cone, .given = slips(x)};
    constexpr double shares = 8;
    for (double k = 1; k <= shares && !done() && !spent(); ++k) {
      for (std::size_t e = 0; e < friction.size(); ++e) scaled_.elements[e].mu = k / shares * friction[e];
      const bool last = k >= shares;
      Progress progress;
      for (int round = 0; round < (last ? 60 : by_points() ? 2 : 6) && !spent(); ++round) {
        const double hidden =
            cone(programme, x, {.rough = round == 0 ? 1e-1 : 1e-3, .fine = 1e-5, .last = 4, .finest = 1e-5},
                 last ? 1e-8 : 1e-6);
        double change = 0, largest = 0;
        const std::vector<double> slip = slips(x);
        for (std::size_t e = 0; e < slip.size(); ++e) {
          const double renewed = slip[e] > 30 * hidden ? slip[e] : 0;
          change = std::max(change, std::abs(renewed - programme.given[e]));
          largest = std::max(largest, renewed);
          programme.given[e] = renewed;
        }
        if (last) {
          if (is_near(look_at(x, Method::convex))) nearby(x, Method::convex);
          if (done() || !progress.goes_on(best_.report.residual)) break;
        } else if (change <= 1e-3 * largest) {
          break;
        }
      }
    }
    for (std::size_t e = 0; e < friction.size(); ++e) scaled_.elements[e].mu = friction[e];
  }

  /// Share of the motion by which an answer has to keep more to be another one.
  static constexpr double barely = 1e-9;

  const Group& group_;
  const SolverOptions& options_;
  Scaled scaled_;
  Newton newton_;
  Interior interior_;
  Solution best_;
  bool tried_ = false;
  bool yields_ = std::ranges::any_of(group_.points, &Point::axial);  ///< interior points know no upper bound
  bool exact_ = false;  ///< no interior points for one programme: they did not lead to an answer
  std::size_t budget_ = options_.patience;
};

}  // namespace

Solution best_answer(const Group& group, const SolverOptions& options) { return Cascade{group, options}.take(); }

}  // namespace cleave::motion
