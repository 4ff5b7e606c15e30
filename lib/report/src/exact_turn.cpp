#include "exact_turn.hpp"

#include <array>
#include <cmath>
#include <cstddef>

namespace cleave::report::detail {
namespace {

// A sum of doubles kept exactly as non-overlapping parts, smallest first (Shewchuk 1997, grow-expansion).
class ExactSum {
 public:
  void add(double term) {
    for (std::size_t i = 0; i < size_; ++i) {
      const double sum = term + parts_[i];
      const double virtual_part = sum - term;
      const double lost = (term - (sum - virtual_part)) + (parts_[i] - virtual_part);
      parts_[i] = lost;
      term = sum;
    }
    parts_[size_++] = term;
  }
  void add_product(double a, double b) {
    const double product = a * b;
    add(std::fma(a, b, -product));
    add(product);
  }
  // The largest part that is not zero decides.
  [[nodiscard]] int sign() const {
    for (std::size_t i = size_; i-- > 0;) {
      if (parts_[i] != 0.0) return parts_[i] > 0.0 ? 1 : -1;
    }
    return 0;
  }

 private:
  std::array<double, 12> parts_{};
  std::size_t size_ = 0;
};

}  // namespace

int turn_exactly(Point2 a, Point2 b, Point2 c) noexcept {
  ExactSum sum;
  sum.add_product(a.u, b.v);
  sum.add_product(-a.v, b.u);
  sum.add_product(b.u, c.v);
  sum.add_product(-b.v, c.u);
  sum.add_product(c.u, a.v);
  sum.add_product(-c.v, a.u);
  return sum.sign();
}

}  // namespace cleave::report::detail
