#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "barrier_factor.hpp"
#include "natural_map.hpp"

namespace cleave::dbem {
namespace {

/// Shares of the first complementarity at which a programme ends. Speeds that its contacts hardly decide are known to
/// the root of it.
constexpr double rough = 1e-6, fine = 1e-10;

/// Of one contact: impulses, what excludes them, and what is left of each bound, which carries digits that its
/// difference would lose.
struct PrimalDual {
  double n = 0, t = 0;
  double pressed = 0;                    // n + tension
  double open = 0;                       // speed of the gap
  double room_ahead = 0, room_back = 0;  // mu n + c + t, mu n + c - t
  double ahead = 0, back = 0;            // speeds of slip towards +t (t at its least) and -t
};

/// Interior points on the law with dilation mu * `slid`: given the speeds of slip, the law is that of a convex
/// quadratic programme over the friction cones (Acary, Cadoux, Lemarechal and Malick 2011, for circular cones), which
/// Mehrotra's predictor and corrector solve in some 25 factors whatever the states of the contacts.
class Interior final {
 public:
  Interior(const ContactProblem& problem, Work& work)
      : problem_{problem},
        work_{work},
        m_{problem.contacts()},
        factor_{problem, work},
        slid_(m_),
        slip_error_(m_),
        at_(m_),
        path_{},
        d_(m_) {
    for (const Vec2 b : problem.b) speed_ = std::max({speed_, std::abs(b.x), std::abs(b.y)});
    guess_slip();
    start(1);
  }

  /// Solves for the present speeds of slip; `share`: of the first complementarity at which it is enough. Counts
  /// factors.
  bool solve(double share, std::size_t& factors) {
    for (int k = 0; k < 60 && !work_.over(); ++k) {
      const double gap = complementarity();
      if (k == 0) whole_ = std::max(whole_, gap);
      if (!std::isfinite(gap)) return false;
      if (gap <= share * whole_) return true;
      if (gap <= 0.1 * whole_) path_.push_back({gap / whole_, at_});
      ++factors;
      const std::optional<double> step = factorise() ? direct(gap) : std::nullopt;
      // Near the end rounding may be all that is left of a direction.
      if (!step) return gap <= rough * whole_;
      for (std::size_t c = 0; c < m_; ++c) {
        at_[c].n += *step * d_[c].n;
        at_[c].t += *step * d_[c].t;
        at_[c].pressed += *step * d_[c].pressed;
        at_[c].open += *step * d_[c].open;
        at_[c].room_ahead += *step * d_[c].room_ahead;
        at_[c].room_back += *step * d_[c].room_back;
        at_[c].ahead += *step * d_[c].ahead;
        at_[c].back += *step * d_[c].back;
      }
    }
    return false;
  }

  /// How far the speeds of slip are from those the programme was made with, over the largest speed.
  [[nodiscard]] double change() const {
    double most = 0;
    for (std::size_t c = 0; c < m_; ++c) most = std::max(most, std::abs(found_slip(c) - slid_[c]));
    return most / speed_;
  }

  /// Moves the speeds of slip towards those found, and goes back along the way to where the next programme has room to
  /// begin; says how far apart they were.
  double renew() {
    const double found = change();
    double own = 0, both = 0, before = 0;
    for (std::size_t c = 0; c < m_; ++c) {
      const double off = found_slip(c) - slid_[c];
      own += off * off;
      both += off * slip_error_[c];
      before += slip_error_[c] * slip_error_[c];
      slip_error_[c] = off;
    }
    // Speeds that change on as they did before have far to go: twice as fast. Where they turn round: half.
    if (own > 0 && before > 0) {
      const double alike = both / (std::sqrt(own) * std::sqrt(before));
      if (alike > 0.9) {
        damping_ *= 2;
      } else if (alike <= 0.5) {
        damping_ = std::max(0.5 * damping_, alike < 0 ? 0.25 : 1.0);
      }
    }
    for (std::size_t c = 0; c < m_; ++c) slid_[c] = std::max(0.0, slid_[c] + damping_ * slip_error_[c]);
    while (!path_.empty() && path_.back().share < 0.1 * found) path_.pop_back();
    if (path_.empty()) {
      start(std::clamp(found, 1e-6, 1.0));
    } else {
      at_ = std::move(path_.back().at);
      path_.pop_back();
    }
    return found;
  }

