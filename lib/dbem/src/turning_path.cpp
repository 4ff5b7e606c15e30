#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "natural_map.hpp"
#include "path_factor.hpp"

namespace cleave::dbem {
namespace {

/// What is positive at one contact, in pairs that exclude each other at the end: n + tension and the speed of the gap;
/// the room before slip towards -t and its speed; the room towards +t and its speed.
using Inner = std::array<double, 6>;
using Products = std::array<double, 3>;

/// A direction along the path: relative changes of what is positive, and of the share.
struct Direction {
  std::vector<Inner> of;
  double share = 0;
};

/// How far the products of a point on the path may be from their own, relative.
constexpr double near_path = 0.1;
/// A point may be this far off for Newton's method to be tried from there.
constexpr double far_off = 50;
/// Cosine of the largest turn between two points, unless the step is already this short.
constexpr double most_turned = 0.5, short_step = 1e-2;
/// Shares of the way to the boundary.
constexpr double first_step = 0.3, shortest_step = 1e-10, longest_step = 0.95;
constexpr int most_corrections = 6;
/// Factors a path is given before another one is drawn; share from which on an answer may be near.
constexpr std::size_t most_of_one_path = 2500;
constexpr double first_look = 1e-5, end_of_path = 1e-12, astray = 1e3;

/// The path of Newton's homotopy from some inner point to an answer of the contact law (Lemke's path, smoothed):
///   y_n - open = share * a,  y_t - ahead + back = 0,  products of pairs = share * those of the first point.
/// At large shares it has one point. The law is not monotone, so the path turns: which way it goes on is told by the
/// sign of the determinant (Smale 1976), also where a step has left it for a neighbouring piece.
class TurningPath final {
 public:
  TurningPath(const ContactProblem& problem, Work& work, std::uint64_t draw)
      : problem_{problem}, m_{problem.contacts()}, factor_{problem, work}, at_(m_), apart_(m_), first_(m_) {
    begin(draw);
  }

  /// One point on; false when there is no way on.
  bool advance(std::size_t& factors) {
    if (path_.of.empty() && !derive(path_, factors)) return false;
    const double reach = longest(path_, 1);
    const std::vector<Inner> here = at_;
    const double share = share_;
    for (; step_ > shortest_step; step_ *= 0.4) {
      at_ = here;
      share_ = share;
      go(path_, step_ * reach);
      const int corrections = correct(factors);
      Direction next;
      if (corrections == 0 || !derive(next, factors)) continue;
      const double turned = std::abs(product(path_, next));
      if (turned < most_turned && step_ > short_step) continue;
      if (turned > 0.95 && corrections <= 2)
        step_ = step_ < 0.5 ? 2 * step_ : std::min(longest_step, 0.5 + 0.5 * step_);
      path_ = std::move(next);
      return true;
    }
    return false;
  }

  [[nodiscard]] double share() const { return share_; }
  [[nodiscard]] std::vector<Vec2> impulses() const {
    std::vector<Vec2> p(m_);
    for (std::size_t c = 0; c < m_; ++c) p[c] = {at_[c][0] - problem_.tension[c], 0.5 * (at_[c][2] - at_[c][4])};
    return p;
  }

 private:
  [[nodiscard]] const bem::Mat2& diagonal(std::size_t c) const { return problem_.w.values[problem_.w.diagonal[c]]; }
  /// Pairs that count: no friction and no cohesion leave no room for a tangential impulse.
  [[nodiscard]] std::size_t pairs(std::size_t c) const {
    return problem_.mu[c] <= 0 && problem_.cohesion[c] <= 0 ? 1 : 3;
  }
  [[nodiscard]] std::vector<Vec2> velocities() const {
    std::vector<Vec2> y = problem_.b;
    problem_.w.add_product(impulses(), y);
    return y;
  }

