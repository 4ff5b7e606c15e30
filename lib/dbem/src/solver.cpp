#include "cleave/dbem/solver.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <span>
#include <utility>

#include "natural_map.hpp"

namespace cleave::dbem {

namespace {

double sign(double x) { return x < 0 ? -1.0 : 1.0; }

/// What to solve next on the natural map: rows by the present state of each contact.
void newton_pattern(const MapEvaluator& evaluator, const NaturalMap& map, Pattern& pattern, std::vector<Vec2>& rhs) {
  const ContactProblem& problem = evaluator.problem();
  const std::size_t m = problem.contacts();
  pattern.closed.resize(m);
  pattern.stuck.resize(m);
  pattern.q.resize(m);
  rhs.resize(m);
  for (std::size_t k = 0; k < m; ++k) {
    const bool closed = map.a_n[k] > -problem.tension[k];
    const bool stuck = map.bound[k] > 0 && std::abs(map.a_t[k]) <= map.bound[k];
    const double q = stuck || !closed || map.bound[k] <= 0 ? 0.0 : sign(map.a_t[k]) * problem.mu[k];
    pattern.closed[k] = closed ? 1 : 0;
    pattern.stuck[k] = stuck ? 1 : 0;
    pattern.q[k] = q;
    const Vec2 f = map.f[k];
    rhs[k].x = closed ? -f.x / evaluator.r_n(k) : -f.x;
    rhs[k].y = stuck ? -f.y / evaluator.r_t(k) : -f.y + q * f.x;
  }
}

struct Tried {
  std::vector<Vec2> p;
  bool converged = false;
  std::size_t iterations = 0;
};

Tried newton(PatternSolver& linear, const ContactProblem& problem, double soft, double tolerance, std::size_t most,
             std::vector<Vec2> start, std::span<const Vec2> centre = {}, double give_up = 1e300) {
  const MapEvaluator evaluator{problem, soft, centre};
  Tried tried{std::move(start)};
  if (tried.p.empty()) tried.p.resize(problem.contacts());
  NaturalMap map, trial;
  Pattern pattern;
  std::vector<Vec2> rhs, next(problem.contacts());
  evaluator.evaluate(tried.p, map);
  std::size_t caught = 0;
  const double hopeless = give_up * map.squared;
  double least = map.squared;
  std::size_t rounds = 0;
  while (tried.iterations < most) {
    if (evaluator.residual(map, tried.p) <= tolerance) {
      tried.converged = true;
      return tried;
    }
    newton_pattern(evaluator, map, pattern, rhs);
    const std::vector<Vec2> d = linear.solve(problem, soft, pattern, rhs);
    ++tried.iterations;
    if (d.empty()) return tried;
    const auto at = [&](double step) {
      for (std::size_t k = 0; k < d.size(); ++k) next[k] = tried.p[k] + step * d[k];
      evaluator.evaluate(next, trial);
    };
    double step = 1;
    bool less = false;
    double best_step = 1, best_squared = 1e300;
    for (int halvings = 0; halvings <= 2; ++halvings, step *= 0.5) {
      at(step);
      if (trial.squared < best_squared) {
        best_squared = trial.squared;
        best_step = step;
      }
      if (trial.squared <= (1 - 1e-4 * step) * map.squared) {
        less = true;
        break;
      }
    }
    if (!less && evaluator.residual(map, tried.p) <= 1e-10) break;  // nothing but rounding is left
    // A full step often leaves the corner a short one is caught in; when that goes round in circles, the best one.
    if (!less) at(++caught % 2 == 1 ? 1.0 : std::max(best_step, 0.1));
    std::swap(tried.p, next);
    std::swap(map, trial);
    if (map.squared > hopeless) return tried;
    // About a centre, what goes round in circles is helped by more weight on the centre, not by patience.
    rounds = map.squared < 0.9 * least ? 0 : rounds + 1;
    least = std::min(least, map.squared);
    if (!centre.empty() && is_large(problem) && rounds >= 8) return tried;
  }
  tried.converged = evaluator.residual(map, tried.p) <= std::max(tolerance, 1e-10);
  return tried;
}

/// One linear solve with each contact in the state its force tells: open without one, slipping at the bound, else
/// stuck. From step to step few states change, while the natural map at the old forces takes many for changed.
Tried keep_states(PatternSolver& linear, const ContactProblem& problem, const std::vector<Vec2>& start,
                  double soft = 0) {
  const std::size_t m = problem.contacts();
  Tried tried;
  Pattern pattern{std::vector<std::uint8_t>(m), std::vector<std::uint8_t>(m), std::vector<double>(m)};
  std::vector<Vec2> rhs(m);
  for (std::size_t k = 0; k < m; ++k) {
    const Vec2 p = start[k];
    const double bound = problem.mu[k] * p.x + problem.cohesion[k];
    const bool closed = p.x > -problem.tension[k];
    const bool stuck = closed && bound > 0 && std::abs(p.y) < bound * (1 - 1e-9);
    const double sense = sign(p.y);
    pattern.closed[k] = closed ? 1 : 0;
    pattern.stuck[k] = stuck ? 1 : 0;
    pattern.q[k] = closed && !stuck ? sense * problem.mu[k] : 0.0;
    const bem::Mat2& d = problem.w.values[problem.w.diagonal[k]];
    rhs[k].x = closed ? -problem.b[k].x + soft * d.xx * p.x : -problem.tension[k];
    rhs[k].y = stuck ? -problem.b[k].y + soft * d.yy * p.y : closed ? sense * problem.cohesion[k] : p.y;
  }
  tried.p = linear.solve(problem, soft, pattern, rhs);
  tried.iterations = 1;
  if (tried.p.empty()) tried.p = start;
  return tried;
}

enum class State : std::uint8_t { open, slip, stick };

/// Shi's iteration with implicit friction in the slip rows. Starts from all contacts closed and stuck.
Tried open_close(PatternSolver& linear, const ContactProblem& problem, std::size_t passes) {
  const std::size_t m = problem.contacts();
  std::vector<State> state(m, State::stick);
  std::vector<double> sense(m, 1);  // of slip
  Tried tried;
  Pattern pattern{std::vector<std::uint8_t>(m), std::vector<std::uint8_t>(m), std::vector<double>(m)};
  std::vector<Vec2> rhs(m);
  std::vector<Vec2> y;
  for (tried.iterations = 1; tried.iterations <= passes; ++tried.iterations) {
    for (std::size_t k = 0; k < m; ++k) {
      const bool slips = state[k] == State::slip;
      pattern.closed[k] = state[k] == State::open ? 0 : 1;
      pattern.stuck[k] = state[k] == State::stick ? 1 : 0;
      pattern.q[k] = slips ? -sense[k] * problem.mu[k] : 0.0;
      rhs[k] = -problem.b[k];
      if (state[k] == State::open) rhs[k] = {-problem.tension[k], 0};
      if (slips) rhs[k].y = -sense[k] * problem.cohesion[k];
    }
    std::vector<Vec2> p = linear.solve(problem, 0, pattern, rhs);
    if (p.empty()) return tried;
    tried.p = std::move(p);
    y = problem.b;
    problem.w.add_product(tried.p, y);
    bool same = true;
    for (std::size_t k = 0; k < m; ++k) {
      const double bound = problem.mu[k] * tried.p[k].x + problem.cohesion[k];
      State now = state[k];
      switch (state[k]) {
        case State::open:
          if (y[k].x < 0) now = State::stick;
          break;
        case State::stick:
        case State::slip:
          if (tried.p[k].x < -problem.tension[k]) {
            now = State::open;
          } else if (state[k] == State::stick) {
            if (std::abs(tried.p[k].y) > bound) {
              now = State::slip;
              sense[k] = -sign(tried.p[k].y);
            }
          } else if (y[k].y * sense[k] < 0) {
            now = State::stick;
          }
          break;
      }
      same = same && now == state[k];
      state[k] = now;
    }
    if (same) {
      tried.converged = true;
      return tried;
    }
  }
  tried.iterations = passes;
  return tried;
}

/// Newton from the side of soft contacts: W + e diag(W), e falling from 1 by `factor`.
Tried continuation(PatternSolver& linear, const ContactProblem& problem, const SolverOptions& options, double factor) {
  Tried tried;
  std::size_t iterations = 0;
  for (double soft = 1; soft > 1e-9 && iterations < options.patience; soft /= factor) {
    Tried stage = newton(linear, problem, soft, 1e-8, 40, std::move(tried.p));
    iterations += stage.iterations;
    tried = std::move(stage);
  }
  tried = newton(linear, problem, 0, options.target, options.newton_iterations, std::move(tried.p));
  tried.iterations += iterations;
  return tried;
}

/// Sweeps over the contacts, each solved alone (block Gauss-Seidel), on W + e diag(W) about `centre`. A cheap start for
/// Newton where e is large.
void sweep(const ContactProblem& problem, double soft, const std::vector<Vec2>& centre, int sweeps,
           std::vector<Vec2>& p) {
  const BlockMatrix& w = problem.w;
  for (int pass = 0; pass < sweeps; ++pass) {
    for (std::size_t at = 0; at < p.size(); ++at) {
      const std::size_t k = pass % 2 == 0 ? at : p.size() - 1 - at;
      Vec2 y = problem.b[k];
      for (std::size_t q = w.starts[k]; q < w.starts[k + 1]; ++q) y += w.values[q] * p[w.columns[q]];
      const bem::Mat2& d = w.values[w.diagonal[k]];
      y += soft * Vec2{d.xx * (p[k].x - centre[k].x), d.yy * (p[k].y - centre[k].y)};
      const double n = std::max(p[k].x - y.x / ((1 + soft) * d.xx), -problem.tension[k]);
      y.y += d.yx * (n - p[k].x);
      const double bound = std::max(0.0, problem.mu[k] * n + problem.cohesion[k]);
      p[k] = {n, std::clamp(p[k].y - y.y / ((1 + soft) * d.yy), -bound, bound)};
    }
  }
}

/// Proximal points: Newton on W + e diag(W) about the last answer, e as small as Newton bears. Forces that equilibrium
/// leaves open stay where they are instead of swinging, and what equilibrium fixes converges by e / (e + sigma). Inner
/// answers need be no better than the outer ones (Rockafellar 1976).
Tried proximal(PatternSolver& linear, const ContactProblem& given, std::vector<Vec2> start, double enough,
               std::size_t patience) {
  ContactProblem problem = given;  // its regularisation moves along with the centre
  const bool cold = start.empty();
  Tried tried{std::move(start)};
  if (cold) tried.p.resize(problem.contacts());
  std::vector<Vec2> centre = tried.p;
  double best = cold ? 1.0 : judge(given, tried.p).residual;
  double soft = cold ? 1.0 : std::clamp(1e3 * best, 1e-6, 1e-2);
  if (cold) {
    sweep(problem, soft, centre, 50, tried.p);
  } else if (is_large(problem)) {
    tried = keep_states(linear, problem, centre, soft);
  }
  std::size_t stale = 0, easy = 0;
  double least = 1e-10;
  for (int outer = 0; outer < 60 && stale < 8 && tried.iterations < patience; ++outer) {
    const double inner = std::clamp(1e-2 * best, 0.1 * enough, 1e-3);
    Tried stage = newton(linear, problem, soft, inner, 40, tried.p, centre);
    tried.iterations += stage.iterations;
    if (!stage.converged) {
      least = std::min(3 * soft, 1.0);  // Newton cannot follow further down
      soft *= 4;
      if (soft > 1e2) break;
      tried.p = centre;
      continue;
    }
    const double residual = judge(given, stage.p).residual;
    stale = residual < 0.9 * best ? 0 : stale + 1;
    best = std::min(best, residual);
    tried.p = centre = std::move(stage.p);
    for (std::size_t k = 0; k < given.yielding.size(); ++k) {
      const Vec2 off = centre[k] - given.start[k];
      problem.b[k] = given.b[k] - Vec2{given.yielding[k].x * off.x, given.yielding[k].y * off.y};
    }
    if (residual <= enough) {
      tried.converged = true;
      break;
    }
    easy = stage.iterations <= 3 ? easy + 1 : 0;
    if (easy >= 3) {  // what Newton could not follow before it may follow from here
      least = std::max(0.3 * least, 1e-10);
      easy = 0;
    }
    if (stage.iterations <= 20 || stale > 0) soft = std::max((stage.iterations <= 6 ? 0.1 : 0.3) * soft, least);
  }
  return tried;
}

class Cascade final {
 public:
  Cascade(PatternSolver& linear, const ContactProblem& problem, const SolverOptions& options)
      : linear_{linear}, problem_{problem}, options_{options} {}

