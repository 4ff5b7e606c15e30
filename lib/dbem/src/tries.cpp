#include "tries.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

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

enum class State : std::uint8_t { open, slip, stick };

}  // namespace

SolverAttempt newton(PatternSolver& linear, const ContactProblem& problem, double soft, double tolerance,
                     std::size_t most, std::vector<Vec2> start, std::span<const Vec2> centre, double give_up) {
  const MapEvaluator evaluator{problem, soft, centre};
  SolverAttempt tried{std::move(start)};
  if (tried.p.empty()) tried.p.resize(problem.contacts());
  NaturalMap map, trial;
  Pattern pattern;
  std::vector<Vec2> rhs, next(problem.contacts());
  evaluator.evaluate(tried.p, map);
  std::size_t caught = 0;
  const double diverged = give_up * map.squared;
  double least = map.squared;
  std::size_t rounds = 0;
  const double evaluation = product_work(problem) + 40 * static_cast<double>(problem.contacts());
  while (tried.iterations < most && !linear.work().over()) {
    if (evaluator.residual(map, tried.p) <= tolerance) {
      tried.converged = true;
      return tried;
    }
    newton_pattern(evaluator, map, pattern, rhs);
    const auto solved = linear.solve(problem, soft, pattern, rhs);
    ++tried.iterations;
    if (!solved) return tried;
    const std::vector<Vec2>& d = *solved;
    const auto at = [&](double step) {
      for (std::size_t k = 0; k < d.size(); ++k) next[k] = tried.p[k] + step * d[k];
      evaluator.evaluate(next, trial);
      linear.work().add(evaluation);
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
    // A full step often leaves the corner a short one is caught in; when that stagnates, the best one.
    if (!less) at(++caught % 2 == 1 ? 1.0 : std::max(best_step, 0.1));
    std::swap(tried.p, next);
    std::swap(map, trial);
    if (map.squared > diverged) return tried;
    // About a centre, what stagnates is helped by more weight on the centre, not by patience.
    rounds = map.squared < 0.9 * least ? 0 : rounds + 1;
    least = std::min(least, map.squared);
    if (!centre.empty() && (is_large(problem) || wanders(problem)) && rounds >= 8) return tried;
  }
  tried.converged = evaluator.residual(map, tried.p) <= std::max(tolerance, 1e-10);
  return tried;
}

SolverAttempt frozen_state_solve(PatternSolver& linear, const ContactProblem& problem, const std::vector<Vec2>& start,
                                 double soft) {
  const std::size_t m = problem.contacts();
  SolverAttempt tried;
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
  tried.p = linear.solve(problem, soft, pattern, rhs).value_or(start);
  tried.iterations = 1;
  return tried;
}

SolverAttempt open_close(PatternSolver& linear, const ContactProblem& problem, std::size_t passes) {
  const std::size_t m = problem.contacts();
  std::vector<State> state(m, State::stick);
  std::vector<double> sense(m, 1);  // of slip
  SolverAttempt tried;
  Pattern pattern{std::vector<std::uint8_t>(m), std::vector<std::uint8_t>(m), std::vector<double>(m)};
  std::vector<Vec2> rhs(m);
  std::vector<Vec2> y;
  for (tried.iterations = 1; tried.iterations <= passes && !linear.work().over(); ++tried.iterations) {
    for (std::size_t k = 0; k < m; ++k) {
      const bool slips = state[k] == State::slip;
      pattern.closed[k] = state[k] == State::open ? 0 : 1;
      pattern.stuck[k] = state[k] == State::stick ? 1 : 0;
      pattern.q[k] = slips ? -sense[k] * problem.mu[k] : 0.0;
      rhs[k] = -problem.b[k];
      if (state[k] == State::open) rhs[k] = {-problem.tension[k], 0};
      if (slips) rhs[k].y = -sense[k] * problem.cohesion[k];
    }
    auto p = linear.solve(problem, 0, pattern, rhs);
    if (!p) return tried;
    tried.p = *std::move(p);
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
  tried.iterations = std::min(tried.iterations, passes);
  return tried;
}

SolverAttempt continuation(PatternSolver& linear, const ContactProblem& problem, const SolverOptions& options,
                           double factor) {
  SolverAttempt tried;
  std::size_t iterations = 0;
  for (double soft = 1;
       soft > 1e-9 && (!options.max_linear_solves || iterations < *options.max_linear_solves) && !linear.work().over();
       soft /= factor) {
    SolverAttempt stage = newton(linear, problem, soft, 1e-8, 40, std::move(tried.p));
    iterations += stage.iterations;
    tried = std::move(stage);
  }
  tried = newton(linear, problem, 0, options.target, options.newton_iterations, std::move(tried.p));
  tried.iterations += iterations;
  return tried;
}

void sweep(const ContactProblem& problem, Work& work, double soft, const std::vector<Vec2>& centre, int sweeps,
           std::vector<Vec2>& p) {
  const BlockMatrix& w = problem.w;
  work.add(sweeps * (product_work(problem) + 30 * static_cast<double>(p.size())));
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

SolverAttempt proximal(PatternSolver& linear, const ContactProblem& given, std::vector<Vec2> start, double enough,
                       std::size_t max_linear_solves) {
  ContactProblem problem = given;  // its regularisation moves along with the centre
  const bool cold = start.empty();
  SolverAttempt tried{std::move(start)};
  if (cold) tried.p.resize(problem.contacts());
  std::vector<Vec2> centre = tried.p;
  double best = cold ? 1.0 : judge(given, tried.p).residual;
  double soft = cold ? 1.0 : std::clamp(1e3 * best, 1e-6, 1e-2);
  if (cold) {
    sweep(problem, linear.work(), soft, centre, 50, tried.p);
  } else if (is_large(problem) || wanders(problem)) {
    tried = frozen_state_solve(linear, problem, centre, soft);
  }
  std::size_t stale = 0, easy = 0;
  double least = 1e-10;
  for (int outer = 0; outer < 60 && stale < 8 && tried.iterations < max_linear_solves && !linear.work().over();
       ++outer) {
    const double inner = std::clamp(1e-2 * best, 0.1 * enough, 1e-3);
    SolverAttempt stage = newton(linear, problem, soft, inner, 40, tried.p, centre);
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

}  // namespace cleave::dbem
