#include "cleave/dbem/solver.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <span>
#include <utility>

#include "natural_map.hpp"
#include "tries.hpp"

namespace cleave::dbem {

namespace {

class Cascade final {
 public:
  Cascade(PatternSolver& linear, const ContactProblem& problem, const SolverOptions& options)
      : linear_{linear},
        problem_{problem},
        options_{options},
        most_solves_{options.max_linear_solves.value_or(std::numeric_limits<std::size_t>::max())} {}

  /// Takes an answer if it is the best so far; true when that is good enough, or no more is to be tried.
  bool take(SolverAttempt tried, Method method) {
    iterations_ += tried.iterations;
    if (tried.p.size() != problem_.contacts()) return false;
    const double residual = judge(problem_, tried.p).residual;
    if (!std::isnan(residual) && residual < best_) {
      best_ = residual;
      method_ = method;
      p_ = std::move(tried.p);
    }
    return best_ <= options_.accept || iterations_ >= most_solves_ || work().over();
  }

  ContactSolution finish() {
    ContactSolution solution;
    if (p_.empty()) p_.resize(problem_.contacts());
    const auto [residual, map] = judge(problem_, p_);
    ContactReport& report = solution.report;
    report.residual = residual;
    report.missed_speed = map.fastest;
    report.method = method_;
    report.iterations = iterations_;
    report.status =
        report.residual <= options_.accept ? ContactReport::Status::converged : ContactReport::Status::not_converged;
    for (std::size_t k = 0; k < problem_.contacts(); ++k) {
      if (map.a_n[k] <= -problem_.tension[k]) {
        ++report.opened;
      } else if (map.bound[k] > 0 && std::abs(map.a_t[k]) <= map.bound[k]) {
        ++report.stick;
      } else {
        ++report.slip;
      }
      report.max_penetration = std::max(report.max_penetration, -map.y[k].x);
    }
    solution.impulse = std::move(p_);
    return solution;
  }

  /// Linear solves of large groups are not spent on digits far below what is promised.
  [[nodiscard]] double target_of(bool large) const {
    return large ? std::max(options_.target, 0.01 * options_.accept) : options_.target;
  }
  bool shi() { return take(open_close(linear_, problem_, options_.open_close_passes), Method::open_close); }

  void run_all() {
    const bool warm = std::ranges::any_of(problem_.start, [](Vec2 v) { return v.x != 0 || v.y != 0; });
    const bool large = is_large(problem_);
    const double target = target_of(large);
    const auto from_here = [&](std::vector<Vec2> start, std::size_t most) {
      return newton(linear_, problem_, 0, target, most, std::move(start));
    };
    const std::size_t most = options_.newton_iterations;
    const bool wander = wanders(problem_);
    const double enough = (wander && large ? 0.1 : 0.01) * options_.accept;
    if (wander) {
      // Forces that nobody knows yet, of thousands of contacts: sweeps do not carry them through the group.
      if (!warm && problem_.contacts() > 3000 && inside(1000)) return;
      if (along_proximal_points(warm ? problem_.start : std::vector<Vec2>{}, enough)) {
        if (!large) take(from_here(p_, 5), Method::continuation);  // the last digits
        return;
      }
    } else {
      if (!warm && shi()) return;
      // From a warm start a few iterations do or none will.
      if (warm) {
        SolverAttempt kept = frozen_state_solve(linear_, problem_, problem_.start);
        iterations_ += kept.iterations;
        if (take(newton(linear_, problem_, 0, target, most / 6, std::move(kept.p), {}, 1e4), Method::newton)) return;
        if (!large && take(from_here(problem_.start, most / 6), Method::newton)) return;
      }
      if (warm && !large && shi()) return;
      if (!large && take(from_here({}, most / 2), Method::newton)) return;
      if (take(proximal(linear_, problem_, warm ? problem_.start : std::vector<Vec2>{}, enough, most_solves_),
               Method::continuation) &&
          best_ <= options_.accept) {
        take(from_here(p_, 5), Method::continuation);  // the last digits
        return;
      }
    }
    run_slow(warm, large, wander, enough);
  }

