#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "cleave/core/rng.hpp"
#include "cleave/core/special.hpp"
#include "cleave/stochastic/ensemble.hpp"
#include "number.hpp"

/// What an ensemble says of the realizations it has seen.
namespace cleave::stochastic {
namespace {

constexpr std::uint32_t resamples = 2000;
/// By simulation of realizations with key blocks as heavy-tailed as those of tunnels (`./x study coverage`).
constexpr double widening = 0.5;
constexpr double skewed = 0.2;

/// Of a realization, between 0 and 1.
bool is_share(std::string_view name) { return name.ends_with("_share"); }

/// The upper end of the interval of a mean, no farther up than it can be.
double no_farther(double mean, double high, const std::optional<double>& most) {
  return most ? std::max(mean, std::min(high, *most)) : high;
}

double lean(double skewness, std::uint64_t n) { return std::abs(skewness) / std::sqrt(number(n)); }

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

Estimate Ensemble::estimate(std::string name, const Moments& m, const Tail& tail, Method method,
                            const std::optional<Force>& pull) const {
  const std::optional<double> most = most_of(name, pull);
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
             .optimistic = m.count() >= 3 && tail.long_from_few(),
             .bootstrap = {}};
  if (m.count() >= 2) {
    const Interval t =
        with_tail(skew_interval(e.mean, e.standard_error, skewness, m.count(), options_.confidence, widening), e.mean,
                  tail, m.count(), options_.confidence);
    e.low = m.smallest() >= 0 ? std::max(0.0, t.low) : t.low;
    e.high = no_farther(e.mean, t.high, most);
  }
  // What no realization has may be met all the same: of its mean no more is known than how often, and of volumes and
  // of what pulls at them how large at the most.
  if (m.count() > 0 && m.smallest() == 0 && m.largest() == 0) {
    const double met = clopper_pearson(0, std::max<std::uint64_t>(units_, 1), options_.confidence).high;
    e.high = most ? met * *most : std::numeric_limits<double>::infinity();
  }
  return e;
}

/// May have either sign. Without a realization that differs nothing is known of it.
Estimate Ensemble::difference(std::string name, const Moments& moments) const {
  Estimate e = estimate(std::move(name), moments, {}, Method::mean);
  if (moments.smallest() == 0 && moments.largest() == 0) {
    e.high = std::numeric_limits<double>::infinity();
    e.low = -e.high;
  }
  return e;
}

std::optional<double> Ensemble::most_of(std::string_view name, const std::optional<Force>& pull) const {
  if (is_share(name)) return 1;
  if (name.ends_with("_m3")) return options_.rock.transform([](Volume rock) { return rock.si(); });
  const bool of_pull = name == "support_force_n" || name == "first_batch_support_force_n";
  return of_pull ? pull.transform([](Force force) { return force.si(); }) : std::nullopt;
}

Estimate Ensemble::estimate(const Quantity& q, const Moments& moments, const Tail& tail,
                            const UnderLoads& loads) const {
  Estimate e = estimate(std::string{q.name}, moments, tail, Method::mean, loads.pull);
  if (q.probability && units_ > 0) {
    const Interval exact = probability_interval(moments);
    e.low = exact.low;
    e.high = exact.high;
    e.optimistic = false;
  }
  if (q.lifted && !loads.lifts) e.high = e.mean;  // 0, and not for want of samples
  return e;
}

/// Of a share of blocks, which hang together within a realization: with the effective number of blocks, Student's t in
/// place of the normal law. Where all or none are of the kind, as many as equal realizations there are.
Interval Ensemble::share_interval(const PairMoments& pair, double most) const {
  const double p = std::clamp(pair.ratio(), 0.0, 1.0), se = pair.ratio_standard_error();
  double effective = pair.equal_parts();
  if (p > 0 && p < 1 && se > 0 && pair.count() >= 2) {
    const double level = 0.5 + options_.confidence / 2;
    const double wider = special::student_t_quantile(level, number(pair.count() - 1)) / normal_quantile(level);
    effective = std::min(p * (1 - p) / (se * se * wider * wider), most);
  }
  return clopper_pearson_effective(p, std::max(effective, 1e-6), options_.confidence);
}

Estimate Ensemble::ratio_estimate(std::string name, const PairMoments& pair, const Tail& tail, bool share) const {
  const double r = pair.ratio(), se = pair.ratio_standard_error(), skewness = pair.ratio_skewness();
  Interval interval{r, r};
  if (share) {
    interval = share_interval(pair, pair.sum_x());
  } else if (pair.count() >= 2) {
    interval = with_tail(skew_interval(r, se, skewness, pair.count(), options_.confidence, widening), r, tail,
                         pair.count(), options_.confidence);
    interval = {std::max(0.0, interval.low), no_farther(r, interval.high, most_of(name, {}))};
  }
  return {.name = std::move(name),
          .method = Method::ratio,
          .realizations = pair.count(),
          .mean = r,
          .standard_error = se,
          .low = interval.low,
          .high = interval.high,
          .std = se * std::sqrt(number(pair.count())),
          .skewness = skewness,
          .optimistic = !share && pair.count() >= 3 && tail.long_from_few(),
          .bootstrap = {}};
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
    figures.orders.push_back({.key_blocks = estimate("key_blocks", order.count, order.count_tail, Method::mean),
                              .key_m3 = estimate("key_m3", order.volume, order.volume_tail, Method::mean),
                              .key_blocks_minus_first = difference("key_blocks_minus_first", order.count_difference),
                              .key_m3_minus_first = difference("key_m3_minus_first", order.volume_difference),
                              .share_best = order.best.mean()});
  }
}

