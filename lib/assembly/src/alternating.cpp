#include "alternating.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "branch.hpp"
#include "settle.hpp"

namespace cleave::assembly {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// Weights of the law against the balance: from a heavy one, that carries loads through many contacts at once, to light
/// ones, that end the motion of what is left; then once more from a heavier one.
constexpr std::array first_weights{1e3, 3e4};
constexpr double next_weight = 0.25;
constexpr int weights = 5, steps_a_weight = 100;
/// Steps between looks at the solution, and at which patches press.
constexpr int between_looks = 20;
/// Rest takes this share of the violation of what moves.
constexpr double rest_needs = 1e-3;
/// Of each step; above 1: beyond its end.
constexpr double relaxation = 1.6;

class Alternating final {
 public:
  Alternating(const Elements& elements, double divisor, const State& state)
      : elements_{elements},
        divisor_{divisor},
        matrix_{elements.bodies(), elements.width(), linear::links_of(elements.all())},
        v_{state.v},
        x_{state.x},
        pressing_{pressing(elements, state)} {
    double mean = 0;
    for (const Element& e : elements.all()) mean += std::log(e.scale);
    mean = std::exp(mean / static_cast<double>(elements.all().size()));
    for (const Element& e : elements.all()) {
      // Between the same for all units and the same for all masses.
      relative_.push_back(mean / e.scale);
      const Vector3d u = elements.relative(e, v_);
      slid_.push_back(friction(e) * u.tail<2>().norm());
      allowed_.emplace_back(std::max(0.0, u[0] + slid_.back()), u[1], u[2]);
    }
  }

  /// True when `best` violates by no more than `enough`.
  bool run(double enough, State& best) {
    least_ = violation(elements_, divisor_, best);
    for (const double first : first_weights) {
      weight_ = first;
      for (int k = 0; k < weights; ++k, weight_ *= next_weight) {
        if (!factorise()) return false;
        for (int step = 1; step <= steps_a_weight; ++step) {
          move();
          carry();
          if (step % between_looks != 0) continue;
          look(best);
          if (least_ <= enough * (best.v.lpNorm<Eigen::Infinity>() > creeps ? 1 : rest_needs)) return true;
        }
      }
    }
    return least_ <= enough;
  }

 private:
  [[nodiscard]] double friction(const Element& e) const { return e.bond ? 0 : e.friction / divisor_; }

  bool factorise() {
    matrix_.clear(true);
    for (std::size_t b = 0; b < elements_.bodies(); ++b) matrix_.block(b, b).diagonal().setOnes();
    const std::vector<Element>& all = elements_.all();
    for (std::size_t k = 0; k < all.size(); ++k) {
      const Element& e = all[k];
      const Rows on_body = weight_ * relative_[k] * e.on_body;
      matrix_.block(e.body, e.body) += on_body * e.on_body.transpose();
      if (!e.other) continue;
      matrix_.block(e.body, *e.other) += on_body * e.on_other.transpose();
      const Rows on_other = weight_ * relative_[k] * e.on_other;
      matrix_.block(*e.other, e.body) += on_other * e.on_body.transpose();
      matrix_.block(*e.other, *e.other) += on_other * e.on_other.transpose();
    }
    return matrix_.factorise();
  }

  /// The bodies, under forces that pull contacts to the rates that they allow.
  void move() {
    v_ = elements_.load();
    for (std::size_t k = 0; k < x_.size(); ++k) {
      Vector3d pull = allowed_[k];
      pull[0] -= slid_[k];
      elements_.add_force(elements_.all()[k], x_[k] + weight_ * relative_[k] * pull, v_);
    }
    matrix_.solve(v_);
  }

  /// Each contact, as far as it carries.
  void carry() {
    for (std::size_t k = 0; k < x_.size(); ++k) {
      const Element& e = elements_.all()[k];
      const double own = weight_ * relative_[k];
      Vector3d u = elements_.relative(e, v_);
      u[0] += slid_[k];
      const Vector3d beyond = relaxation * u + (1 - relaxation) * allowed_[k];
      const Vector3d next = carried(k, x_[k] - own * beyond);
      const Vector3d allowed = beyond + (next - x_[k]) / own;
      allowed_[k] = allowed;
      x_[k] = next;
      slid_[k] = friction(e) * allowed.tail<2>().norm();
    }
  }

  [[nodiscard]] Vector3d carried(std::size_t k, Vector3d w) const {
    const Element& e = elements_.all()[k];
    if (!e.bond) return linear::onto_cone(w, friction(e), 0).x;
    linear::Projection shear;
    linear::onto_disc(w.tail<2>(), pressing_[k] != 0 ? e.cohesion / divisor_ : 0, shear);
    return {std::clamp(w[0], -e.tension / divisor_, 0.0), shear.x[1], shear.x[2]};
  }

  /// Keeps what violates least, with the rates that the forces give.
  void look(State& best) {
    State now{elements_.load(), x_};
    for (std::size_t k = 0; k < x_.size(); ++k) elements_.add_force(elements_.all()[k], x_[k], now.v);
    pressing_ = pressing(elements_, now);
    const double found = violation(elements_, divisor_, now);
    if (!(found < least_)) return;
    least_ = found;
    best = std::move(now);
  }

  const Elements& elements_;
  double divisor_, weight_ = 0, least_ = 0;
  linear::FrontalFactor matrix_;
  VectorXd v_;
  std::vector<Vector3d> x_, allowed_;  ///< by element: force; rate, opening by the slip more, that the law allows
  std::vector<double> slid_;           ///< by element: slip times friction of the last step
  std::vector<double> relative_;       ///< by element: of the weight
  std::vector<std::uint8_t> pressing_;
};

}  // namespace

bool alternate(const Elements& elements, double divisor, double enough, State& state) {
  return Alternating{elements, divisor, state}.run(enough, state);
}

}  // namespace cleave::assembly
