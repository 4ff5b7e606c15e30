#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "cleave/linear/fronts.hpp"

/// What Newton iterations on bodies in contact have in common.
namespace cleave::linear {

using Links = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// Pairs of bodies that touch, the smaller number first, each as often as they have contacts: where factors have
/// entries.
template <class Elements>
[[nodiscard]] Links links_of(const Elements& elements) {
  Links out;
  for (const auto& e : elements) {
    if (!e.other) continue;
    const std::pair link{std::min(e.body, *e.other), std::max(e.body, *e.other)};
    if (out.empty() || out.back() != link) out.push_back(link);
  }
  return out;
}

/// A system of one block row a body: 1 plus what is added. The factor is dense where that is as good.
class BlockSystem final {
 public:
  BlockSystem(std::size_t bodies, Eigen::Index width, Links links);

  /// The unit matrix.
  void clear(bool symmetric);
  /// Adds to the block of two bodies that are linked or the same; of a symmetric matrix both (r, c) and (c, r).
  template <class Block>
  void add(std::size_t row, std::size_t column, const Block& value) {
    constexpr int width = Block::RowsAtCompileTime;
    if (sparse_) {
      sparse_->block<width>(row, column) += value;
    } else {
      dense_.block<width, width>(width_ * static_cast<Eigen::Index>(row), width_ * static_cast<Eigen::Index>(column),
                                 width_, width_) += value;
    }
  }
  /// What an element with `slope` between velocity and force adds.
  template <class Element, class Slope>
  void add_element(const Element& e, const Slope& slope) {
    const auto left = (e.on_body * slope).eval();
    add(e.body, e.body, left * e.on_body.transpose());
    if (!e.other) return;
    const auto right = (e.on_other * slope).eval();
    add(*e.other, *e.other, right * e.on_other.transpose());
    add(e.body, *e.other, left * e.on_other.transpose());
    add(*e.other, e.body, right * e.on_body.transpose());
  }
  /// False when a pivot vanishes.
  [[nodiscard]] bool factorise();
  /// In place.
  void solve(Eigen::VectorXd& x) const;

  [[nodiscard]] bool is_dense() const noexcept { return !sparse_; }
  [[nodiscard]] std::size_t factors() const noexcept { return factors_; }

 private:
  Eigen::Index size_, width_;
  bool symmetric_ = true;
  std::optional<FrontalFactor> sparse_;
  Eigen::MatrixXd dense_;
  Eigen::LLT<Eigen::MatrixXd> cholesky_;
  Eigen::PartialPivLU<Eigen::MatrixXd> lu_;
  std::size_t factors_ = 0;
};

/// How well a place serves: value of the function that is made least (convex), size of its gradient (any).
struct Merit {
  double value, size;
};

/// What a line search goes by.
struct Search {
  bool convex = false;  ///< the value counts
  double rounding = 0;  ///< of the value
  int halvings = 20;
};

/// Share of a Newton step to take: the first of 1, 1/2, 1/4 ... with enough less of the value (where `convex`; `slope`:
/// its derivative along the step) or of the gradient, else the one with the smallest gradient; 0 when none has less.
/// Of a convex function the value never grows by more than its rounding: led by either measure in turn, an iteration
/// may go in circles.
template <class MeritAt>
[[nodiscard]] double share_of_step(Merit now, double slope, const Search& how, MeritAt&& merit_at) {
  double share = 1, best = 0, best_size = now.size;
  for (int halving = 0; halving < how.halvings; ++halving, share *= 0.5) {
    const Merit found = merit_at(share);
    if (how.convex && !(found.value <= now.value + how.rounding)) continue;
    // Near the end the value has no digits left; what remains of the gradient has.
    if ((how.convex && found.value <= now.value + 1e-4 * share * slope) || found.size <= (1 - 0.1 * share) * now.size) {
      return share;
    }
    if (found.size < best_size) {
      best = share;
      best_size = found.size;
      if (!how.convex && halving > 6) break;
    }
  }
  return best;
}

}  // namespace cleave::linear
