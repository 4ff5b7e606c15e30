#include "cleave/report/monte_carlo.hpp"

#include <utility>

#include "cleave/report/json.hpp"
#include "cleave/scene/plan.hpp"
#include "plane_parts.hpp"

namespace cleave::report {
namespace {

using stochastic::Estimate;
using stochastic::Figures;
using stochastic::Interval;

void write_interval(JsonWriter& json, const Interval& interval) {
  json.member("low", interval.low);
  json.member("high", interval.high);
}

void write_estimates(JsonWriter& json, const Figures& figures) {
  json.key("quantities");
  json.begin_object();
  for (const Estimate& e : figures.estimates) {
    json.key(e.name);
    json.begin_object();
    json.member("mean", e.mean);
    json.member("standard_error", e.standard_error);
    json.member("low", e.low);
    json.member("high", e.high);
    json.member("confidence", figures.confidence);
    json.member("std", e.std);
    json.member("method", stochastic::name_of(e.method));
    json.member("realizations", e.realizations);
    if (e.method != stochastic::Method::ratio) {
      json.member("smallest", e.smallest);
      json.member("largest", e.largest);
      json.member("skewness", e.skewness);
      json.member("optimistic", e.optimistic);
    }
    if (e.bootstrap) {
      json.member("bootstrap_low", e.bootstrap->low);
      json.member("bootstrap_high", e.bootstrap->high);
    }
    json.end_object();
  }
  json.end_object();
}

void write_difference(JsonWriter& json, std::string_view name, const Estimate& e) {
  json.key(name);
  json.begin_object();
  json.member("mean", e.mean);
  json.member("standard_error", e.standard_error);
  json.member("low", e.low);
  json.member("high", e.high);
  json.end_object();
}

/// Orders of the excavation stages, each in every realization.
void write_orders(JsonWriter& json, const MonteCarloPage& page) {
  const Figures& f = page.result.figures;
  if (f.orders.empty()) return;
  json.key("orders");
  json.begin_array();
  for (std::size_t i = 0; i < f.orders.size(); ++i) {
    json.begin_object();
    json.key("stages");
    json.begin_array();
    for (const std::uint32_t stage : page.orders.at(i)) json.value(stage);
    json.end_array();
    write_difference(json, "key_blocks", f.orders[i].key_blocks);
    write_difference(json, "key_volume_m3", f.orders[i].key_m3);
    write_difference(json, "key_blocks_minus_first", f.orders[i].key_blocks_minus_first);
    write_difference(json, "key_volume_minus_first_m3", f.orders[i].key_m3_minus_first);
    json.member("share_best", f.orders[i].share_best);
    json.end_object();
  }
  json.end_array();
}

void write_variances(JsonWriter& json, const Figures& f) {
  if (f.strengths_per_geometry == 1) return;
  json.key("nested");
  json.begin_object();
  json.member("strengths_per_geometry", f.strengths_per_geometry);
  json.key("variances");
  json.begin_object();
  for (const stochastic::VarianceShare& share : f.variances) {
    json.key(share.name);
    json.begin_object();
    json.member("geometry", share.geometry);
    json.member("strength", share.strength);
    json.end_object();
  }
  json.end_object();
  json.end_object();
}

void write_quantiles(JsonWriter& json, const Figures& figures) {
  json.key("quantiles");
  json.begin_array();
  for (const auto& q : figures.quantiles) {
    json.begin_object();
    json.member("quantity", q.name);
    json.member("p", q.p);
    json.member("value", q.value);
    if (q.interval) {
      write_interval(json, *q.interval);
    } else {
      json.key("low");
      json.null();
      json.key("high");
      json.null();
      json.member("reason", "not available: too few realizations");
    }
    json.end_object();
  }
  json.end_array();
}

void write_exceedances(JsonWriter& json, const Figures& figures) {
  json.key("exceedance");
  json.begin_array();
  for (const auto& e : figures.exceedances) {
    json.begin_object();
    json.member("volume_m3", e.volume_m3);
    json.member("realizations", e.realizations);
    json.member("probability", e.probability);
    write_interval(json, e.interval);
    json.member("number", e.number);
    json.member("number_standard_error", e.number_standard_error);
    if (e.per_metre) json.member("per_metre", *e.per_metre);
    if (e.per_metre_standard_error) json.member("per_metre_standard_error", *e.per_metre_standard_error);
    if (!e.by_chainage.empty()) {
      json.key("by_chainage");
      json.begin_array();
      for (std::size_t i = 0; i < e.by_chainage.size(); ++i) {
        json.begin_object();
        json.member("probability", e.by_chainage[i]);
        write_interval(json, e.by_chainage_interval[i]);
        json.end_object();
      }
      json.end_array();
    }
    json.end_object();
  }
  json.end_array();
}

void write_sizes(JsonWriter& json, std::string_view name, const std::vector<stochastic::SizePoint>& points) {
  json.key(name);
  json.begin_array();
  for (const auto& p : points) {
    json.begin_object();
    json.member("volume_m3", p.volume_m3);
    json.member("share_below", p.share);
    json.member("standard_error", p.standard_error);
    json.end_object();
  }
  json.end_array();
}

void write_extremes(JsonWriter& json, std::string_view name, const std::vector<stochastic::Extreme>& list) {
  json.key(name);
  json.begin_array();
  for (const auto& e : list) {
    json.begin_object();
    json.member("realization", e.realization);
    json.member("key_block_volume_m3", e.volume_m3);
    json.member("key_block_count", e.count);
    json.end_object();
  }
  json.end_array();
}

void write_section(JsonWriter& json, const MonteCarloPage& page) {
  const Figures& f = page.result.figures;
  json.key("monte_carlo");
  json.begin_object();
  json.member("realizations", f.realizations);
  json.member("seed", page.summary.seed);
  json.member("stopped_by", name_of(page.result.stopped_by));
  json.member("status", f.failures > 0                                    ? "incomplete"
                        : page.result.stopped_by == scene::StoppedBy::max ? "not converged"
                                                                          : "done");
  if (!page.stop_quantity.empty()) json.member("interval_kind", "sequential, fixed looks");
  json.key("shard");
  json.begin_object();
  json.member("number", page.result.shard.number);
  json.member("of", page.result.shard.of);
  json.end_object();
  write_estimates(json, f);
  write_quantiles(json, f);
  write_exceedances(json, f);
  write_orders(json, page);
  write_variances(json, f);
  write_sizes(json, "size_distribution", f.sizes);
  write_sizes(json, "first_batch_size_distribution", f.first_sizes);
  json.key("running");
  json.begin_object();
  json.member("quantity", f.running_quantity);
  json.key("points");
  json.begin_array();
  for (const auto& p : f.running) {
    json.begin_object();
    json.member("realizations", p.realizations);
    json.member("mean", p.mean);
    json.member("half_width", p.half_width);
    json.end_object();
  }
  json.end_array();
  json.end_object();
  write_extremes(json, "worst", f.worst);
  write_extremes(json, "best", f.best);
  json.member("failures", f.failures);
  json.key("failed_realizations");
  json.begin_array();
  for (const std::uint64_t k : f.failed) json.value(k);
  json.end_array();
  json.member("stopped_at_max_batches", f.stopped_at_max_batches);
  json.member("free_area_fixed_share", f.free_area_fixed_share);
  if (f.middle_fixed_share) json.member("middle_area_fixed_share", *f.middle_fixed_share);
  if (f.guard_length_m) json.member("guard_length_m", *f.guard_length_m);
  json.key("factors_of_safety");
  json.begin_array();
  for (const auto& point : f.factors) {
    json.begin_object();
    json.member("factor", point.factor);
    json.member("share_below", point.share_below);
    json.member("number_below", point.number_below);
    json.end_object();
  }
  json.end_array();
  json.member("surface_blocks_fixed_share", f.surface_fixed_share);
  json.member("key_volume_beside_fixed_share", f.beside_fixed_share);
  json.key("notes");
  json.begin_array();
  for (const std::string& note : f.notes) json.value(std::string_view{note});
  json.end_array();
  json.member("hash", f.hash);
  json.end_object();
}

}  // namespace

Summary monte_carlo_summary(const scene::Scene& scene, const scene::RunCost& cost) {
  return head_of(scene.title, scene.seed, scene.sha256, make_plan(scene), cost);
}

MonteCarloPage monte_carlo_page(const scene::Scene& scene, const scene::RunCost& cost, scene::MonteCarloResult result) {
  MonteCarloPage page{.summary = monte_carlo_summary(scene, cost),
                      .result = std::move(result),
                      .scene_file = scene.file_name,
                      .files = {},
                      .notes = {},
                      .tunnel_length_m = ensemble_options_of(scene).tunnel_length_m,
                      .stop_quantity = {},
                      .orders = orders_of(scene)};
  for (const scene::InputFile& file : scene.files) {
    page.files.push_back({.name = file.name, .sha256 = file.sha256, .bytes = file.bytes});
  }
  for (const scene::Problem& note : scene.notes) page.notes.push_back(describe(note));
  if (scene.monte_carlo && scene.monte_carlo->stop) page.stop_quantity = scene.monte_carlo->stop->quantity;
  return page;
}

std::string monte_carlo_json(const MonteCarloPage& page) {
  JsonWriter json;
  json.begin_object();
  write_summary_head(json, page.summary);
  json.member("scene_file", page.scene_file);
  write_section(json, page);
  json.end_object();
  return std::move(json).finish();
}

}  // namespace cleave::report