void Ensemble::add_cases(Figures& figures) const {
  for (std::size_t k = 0; k < cases_.size(); ++k) {
    CaseEstimates& under = figures.cases.emplace_back(options_.cases[k]);
    const UnderLoads loads{.lifts = k >= options_.cases_lift.size() || options_.cases_lift[k],
                           .pull = k < options_.cases_pull.size() ? options_.cases_pull[k] : std::nullopt};
    for (std::size_t i = 0; i < quantities().size(); ++i) {
      if (!of_case(quantities()[i])) continue;
      under.estimates.push_back(estimate(quantities()[i], cases_[k].moments[i], cases_[k].tails[i], loads));
    }
    for (std::size_t i = 0; i < options_.volumes_m3.size() && units_ > 0; ++i) {
      const Moments& hits = cases_[k].exceeding[i];
      under.exceedances.push_back(
          {cubic_metres(options_.volumes_m3[i]), probability_of(hits), probability_interval(hits)});
    }
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
    Estimate e = estimate(q, moments_[i], tails_[i], base_loads());
    if (q.quantiles && e.realizations >= 3 && lean(e.skewness, e.realizations) > skewed) {
      const std::vector<double> units = (options_.strengths_per_geometry > 1 ? means_[i] : values_[i]).all();
      e.bootstrap = bca_mean(units, options_.confidence, resamples, options_.seed);
      // A bootstrap knows no larger block than the sample does.
      if (e.bootstrap) e.bootstrap = {std::min(e.bootstrap->low, e.low), std::max(e.bootstrap->high, e.high)};
    }
    if (q.by_slivers && e.largest > 0) {
      e.estimable = false;
      e.optimistic = true;
    }
    figures.estimates.push_back(std::move(e));
  }
  if (options_.stability && options_.tunnel_length_m) {
    for (const std::string_view name : {"support_force_n", "support_force_transferred_n", "key_block_volume_m3"}) {
      Estimate e = estimate(std::string{name}, moments(name), tails_[index_of(name)], Method::mean, options_.pull);
      e.name += "_per_metre";
      const double metres = metres_in_rock();
      for (double* value : {&e.mean, &e.standard_error, &e.low, &e.high, &e.std, &e.smallest, &e.largest}) {
        *value /= metres;
      }
      figures.estimates.push_back(std::move(e));
    }
  }
  if (options_.stability && mean_volume_per_realization_.count() > 0) {
    figures.estimates.push_back(estimate("key_block_mean_volume_per_realization_m3", mean_volume_per_realization_,
                                         mean_volume_per_realization_tail_, Method::mean_of_ratios));
  }
  for (std::size_t i = 0; i < ratios().size(); ++i) {
    if (!has(ratios()[i].stability, ratios()[i].whole_system) || !ratios_[i].has_ratio()) continue;
    figures.estimates.push_back(
        ratio_estimate(std::string{ratios()[i].name}, ratios_[i], ratio_tails_[i], ratios()[i].share()));
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
      e.per_metre = e.number / metres_in_rock();
      e.per_metre_standard_error = e.number_standard_error / metres_in_rock();
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
  const auto add_heavy = [&](const Estimate& e, const std::string& under) {
    if (e.optimistic && e.estimable && !e.name.ends_with("_per_metre")) {
      heavy += (heavy.empty() ? "" : ", ") + e.name + under;
    }
  };
  for (const Estimate& e : figures.estimates) {
    if (!e.estimable) {
      figures.notes.push_back(e.name +
                              " has no mean that realizations would show: it hangs on the thinnest sliver met, its "
                              "interval holds nothing; take its quantiles and pressure_exceedance");
    }
    add_heavy(e, "");
  }
  for (const CaseEstimates& c : figures.cases) {
    for (const Estimate& e : c.estimates) add_heavy(e, " (load case " + c.name + ")");
  }
  if (!heavy.empty()) {
    figures.notes.push_back(
        fmt::format("long tails seen in few of {} samples: the intervals of these may be optimistic, they cover up to "
                    "some per cent less than they say: {}",
                    units_, heavy));
  }
  std::string unseen;
  for (const Estimate& e : figures.estimates) {
    const bool mean = e.method == Method::mean && e.smallest == 0 && e.largest == 0 && e.high > 0;
    const Quantity* quantity = quantity_named(e.name);
    if (mean && quantity != nullptr && !quantity->probability) unseen += (unseen.empty() ? "" : ", ") + e.name;
  }
  if (!unseen.empty()) {
    figures.notes.push_back(fmt::format(
        "seen in none of {} samples, so that no mean is known but for an upper end of volumes (the chance to meet one "
        "times all of the rock): {}",
        units_, unseen));
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
  constexpr double alarm = 0.1;
  if (figures.free_area_fixed_share.value_or(0) > alarm) {
    std::string what = fmt::format(
        "{:.1f} % of the area of excavations belongs to blocks that only fixed sides of the domain hold: key blocks "
        "are "
        "missed there",
        100 * *figures.free_area_fixed_share);
    if (figures.middle_fixed_share && *figures.middle_fixed_share > alarm) {
      what += fmt::format(
          "; {:.1f} % of the middle half of the tunnel does: give it more room to the sides, above and "
          "below",
          100 * *figures.middle_fixed_share);
    } else if (figures.guard_length_m) {
      what += fmt::format(
          "; about {:.3g} m at each end of the tunnel are lost (guard length): leave them out when you "
          "count per metre, or make the tunnel {:.3g} m long, where they are 10 %",
          *figures.guard_length_m, 2 * *figures.guard_length_m / alarm);
    }
    figures.notes.push_back(std::move(what));
  }
}

void Ensemble::add_border(Figures& figures) const {
  if (!(free_ > 0)) return;
  const double all = free_fixed_ / free_;
  figures.free_area_fixed_share = all;
  if (!options_.tunnel_length_m || !(middle_ > 0)) return;
  const double middle = middle_fixed_ / middle_;
  figures.middle_fixed_share = middle;
  // What the ends lose beyond what the sides hold everywhere, as a length.
  const double ends = middle < 1 ? std::max(0.0, all - middle) / (1 - middle) : 0;
  figures.guard_length_m = 0.5 * metres_in_rock() * ends;
}

void Ensemble::add_factors(Figures& figures) const {
  if (!options_.stability || units_ == 0 || !factors_below_.front().has_ratio()) return;
  const double blocks = factors_below_.front().sum_x() / number(units_ * options_.strengths_per_geometry);
  for (std::size_t i = 0; i < factors_below_.size(); ++i) {
    const PairMoments& below = factors_below_[i];
    figures.factors.push_back({.factor = factor_step * number(i + 1),
                               .share_below = below.ratio(),
                               .share_interval = share_interval(below, below.sum_x()),
                               .number_below = below.ratio() * blocks,
                               .probability = probability_of(with_factor_below_[i]),
                               .interval = probability_interval(with_factor_below_[i])});
  }
}

void Ensemble::add_pressures(Figures& figures) const {
  if (!options_.stability || units_ == 0) return;
  if (!options_.openings) {
    figures.notes.emplace_back(
        "no opening over whose area forces to be held would be a pressure: support_pressure_pa is not given, and "
        "pressure_exceedance is that of single blocks");
  }
  for (std::size_t i = 0; i < pressing_.size(); ++i) {
    PressureExceedance row{.pressure = Stress::from_si(pressures_pa()[i]),
                           .probability = {},
                           .interval = {},
                           .block_probability = probability_of(pressing_blocks_[i]),
                           .block_interval = probability_interval(pressing_blocks_[i])};
    if (options_.openings) {
      row.probability = probability_of(pressing_[i]);
      row.interval = probability_interval(pressing_[i]);
    }
    // Pressures that all exceed, or none, say nothing more but the last and the first.
    if (row.probability.value_or(1) >= 1 && row.block_probability >= 1) figures.pressures.clear();
    figures.pressures.push_back(row);
    if (!(row.probability.value_or(0) > 0) && !(row.block_probability > 0)) break;
  }
}

void Ensemble::add_percolation(Figures& figures) const {
  if (units_ == 0) return;
  const std::vector<std::string>& sides = options_.sides;
  for (std::size_t b = 1; b < sides.size() && !connected_.empty(); ++b) {
    for (std::size_t a = 0; a < b; ++a) {
      const Moments& hits = connected_[pair_of_sides(a, b)];
      if (sides.size() > sides_in_full && !(hits.mean() > 0)) continue;
      figures.percolation.push_back({sides[a], sides[b], probability_of(hits), probability_interval(hits)});
    }
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
  add_cases(figures);
  add_block_sizes(figures);
  add_variances(figures);
  add_border(figures);
  add_factors(figures);
  add_pressures(figures);
  add_percolation(figures);
  add_notes(figures);
  return figures;
}

}  // namespace cleave::stochastic