  [[nodiscard]] std::vector<Vec2> impulses() const {
    std::vector<Vec2> p(m_);
    for (std::size_t c = 0; c < m_; ++c) p[c] = {at_[c].n, at_[c].t};
    return p;
  }

 private:
  struct Checkpoint {
    double share;  // of the first complementarity
    std::vector<PrimalDual> at;
  };

  [[nodiscard]] const bem::Mat2& diagonal(std::size_t c) const { return problem_.w.values[problem_.w.diagonal[c]]; }
  /// No friction, no cohesion: no room for a tangential impulse.
  [[nodiscard]] bool smooth(std::size_t c) const { return problem_.mu[c] <= 0 && problem_.cohesion[c] <= 0; }
  [[nodiscard]] double found_slip(std::size_t c) const { return std::abs(at_[c].ahead - at_[c].back); }

  [[nodiscard]] std::vector<Vec2> velocities(const std::vector<Vec2>& p) const {
    std::vector<Vec2> y = problem_.b;
    problem_.w.add_product(p, y);
    return y;
  }

  /// Speeds of slip under the forces of a warm start: what slides, slides on.
  void guess_slip() {
    if (problem_.start.empty()) return;
    const std::vector<Vec2> y = velocities(problem_.start);
    for (std::size_t c = 0; c < m_; ++c) {
      const Vec2 p = problem_.start[c];
      const double bound = problem_.mu[c] * p.x + problem_.cohesion[c];
      if (p.x > 0 && std::abs(p.y) >= bound * (1 - 1e-6)) slid_[c] = std::abs(y[c].y);
    }
  }

  /// At least this far inside, over what the loads ask for.
  void start(double inside) {
    for (std::size_t c = 0; c < m_; ++c) {
      PrimalDual& v = at_[c];
      const double e = inside * speed_;
      v.n = std::max(v.n, std::sqrt(inside) * speed_ / diagonal(c).xx);
      v.t = 0;
      v.pressed = v.n + problem_.tension[c];
      v.room_ahead = v.room_back = problem_.mu[c] * v.n + problem_.cohesion[c];
      v.open = std::max(v.open, e);
      v.ahead = std::max(v.ahead, e);
      v.back = std::max(v.back, e);
    }
  }

  /// Mean product of what excludes each other, after a share of the direction.
  [[nodiscard]] double complementarity(double share = 0) const {
    double sum = 0;
    for (std::size_t c = 0; c < m_; ++c) {
      const PrimalDual &v = at_[c], &d = d_[c];
      sum += (v.pressed + share * d.pressed) * (v.open + share * d.open);
      if (smooth(c)) continue;
      sum += (v.room_ahead + share * d.room_ahead) * (v.ahead + share * d.ahead);
      sum += (v.room_back + share * d.room_back) * (v.back + share * d.back);
    }
    return sum / (3 * static_cast<double>(m_));
  }

  bool factorise() {
    std::vector<Barrier> added(m_);
    for (std::size_t c = 0; c < m_; ++c) {
      const PrimalDual& v = at_[c];
      added[c].normal = v.open / v.pressed;
      if (smooth(c)) {
        added[c].back = 1e12 * diagonal(c).yy;
      } else {
        added[c].ahead = v.ahead / v.room_ahead;
        added[c].back = v.back / v.room_back;
      }
    }
    return factor_.compute(std::move(added));
  }

  /// Mehrotra's direction, in `d_`, and how much of it to go; nothing where rounding is all that is left.
  std::optional<double> direct(double gap) {
    if (!direct(0, false)) return {};
    const double after = std::max(0.0, complementarity(longest(1)));
    const double centre = std::clamp(std::pow(after / gap, 3), 1e-3, 1.0);
    if (!direct(centre * gap, true)) return {};
    const double step = longest(0.99);
    if (step >= 0.1) return step;
    // The corrector leads out of the cone.
    if (!direct(std::max(0.5, centre) * gap, false)) return {};
    return longest(0.95);
  }

