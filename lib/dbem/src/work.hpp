#pragma once

#include <limits>

namespace cleave::dbem {

/// Operations spent on answers, and how many may be. Counted, not timed: a run ends at the same place on any machine.
/// Some 2.5 x 10^9 of them take a second.
class Work final {
 public:
  explicit Work(double most = std::numeric_limits<double>::infinity()) : most_{most} {}
  void add(double operations) noexcept { spent_ += operations; }
  [[nodiscard]] double spent() const noexcept { return spent_; }
  [[nodiscard]] bool over() const noexcept { return spent_ >= most_; }

 private:
  double most_, spent_ = 0;
};

}  // namespace cleave::dbem
