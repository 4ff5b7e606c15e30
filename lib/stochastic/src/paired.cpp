#include "cleave/stochastic/paired.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "cleave/core/assert.hpp"
#include "cleave/stochastic/ensemble.hpp"

namespace cleave::stochastic {

namespace {
/// Of the larger of two numbers.
constexpr double rounding = 1e-12;
}  // namespace

PairedComparison::PairedComparison(std::uint64_t unit)
    : unit_{unit}, quantities_(quantities().size()), sums_(quantities().size()) {
  CLEAVE_ASSERT(unit >= 1);
}

void PairedComparison::add(const Record& first, const Record& second) {
  CLEAVE_ASSERT(first.realization == second.realization);
  if (first.outcome != Outcome::done || second.outcome != Outcome::done) {
    ++left_out_;
    return;
  }
  other_joints_ += first.joints != second.joints ? 1U : 0U;
  if (in_unit_ > 0 && first.realization / unit_ != unit_number_) {  // the unit before has a gap
    left_out_ += in_unit_;
    in_unit_ = 0;
  }
  if (in_unit_ == 0) {
    unit_number_ = first.realization / unit_;
    sums_.assign(sums_.size(), {});
  }
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    quantities_[i].in_first |= quantities()[i].asked_in(first);
    quantities_[i].in_second |= quantities()[i].asked_in(second);
    sums_[i].first += quantities()[i].of(first);
    sums_[i].second += quantities()[i].of(second);
  }
  if (++in_unit_ == unit_) finish_unit();
}

void PairedComparison::finish_unit() {
  const auto n = static_cast<double>(unit_);
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    const double a = sums_[i].first / n, b = sums_[i].second / n;
    Paired& paired = quantities_[i];
    paired.first.add(a);
    paired.second.add(b);
    // Sums over the same joints in another order differ by rounding: that is no difference of two designs.
    paired.difference.add(std::abs(b - a) <= rounding * std::max(std::abs(a), std::abs(b)) ? 0 : b - a);
    paired.sum.add(a + b);
  }
  in_unit_ = 0;
}

PairedComparison::OnlyInOne PairedComparison::only_in_one() const {
  OnlyInOne out;
  for (std::size_t i = 0; i < quantities_.size(); ++i) {
    const Paired& p = quantities_[i];
    if (p.in_first != p.in_second) (p.in_first ? out.first : out.second).emplace_back(quantities()[i].name);
  }
  return out;
}

std::vector<PairedEstimate> PairedComparison::estimates(double confidence, bool by_case) const {
  std::vector<PairedEstimate> rows;
  for (std::size_t i = 0; i < quantities_.size(); ++i) {
    const Paired& p = quantities_[i];
    const std::uint64_t n = p.difference.count();
    if (by_case && !quantities()[i].by_case) continue;
    // What one design alone was asked for is no row, nor is what neither has (no support, not all blocks cut).
    if (!p.in_first || !p.in_second) continue;
    const bool nothing =
        p.first.largest() == 0 && p.first.smallest() == 0 && p.second.largest() == 0 && p.second.smallest() == 0;
    if (n < 2 || nothing || !std::isfinite(p.sum.mean())) continue;
    PairedEstimate row{.name = std::string{quantities()[i].name},
                       .pairs = n,
                       .first = p.first.mean(),
                       .second = p.second.mean(),
                       .difference = p.difference.mean(),
                       .standard_error = p.difference.standard_error(),
                       .interval = t_interval(p.difference.mean(), p.difference.standard_error(), n, confidence),
                       .correlation = 0,
                       .gain = {}};
    if (p.difference.smallest() == 0 && p.difference.largest() == 0) {
      row.interval = {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    }
    const double spread = p.first.std() * p.second.std();
    const double covariance = (p.sum.variance() - p.difference.variance()) / 4;
    if (spread > 0) row.correlation = std::clamp(covariance / spread, -1.0, 1.0);
    const double independent = p.first.variance() + p.second.variance();
    if (p.difference.variance() > 0 && independent > 0) row.gain = independent / p.difference.variance();
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace cleave::stochastic