  /// Newton's direction towards products of `target`, less the second-order part of the direction before.
  bool direct(double target, bool corrected) {
    const std::vector<Vec2> y = velocities(impulses());
    std::vector<Vec2> right(m_), z;
    for (std::size_t c = 0; c < m_; ++c) {
      const PrimalDual& v = at_[c];
      PrimalDual& d = d_[c];
      const double mu = problem_.mu[c], sense = factor_.sense(c);
      d.open = (target - (corrected ? d.pressed * d.open : 0)) / v.pressed;
      if (smooth(c)) {
        right[c] = {d.open - y[c].x, 0};
        continue;
      }
      d.ahead = (target - (corrected ? d.ahead * d.room_ahead : 0)) / v.room_ahead;
      d.back = (target - (corrected ? d.back * d.room_back : 0)) / v.room_back;
      const double near = sense > 0 ? d.back : d.ahead, far = sense > 0 ? d.ahead : d.back;
      right[c] = {d.open - y[c].x - mu * (slid_[c] + sense * y[c].y - 2 * far), near - far + sense * y[c].y};
    }
    if (!factor_.solve(right, z)) return false;
    for (std::size_t c = 0; c < m_; ++c) {
      const PrimalDual& v = at_[c];
      PrimalDual& d = d_[c];
      const double mu = problem_.mu[c], sense = factor_.sense(c);
      d.n = d.pressed = z[c].x;
      d.open -= v.open + v.open / v.pressed * d.pressed;
      if (smooth(c)) continue;
      d.t = sense * (mu * z[c].x - z[c].y);
      d.room_ahead = d.room_back = z[c].y;
      (sense > 0 ? d.room_ahead : d.room_back) = 2 * mu * z[c].x - z[c].y;
      d.ahead -= v.ahead + v.ahead / v.room_ahead * d.room_ahead;
      d.back -= v.back + v.back / v.room_back * d.room_back;
    }
    return true;
  }

  /// The longest part of the direction that keeps `share` of the way to the boundary.
  [[nodiscard]] double longest(double share) const {
    double step = 1;
    const auto keep = [&](double value, double change) {
      if (change < 0) step = std::min(step, -share * value / change);
    };
    for (std::size_t c = 0; c < m_; ++c) {
      const PrimalDual &v = at_[c], &d = d_[c];
      keep(v.pressed, d.pressed);
      keep(v.open, d.open);
      if (smooth(c)) continue;
      keep(v.room_ahead, d.room_ahead);
      keep(v.room_back, d.room_back);
      keep(v.ahead, d.ahead);
      keep(v.back, d.back);
    }
    return step;
  }

  const ContactProblem& problem_;
  Work& work_;
  std::size_t m_;
  BarrierFactor factor_;
  double speed_ = 0, whole_ = 0, damping_ = 1;
  std::vector<double> slid_, slip_error_;  // speeds of slip; how far off they were
  std::vector<PrimalDual> at_;
  std::vector<Checkpoint> path_;
  std::vector<PrimalDual> d_;
};

}  // namespace

void interior_point_solve(const ContactProblem& problem, std::size_t most, Work& work, std::size_t& factors,
                          const std::function<bool(const std::vector<Vec2>&)>& enough) {
  Interior inside{problem, work};
  double share = rough;
  while (factors < most) {
    if (!inside.solve(share, factors)) return;
    // Speeds of slip that stay let one programme go on to its digits; what comes after an answer is dear in large
    // groups, and seldom gets home from a rough one.
    const bool goes_on = share > fine && inside.change() <= 1e-4;
    if (!(goes_on && is_large(problem) && has_friction(problem)) && enough(inside.impulses())) return;
    if (goes_on) {
      share = fine;
      continue;
    }
    const double change = inside.renew();
    if (change == 0) return;  // the next programme would be the same
    share = std::clamp(1e-2 * change * change, 1e-18, rough);
  }
}

}  // namespace cleave::dbem
