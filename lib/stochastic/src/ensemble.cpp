#include "cleave/stochastic/ensemble.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "cleave/core/assert.hpp"

namespace cleave::stochastic {
namespace {

constexpr std::size_t extremes = 5;
constexpr std::size_t most_listed = 1000;
constexpr std::uint32_t resamples = 2000;

double number(std::uint64_t n) { return static_cast<double>(n); }

void keep_extreme(std::vector<Extreme>& list, const Extreme& candidate, bool largest) {
  const auto before = [&](const Extreme& a, const Extreme& b) {
    if (a.volume_m3 != b.volume_m3) return largest ? a.volume_m3 > b.volume_m3 : a.volume_m3 < b.volume_m3;
    return a.realization < b.realization;
  };
  list.insert(std::ranges::upper_bound(list, candidate, before), candidate);
  if (list.size() > extremes) list.pop_back();
}

std::vector<SizePoint> size_points(const std::vector<PairMoments>& below) {
  std::vector<SizePoint> points;
  for (std::size_t bin = 0; bin < below.size(); ++bin) {
    if (!below[bin].has_ratio()) return {};
    const double share = below[bin].ratio();
    if (share <= 0) continue;
    points.push_back({SizeHistogram::edge(bin + 1), share, below[bin].ratio_standard_error()});
    if (share >= 1) break;
  }
  return points;
}

}  // namespace

const std::vector<Quantity>& quantities() {
  static const std::vector<Quantity> all{
      {"key_block_volume_m3", [](const Record& r) { return r.all.volume_m3; }, true, false, true},
      {"key_block_count", [](const Record& r) { return number(r.all.count); }, true, false, true},
      {"key_block_largest_m3", [](const Record& r) { return r.all.largest_m3; }, true, false, true},
      {"support_force_n", [](const Record& r) { return r.all.support_n; }, true, false, true},
      {"support_force_transferred_n", [](const Record& r) { return r.all.support_transferred_n; }, true, false, false},
      {"first_batch_volume_m3", [](const Record& r) { return r.first.volume_m3; }, true, false, true},
      {"first_batch_count", [](const Record& r) { return number(r.first.count); }, true, false, true},
      {"first_batch_largest_m3", [](const Record& r) { return r.first.largest_m3; }, true, false, true},
      {"first_batch_support_force_n", [](const Record& r) { return r.first.support_n; }, true, false, false},
      {"first_batch_support_force_transferred_n", [](const Record& r) { return r.first.support_transferred_n; }, true,
       false, false},
      {"batches", [](const Record& r) { return static_cast<double>(r.batches); }, true, false, false},
      {"block_count", [](const Record& r) { return number(r.blocks); }, false, true, true},
      {"block_mean_volume_m3", [](const Record& r) { return r.rock_m3 / number(r.blocks); }, false, true, false},
      {"concave_block_count", [](const Record& r) { return number(r.concave_blocks); }, false, true, false},
      {"joint_count", [](const Record& r) { return number(r.joints); }, false, false, false},
      {"support_blocks_needing", [](const Record& r) { return r.support ? number(r.support->needing) : 0; }, true,
       false, false, true},
      {"support_blocks_not_held", [](const Record& r) { return r.support ? number(r.support->not_held) : 0; }, true,
       false, true, true},
      {"support_not_held_m3", [](const Record& r) { return r.support ? r.support->not_held_m3 : 0; }, true, false, true,
       true},
      {"support_missing_force_n", [](const Record& r) { return r.support ? r.support->missing_n : 0; }, true, false,
       true, true},
      {"support_fails",
       [](const Record& r) {
         return r.support && (r.support->not_held > 0 || r.support->failing_bodies > 0) ? 1.0 : 0.0;
       },
       true, false, false, true},
      {"support_spot_bolts", [](const Record& r) { return r.support ? number(r.support->spot_bolts) : 0; }, true, false,
       false, true},
  };
  return all;
}

const Quantity* quantity_named(std::string_view word) {
  for (const Quantity& q : quantities()) {
    if (q.name == word) return &q;
  }
  for (const Quantity& q : quantities()) {
    for (const std::string_view unit : {"_m3", "_n"}) {
      if (q.name.ends_with(unit) && q.name.substr(0, q.name.size() - unit.size()) == word) return &q;
    }
  }
  return nullptr;
}

std::string_view name_of(Method method) noexcept {
  switch (method) {
    case Method::mean: return "mean";
    case Method::ratio: return "ratio";
    case Method::mean_of_ratios: return "mean_of_ratios";
  }
  std::unreachable();
}

const std::vector<Ensemble::Ratio>& Ensemble::ratios() {
  static const auto all_count = [](const Record& r) { return number(r.all.count); };
  static const auto first_count = [](const Record& r) { return number(r.first.count); };
  static const std::vector<Ratio> list{
      {"key_block_mean_volume_m3", [](const Record& r) { return r.all.volume_m3; }, all_count, true, false},
      {"support_force_per_block_n", [](const Record& r) { return r.all.support_n; }, all_count, true, false},
      {"support_force_transferred_per_block_n", [](const Record& r) { return r.all.support_transferred_n; }, all_count,
       true, false},
      {"share_falling", [](const Record& r) { return number(r.all.modes[0]); }, all_count, true, false},
      {"share_lifting", [](const Record& r) { return number(r.all.modes[1]); }, all_count, true, false},
      {"share_sliding", [](const Record& r) { return number(r.all.modes[2]); }, all_count, true, false},
      {"share_wedge", [](const Record& r) { return number(r.all.modes[3]); }, all_count, true, false},
      {"share_tetrahedral", [](const Record& r) { return number(r.all.shapes[0]); }, all_count, true, false},
      {"share_pentahedral", [](const Record& r) { return number(r.all.shapes[1]); }, all_count, true, false},
      {"share_hexahedral", [](const Record& r) { return number(r.all.shapes[2]); }, all_count, true, false},
      {"share_higher", [](const Record& r) { return number(r.all.shapes[3]); }, all_count, true, false},
      {"share_other", [](const Record& r) { return number(r.all.shapes[4]); }, all_count, true, false},
      {"share_concave", [](const Record& r) { return number(r.all.concave); }, all_count, true, false},
      {"sphericity", [](const Record& r) { return r.all.sphericity_sum; }, all_count, true, false},
      {"first_batch_mean_volume_m3", [](const Record& r) { return r.first.volume_m3; }, first_count, true, false},
      {"first_batch_support_force_per_block_n", [](const Record& r) { return r.first.support_n; }, first_count, true,
       false},
      {"first_batch_share_falling", [](const Record& r) { return number(r.first.modes[0]); }, first_count, true, false},
      {"first_batch_share_lifting", [](const Record& r) { return number(r.first.modes[1]); }, first_count, true, false},
      {"first_batch_share_sliding", [](const Record& r) { return number(r.first.modes[2]); }, first_count, true, false},
      {"first_batch_share_wedge", [](const Record& r) { return number(r.first.modes[3]); }, first_count, true, false},
      {"first_batch_share_tetrahedral", [](const Record& r) { return number(r.first.shapes[0]); }, first_count, true,
       false},
      {"first_batch_share_pentahedral", [](const Record& r) { return number(r.first.shapes[1]); }, first_count, true,
       false},
      {"first_batch_share_other",
       [](const Record& r) { return number(r.first.shapes[2] + r.first.shapes[3] + r.first.shapes[4]); }, first_count,
       true, false},
      {"first_batch_sphericity", [](const Record& r) { return r.first.sphericity_sum; }, first_count, true, false},
      {"concave_block_share", [](const Record& r) { return number(r.concave_blocks); },
       [](const Record& r) { return number(r.blocks); }, false, true},
  };
  return list;
}

Ensemble::Ensemble(EnsembleOptions options)
    : options_{std::move(options)},
      moments_(quantities().size()),
      values_(quantities().size()),
      means_(quantities().size()),
      ratios_(ratios().size()),
      exceeding_(options_.volumes_m3.size()),
      numbers_above_(options_.volumes_m3.size()),
      chainage_(options_.volumes_m3.size(), std::vector<Moments>(options_.chainage_parts)),
      orders_(options_.orders),
      within_(quantities().size()),
      within_squares_(quantities().size()),
      below_(SizeHistogram::bins),
      first_below_(SizeHistogram::bins) {
  CLEAVE_ASSERT(options_.strengths_per_geometry >= 1);
  if (!options_.stability) options_.running_quantity = "block_count";
  const Quantity* running = quantity_named(options_.running_quantity);
  CLEAVE_ASSERT(running != nullptr);
  running_index_ = static_cast<std::size_t>(running - quantities().data());
}

/// All that is averaged, one realization's share of it; `add_unit` takes them in the same order.
std::vector<double> Ensemble::numbers_of(const Record& record) const {
  std::vector<double> numbers;
  for (const Quantity& q : quantities()) numbers.push_back(has(q) ? q.of(record) : 0);
  for (const Ratio& ratio : ratios()) {
    numbers.push_back(ratio.top(record));
    numbers.push_back(ratio.bottom(record));
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
  const auto least = std::ranges::min_element(record.orders, {}, &OrderTally::key_m3);
  for (std::size_t i = 0; i < orders_.size(); ++i) {
    const OrderTally order = i < record.orders.size() ? record.orders[i] : OrderTally{};
    const OrderTally first = record.orders.empty() ? OrderTally{} : record.orders.front();
    numbers.push_back(number(order.key_blocks));
    numbers.push_back(order.key_m3);
    numbers.push_back(number(order.key_blocks) - number(first.key_blocks));
    numbers.push_back(order.key_m3 - first.key_m3);
    numbers.push_back(static_cast<std::size_t>(least - record.orders.begin()) == i ? 1 : 0);
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
    if (has(quantities()[i])) moments_[i].add(sum / m);
  }
  for (PairMoments& ratio : ratios_) {
    const double top = take();
    ratio.add(top, take());
  }
  if (units_ == next_running_) {
    const Moments& mean = moments_[running_index_];
    running_.push_back({counted_, mean.mean(),
                        mean.mean() - t_interval(mean.mean(), mean.standard_error(), units_, options_.confidence).low});
    next_running_ = std::max(units_ + 1, static_cast<std::uint64_t>(std::ceil(number(units_) * 1.08)));
  }
  if (!options_.stability) return;
  const double mean_volumes = take(), with_key_blocks = take();
  if (with_key_blocks > 0) mean_volume_per_realization_.add(mean_volumes / with_key_blocks);
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
  for (OrderMoments& order : orders_) {
    for (Moments* moments :
         {&order.count, &order.volume, &order.count_difference, &order.volume_difference, &order.best}) {
      moments->add(take() / m);
    }
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
  key_volume_ += record.all.volume_m3;
  beside_fixed_ += record.key_beside_fixed_m3;
}

const Moments& Ensemble::moments(std::string_view quantity) const {
  const Quantity* found = quantity_named(quantity);
  CLEAVE_ASSERT(found != nullptr);
  return moments_[static_cast<std::size_t>(found - quantities().data())];
}

Estimate Ensemble::estimate(std::string name, const Moments& m, Method method) const {
  const double skewness = m.skewness();
  Estimate e{.name = std::move(name),
             .method = method,
             .realizations = m.count(),
             .mean = m.mean(),
             .standard_error = m.standard_error(),
             .low = m.mean(),
             .high = m.mean(),
             .std = m.std(),
             .skewness = skewness,
             .smallest = m.smallest(),
             .largest = m.largest(),
             .optimistic = m.count() >= 3 && std::abs(skewness) / std::sqrt(number(m.count())) > 0.2,
             .bootstrap = {}};
  if (m.count() >= 2) {
    const Interval t = t_interval(e.mean, e.standard_error, m.count(), options_.confidence);
    e.low = t.low;
    e.high = t.high;
  }
  return e;
}

/// Hits over realizations; a running mean would be off by rounding.
double Ensemble::probability_of(const Moments& hits) const {
  const double m = number(options_.strengths_per_geometry);
  return std::round(hits.mean() * number(units_) * m) / (number(units_) * m);
}

/// Of the mean of 0 and 1: exact where realizations are independent; else with the effective sample size, which lies
/// between the number of geometries and that of realizations.
Interval Ensemble::probability_interval(const Moments& hits) const {
  const std::uint64_t m = options_.strengths_per_geometry;
  if (m == 1) {
    const auto k = static_cast<std::uint64_t>(std::llround(hits.mean() * number(units_)));
    return clopper_pearson(k, units_, options_.confidence);
  }
  const double p = std::clamp(hits.mean(), 0.0, 1.0), se = hits.standard_error();
  const double effective =
      se > 0 ? std::clamp(p * (1 - p) / (se * se), number(units_), number(units_ * m)) : number(units_);
  return clopper_pearson_effective(p, effective, options_.confidence);
}

void Ensemble::add_orders(Figures& figures) const {
  for (const OrderMoments& order : orders_) {
    figures.orders.push_back(
        {.key_blocks = estimate("key_blocks", order.count, Method::mean),
         .key_m3 = estimate("key_m3", order.volume, Method::mean),
         .key_blocks_minus_first = estimate("key_blocks_minus_first", order.count_difference, Method::mean),
         .key_m3_minus_first = estimate("key_m3_minus_first", order.volume_difference, Method::mean),
         .share_best = order.best.mean()});
  }
}

void Ensemble::add_variances(Figures& figures) const {
  const std::uint64_t m = options_.strengths_per_geometry;
  if (m == 1 || units_ < 2) return;
  for (std::size_t i = 0; i < quantities().size(); ++i) {
    if (!has(quantities()[i]) || !quantities()[i].stability) continue;
    const double strength = within_squares_[i] / number(units_ * (m - 1));
    figures.variances.push_back(
        {std::string{quantities()[i].name}, std::max(0.0, moments_[i].variance() - strength / number(m)), strength});
  }
}

void Ensemble::add_estimates(Figures& figures) const {
  for (std::size_t i = 0; i < quantities().size(); ++i) {
    const Quantity& q = quantities()[i];
    if (!has(q)) continue;
    Estimate e = estimate(std::string{q.name}, moments_[i], Method::mean);
    if (e.optimistic && q.quantiles) {
      const std::vector<double> units = (options_.strengths_per_geometry > 1 ? means_[i] : values_[i]).all();
      e.bootstrap = bca_mean(units, options_.confidence, resamples, options_.seed);
    }
    figures.estimates.push_back(std::move(e));
  }
  if (options_.stability && options_.tunnel_length_m) {
    for (const std::string_view name : {"support_force_n", "support_force_transferred_n", "key_block_volume_m3"}) {
      Estimate e = estimate(std::string{name} + "_per_metre", moments(name), Method::mean);
      const double metres = *options_.tunnel_length_m;
      for (double* value : {&e.mean, &e.standard_error, &e.low, &e.high, &e.std, &e.smallest, &e.largest}) {
        *value /= metres;
      }
      figures.estimates.push_back(std::move(e));
    }
  }
  if (options_.stability) {
    figures.estimates.push_back(
        estimate("key_block_mean_volume_per_realization_m3", mean_volume_per_realization_, Method::mean_of_ratios));
  }
  for (std::size_t i = 0; i < ratios().size(); ++i) {
    if (!has(ratios()[i].stability, ratios()[i].whole_system) || !ratios_[i].has_ratio()) continue;
    const PairMoments& pair = ratios_[i];
    const double r = pair.ratio(), se = pair.ratio_standard_error();
    const Interval t = pair.count() >= 2 ? t_interval(r, se, pair.count(), options_.confidence) : Interval{r, r};
    figures.estimates.push_back({.name = std::string{ratios()[i].name},
                                 .method = Method::ratio,
                                 .realizations = pair.count(),
                                 .mean = r,
                                 .standard_error = se,
                                 .low = t.low,
                                 .high = t.high,
                                 .std = se * std::sqrt(number(pair.count())),
                                 .bootstrap = {}});
  }
}

void Ensemble::add_quantiles(Figures& figures) const {
  if (counted_ == 0) return;
  for (std::size_t i = 0; i < quantities().size(); ++i) {
    if (!quantities()[i].quantiles || values_[i].empty()) continue;
    std::vector<double> sorted = values_[i].all();
    if (sorted.empty()) continue;
    std::ranges::sort(sorted);
    for (const double p : {0.5, 0.9, 0.95, 0.99}) {
      const auto rank = static_cast<std::size_t>(std::ceil(p * number(sorted.size())));
      QuantileEstimate q{std::string{quantities()[i].name}, p, sorted[std::max<std::size_t>(rank, 1) - 1], {}};
      if (const auto ranks = quantile_ranks(sorted.size(), p, options_.confidence)) {
        q.interval = Interval{sorted[ranks->low - 1], sorted[ranks->high - 1]};
      }
      figures.quantiles.push_back(std::move(q));
    }
  }
}

void Ensemble::add_exceedances(Figures& figures) const {
  if (units_ == 0 || !options_.stability) return;
  for (std::size_t i = 0; i < exceeding_.size(); ++i) {
    Exceedance e{.volume_m3 = options_.volumes_m3[i],
                 .realizations = static_cast<std::uint64_t>(std::llround(exceeding_[i].mean() * number(counted_))),
                 .probability = probability_of(exceeding_[i]),
                 .interval = probability_interval(exceeding_[i]),
                 .number = numbers_above_[i].mean(),
                 .number_standard_error = numbers_above_[i].standard_error(),
                 .per_metre = {},
                 .per_metre_standard_error = {},
                 .by_chainage = {},
                 .by_chainage_interval = {}};
    if (options_.tunnel_length_m) {
      e.per_metre = e.number / *options_.tunnel_length_m;
      e.per_metre_standard_error = e.number_standard_error / *options_.tunnel_length_m;
    }
    for (const Moments& hits : chainage_[i]) {
      e.by_chainage.push_back(probability_of(hits));
      e.by_chainage_interval.push_back(probability_interval(hits));
    }
    figures.exceedances.push_back(std::move(e));
  }
}

void Ensemble::add_notes(Figures& figures) const {
  std::string heavy;
  double most = 0;
  for (const Estimate& e : figures.estimates) {
    if (!e.optimistic || e.name.ends_with("_per_metre")) continue;
    heavy += (heavy.empty() ? "" : ", ") + e.name;
    most = std::max(most, std::abs(e.skewness));
  }
  if (!heavy.empty()) {
    figures.notes.push_back(
        fmt::format("heavy tails (skewness up to {:.1f} over {} samples): the intervals of these are optimistic, they "
                    "cover less than they say: {}",
                    most, units_, heavy));
  }
  if (figures.failures > 0) {
    figures.notes.push_back(
        fmt::format("{} realizations could not be done and are not in the figures: large block systems are more likely "
                    "among them, so the figures may lean to the small side",
                    figures.failures));
  }
  if (options_.strengths_per_geometry > 1) {
    figures.notes.push_back(
        fmt::format("nested design: {} geometries with {} draws of strengths and loads each; the geometry is the "
                    "sample unit, quantiles "
                    "are those of the first draw of each",
                    units_, options_.strengths_per_geometry));
  }
  if (!options_.stability || counted_ == 0) return;
  if (stopped_ > 0) {
    figures.notes.push_back(fmt::format(
        "{} of {} realizations stopped at max_batches: figures of all batches are too small by what would still leave",
        stopped_, counted_));
  }
  const auto& ratio = ratios_.front();
  const double plain = mean_volume_per_realization_.mean();
  if (ratio.has_ratio() && mean_volume_per_realization_.count() > 1 &&
      std::abs(plain - ratio.ratio()) > 2 * ratio.ratio_standard_error()) {
    figures.notes.push_back(fmt::format(
        "mean volume of a key block: {:.4g} m3 as ratio of sums, {:.4g} m3 as mean over realizations; they differ "
        "because realizations with many key blocks have larger ones: say which one you mean",
        ratio.ratio(), plain));
  }
  if (figures.surface_fixed_share > 0.01 || figures.beside_fixed_share > 0.01) {
    figures.notes.push_back(fmt::format(
        "{:.1f} % of the blocks at free faces are held by the domain's border, {:.1f} % of the key-block volume lies "
        "beside such blocks: above 1 % the domain is too small and key blocks are missed",
        100 * figures.surface_fixed_share, 100 * figures.beside_fixed_share));
  }
}

Figures Ensemble::figures() const {
  Figures figures{.realizations = counted_,
                  .confidence = options_.confidence,
                  .estimates = {},
                  .quantiles = {},
                  .exceedances = {},
                  .orders = {},
                  .strengths_per_geometry = options_.strengths_per_geometry,
                  .variances = {},
                  .sizes = size_points(below_),
                  .first_sizes = size_points(first_below_),
                  .running_quantity = options_.running_quantity,
                  .running = running_,
                  .worst = worst_,
                  .best = best_,
                  .failed = failed_,
                  .failures = failures_,
                  .stopped_at_max_batches = stopped_,
                  .surface_fixed_share = surface_ > 0 ? number(surface_fixed_) / number(surface_) : 0,
                  .beside_fixed_share = key_volume_ > 0 ? beside_fixed_ / key_volume_ : 0,
                  .notes = {},
                  .hash = hash_.hex()};
  if (units_ >= 2 && (running_.empty() || running_.back().realizations != counted_)) {
    const Moments& m = moments_[running_index_];
    figures.running.push_back(
        {counted_, m.mean(), m.mean() - t_interval(m.mean(), m.standard_error(), units_, options_.confidence).low});
  }
  add_estimates(figures);
  add_quantiles(figures);
  add_exceedances(figures);
  add_orders(figures);
  add_variances(figures);
  add_notes(figures);
  return figures;
}

}  // namespace cleave::stochastic
