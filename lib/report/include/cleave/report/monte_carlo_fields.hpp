#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "cleave/core/fields.hpp"
#include "cleave/report/monte_carlo.hpp"

/// The figures of a Monte Carlo run in summary.json.
namespace cleave::stochastic {

template <class V>
void fields(V& v, const Interval& x) {
  v("low", x.low);
  v("high", x.high);
}
/// What is known of an estimate among others of its kind.
template <class V>
void mean_fields(V& v, const Estimate& x) {
  v("mean", x.mean);
  v("standard_error", x.standard_error);
  v("low", or_null(x.low));
  v("high", or_null(x.high), "null: no realization has any, so that nothing is known of its size");
}
template <class V>
void fields(V& v, const SizePoint& x) {
  v("volume_m3", x.volume_m3);
  v("share_below", x.share);
  v("standard_error", x.standard_error);
}
template <class V>
void fields(V& v, const SizeShare& x) {
  v("volume_m3", x.volume);
  v("by_number", x.by_number, "share of the blocks below that volume");
  v("by_number_low", x.by_number_interval.low);
  v("by_number_high", x.by_number_interval.high);
  v("by_volume", x.by_volume, "share of their volume in blocks below it (passing)");
  v("by_volume_low", x.by_volume_interval.low);
  v("by_volume_high", x.by_volume_interval.high);
}
/// Why an end of the interval is not there.
inline std::string reason_of_no_end(const SizeLevel& x) {
  if (!x.low && !x.high) return "not available: too few realizations or blocks";
  return x.high ? "low is not available: no volume below which the share would be too small"
                : "high is not available: too few blocks for an upper end";
}
template <class V>
void fields(V& v, const SizeLevel& x) {
  v("p", x.p);
  v("volume_m3", x.volume_m3, "below which that share lies");
  v("low", OrNull<double>{x.low}, "null: no volume below which the share would be too small");
  v("high", OrNull<double>{x.high}, "null: too few blocks for an upper end");
  v("reason", when(!x.low || !x.high, reason_of_no_end(x)));
}
/// A length with the cubes that its percentile has.
template <class V>
void cube_root_fields(V& v, const BlockSizeFigures& x, double p) {
  const auto found = std::ranges::find(x.by_volume, p, &SizeLevel::p);
  const SizeLevel level = found == x.by_volume.end() ? SizeLevel{} : *found;
  const auto root = [](const std::optional<double>& volume) {
    return OrNull<double>{volume ? std::optional{std::cbrt(*volume)} : std::nullopt};
  };
  v("mean", std::cbrt(level.volume_m3));
  v("low", root(level.low));
  v("high", root(level.high));
  v("reason", when(!level.low || !level.high, reason_of_no_end(level)));
}
template <class V>
void fields(V& v, const BlockSizeFigures& x) {
  const auto mean = [](const Estimate& e) { return group([&e](auto& w) { mean_fields(w, e); }); };
  v("blocks", x.blocks, "of all realizations, that touch no fixed side of the domain");
  v("corrected", x.corrected,
    "each counts as often as blocks of its extents are cut by the domain's sides for one that is not; false: the "
    "domain is no box, or has openings or free sides: large blocks are then too rare");
  v("mean_volume_m3", mean(x.mean_volume));
  v("met_share", mean(x.met_share), "of the rock's volume, that of these blocks");
  v("shares", by_name(x.shapes, &Estimate::name, [](auto& w, const Estimate& e) { mean_fields(w, e); }),
    "of their number, by Zingg's classes");
  v("by_number", x.by_number, "volumes below which a share of the blocks lies");
  v("by_volume", x.by_volume, "volumes below which a share of their volume lies (in-situ block size distribution)");
  v("d50_m", group([&x](auto& w) { cube_root_fields(w, x, 0.5); }), "cube root of by_volume at 0.5");
  v("d80_m", group([&x](auto& w) { cube_root_fields(w, x, 0.8); }), "cube root of by_volume at 0.8");
  v("curve", x.curve);
}
template <class V>
void fields(V& v, const SetEstimates& x) {
  const auto mean = [](const Estimate& e) { return group([&e](auto& w) { mean_fields(w, e); }); };
  v("name", x.name);
  v("joints", mean(x.joints), "that meet the box around the domain");
  v("p32", mean(x.p32), "1/m, area of joints in that box over its volume");
  v("p10", mean(x.p10), "1/m, joints along their mean normal, mean over all lines that way");
  v("p21", mean(x.p21), "1/m, length of traces on level planes, mean over all of them");
}
template <class V>
void fields(V& v, const Percolation& x) {
  v("from", x.from);
  v("to", x.to);
  v("probability", x.probability, "share of the realizations in which one cluster of joints connects the two");
  v("low", x.interval.low);
  v("high", x.interval.high);
}
template <class V>
void fields(V& v, const LineEstimates& x) {
  const auto mean = [](const Estimate& e) {
    return group([&e](auto& w) {
      mean_fields(w, e);
      w("std", e.std, "of one line: between realizations");
      w("smallest", e.smallest);
      w("largest", e.largest);
    });
  };
  v("name", x.name);
  v("frequency_per_m", mean(x.frequency), "joints crossed over metres of rock");
  v("rqd", mean(x.rqd), "%, share of the line in pieces of 0.1 m and more");
}
template <class V>
void fields(V& v, const FactorPoint& x) {
  v("factor", x.factor);
  v("share_below", x.share_below, "of those blocks");
  fields(v, x.share_interval);
  v("number_below", x.number_below, "mean a realization");
  v("probability", x.probability, "that a realization has one: the distribution of its least factor");
  v("probability_low", x.interval.low);
  v("probability_high", x.interval.high);
}
template <class V>
void fields(V& v, const PressureExceedance& x) {
  v("pressure_pa", x.pressure.si());
  v("probability", OrNull<double>{x.probability}, "that a realization needs more over the area of its excavations");
  v("low", or_null(x.interval, &Interval::low));
  v("high", or_null(x.interval, &Interval::high));
  v("reason", when(!x.probability, "no opening over whose area it would be"));
  v("block_probability", x.block_probability, "that a block of its first batch needs more over its free area");
  v("block_low", x.block_interval.low);
  v("block_high", x.block_interval.high);
}
template <class V>
void fields(V& v, const RunningPoint& x) {
  v("realizations", x.realizations);
  v("mean", x.mean);
  v("half_width", x.half_width);
}
template <class V>
void fields(V& v, const Extreme& x) {
  v("realization", x.realization);
  v("key_block_volume_m3", x.volume_m3);
  v("key_block_count", x.count);
}
template <class V>
void fields(V& v, const QuantileEstimate& x) {
  v("quantity", x.name);
  v("p", x.p);
  v("value", x.value);
  v("low", or_null(x.interval, &Interval::low));
  v("high", or_null(x.interval, &Interval::high));
  v("reason", when(!x.interval, "not available: too few realizations"));
}
template <class V>
void fields(V& v, const CaseExceedance& x) {
  v("volume_m3", x.volume.si());
  v("probability", x.probability, "that a realization has a key block above this volume");
  fields(v, x.interval);
}
template <class V>
void fields(V& v, const Exceedance& x) {
  v("volume_m3", x.volume_m3);
  v("realizations", x.realizations, "with a key block above this volume");
  v("probability", x.probability);
  fields(v, x.interval);
  v("number", x.number, "mean number of such blocks a realization");
  v("number_standard_error", x.number_standard_error);
  v("per_metre", x.per_metre);
  v("per_metre_standard_error", x.per_metre_standard_error);
  v("by_chainage", when_any(each(x.by_chainage, [&](auto& w, double probability, std::size_t part) {
      w("probability", probability);
      fields(w, part < x.by_chainage_interval.size() ? x.by_chainage_interval[part] : Interval{});
    })));
}

}  // namespace cleave::stochastic