  void begin(std::uint64_t draw) {
    double speed = 0;
    for (const Vec2 b : problem_.b) speed = std::max({speed, std::abs(b.x), std::abs(b.y)});
    scale_ = speed;
    for (std::size_t c = 0; c < m_; ++c) {
      const double n = speed / diagonal(c).xx;
      const double room = problem_.mu[c] * n + problem_.cohesion[c];
      at_[c] = {n + problem_.tension[c], 0, room, 0, room, 0};
    }
    std::mt19937_64 random{draw};
    // Each a little different: paths of scenes with many equal contacts would cross.
    const auto about_one = [&] { return std::exp(static_cast<double>(random() >> 11U) * 0x1p-52 - 1.0); };
    const std::vector<Vec2> y = velocities();
    for (std::size_t c = 0; c < m_; ++c) {
      Inner& v = at_[c];
      v[1] = std::max(y[c].x, 0.0) + speed * about_one();
      v[5] = std::max(-y[c].y, 0.0) + speed * about_one();
      v[3] = v[5] + y[c].y;
      apart_[c] = y[c].x - v[1];
      first_[c] = {v[0] * v[1], v[2] * v[3], v[4] * v[5]};
    }
  }

  bool factorise(std::size_t& factors) {
    std::vector<Barrier> barrier(m_);
    for (std::size_t c = 0; c < m_; ++c) {
      const Inner& v = at_[c];
      barrier[c].normal = v[1] / v[0];
      if (pairs(c) == 1) {
        barrier[c].back = 1e12 * diagonal(c).yy;
      } else {
        barrier[c].ahead = v[3] / v[2];
        barrier[c].back = v[5] / v[4];
      }
    }
    ++factors;
    return factor_.compute(barrier);
  }

  /// Relative changes that move the linear equations by `lines` and the products by `products`.
  bool solve(const std::vector<Vec2>& lines, const std::vector<Products>& products, std::vector<Inner>& out) const {
    std::vector<Vec2> right(m_), z;
    for (std::size_t c = 0; c < m_; ++c) {
      const Inner& v = at_[c];
      right[c] = {lines[c].x + products[c][0] / v[0], 0};
      if (pairs(c) == 3) right[c].y = lines[c].y + products[c][1] / v[2] - products[c][2] / v[4];
    }
    if (!factor_.solve(right, z)) return false;
    out.assign(m_, {});
    for (std::size_t c = 0; c < m_; ++c) {
      const Inner& v = at_[c];
      const bool forward = factor_.sense(c) > 0;
      const double near = z[c].y, far = 2 * problem_.mu[c] * z[c].x - z[c].y;
      const Products room{z[c].x, forward ? far : near, forward ? near : far};
      for (std::size_t q = 0; q < pairs(c); ++q) {
        out[c][2 * q] = room[q] / v[2 * q];
        out[c][2 * q + 1] = products[c][q] / (v[2 * q] * v[2 * q + 1]) - out[c][2 * q];
      }
    }
    return true;
  }

  /// Changes with the logarithm of the share.
  bool solve_for_share(std::vector<Inner>& out) const {
    std::vector<Vec2> lines(m_);
    std::vector<Products> products(first_);
    for (std::size_t c = 0; c < m_; ++c) {
      lines[c].x = share_ * apart_[c];
      for (double& p : products[c]) p *= share_;
    }
    return solve(lines, products, out);
  }

  [[nodiscard]] double product(const Direction& a, const Direction& b) const {
    double sum = static_cast<double>(m_) * a.share * b.share;
    for (std::size_t c = 0; c < m_; ++c) {
      for (std::size_t q = 0; q < 2 * pairs(c); ++q) sum += a.of[c][q] * b.of[c][q];
    }
    return sum;
  }

  static void scale(Direction& d, double by) {
    d.share *= by;
    for (Inner& v : d.of) {
      for (double& x : v) x *= by;
    }
  }