  /// Takes an answer if it is the best so far; true when that is good enough, or patience is at an end.
  bool take(Tried tried, Method method) {
    iterations_ += tried.iterations;
    if (tried.p.size() != problem_.contacts()) return false;
    const double residual = judge(problem_, tried.p).residual;
    if (!std::isnan(residual) && residual < best_) {
      best_ = residual;
      method_ = method;
      p_ = std::move(tried.p);
    }
    return best_ <= options_.accept || iterations_ >= options_.patience;
  }

  /// One more try from the best answer found.
  [[nodiscard]] const std::vector<Vec2>& best() const { return p_; }

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

  void run_all() {
    const bool warm = std::ranges::any_of(problem_.start, [](Vec2 v) { return v.x != 0 || v.y != 0; });
    const bool large = is_large(problem_);
    // Linear solves of large groups are not spent on digits far below what is promised.
    const double target = large ? std::max(options_.target, 0.01 * options_.accept) : options_.target;
    const auto from_here = [&](std::vector<Vec2> start, std::size_t most) {
      return newton(linear_, problem_, 0, target, most, std::move(start));
    };
    const auto shi = [&] {
      return take(open_close(linear_, problem_, options_.open_close_passes), Method::open_close);
    };
    const std::size_t most = options_.newton_iterations;
    // Large groups of rigid bodies have far more forces than freedoms: plain Newton wanders among them.
    const bool wanders = large && problem_.rigid.has_value();
    const double enough = (wanders ? 0.1 : 0.01) * options_.accept;
    if (wanders) {
      if (warm && take(Tried{problem_.start}, Method::newton) && best_ <= enough) return;
      // Forces that nobody knows yet, of thousands of contacts: sweeps do not carry them through the group.
      if (!warm && problem_.contacts() > 3000 && inside(1000)) return;
      if (take(proximal(linear_, problem_, warm ? problem_.start : std::vector<Vec2>{}, enough, options_.patience),
               Method::continuation) &&
          best_ <= options_.accept) {
        return;
      }
    } else {
      if (!warm && shi()) return;
      // From a warm start a few iterations do or none will.
      if (warm) {
        Tried kept = keep_states(linear_, problem_, problem_.start);
        iterations_ += kept.iterations;
        if (take(newton(linear_, problem_, 0, target, most / 6, std::move(kept.p), {}, 1e4), Method::newton)) return;
        if (!large && take(from_here(problem_.start, most / 6), Method::newton)) return;
      }
      if (warm && !large && shi()) return;
      if (!large && take(from_here({}, most / 2), Method::newton)) return;
      if (take(proximal(linear_, problem_, warm ? problem_.start : std::vector<Vec2>{}, enough, options_.patience),
               Method::continuation) &&
          best_ <= options_.accept) {
        take(from_here(p_, 5), Method::continuation);  // the last digits
        return;
      }
    }
    if (wanders && swept()) return;
    // Rather than cut the step of a large group at once: what made it hard is often there in a shorter one, too.
    if (iterations_ >= options_.patience) {
      if (large) inside(wanders ? 150 : 1000);
      return;
    }
    // What else there is needs thousands of linear solves there, and never got home.
    if (wanders && problem_.contacts() > 300) {
      inside(1000);
      return;
    }
    if (wanders && shi()) return;
    if (take(from_here({}, most), Method::newton)) return;
    if (warm && take(proximal(linear_, problem_, {}, enough, options_.patience), Method::continuation)) return;
    for (const double factor : {10.0, 3.0, 1.5}) {
      if (take(continuation(linear_, problem_, options_, factor), Method::continuation)) return;
    }
    Tried longer = open_close(linear_, problem_, 10 * options_.open_close_passes);
    std::vector<Vec2> state = longer.p;
    if (take(std::move(longer), Method::open_close)) return;
    if (!state.empty() && take(from_here(std::move(state), most), Method::newton)) return;
    if (problem_.contacts() <= 3 * most_for_lemke && take(pivot(), Method::lemke)) return;
    if (take(from_here(p_, most), Method::newton)) return;
    if (inside(1000)) return;
    // Sweeps creep up to an answer where Newton goes round in circles between the states of a few contacts.
    Tried swept{p_};
    for (int more = 0; more < 4; ++more) {
      const std::vector<Vec2> nowhere(swept.p.size());
      sweep(problem_, 0, nowhere, 500, swept.p);
      if (take(swept, Method::continuation) || take(from_here(swept.p, 10), Method::newton)) return;
    }
  }

