#include "cleave/stochastic/ensemble.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "cleave/core/assert.hpp"
#include "number.hpp"

namespace cleave::stochastic {
namespace {

constexpr std::size_t extremes = 5;
constexpr std::size_t most_listed = 1000;

void keep_extreme(std::vector<Extreme>& list, const Extreme& candidate, bool largest) {
  const auto before = [&](const Extreme& a, const Extreme& b) {
    if (a.volume_m3 != b.volume_m3) return largest ? a.volume_m3 > b.volume_m3 : a.volume_m3 < b.volume_m3;
    return a.realization < b.realization;
  };
  list.insert(std::ranges::upper_bound(list, candidate, before), candidate);
  if (list.size() > extremes) list.pop_back();
}

}  // namespace

Ensemble::Ensemble(EnsembleOptions options)
    : options_{std::move(options)},
      moments_(quantities().size()),
      tails_(quantities().size()),
      values_(quantities().size()),
      means_(quantities().size()),
      ratios_(ratios().size()),
      ratio_tails_(ratios().size()),
      exceeding_(options_.volumes_m3.size()),
      numbers_above_(options_.volumes_m3.size()),
      chainage_(options_.volumes_m3.size(), std::vector<Moments>(options_.chainage_parts)),
      orders_(options_.orders),
      cases_(options_.cases.size(), {std::vector<Moments>(quantities().size()), std::vector<Tail>(quantities().size()),
                                     std::vector<Moments>(options_.volumes_m3.size())}),
      block_sizes_{options_.sets.size(), options_.lines.size()},
      within_(quantities().size()),
      within_squares_(quantities().size()),
      below_(SizeHistogram::bins),
      first_below_(SizeHistogram::bins),
      factors_below_(factor_bins - 1),
      with_factor_below_(factor_bins - 1),
      pressing_(pressures_pa().size()),
      pressing_blocks_(pressures_pa().size()),
      connected_(options_.flow && options_.sides.size() <= most_sides ? pair_of_sides(0, options_.sides.size()) : 0) {
  CLEAVE_ASSERT(options_.strengths_per_geometry >= 1);
  const Quantity* running = quantity_named(options_.running_quantity);
  CLEAVE_ASSERT(running != nullptr);
  running_index_ = static_cast<std::size_t>(running - quantities().data());
}

Record under_case(const Record& of, std::size_t number) {
  const CaseTally c = number < of.cases.size() ? of.cases[number] : CaseTally{};
  Record record;
  record.realization = of.realization;
  record.outcome = of.outcome;
  record.joints = of.joints;
  record.all.count = c.count;
  record.all.volume_m3 = c.volume.si();
  record.all.largest_m3 = c.largest.si();
  record.all.support_n = c.net.si();
  record.all.modes[std::to_underlying(stability::Mode::lifting)] = c.lifting;
  record.support = c.support;
  record.groups = c.groups;
  record.border = c.border;
  record.tapered = c.tapered;
  record.at_parts = c.at_parts;
  record.turning = c.turning;
  record.at_target = c.at_target;
  return record;
}

/// All that is averaged, one realization's share of it; `add_unit` takes them in the same order.
std::vector<double> Ensemble::numbers_of(const Record& record) const {
  std::vector<double> numbers;
  for (const Quantity& q : quantities()) numbers.push_back(has(q) ? q.of(record) : 0);
  for (const Ratio& ratio : ratios()) {
    numbers.push_back(ratio.top(record));
    numbers.push_back(ratio.bottom(record));
  }
  block_sizes_.add_numbers(record, numbers);
  for (std::size_t pair = 0; pair < connected_.size(); ++pair) {
    numbers.push_back(record.flow && std::ranges::binary_search(record.flow->connected, pair) ? 1 : 0);
  }
  if (!options_.stability) return numbers;
  numbers.push_back(record.all.count > 0 ? record.all.volume_m3 / number(record.all.count) : 0);
  numbers.push_back(record.all.count > 0 ? 1 : 0);
  for (std::size_t i = 0; i < exceeding_.size(); ++i) {
    const std::uint64_t above = i < record.above.size() ? record.above[i] : 0;
    numbers.push_back(above > 0 ? 1 : 0);
    numbers.push_back(number(above));
    for (std::size_t part = 0; part < chainage_[i].size(); ++part) {
      const bool is_above = part < record.chainage_m3.size() && record.chainage_m3[part] > options_.volumes_m3[i];
      numbers.push_back(is_above ? 1 : 0);
    }
  }
  for (const Tally* tally : {&record.all, &record.first}) {
    std::uint64_t sum = 0;
    for (const std::uint32_t count : tally->sizes.counts()) numbers.push_back(number(sum += count));
    numbers.push_back(number(tally->count));
  }
  std::uint64_t below = 0;
  for (std::size_t i = 0; i + 1 < factor_bins; ++i) {
    below += i < record.factors.size() ? record.factors[i] : 0;
    numbers.push_back(number(below));
    numbers.push_back(below > 0 ? 1 : 0);
  }
  numbers.push_back(number(std::accumulate(record.factors.begin(), record.factors.end(), std::uint64_t{0})));
  for (const double pressure : pressures_pa()) {
    numbers.push_back(pressure_over_area(record) > pressure ? 1 : 0);
    numbers.push_back(record.largest_pressure_pa > pressure ? 1 : 0);
  }
  double least = INFINITY;
  for (const OrderTally& order : record.orders) least = std::min(least, order.key_m3);
  const auto best = std::ranges::count(record.orders, least, &OrderTally::key_m3);
  for (std::size_t i = 0; i < orders_.size(); ++i) {
    const OrderTally order = i < record.orders.size() ? record.orders[i] : OrderTally{};
    const OrderTally first = record.orders.empty() ? OrderTally{} : record.orders.front();
    numbers.push_back(number(order.key_blocks));
    numbers.push_back(order.key_m3);
    numbers.push_back(number(order.key_blocks) - number(first.key_blocks));
    numbers.push_back(order.key_m3 - first.key_m3);
    numbers.push_back(i < record.orders.size() && order.key_m3 == least ? 1 / static_cast<double>(best) : 0);
  }
  for (std::size_t i = 0; i < cases_.size(); ++i) {
    const Record under = under_case(record, i);
    for (const Quantity& q : quantities()) {
      if (of_case(q)) numbers.push_back(q.of(under));
    }
    for (const double volume : options_.volumes_m3) numbers.push_back(under.all.largest_m3 > volume ? 1 : 0);
  }
  return numbers;
}

void Ensemble::add(const Record& record, std::string_view line) {
  hash_.update(line).update("\n");
  const std::uint64_t m = options_.strengths_per_geometry;
  if (m > 1 && seen_in_unit_ == m) seen_in_unit_ = in_unit_ = 0;
  ++seen_in_unit_;
  if (record.outcome != Outcome::done) {
    ++failures_;
    if (failed_.size() < most_listed) failed_.push_back(record.realization);
    return;
  }
  ++counted_;
  add_extremes(record);
  const std::vector<double> numbers = numbers_of(record);
  if (m == 1) {
    for (std::size_t i = 0; i < quantities().size(); ++i) {
      if (quantities()[i].quantiles && has(quantities()[i])) values_[i].push_back(numbers[i]);
    }
    add_unit(numbers);
    return;
  }
  if (in_unit_ == 0) {
    sums_.assign(numbers.size(), 0);
    within_.assign(quantities().size(), {});
  }
  for (std::size_t i = 0; i < numbers.size(); ++i) sums_[i] += numbers[i];
  for (std::size_t i = 0; i < quantities().size(); ++i) {
    within_[i].add(numbers[i]);
    if (in_unit_ == 0 && quantities()[i].quantiles && has(quantities()[i])) values_[i].push_back(numbers[i]);
  }
  // A geometry with a failure among its realizations never gets here: all or none of them can be cut.
  if (++in_unit_ < m) return;
  for (std::size_t i = 0; i < quantities().size(); ++i) {
    within_squares_[i] += within_[i].variance() * number(m - 1);
    if (quantities()[i].quantiles && has(quantities()[i])) means_[i].push_back(sums_[i] / number(m));
  }
  add_unit(sums_);
}

void Ensemble::add_unit(const std::vector<double>& sums) {
  const double m = number(options_.strengths_per_geometry);
  ++units_;
  std::size_t next = 0;
  const auto take = [&] { return sums[next++]; };
  for (std::size_t i = 0; i < quantities().size(); ++i) {
    const double sum = take();
    if (!has(quantities()[i])) continue;
    moments_[i].add(sum / m);
    tails_[i].add(sum / m);
  }
  for (std::size_t i = 0; i < ratios_.size(); ++i) {
    const double top = take(), bottom = take();
    ratios_[i].add(top, bottom);
    if (bottom > 0) ratio_tails_[i].add(top / bottom, bottom);
  }
  if (units_ == next_running_) {
    const Moments& mean = moments_[running_index_];
    running_.push_back({counted_, mean.mean(),
                        mean.mean() - t_interval(mean.mean(), mean.standard_error(), units_, options_.confidence).low});
    next_running_ = std::max(units_ + 1, static_cast<std::uint64_t>(std::ceil(number(units_) * 1.08)));
  }
  block_sizes_.add_unit(sums, next, m);
  for (Moments& pair : connected_) pair.add(take() / m);
  if (!options_.stability) return;
  const double mean_volumes = take(), with_key_blocks = take();
  if (with_key_blocks > 0) {
    mean_volume_per_realization_.add(mean_volumes / with_key_blocks);
    mean_volume_per_realization_tail_.add(mean_volumes / with_key_blocks);
  }
  for (std::size_t i = 0; i < exceeding_.size(); ++i) {
    exceeding_[i].add(take() / m);
    numbers_above_[i].add(take() / m);
    for (Moments& part : chainage_[i]) part.add(take() / m);
  }
  for (auto* below : {&below_, &first_below_}) {
    const double count = sums[next + below->size()];
    for (PairMoments& bin : *below) bin.add(take(), count);
    ++next;
  }
  const double judged = sums[next + 2 * factors_below_.size()];
  for (std::size_t i = 0; i < factors_below_.size(); ++i) {
    factors_below_[i].add(take(), judged);
    with_factor_below_[i].add(take() / m);
  }
  ++next;
  for (std::size_t i = 0; i < pressing_.size(); ++i) {
    pressing_[i].add(take() / m);
    pressing_blocks_[i].add(take() / m);
  }
  for (OrderMoments& order : orders_) {
    order.count_tail.add(sums[next] / m);
    order.volume_tail.add(sums[next + 1] / m);
    for (Moments* moments :
         {&order.count, &order.volume, &order.count_difference, &order.volume_difference, &order.best}) {
      moments->add(take() / m);
    }
  }
  for (CaseMoments& under : cases_) {
    for (std::size_t i = 0; i < quantities().size(); ++i) {
      if (!of_case(quantities()[i])) continue;
      const double mean = take() / m;
      under.moments[i].add(mean);
      under.tails[i].add(mean);
    }
    for (Moments& exceeding : under.exceeding) exceeding.add(take() / m);
  }
  CLEAVE_ASSERT(next == sums.size());
}

void Ensemble::add_extremes(const Record& record) {
  if (!options_.stability) return;
  const Extreme extreme{record.realization, record.all.volume_m3, record.all.count};
  keep_extreme(worst_, extreme, true);
  keep_extreme(best_, extreme, false);
  stopped_ += record.stopped_at_max_batches ? 1U : 0U;
  surface_ += record.surface_blocks;
  surface_fixed_ += record.surface_blocks_fixed;
  free_ += record.free_m2;
  free_fixed_ += record.free_fixed_m2;
  middle_ += record.middle_m2;
  middle_fixed_ += record.middle_fixed_m2;
  key_volume_ += record.all.volume_m3;
  beside_fixed_ += record.key_beside_fixed_m3;
}

std::size_t Ensemble::index_of(std::string_view quantity) {
  const Quantity* found = quantity_named(quantity);
  CLEAVE_ASSERT(found != nullptr);
  return static_cast<std::size_t>(found - quantities().data());
}

}  // namespace cleave::stochastic
