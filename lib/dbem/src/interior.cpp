#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "fronts.hpp"
#include "natural_map.hpp"

namespace cleave::dbem {
namespace {

/// Interior points on the law with dilation mu * `slid`: given the speeds of slip, the law is that of a convex
/// quadratic programme over the friction cones (Acary, Cadoux, Lemarechal and Malick 2011, for circular cones), which
/// Mehrotra's predictor and corrector solve in some 25 factors whatever the states of the contacts.
class Interior final {
 public:
  explicit Interior(const ContactProblem& problem)
      : problem_{problem},
        m_{problem.contacts()},
        factor_{m_, 2, links(problem.w)},
        slid_(m_),
        n_(m_),
        t_(m_),
        g_(m_),
        ahead_(m_),
        back_(m_),
        dn_(m_),
        dt_(m_),
        dg_(m_),
        da_(m_),
        db_(m_) {
    for (const Vec2 b : problem.b) speed_ = std::max({speed_, std::abs(b.x), std::abs(b.y)});
  }

  /// Solves for the present speeds of slip; `share`: of the first complementarity at which it is enough. Counts
  /// factors.
  bool solve(double share, std::size_t& factors) {
    double first = -1;
    for (int k = 0; k < 60; ++k) {
      const double gap = complementarity();
      if (first < 0) first = std::max(gap, whole_);
      whole_ = std::max(whole_, first);
      if (!std::isfinite(gap)) return false;
      if (gap <= share * whole_) return true;
      ++factors;
      if (!factorise()) return false;
      direction(0, false);
      const double reach = longest(1);
      const double after = std::max(0.0, complementarity(reach));
      const double centre = std::clamp(std::pow(after / gap, 3), 1e-3, 1.0);
      direction(centre * gap, true);
      double step = longest(0.99);
      if (step < 0.1) {  // the corrector leads out of the cone
        direction(std::max(0.5, centre) * gap, false);
        step = longest(0.95);
      }
      for (std::size_t c = 0; c < m_; ++c) {
        n_[c] += step * dn_[c];
        t_[c] += step * dt_[c];
        g_[c] += step * dg_[c];
        ahead_[c] += step * da_[c];
        back_[c] += step * db_[c];
      }
    }
    return false;
  }

  /// Takes over the speeds of slip found, and moves inwards for the next programme; says by how much they changed, over
  /// the largest speed.
  double renew() {
    double change = 0;
    for (std::size_t c = 0; c < m_; ++c) {
      const double now = std::abs(ahead_[c] - back_[c]);
      change = std::max(change, std::abs(now - slid_[c]));
      slid_[c] = now;
    }
    change /= speed_;
    start(std::clamp(change, 1e-6, 1.0));
    return change;
  }

  /// At least this far inside, over what the loads ask for.
  void start(double inside) {
    for (std::size_t c = 0; c < m_; ++c) {
      const double e = inside * speed_;
      n_[c] = std::max(n_[c], std::sqrt(inside) * speed_ / diagonal(c).xx);
      t_[c] = 0;
      g_[c] = std::max(g_[c], e);
      ahead_[c] = std::max(ahead_[c], e);
      back_[c] = std::max(back_[c], e);
    }
  }

  [[nodiscard]] std::vector<Vec2> impulses() const {
    std::vector<Vec2> p(m_);
    for (std::size_t c = 0; c < m_; ++c) p[c] = {n_[c], t_[c]};
    return p;
  }

 private:
  static std::vector<std::pair<std::uint32_t, std::uint32_t>> links(const BlockMatrix& w) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> out;
    for (std::uint32_t r = 0; r < w.rows(); ++r) {
      for (std::size_t at = w.starts[r]; at < w.starts[r + 1]; ++at) {
        if (r < w.columns[at]) out.emplace_back(r, w.columns[at]);
      }
    }
    return out;
  }
  [[nodiscard]] const bem::Mat2& diagonal(std::size_t c) const { return problem_.w.values[problem_.w.diagonal[c]]; }
  /// No friction, no cohesion: no room for a tangential impulse.
  [[nodiscard]] bool smooth(std::size_t c) const { return problem_.mu[c] <= 0 && problem_.cohesion[c] <= 0; }
  /// Normal impulse above where the contact tears; what is left of friction against either sense of slip.
  [[nodiscard]] double pressed(std::size_t c) const { return n_[c] + problem_.tension[c]; }
  [[nodiscard]] double room_ahead(std::size_t c) const { return problem_.mu[c] * n_[c] + problem_.cohesion[c] + t_[c]; }
  [[nodiscard]] double room_back(std::size_t c) const { return problem_.mu[c] * n_[c] + problem_.cohesion[c] - t_[c]; }

  /// Mean product of what excludes each other, after a share of the direction.
  [[nodiscard]] double complementarity(double share = 0) const {
    double sum = 0;
    for (std::size_t c = 0; c < m_; ++c) {
      const double mu = problem_.mu[c];
      sum += (pressed(c) + share * dn_[c]) * (g_[c] + share * dg_[c]);
      if (smooth(c)) continue;
      sum += (room_ahead(c) + share * (mu * dn_[c] + dt_[c])) * (ahead_[c] + share * da_[c]);
      sum += (room_back(c) + share * (mu * dn_[c] - dt_[c])) * (back_[c] + share * db_[c]);
    }
    return sum / (3 * static_cast<double>(m_));
  }

