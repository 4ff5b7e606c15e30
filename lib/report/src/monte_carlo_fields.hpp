#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

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
  v("low", x.low);
  v("high", x.high);
}
template <class V>
void fields(V& v, const SizePoint& x) {
  v("volume_m3", x.volume_m3);
  v("share_below", x.share);
  v("standard_error", x.standard_error);
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
  v("probability", x.probability, "that a realization needs more over the area of its excavations");
  fields(v, x.interval);
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

template <class V>
void fields(V& v, const SizeLevel& x) {
  v("volume_m3", x.volume.si(), "of the blocks of all realizations");
  v("low", OrNull<double>{x.low}, "null: too few blocks");
  v("high", OrNull<double>{x.high}, "null: too few blocks");
  v("optimistic", when(x.optimistic, x.optimistic),
    "less than half of the rock is measured: the interval may cover less than it says");
  v("alone_mean", x.alone.mean, "mean over realizations of the volume in each alone");
  v("alone_low", x.alone.low);
  v("alone_high", x.alone.high);
  v("alone_std", x.alone.std, "between realizations");
}
template <class V>
void fields(V& v, const SizeCurvePoint& x) {
  v("volume_m3", x.volume.si());
  v("by_number", x.by_number, "share of the blocks that are smaller");
  v("by_number_low", x.number_interval.low);
  v("by_number_high", x.number_interval.high);
  v("by_volume", x.by_volume, "share of their volume in smaller blocks (passing)");
  v("by_volume_low", x.volume_interval.low);
  v("by_volume_high", x.volume_interval.high);
}
/// The edge of a cube as large as a block at a level of `by_volume`.
template <class V>
void diameter_fields(V& v, const BlockSizeFigures& x, std::string_view level) {
  const SizeLevel& at = *std::ranges::find(x.by_volume, level, &SizeLevel::name);
  v("mean", std::cbrt(at.volume.si()));
  v("optimistic", when(at.optimistic, at.optimistic), "the interval may cover less than it says");
  v("low", OrNull<double>{at.low ? std::optional{std::cbrt(*at.low)} : std::nullopt});
  v("high", OrNull<double>{at.high ? std::optional{std::cbrt(*at.high)} : std::nullopt});
}
template <class V>
void fields(V& v, const BlockSizeFigures& x) {
  const auto level = [](auto& w, const SizeLevel& at) { fields(w, at); };
  v("blocks", x.blocks, "that lie whole in the domain and touch no opening, of all realizations");
  v("border", one_of(x.corrected ? "corrected" : "left out", {"corrected", "left out"}),
    "corrected: each such block stands for as many as there are in a mass without sides (volume of the box over that "
    "of the places where the block lies whole in it); left out: the domain is no box, sizes are on the small side");
  v("mean_weight", x.mean_weight, "blocks that one stands for, mean");
  v("measured_share", x.measured_share, "of the rock, what lies in these blocks");
  v("beyond_share", x.beyond_share,
    "of the number of blocks, those below 1.1e-15 or above 8.9e11 m3: their volumes are not told apart");
  v("at_openings_share", x.at_openings_share,
    "of the rock that no side of the domain holds, what lies in blocks that openings cut: left out");
  v("by_number", by_name(x.by_number, &SizeLevel::name, level),
    "volumes below which so much of the number of blocks lies");
  v("by_volume", by_name(x.by_volume, &SizeLevel::name, level), "below which so much of their volume lies (passing)");
  v("d50_m", group([&](auto& w) { diameter_fields(w, x, "p50"); }), "cube root of by_volume.p50");
  v("d80_m", group([&](auto& w) { diameter_fields(w, x, "p80"); }), "cube root of by_volume.p80");
  v("shapes",
    by_name(x.shapes, &ShapeShare::name,
            [](auto& w, const ShapeShare& shape) {
              w("share", shape.share);
              fields(w, shape.interval);
            }),
    "Zingg's classes by number, a >= b >= c the axes of the ellipsoid of inertia, limits 2/3");
  v("curve", x.curve, "block size distribution; block_sizes.csv holds the same");
}

}  // namespace cleave::stochastic

namespace cleave::report {

template <class V>
void fields(V& v, const stochastic::SetEstimates& x) {
  const auto mean = [](const stochastic::Estimate& e) { return group([&e](auto& w) { mean_fields(w, e); }); };
  v("name", x.name);
  v("joints", mean(x.joints), "that meet the box around the domain");
  v("p10", mean(x.p10), "1/m, joints along their mean normal, mean over all lines that way");
  v("p21", mean(x.p21), "1/m, length of traces on level planes, mean over all of them");
  v("p32", mean(x.p32), "1/m, area of joints in that box over its volume");
}

template <class V>
void quantity_fields(V& v, const stochastic::Estimate& x, double confidence) {
  const bool ratio = x.method == stochastic::Method::ratio;
  mean_fields(v, x);
  v("confidence", confidence);
  v("std", x.std);
  v("method", one_of(stochastic::name_of(x.method), {"mean", "ratio", "mean_of_ratios"}));
  v("realizations", x.realizations);
  v("smallest", when(!ratio, x.smallest));
  v("largest", when(!ratio, x.largest));
  v("skewness", when(!ratio, x.skewness));
  v("optimistic", when(!ratio || x.optimistic, x.optimistic),
    "heavy tail: the interval covers some per cent less than it says");
  const stochastic::Interval bootstrap = x.bootstrap.value_or(stochastic::Interval{});
  v("bootstrap_low", when(x.bootstrap.has_value(), bootstrap.low));
  v("bootstrap_high", when(x.bootstrap.has_value(), bootstrap.high));
}

template <class V>
void fields(V& v, const scene::StageSeconds& x) {
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
      w("stopped_by", one_of(name_of(stopped), {"realizations", "precision", "max"}));
      w("status", one_of(f.failures > 0                     ? "incomplete"
                         : stopped == scene::StoppedBy::max ? "not converged"
                                                            : "done",
                         {"done", "not converged", "incomplete"}));
      w("interval_kind", when(x.stop_quantity.has_value(), "sequential, fixed looks"));
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
      w("size_distribution", f.sizes);
      w("first_batch_size_distribution", f.first_sizes);
      w("running", group([&](auto& r) {
          r("quantity", f.running_quantity);
          r("points", f.running);
        }));
      w("block_sizes", f.block_sizes,
        "sizes of the rock's blocks, where all of it was cut; intervals are over realizations");
      w("sets", when_any(f.sets), "realized amounts of the joint sets that were in the box in any realization");
      const stochastic::Estimate jv = f.jv.value_or(stochastic::Estimate{});
      w("jv", when(f.jv.has_value(), group([&](auto& j) { mean_fields(j, jv); })),
        "1/m, volumetric joint count: p10 of all sets (Palmstrom 1982)");
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
      w("surface_blocks_fixed_share", f.surface_fixed_share);
      w("key_volume_beside_fixed_share", f.beside_fixed_share);
      w("notes", f.notes);
      w("hash", f.hash);
    }),
    "the same bytes for any number of threads, shards and interruptions");
}

}  // namespace cleave::report