  /// What is left when the quick ways found no answer.
  void run_slow(bool warm, bool large, bool wander, double enough) {
    const double target = target_of(large);
    const std::size_t most = options_.newton_iterations;
    // From forces that nobody knows a path leads home sooner than sweeps, from the step before sweeps do.
    const auto look_quickly = [&] { return along_path(std::min(quick_look, options_.path)); };
    const bool patient = !options_.max_linear_solves;
    const std::size_t rounds = patient || !warm ? 12 : 2;
    if (wander && (warm ? swept(rounds) || look_quickly() : look_quickly() || swept(rounds))) return;
    if (work().over()) return;
    // Shorter steps from known forces are cheaper than all that follows.
    if (wander && warm && !patient) return;
    // Rather than cut the step of a large group at once: what made it hard is often there in a shorter one, too.
    if (iterations_ >= most_solves_) {
      if (large && !inside(wander ? 150 : 1000)) along_path(options_.path);
      return;
    }
    // What else there is needs thousands of linear solves there, and never got home.
    if (wander && problem_.contacts() > 300) {
      if (!inside(options_.path > 0 ? 150 : 1000)) along_path(options_.path);
      return;
    }
    if (wander && shi()) return;
    const auto from_here = [&](std::vector<Vec2> start, std::size_t iterations) {
      return newton(linear_, problem_, 0, target, iterations, std::move(start));
    };
    if (take(from_here({}, most), Method::newton)) return;
    if (warm && take(proximal(linear_, problem_, {}, enough, most_solves_), Method::continuation)) return;
    for (const double factor : {10.0, 3.0, 1.5}) {
      if (take(continuation(linear_, problem_, options_, factor), Method::continuation)) return;
    }
    SolverAttempt longer = open_close(linear_, problem_, 10 * options_.open_close_passes);
    std::vector<Vec2> state = longer.p;
    if (take(std::move(longer), Method::open_close)) return;
    if (!state.empty() && take(from_here(std::move(state), most), Method::newton)) return;
    if (problem_.contacts() <= 3 * most_for_lemke && take(pivot(), Method::lemke)) return;
    if (take(from_here(p_, most), Method::newton)) return;
    if (inside(1000) || along_path(options_.path)) return;
    // Sweeps creep up to an answer where Newton orbits between the states of a few contacts.
    SolverAttempt swept{p_};
    for (int more = 0; more < 4; ++more) {
      const std::vector<Vec2> nowhere(swept.p.size());
      sweep(problem_, work(), 0, nowhere, 500, swept.p);
      if (take(swept, Method::continuation) || take(from_here(swept.p, 10), Method::newton)) return;
    }
  }

  /// What is likely to be enough from a start that is nearly an answer.
  void run_near() {
    const bool large = is_large(problem_);
    const double target = large ? std::max(options_.target, 0.01 * options_.accept) : options_.target;
    if (wanders(problem_)) {
      along_proximal_points(problem_.start, (large ? 0.1 : 0.01) * options_.accept);
    } else {
      take(newton(linear_, problem_, 0, target, options_.newton_iterations / 6, problem_.start, {}, 1e4),
           Method::newton);
    }
  }

  /// Groups that wander: true when an answer was found, the start for one included.
  bool along_proximal_points(const std::vector<Vec2>& start, double enough) {
    if (!start.empty() && take(SolverAttempt{start}, Method::newton) && best_ <= enough) return true;
    return take(proximal(linear_, problem_, start, enough, most_solves_), Method::continuation) &&
           best_ <= options_.accept;
  }

  /// Sweeps and proximal points in turns: sweeps find what opens and slips where Newton wanders, proximal points carry
  /// forces through the group, which takes sweeps for ever.
  bool swept(std::size_t most) {
    constexpr int sweeps = 1200;
    const double enough = 0.1 * options_.accept;
    const std::vector<Vec2> nowhere(p_.size());
    SolverAttempt turn{p_};
    std::array<double, 3> before{1e300, 1e300, 1e300};  // best of the rounds before
    for (std::size_t k = 0; k < most && best_ <= 0.7 * before[k % 3] && !work().over(); ++k) {
      before[k % 3] = best_;
      sweep(problem_, work(), 0, nowhere, sweeps, turn.p);
      const double residual = judge(problem_, turn.p).residual;
      take(turn, Method::continuation);
      SolverAttempt next = proximal(linear_, problem_, turn.p, enough, 100);
      const bool better = judge(problem_, next.p).residual < residual;
      if (better) turn.p = next.p;
      take(std::move(next), Method::continuation);
      if (best_ <= options_.accept) return true;
    }
    return false;
  }

