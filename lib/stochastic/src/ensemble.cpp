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

/// Adds one realization's counts to the shares below the upper end of each bin.
void add_sizes(std::vector<PairMoments>& below, const Tally& tally) {
  std::uint64_t sum = 0;
  for (std::size_t bin = 0; bin < SizeHistogram::bins; ++bin) {
    sum += tally.sizes.counts()[bin];
    below[bin].add(number(sum), number(tally.count));
  }
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
      ratios_(ratios().size()),
      exceeding_(options_.volumes_m3.size()),
      numbers_above_(options_.volumes_m3.size()),
      chainage_(options_.volumes_m3.size(), std::vector<std::uint64_t>(options_.chainage_parts)),
      below_(SizeHistogram::bins),
      first_below_(SizeHistogram::bins) {
  if (!options_.stability) options_.running_quantity = "block_count";
  const Quantity* running = quantity_named(options_.running_quantity);
  CLEAVE_ASSERT(running != nullptr);
  running_index_ = static_cast<std::size_t>(running - quantities().data());
}

void Ensemble::add(const Record& record, std::string_view line) {
  hash_.update(line).update("\n");
  if (record.outcome != Outcome::done) {
    ++failures_;
    if (failed_.size() < most_listed) failed_.push_back(record.realization);
    return;
  }
  ++counted_;
  for (std::size_t i = 0; i < quantities().size(); ++i) {
    const Quantity& q = quantities()[i];
    if (!has(q.stability, q.whole_system)) continue;
    const double value = q.of(record);
    moments_[i].add(value);
    if (q.quantiles) values_[i].push_back(value);
  }
  for (std::size_t i = 0; i < ratios().size(); ++i) ratios_[i].add(ratios()[i].top(record), ratios()[i].bottom(record));
  if (counted_ == next_running_) {
    const Moments& m = moments_[running_index_];
    running_.push_back(
        {counted_, m.mean(), m.mean() - t_interval(m.mean(), m.standard_error(), counted_, options_.confidence).low});
    next_running_ = std::max(counted_ + 1, static_cast<std::uint64_t>(std::ceil(number(counted_) * 1.08)));
  }
  if (!options_.stability) return;
  if (record.all.count > 0) mean_volume_per_realization_.add(record.all.volume_m3 / number(record.all.count));
  for (std::size_t i = 0; i < exceeding_.size(); ++i) {
    const std::uint64_t above = i < record.above.size() ? record.above[i] : 0;
    exceeding_[i] += above > 0 ? 1U : 0U;
    numbers_above_[i].add(number(above));
    for (std::size_t part = 0; part < std::min(chainage_[i].size(), record.chainage_m3.size()); ++part) {
      chainage_[i][part] += record.chainage_m3[part] > options_.volumes_m3[i] ? 1U : 0U;
    }
  }
  add_sizes(below_, record.all);
  add_sizes(first_below_, record.first);
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

void Ensemble::add_estimates(Figures& figures) const {
  const auto estimate = [&](std::string name, const Moments& m, Method method) {
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
  };
  for (std::size_t i = 0; i < quantities().size(); ++i) {
    const Quantity& q = quantities()[i];
    if (!has(q.stability, q.whole_system)) continue;
    Estimate e = estimate(std::string{q.name}, moments_[i], Method::mean);
    if (e.optimistic && q.quantiles) e.bootstrap = bca_mean(values_[i], options_.confidence, resamples, options_.seed);
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
    std::vector<double> sorted = values_[i];
    std::ranges::sort(sorted);
    for (const double p : {0.5, 0.9, 0.95, 0.99}) {
      const auto rank = static_cast<std::size_t>(std::ceil(p * number(counted_)));
      QuantileEstimate q{std::string{quantities()[i].name}, p, sorted[std::max<std::size_t>(rank, 1) - 1], {}};
      if (const auto ranks = quantile_ranks(counted_, p, options_.confidence)) {
        q.interval = Interval{sorted[ranks->low - 1], sorted[ranks->high - 1]};
      }
      figures.quantiles.push_back(std::move(q));
    }
  }
}

void Ensemble::add_exceedances(Figures& figures) const {
  if (counted_ == 0 || !options_.stability) return;
  for (std::size_t i = 0; i < exceeding_.size(); ++i) {
    Exceedance e{.volume_m3 = options_.volumes_m3[i],
                 .realizations = exceeding_[i],
                 .probability = number(exceeding_[i]) / number(counted_),
                 .interval = clopper_pearson(exceeding_[i], counted_, options_.confidence),
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
    for (const std::uint64_t hits : chainage_[i]) {
      e.by_chainage.push_back(number(hits) / number(counted_));
      e.by_chainage_interval.push_back(clopper_pearson(hits, counted_, options_.confidence));
    }
    figures.exceedances.push_back(std::move(e));
  }
}

void Ensemble::add_notes(Figures& figures) const {
  for (const Estimate& e : figures.estimates) {
    if (!e.optimistic || e.name.ends_with("_per_metre")) continue;
    figures.notes.push_back(
        fmt::format("{}: heavy tail (skewness {:.1f} over {} realizations): its interval is optimistic, it covers less "
                    "than it says",
                    e.name, e.skewness, e.realizations));
  }
  if (figures.failures > 0) {
    figures.notes.push_back(
        fmt::format("{} realizations could not be done and are not in the figures: large block systems are more likely "
                    "among them, so the figures may lean to the small side",
                    figures.failures));
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
  if (counted_ >= 2 && (running_.empty() || running_.back().realizations != counted_)) {
    const Moments& m = moments_[running_index_];
    figures.running.push_back(
        {counted_, m.mean(), m.mean() - t_interval(m.mean(), m.standard_error(), counted_, options_.confidence).low});
  }
  add_estimates(figures);
  add_quantiles(figures);
  add_exceedances(figures);
  add_notes(figures);
  return figures;
}

}  // namespace cleave::stochastic