  /// What the barrier adds to W at a contact.
  [[nodiscard]] bem::Mat2 barrier(std::size_t c) const {
    const double n = g_[c] / pressed(c);
    if (smooth(c)) return {n, 0, 0, 1e12 * diagonal(c).yy};
    const double mu = problem_.mu[c], a = ahead_[c] / room_ahead(c), b = back_[c] / room_back(c);
    return {n + mu * mu * (a + b), mu * (a - b), mu * (a - b), a + b};
  }

  bool factorise() {
    const BlockMatrix& w = problem_.w;
    factor_.clear(true);
    for (std::size_t r = 0; r < m_; ++r) {
      for (std::size_t at = w.starts[r]; at < w.starts[r + 1]; ++at) {
        bem::Mat2 v = w.values[at];
        if (w.columns[at] == r) v += barrier(r);
        auto block = factor_.block(r, w.columns[at]);
        block(0, 0) = v.xx;
        block(0, 1) = v.xy;
        block(1, 0) = v.yx;
        block(1, 1) = v.yy;
      }
    }
    return factor_.factorise();
  }

  /// Newton's direction towards products of `target`, less the second-order part of the direction before.
  void direction(double target, bool corrected) {
    std::vector<Vec2> y = problem_.b, right(m_);
    problem_.w.add_product(impulses(), y);
    for (std::size_t c = 0; c < m_; ++c) {
      const double mu = problem_.mu[c];
      const double of_n = corrected ? dn_[c] * dg_[c] : 0;
      const double kept_g = (target - of_n) / pressed(c) - g_[c];
      right[c].x = g_[c] - y[c].x + kept_g;
      dg_[c] = kept_g;
      if (smooth(c)) {
        right[c].y = 0;
        continue;
      }
      const double of_a = corrected ? da_[c] * (mu * dn_[c] + dt_[c]) : 0;
      const double of_b = corrected ? db_[c] * (mu * dn_[c] - dt_[c]) : 0;
      const double kept_a = (target - of_a) / room_ahead(c) - ahead_[c];
      const double kept_b = (target - of_b) / room_back(c) - back_[c];
      right[c].x += mu * (ahead_[c] + back_[c] - slid_[c] + kept_a + kept_b);
      right[c].y = ahead_[c] - back_[c] - y[c].y + kept_a - kept_b;
      da_[c] = kept_a;
      db_[c] = kept_b;
    }
    Eigen::VectorXd z(2 * static_cast<Eigen::Index>(m_));
    const auto at = [](std::size_t c) { return 2 * static_cast<Eigen::Index>(c); };
    for (std::size_t c = 0; c < m_; ++c) z.segment(at(c), 2) << right[c].x, right[c].y;
    factor_.solve(z);
    // Once more for what rounding left: near the end some barriers are 10^20 times others.
    std::vector<Vec2> x(m_);
    for (std::size_t c = 0; c < m_; ++c) x[c] = {z[at(c)], z[at(c) + 1]};
    std::vector<Vec2> product(m_);
    problem_.w.add_product(x, product);
    for (std::size_t c = 0; c < m_; ++c) {
      const Vec2 left = right[c] - product[c] - barrier(c) * x[c];
      z.segment(at(c), 2) << left.x, left.y;
    }
    factor_.solve(z);
    for (std::size_t c = 0; c < m_; ++c) {
      const double mu = problem_.mu[c];
      dn_[c] = x[c].x + z[at(c)];
      dt_[c] = smooth(c) ? 0.0 : x[c].y + z[at(c) + 1];
      dg_[c] -= g_[c] / pressed(c) * dn_[c];
      if (smooth(c)) continue;
      da_[c] -= ahead_[c] / room_ahead(c) * (mu * dn_[c] + dt_[c]);
      db_[c] -= back_[c] / room_back(c) * (mu * dn_[c] - dt_[c]);
    }
  }

  /// The longest part of the direction that keeps `share` of the way to the boundary.
  [[nodiscard]] double longest(double share) const {
    double step = 1;
    const auto keep = [&](double value, double change) {
      if (change < 0) step = std::min(step, -share * value / change);
    };
    for (std::size_t c = 0; c < m_; ++c) {
      const double mu = problem_.mu[c];
      keep(pressed(c), dn_[c]);
      keep(g_[c], dg_[c]);
      if (smooth(c)) continue;
      keep(room_ahead(c), mu * dn_[c] + dt_[c]);
      keep(room_back(c), mu * dn_[c] - dt_[c]);
      keep(ahead_[c], da_[c]);
      keep(back_[c], db_[c]);
    }
    return step;
  }

  const ContactProblem& problem_;
  std::size_t m_;
  FrontalFactor factor_;
  double speed_ = 0, whole_ = 0;
  std::vector<double> slid_;
  std::vector<double> n_, t_, g_, ahead_, back_;  // impulses; gap speed; slip towards +t (t at its least) and -t
  std::vector<double> dn_, dt_, dg_, da_, db_;
};

}  // namespace

void interior(const ContactProblem& problem, std::size_t most, std::size_t& factors,
              const std::function<bool(const std::vector<Vec2>&)>& enough) {
  Interior inside{problem};
  inside.start(1);
  double share = 1e-6;
  while (factors < most) {
    if (!inside.solve(share, factors)) return;
    if (enough(inside.impulses())) return;
    const double change = inside.renew();
    share = std::clamp(1e-4 * change, 1e-12, 1e-6);
  }
}

}  // namespace cleave::dbem