  /// Interior points until Newton, or proximal points, get home from one of them.
  bool inside(std::size_t most) {
    // What does not end within a minute or two is left to shorter steps.
    if (problem_.contacts() > 5000) most = std::min<std::size_t>(most, 300);
    bool done = false;
    std::size_t factors = 0, counted = 0, programmes = 0;
    interior_point_solve(problem_, most, work(), factors, [&](const std::vector<Vec2>& p) {
      SolverAttempt here{p};
      here.iterations = factors - counted;
      counted = factors;
      // A large group is tried from near answers only. Patience does not end here: nothing else is likelier to help.
      if (is_large(problem_) && judge(problem_, p).residual > 1e-6) {
        take(std::move(here), Method::interior);
        if (best_ <= options_.accept) return true;
        // Now and then sweeps lead on from there.
        ++programmes;
        if (!problem_.rigid || !has_friction(problem_) || !std::has_single_bit(programmes)) return false;
        std::vector<Vec2> turn = p;
        sweep(problem_, work(), 0, turn, 400, turn);
        return (take(SolverAttempt{turn}, Method::interior) && best_ <= options_.accept) ||
               (take(proximal(linear_, problem_, std::move(turn), 0.1 * options_.accept, 60), Method::interior) &&
                best_ <= options_.accept);
      }
      done =
          (take(std::move(here), Method::interior) && best_ <= options_.accept) ||
          (take(newton(linear_, problem_, 0, options_.target, 10, p), Method::interior) && best_ <= options_.accept) ||
          (take(proximal(linear_, problem_, p, 0.1 * options_.accept, 20), Method::interior) &&
           best_ <= options_.accept);
      return done;
    });
    return done;
  }

  /// Proximal points from what is near the end of a path.
  bool along_path(std::size_t most) {
    if (!problem_.rigid || most == 0 || work().over()) return false;
    std::size_t factors = 0, counted = 0;
    bool done = false;
    turning_path(problem_, most, work(), factors, [&](const std::vector<Vec2>& p) {
      iterations_ += factors - counted;
      counted = factors;
      done = (take(proximal(linear_, problem_, p, 0.1 * options_.accept, 30), Method::interior) ||
              take(SolverAttempt{p}, Method::interior)) &&
             best_ <= options_.accept;
      return done;
    });
    iterations_ += factors - counted;
    return done;
  }

  static constexpr std::size_t quick_look = 500;
  static constexpr std::size_t most_for_lemke = 100;
  SolverAttempt pivot() const {
    SolverAttempt tried;
    tried.p = lemke(problem_, work(), tried.iterations);
    return tried;
  }

 private:
  [[nodiscard]] Work& work() const { return linear_.work(); }

  PatternSolver& linear_;
  const ContactProblem& problem_;
  const SolverOptions& options_;
  std::size_t most_solves_;
  std::vector<Vec2> p_;
  double best_ = 1e300;
  Method method_ = Method::none;
  std::size_t iterations_ = 0;
};

/// Nothing pushes: zero impulses solve it.
bool nothing_pushes(const ContactProblem& problem) {
  for (std::size_t k = 0; k < problem.contacts(); ++k) {
    const bool glued = problem.cohesion[k] > 0 || problem.tension[k] > 0;
    if (problem.b[k].x < 0 || (glued && problem.b[k] != Vec2{})) return false;
  }
  return true;
}

}  // namespace

ContactSolution solve(const ContactProblem& problem, const SolverOptions& options) {
  Work work;
  PatternSolver linear{work};
  return solve_again(problem, options, linear);
}

ContactSolution solve_again(const ContactProblem& problem, const SolverOptions& options, PatternSolver& linear) {
  if (nothing_pushes(problem)) {
    ContactSolution solution;
    solution.impulse.resize(problem.contacts());
    solution.report.opened = problem.contacts();
    return solution;
  }
  Cascade tries{linear, problem, options};
  switch (options.method) {
    case Method::none:
    case Method::cascade: tries.run_all(); break;
    case Method::open_close:
      tries.take(open_close(linear, problem, options.open_close_passes), Method::open_close);
      break;
    case Method::newton:
      tries.take(newton(linear, problem, 0, options.target, options.newton_iterations, problem.start), Method::newton);
      break;
    case Method::continuation:
      for (const double factor : {10.0, 3.0, 1.5}) {
        if (tries.take(continuation(linear, problem, options, factor), Method::continuation)) break;
      }
      break;
    case Method::interior: tries.inside(1000); break;
    case Method::lemke:
      if (problem.contacts() <= Cascade::most_for_lemke) tries.take(tries.pivot(), Method::lemke);
      break;
  }
  return tries.finish();
}

ContactSolution solve_near(const ContactProblem& problem, const SolverOptions& options, PatternSolver& linear) {
  Cascade tries{linear, problem, options};
  tries.run_near();
  return tries.finish();
}

}  // namespace cleave::dbem