  /// The direction of the path, of length 1, towards its end.
  bool derive(Direction& out, std::size_t& factors) {
    if (!factorise(factors) || !solve_for_share(out.of)) return false;
    out.share = 1;
    const double length = std::sqrt(product(out, out));
    if (!std::isfinite(length)) return false;
    scale(out, (factor_.sign() > 0 ? -1 : 1) / length);
    return true;
  }

  /// The part of a direction that takes `part` of what is left of the value that vanishes first.
  [[nodiscard]] double longest(const Direction& d, double part) const {
    double most = std::max(1e-6, -d.share);
    for (std::size_t c = 0; c < m_; ++c) {
      for (std::size_t q = 0; q < 2 * pairs(c); ++q) most = std::max(most, -d.of[c][q]);
    }
    return part / most;
  }

  void go(const Direction& d, double step) {
    share_ *= 1 + step * d.share;
    for (std::size_t c = 0; c < m_; ++c) {
      for (std::size_t q = 0; q < 6; ++q) at_[c][q] *= 1 + step * d.of[c][q];
    }
  }

  /// What the equations miss; says how much, relative.
  double miss(std::vector<Vec2>& lines, std::vector<Products>& products) const {
    const std::vector<Vec2> y = velocities();
    lines.resize(m_);
    products.resize(m_);
    double worst = 0;
    for (std::size_t c = 0; c < m_; ++c) {
      const Inner& v = at_[c];
      lines[c] = {share_ * apart_[c] - y[c].x + v[1], pairs(c) == 1 ? 0.0 : v[3] - v[5] - y[c].y};
      worst = std::max({worst, std::abs(lines[c].x) / (scale_ * (share_ + 1e-14)),
                        std::abs(lines[c].y) / (scale_ * (share_ + 1e-14))});
      for (std::size_t q = 0; q < pairs(c); ++q) {
        products[c][q] = share_ * first_[c][q] - v[2 * q] * v[2 * q + 1];
        worst = std::max(worst, std::abs(products[c][q]) / (share_ * first_[c][q]));
      }
    }
    return worst;
  }

  /// Newton's method across the path; iterations made, at least one, or 0 when it does not get there.
  int correct(std::size_t& factors) {
    std::vector<Vec2> lines;
    std::vector<Products> products;
    Direction back, along;
    for (int k = 0; k <= most_corrections; ++k) {
      const double off = miss(lines, products);
      if (off < near_path && k > 0) return k;
      if (k == most_corrections || !(off < far_off)) return 0;
      if (!factorise(factors) || !solve(lines, products, back.of) || !solve_for_share(along.of)) return 0;
      back.share = 0;
      along.share = 1;
      const double move = -product(path_, back) / product(path_, along);
      if (!std::isfinite(move)) return 0;
      back.share = move;
      for (std::size_t c = 0; c < m_; ++c) {
        for (std::size_t q = 0; q < 6; ++q) back.of[c][q] += move * along.of[c][q];
      }
      const double step = std::min(1.0, longest(back, 0.9));
      go(back, step);
      if (step < 0.1) return 0;
    }
    return 0;
  }

  const ContactProblem& problem_;
  std::size_t m_;
  PathFactor factor_;
  std::vector<Inner> at_;
  std::vector<double> apart_;     // a
  std::vector<Products> first_;   // products at the share 1
  double share_ = 1, scale_ = 1;  // speed of the problem
  double step_ = first_step;
  Direction path_;
};

}  // namespace

void turning_path(const ContactProblem& problem, std::size_t most, Work& work, std::size_t& factors,
                  const std::function<bool(const std::vector<Vec2>&)>& enough) {
  for (std::uint64_t draw = 1; factors < most && !work.over(); ++draw) {
    TurningPath path{problem, work, draw};
    const std::size_t end = std::min(most, factors + most_of_one_path);
    double look = first_look;
    while (factors < end && !work.over() && path.advance(factors) && path.share() < astray) {
      if (path.share() >= look) continue;
      look = 0.1 * path.share();
      if (enough(path.impulses()) || path.share() < end_of_path) return;
    }
  }
}

}  // namespace cleave::dbem