namespace cleave::report {

template <class V>
void quantity_fields(V& v, const stochastic::Estimate& x, double confidence) {
  const bool ratio = x.method == stochastic::Method::ratio;
  mean_fields(v, x);
  v("confidence", confidence);
  v("std", x.std);
  v("method", one_of(x.method));
  v("realizations", x.realizations);
  v("smallest", when(!ratio, x.smallest));
  v("largest", when(!ratio, x.largest));
  v("skewness", when(!ratio, x.skewness));
  v("optimistic", when(!ratio || x.optimistic, x.optimistic),
    "long tail seen in few realizations: the interval may cover some per cent less than it says");
  const stochastic::Interval bootstrap = x.bootstrap.value_or(stochastic::Interval{});
  v("bootstrap_low", when(x.bootstrap.has_value(), bootstrap.low));
  v("bootstrap_high", when(x.bootstrap.has_value(), bootstrap.high));
  v("estimable", when(!x.estimable, x.estimable), "false: no number of realizations shows the mean: take quantiles");
}

template <class V>
void fields(V& v, const scene::StepSeconds& x) {
  v("stage", x.stage);
  v("thread_s", x.seconds);
}

template <class V>
void order_fields(V& v, const stochastic::OrderFigures& x, const std::vector<std::uint32_t>& stages) {
  const auto mean = [](const stochastic::Estimate& e) { return group([&e](auto& w) { mean_fields(w, e); }); };
  v("stages", stages);
  v("key_blocks", mean(x.key_blocks));
  v("key_volume_m3", mean(x.key_m3));
  v("key_blocks_minus_first", mean(x.key_blocks_minus_first));
  v("key_volume_minus_first_m3", mean(x.key_m3_minus_first));
  v("share_best", x.share_best);
}

template <class V>
void stop_fields(V& v, const scene::StopFigures& x) {
  v("quantity", x.asked.quantity);
  v("rule", one_of(x.asked.rule));
  v("confidence", x.asked.confidence);
  v("relative_half_width", x.asked.relative_half_width, "asked for");
  v("half_width_at_stop", OrNull<double>{x.half_width},
    "what the rule goes by: with fixed_looks the normal quantile times the standard error, with always_valid that of "
    "the confidence sequence; the quantity's own interval is wider where its law is skewed");
  v("relative_half_width_at_stop", OrNull<double>{x.relative_half_width}, "of the mean");
  v("reason",
    when(!x.relative_half_width, std::string{x.half_width ? "the mean is 0" : "fewer than two realizations"}));
}

/// What the rule that may end a run makes of the intervals.
inline std::string_view interval_kind_of(const MonteCarloPage& x) {
  const bool sequence = x.result.stop && x.result.stop->asked.rule == stochastic::StopRule::always_valid;
  return sequence ? "of a fixed number, stopped by a confidence sequence" : "sequential, fixed looks";
}

template <class V>
void stopping_fields(V& v, const MonteCarloPage& x) {
  v("interval_kind", when(x.stop_quantity.has_value(), interval_kind_of(x)),
    "of `quantities` in a run that `stop` ends. They are made as if the number of realizations had been fixed: with "
    "fixed_looks they hold about what they say all the same, with always_valid only half_width_at_stop holds at every "
    "look");
  v("stop", when(x.result.stop.has_value(),
                 group([&](auto& s) { stop_fields(s, x.result.stop.value_or(scene::StopFigures{})); })));
}

template <class V>
void fields(V& v, const MonteCarloPage& x) {
  const stochastic::Figures& f = x.result.figures;
  const scene::StoppedBy stopped = x.result.stopped_by;
  v("scene_file", x.scene_file, "of Monte Carlo runs: name of the scene's file, without its folder");
  v("openings", when_any(x.excavations), "of Monte Carlo runs: what each takes of the rock, in the order of the scene");
  v("realization_cost", when_any(x.result.stages),
    "seconds that the threads of this process spent in the stages of the realizations it made");
  v("monte_carlo", group([&](auto& w) {
      w("realizations", f.realizations);
      w("seed", x.seed);
      w("stopped_by", one_of(stopped));
      w("status", one_of(f.failures > 0                     ? "incomplete"
                         : stopped == scene::StoppedBy::max ? "not converged"
                                                            : "done",
                         {"done", "not converged", "incomplete"}));
      stopping_fields(w, x);
      w("shard", group([&](auto& s) {
          s("number", x.result.shard.number);
          s("of", x.result.shard.of);
        }));
      w("quantities",
        by_name(f.estimates, &stochastic::Estimate::name,
                [&](auto& q, const stochastic::Estimate& e) { quantity_fields(q, e, f.confidence); }),
        "by name");
      w("quantiles", f.quantiles);
      w("exceedance", f.exceedances);
      w("orders",
        when_any(each(f.orders,
                      [&](auto& o, const stochastic::OrderFigures& order, std::size_t at) {
                        order_fields(o, order, at < x.orders.size() ? x.orders[at] : std::vector<std::uint32_t>{});
                      })),
        "orders of the excavation stages, the scene's own first; differences are paired");
      w("load_cases",
        when_any(each(f.cases,
                      [&](auto& c, const stochastic::CaseEstimates& under) {
                        c("name", under.name);
                        c("quantities",
                          by_name(under.estimates, &stochastic::Estimate::name,
                                  [&](auto& q, const stochastic::Estimate& e) { quantity_fields(q, e, f.confidence); }),
                          "by name, as of the base case");
                        c("exceedance", when_any(under.exceedances));
                      })),
        "the same realizations under each [[load]]");
      w("nested", when(f.strengths_per_geometry != 1, group([&](auto& n) {
                         n("strengths_per_geometry", f.strengths_per_geometry);
                         n("variances",
                           by_name(f.variances, &stochastic::VarianceShare::name,
                                   [](auto& s, const stochastic::VarianceShare& share) {
                                     s("geometry", share.geometry);
                                     s("strength", share.strength);
                                   }),
                           "by quantity");
                       })));
      w("sets", when_any(f.sets), "realized amounts of the joint sets, mean over realizations");
      w("jv", when(f.jv.has_value(), group([&](auto& q) { mean_fields(q, f.jv.value_or(stochastic::Estimate{})); })),
        "1/m, volumetric joint count: p10 of the sets, added (Palmstrom 1982)");
      w("lines", when_any(f.lines), "scanlines, mean over realizations");
      w("percolation", when_any(f.percolation),
        "[flow]: pairs of the domain's sides (of over 8 those that some realization connects, of over 100 none)");
      w("block_sizes", f.block_sizes, "where all blocks are cut");
      w("size_distribution", f.sizes);
      w("first_batch_size_distribution", f.first_sizes);
      w("running", group([&](auto& r) {
          r("quantity", f.running_quantity);
          r("points", f.running);
        }));
      w("worst", f.worst);
      w("best", f.best);
      w("failures", f.failures);
      w("failed_realizations", f.failed);
      w("stopped_at_max_batches", f.stopped_at_max_batches);
      w("free_area_fixed_share", f.free_area_fixed_share,
        "of the area of excavations, that of blocks that a fixed side of the domain holds");
      w("middle_area_fixed_share", f.middle_fixed_share, "the same in the middle half of the tunnel");
      w("guard_length_m", f.guard_length_m, "lost at each end of the tunnel to blocks that the domain holds");
      w("factors_of_safety", f.factors, "distribution over the blocks that would move without friction");
      w("pressure_exceedance", f.pressures, "of what has to be held");
      w("surface_blocks_fixed_share", f.surface_fixed_share,
        "of blocks with a free face, those that a side of the domain that is not free may hold: a larger domain may "
        "lay "
        "them bare");
      w("key_volume_beside_fixed_share", f.beside_fixed_share,
        "of the volume of key blocks, that of those beside such a block");
      w("notes", f.notes, "of those at the top, what is said of the figures here");
      w("hash", f.hash);
    }),
    "the same bytes for any number of threads, shards and interruptions");
}

}  // namespace cleave::report