  /// Sweeps and proximal points in turns: sweeps find what opens and slips where Newton wanders, proximal points carry
  /// forces through the group, which takes sweeps for ever.
  bool swept() {
    constexpr std::size_t most = 12;
    constexpr int sweeps = 400;
    const double enough = 0.1 * options_.accept;
    const std::vector<Vec2> nowhere(p_.size());
    Tried turn{p_};
    std::array<double, 3> before{1e300, 1e300, 1e300};  // best of the rounds before
    for (std::size_t k = 0; k < most && best_ <= 0.7 * before[k % 3]; ++k) {
      before[k % 3] = best_;
      sweep(problem_, 0, nowhere, sweeps, turn.p);
      const double residual = judge(problem_, turn.p).residual;
      take(turn, Method::continuation);
      Tried next = proximal(linear_, problem_, turn.p, enough, 100);
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
    interior(problem_, most, factors, [&](const std::vector<Vec2>& p) {
      Tried here{p};
      here.iterations = factors - counted;
      counted = factors;
      // A large group is tried from near answers only. Patience does not end here: nothing else is likelier to help.
      if (is_large(problem_) && judge(problem_, p).residual > 1e-6) {
        take(std::move(here), Method::interior);
        // Now and then sweeps lead on from there.
        ++programmes;
        if (!problem_.rigid || !std::has_single_bit(programmes)) return false;
        std::vector<Vec2> turn = p;
        sweep(problem_, 0, turn, 400, turn);
        return (take(Tried{turn}, Method::interior) && best_ <= options_.accept) ||
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

  static constexpr std::size_t most_for_lemke = 100;
  Tried pivot() const {
    Tried tried;
    tried.p = lemke(problem_, tried.iterations);
    return tried;
  }

 private:
  PatternSolver& linear_;
  const ContactProblem& problem_;
  const SolverOptions& options_;
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
  PatternSolver linear;
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

}  // namespace cleave::dbem
