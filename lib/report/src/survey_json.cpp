#include <cmath>

#include "cleave/geometry/orientation.hpp"
#include "cleave/report/json.hpp"
#include "cleave/report/survey.hpp"
#include "cleave/survey/comparison.hpp"

namespace cleave::report {
namespace {

using survey::Estimate;

void write_estimate(JsonWriter& json, const Estimate& e) {
  json.begin_object();
  json.member("name", e.name);
  if (e.value) {
    json.member("value", *e.value);
    json.member("low", e.low);
    json.member("high", e.high);
  } else {
    json.key("value");
    json.null();
  }
  json.member("method", e.method);
  if (!e.note.empty()) json.member("note", e.note);
  json.end_object();
}

/// NAME_low and NAME_high; null where there is no end.
void write_interval(JsonWriter& json, const std::string& name, double low, double high) {
  json.member(name + "_low", low);
  json.member(name + "_high", high);
}
void write_interval(JsonWriter& json, const std::string& name, const Estimate& e) {
  if (e.value) write_interval(json, name, e.low, e.high);
}

void write_fit(JsonWriter& json, const survey::Fit& fit, double confidence) {
  json.member("law", survey::name_of(fit.family));
  json.member("mean", fit.moment(1));
  json.member("std", std::sqrt(std::max(0.0, fit.moment(2) - fit.moment(1) * fit.moment(1))));
  json.member("a", fit.a);
  json.member("b", fit.b);
  json.member("aic", fit.aic);
  json.member("kolmogorov_smirnov", fit.distance);
  for (const Estimate& e : parameters_of(fit, confidence)) write_interval(json, e.name, e);
  if (fit.p_value) json.member("p_value", *fit.p_value);
}

void write_size(JsonWriter& json, const survey::SizeOfJoints& law) {
  json.member("law", survey::name_of(law.family));
  json.member("mean", law.mean);
  json.member("std", law.std);
  if (law.family == survey::Family::power) {
    json.member("exponent", law.exponent);
    json.member("min", law.min);
    json.member("max", law.max);
  }
}

void write_orientation(JsonWriter& json, const survey::SetResult& set) {
  const survey::FisherFit& fit = set.orientation;
  const geometry::Attitude mean = geometry::attitude_of(fit.mean);
  json.begin_object();
  json.member("dip", mean.dip.degrees());
  json.member("dip_direction", mean.direction.degrees());
  if (set.direction) write_interval(json, "dip_direction", *set.direction);
  json.member("measured", !set.orientation_stated);
  json.member("cone_degrees", fit.cone_degrees);
  json.member("kappa", fit.kappa);
  // Stated figures have no error.
  if (!set.orientation_stated || fit.kappa_high > 0) write_interval(json, "kappa", fit.kappa_low, fit.kappa_high);
  json.member("effective_count", fit.effective_count);
  json.member("capped", fit.capped);
  json.member("fisher", fit.fisher);
  json.member("statistic", fit.statistic);
  if (set.bingham) {
    json.member("bingham_k1", set.bingham->k1);
    write_interval(json, "bingham_k1", set.bingham->first[0], set.bingham->first[1]);
    json.member("bingham_k2", set.bingham->k2);
    write_interval(json, "bingham_k2", set.bingham->second[0], set.bingham->second[1]);
  }
  json.end_object();
}

void write_set(JsonWriter& json, const survey::SetResult& set, double confidence) {
  json.begin_object();
  json.member("name", set.name);
  json.member("joints", set.joints);
  json.member("traces", set.traces);
  if (set.joints > 0 || set.orientation_stated) {
    json.key("orientation");
    write_orientation(json, set);
  }
  json.key("estimates");
  json.begin_array();
  for (const auto* e : {&set.p10_normal, &set.p20, &set.p21, &set.mean_length, &set.mean_length_counts, &set.p32_lines,
                        &set.p32_windows, &set.p30, &set.m2, &set.m3}) {
    if (*e) write_estimate(json, **e);
  }
  json.end_array();
  if (set.p32) {
    json.key("p32");
    write_estimate(json, *set.p32);
  }
  json.key("trace_lengths");
  json.begin_array();
  for (const survey::FittedLaw& law : set.lengths) {
    json.begin_object();
    write_fit(json, law.fit, confidence);
    write_interval(json, "mean", law.mean);
    write_interval(json, "std", law.std);
    if (law.size_mean) write_interval(json, "size_mean", *law.size_mean);
    if (law.size_std) write_interval(json, "size_std", *law.size_std);
    if (law.test) {
      json.member("p_value", law.test->p_value);
      json.member("p_value_traces", law.test->traces);
    }
    if (law.sizes) {
      json.member("size_mean", law.sizes->mean);
      json.member("size_std", law.sizes->std);
    }
    json.end_object();
  }
  json.end_array();
  json.key("spacings");
  json.begin_array();
  for (const survey::Fit& fit : set.spacings) {
    json.begin_object();
    write_fit(json, fit, confidence);
    write_interval(json, "mean", estimate_of(fit, "", [](const survey::Fit& f) { return f.moment(1); }, confidence));
    write_interval(json, "std", estimate_of(fit, "", [](const survey::Fit& f) { return std_of(f); }, confidence));
    json.member("p_value_textbook", survey::textbook_p_value(fit.distance, set.gaps.size()));
    const survey::ChiSquared chi = chi_squared(set.gaps, fit);
    if (chi.bins >= 3) {
      json.member("chi_squared", chi.statistic);
      json.member("chi_squared_bins", chi.bins);
      json.member("chi_squared_p_low", chi.p_low);
      json.member("chi_squared_p_high", chi.p_high);
    }
    json.end_object();
  }
  json.end_array();
  json.member("shape", survey::name_of(set.shape.shape));
  if (set.shape.shape != survey::JointShape::disc) {
    json.member("aspect", set.shape.aspect);
    json.member("rotation", set.shape.rotation);
  }
  json.key("sizes");
  json.begin_array();
  for (const survey::FittedSize& size : set.sizes) {
    json.begin_object();
    write_size(json, size.law);
    write_interval(json, "mean", size.mean);
    write_interval(json, "std", size.std);
    if (size.exponent) write_interval(json, "exponent", *size.exponent);
    json.member("aic", size.aic);
    json.member("method", size.method);
    json.end_object();
  }
  json.end_array();
  json.key("comparisons");
  json.begin_array();
  for (const Estimate& e : set.comparisons) write_estimate(json, e);
  json.end_array();
  if (set.size) {
    json.key("size");
    json.begin_object();
    write_size(json, *set.size);
    if (set.size_mean) write_interval(json, "mean", *set.size_mean);
    if (set.size_std) write_interval(json, "std", *set.size_std);
    json.end_object();
  }
  json.key("notes");
  json.begin_array();
  for (const std::string& note : set.notes) json.value(std::string_view{note});
  json.end_array();
  json.end_object();
}

void write_map(JsonWriter& json, const scene::MapFigures& map) {
  json.begin_object();
  json.member("traces", map.traces);
  json.member("p20", map.p20);
  json.member("p21", map.p21);
  json.member("mean_length_m", map.mean_length);
  json.member("connections_per_trace", map.connections);
  json.member("direction", map.direction);
  json.member("alignment", map.alignment);
  json.end_object();
}

/// The measured map as a whole with its intervals, and simulated ones of the fitted sets to lie beside it.
void write_maps(JsonWriter& json, const scene::MapsBeside& maps) {
  json.key("map");
  write_map(json, maps.measured);
  json.key("map_estimates");
  json.begin_array();
  for (const Estimate& e : maps.measured.estimates) write_estimate(json, e);
  json.end_array();
  json.key("simulated_maps");
  json.begin_array();
  for (const scene::MapFigures& map : maps.simulated) write_map(json, map);
  json.end_array();
}

}  // namespace

std::string survey_json(const scene::SurveyScene& survey, const survey::SurveyResult& result,
                        std::span<const scene::MapsBeside> maps) {
  JsonWriter json;
  json.begin_object();
  json.member("cleave", CLEAVE_VERSION);
  json.member("schema", 1U);
  json.member("title", survey.input.title);
  json.member("survey_sha256", survey.sha256);
  json.member("confidence", survey.input.confidence);
  json.member("orientations", survey.input.orientations.size());
  json.member("unassigned", result.unassigned);
  json.key("eigenvalues");
  json.begin_array();
  for (const double v : result.tensor.values) json.value(v);
  json.end_array();
  for (const std::size_t end : {std::size_t{0}, std::size_t{1}}) {
    json.key(end == 0 ? "eigenvalues_low" : "eigenvalues_high");
    json.begin_array();
    for (const auto& interval : result.tensor_intervals) json.value(interval.at(end));
    json.end_array();
  }
  json.key("silhouettes");
  json.begin_array();
  for (const auto& [sets, value] : result.silhouettes) {
    json.begin_object();
    json.member("sets", sets);
    json.member("silhouette", value);
    json.end_object();
  }
  json.end_array();
  json.key("sets");
  json.begin_array();
  for (const survey::SetResult& set : result.sets) write_set(json, set, survey.input.confidence);
  json.end_array();
  json.key("lines");
  json.begin_array();
  for (const survey::LineResult& line : result.lines) {
    json.begin_object();
    json.member("name", line.name);
    json.member("length_m", line.length);
    json.key("frequency");
    write_estimate(json, line.frequency);
    json.member("rqd_measured", line.rqd_measured);
    json.member("rqd_of_frequency", line.rqd_of_frequency);
    json.key("rqd");
    json.begin_array();
    write_estimate(json, line.rqd);
    write_estimate(json, line.rqd_by_frequency);
    json.end_array();
    json.key("comparisons");
    json.begin_array();
    for (const Estimate& e : line.comparisons) write_estimate(json, e);
    json.end_array();
    json.end_object();
  }
  json.end_array();
  json.key("windows");
  json.begin_array();
  for (std::size_t w = 0; w < result.windows.size(); ++w) {
    const survey::WindowResult& window = result.windows[w];
    const survey::WindowCounts& c = window.counts;
    json.begin_object();
    json.member("name", window.name);
    json.member("area_m2", c.area);
    json.member("traces", c.traces());
    json.member("ends_0", c.n0);
    json.member("ends_1", c.n1);
    json.member("ends_2", c.n2);
    json.member("length_inside_m", c.length);
    json.member("crossings", c.crossings);
    json.key("estimates");
    json.begin_array();
    for (const Estimate& e : window.estimates) write_estimate(json, e);
    json.end_array();
    if (window.nodes) {
      json.member("nodes_isolated", window.nodes->isolated);
      json.member("nodes_abutting", window.nodes->abutting);
      json.member("nodes_crossing", window.nodes->crossing);
      json.member("connections_per_trace", window.nodes->connections.value.value_or(0));
      write_interval(json, "connections_per_trace", window.nodes->connections);
    }
    write_maps(json, maps[w]);
    json.end_object();
  }
  json.end_array();
  json.key("notes");
  json.begin_array();
  for (const std::string& note : result.notes) json.value(std::string_view{note});
  for (const scene::Problem& note : survey.notes) json.value(std::string_view{describe(note)});
  json.end_array();
  json.end_object();
  return std::move(json).finish();
}

}  // namespace cleave::report
