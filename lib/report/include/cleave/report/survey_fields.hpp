#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "cleave/core/fields.hpp"
#include "cleave/core/version.hpp"
#include "cleave/field_data/survey_file.hpp"
#include "cleave/geometry/orientation.hpp"
#include "cleave/survey/comparison.hpp"

/// The figures of a survey: survey.json and the lines of the terminal show these.
namespace cleave::survey {

template <class V>
void fields(V& v, const Estimate& x) {
  v("name", x.name);
  v("value", OrNull<double>{x.value});
  v("low", when(x.value.has_value(), bounded(x) ? x.low : NAN));
  v("high", when(x.value.has_value(), x.high));
  v("method", x.method);
  v("note", when(!x.note.empty(), x.note));
}

/// NAME_low and NAME_high; null where there is no end.
template <class V>
void interval_fields(V& v, const std::string& name, double low, double high) {
  v(name + "_low", low != 0 || std::isfinite(high) ? low : NAN);
  v(name + "_high", high);
}
template <class V>
void interval_fields(V& v, const std::string& name, const Estimate& e) {
  if (e.value) interval_fields(v, name, e.low, e.high);
}
template <class V>
void interval_fields(V& v, const std::string& name, const std::optional<Estimate>& e) {
  if (e) interval_fields(v, name, *e);
}

template <class V>
void fit_fields(V& v, const Fit& fit, double confidence) {
  v("law", name_of(fit.family));
  v("mean", fit.moment(1));
  v("std", std::sqrt(std::max(0.0, fit.moment(2) - fit.moment(1) * fit.moment(1))));
  v("a", fit.a);
  v("b", fit.b);
  v("aic", fit.aic);
  v("kolmogorov_smirnov", fit.distance);
  for (const Estimate& e : parameters_of(fit, confidence)) interval_fields(v, e.name, e);
  v("p_value", fit.p_value);
}

template <class V>
void fields(V& v, const SizeOfJoints& law) {
  const bool power = law.family == Family::power;
  v("law", name_of(law.family));
  v("mean", law.mean);
  v("std", law.std);
  v("exponent", when(power, law.exponent));
  v("min", when(power, law.min));
  v("max", when(power, law.max));
}

/// Why the mean has no cone.
inline std::string no_cone(const SetResult& set) {
  if (set.orientation_stated) return "stated, not measured";
  return set.joints == 1 ? "one joint: nothing tells how they scatter"
                         : "all joints are parallel: nothing tells how others scatter";
}

template <class V>
void orientation_fields(V& v, const SetResult& set) {
  const FisherFit& fit = set.orientation;
  const geometry::Attitude mean = compass_attitude(fit.mean, set.north);
  v("dip", mean.dip.degrees());
  v("dip_direction", mean.direction.degrees());
  interval_fields(v, "dip_direction", set.direction);
  v("measured", !set.orientation_stated);
  v("cone_degrees", OrNull<double>{fit.cone_degrees});
  v("cone_degrees_reason", when(!fit.cone_degrees, no_cone(set)));
  v("kappa", fit.kappa);
  // Stated figures have no error.
  if (!set.orientation_stated || fit.kappa_high > 0) interval_fields(v, "kappa", fit.kappa_low, fit.kappa_high);
  v("effective_count", fit.effective_count);
  v("capped", fit.capped);
  v("fisher", set.orientation_stated || (fit.statistic && fit.fisher), "stated, or tested and not refused");
  v("statistic", OrNull<double>{fit.statistic}, "null: fewer than five joints, or all parallel: not tested");
  if (set.bingham) {
    v("bingham_k1", set.bingham->k1);
    interval_fields(v, "bingham_k1", set.bingham->first[0], set.bingham->first[1]);
    v("bingham_k2", set.bingham->k2);
    interval_fields(v, "bingham_k2", set.bingham->second[0], set.bingham->second[1]);
  }
}

template <class V>
void trace_length_fields(V& v, const FittedLaw& law, double confidence) {
  fit_fields(v, law.fit, confidence);
  interval_fields(v, "mean", law.mean);
  interval_fields(v, "std", law.std);
  interval_fields(v, "size_mean", law.size_mean);
  interval_fields(v, "size_std", law.size_std);
  if (law.test) {
    v("p_value", law.test->p_value);
    v("p_value_traces", law.test->traces);
  }
  if (law.sizes) {
    v("size_mean", law.sizes->mean);
    v("size_std", law.sizes->std);
  }
}

template <class V>
void spacing_fields(V& v, const SetResult& set, const Fit& fit, double confidence) {
  fit_fields(v, fit, confidence);
  interval_fields(v, "mean", estimate_of(fit, "", [](const Fit& f) { return f.moment(1); }, confidence));
  interval_fields(v, "std", estimate_of(fit, "", [](const Fit& f) { return std_of(f); }, confidence));
  v("p_value_textbook", textbook_p_value(fit.distance, set.gaps.size()));
  const ChiSquared chi = chi_squared(set.gaps, fit);
  if (chi.bins >= 3) {
    v("chi_squared", chi.statistic);
    v("chi_squared_bins", chi.bins);
    v("chi_squared_p_low", chi.p_low);
    v("chi_squared_p_high", chi.p_high);
  }
}

template <class V>
void set_fields(V& v, const SetResult& set, double confidence) {
  v("name", set.name);
  v("joints", set.joints);
  v("traces", set.traces);
  v("orientation", when(set.joints > 0 || set.orientation_stated, group([&](auto& w) { orientation_fields(w, set); })));
  std::vector<Estimate> estimates;
  for (const auto* e : {&set.p10_normal, &set.p20, &set.p21, &set.mean_length, &set.mean_length_counts, &set.p32_lines,
                        &set.p32_windows, &set.p30, &set.m2, &set.m3}) {
    if (*e) estimates.push_back(**e);
  }
  v("estimates", estimates);
  v("p32", set.p32);
  v("trace_lengths", each(set.lengths, [&](auto& w, const FittedLaw& x) { trace_length_fields(w, x, confidence); }));
  v("spacings", each(set.spacings, [&](auto& w, const Fit& fit) { spacing_fields(w, set, fit, confidence); }));
  const bool disc = set.shape.shape == JointShape::disc;
  v("shape", name_of(set.shape.shape));
  v("aspect", when(!disc, set.shape.aspect));
  v("rotation", when(!disc, set.shape.rotation));
  v("sizes", each(set.sizes, [](auto& w, const FittedSize& size) {
      fields(w, size.law);
      interval_fields(w, "mean", size.mean);
      interval_fields(w, "std", size.std);
      interval_fields(w, "exponent", size.exponent);
      w("aic", size.aic);
      w("method", size.method);
    }));
  v("comparisons", set.comparisons);
  v("size", when(set.size.has_value(), group([&](auto& w) {
                   fields(w, *set.size);
                   interval_fields(w, "mean", set.size_mean);
                   interval_fields(w, "std", set.size_std);
                 })));
  v("notes", set.notes);
}

template <class V>
void fields(V& v, const LineResult& line) {
  v("name", line.name);
  v("length_m", line.length);
  v("frequency", line.frequency);
  v("rqd_measured", line.rqd_measured);
  v("rqd_of_frequency", line.rqd_of_frequency);
  v("rqd", std::array{line.rqd, line.rqd_by_frequency});
  v("comparisons", line.comparisons);
}

template <class V>
void window_fields(V& v, const WindowResult& window) {
  const WindowCounts& c = window.counts;
  v("name", window.name);
  v("area_m2", c.area);
  v("traces", c.traces());
  v("ends_0", c.n0);
  v("ends_1", c.n1);
  v("ends_2", c.n2);
  v("length_inside_m", c.length);
  v("crossings", c.crossings);
  v("estimates", window.estimates);
  if (window.nodes) {
    v("nodes_isolated", window.nodes->isolated);
    v("nodes_abutting", window.nodes->abutting);
    v("nodes_crossing", window.nodes->crossing);
    v("connections_per_trace", or_null(window.nodes->connections.value.value_or(NAN)));
    interval_fields(v, "connections_per_trace", window.nodes->connections);
  }
}

}  // namespace cleave::survey

namespace cleave::scene {

template <class V>
void fields(V& v, const MapFigures& map) {
  v("traces", map.traces);
  v("p20", map.p20);
  v("p21", map.p21);
  v("mean_length_m", map.mean_length);
  v("connections_per_trace", map.connections);
  v("direction", map.direction);
  v("alignment", map.alignment);
}

/// The measured map as a whole with its intervals, and simulated ones of the fitted sets to lie beside it.
template <class V>
void fields(V& v, const SimulatedTraceMaps& maps) {
  v("map", maps.measured);
  v("map_estimates", maps.measured.estimates);
  v("simulated_maps", maps.simulated);
}

}  // namespace cleave::scene

namespace cleave::report {

/// All of survey.json. `maps`: one a window.
template <class V>
void survey_fields(V& v, const scene::SurveyScene& survey, const survey::SurveyResult& result,
                   std::span<const scene::SimulatedTraceMaps> maps) {
  std::vector<std::string> notes = result.notes;
  for (const scene::Problem& note : survey.notes) notes.push_back(describe(note));
  const auto end = [](std::size_t which) {
    return [which](const std::array<double, 2>& interval) { return interval.at(which); };
  };
  v("cleave", version);
  v("schema", 1U);
  v("title", survey.input.title);
  v("survey_sha256", survey.sha256);
  v("confidence", survey.input.confidence);
  v("north", survey.input.north.degrees());
  v("orientations", survey.input.orientations.size());
  v("unassigned", result.unassigned);
  v("eigenvalues", result.tensor.values);
  v("eigenvalues_low", each_as(result.tensor_intervals, end(0)));
  v("eigenvalues_high", each_as(result.tensor_intervals, end(1)));
  v("silhouettes", each(result.silhouettes, [](auto& w, const auto& row) {
      w("sets", row.first);
      w("silhouette", row.second);
    }));
  v("sets",
    each(result.sets, [&](auto& w, const survey::SetResult& set) { set_fields(w, set, survey.input.confidence); }));
  v("lines", result.lines);
  v("windows", each(result.windows, [&](auto& w, const survey::WindowResult& window, std::size_t i) {
      window_fields(w, window);
      fields(w, maps[i]);
    }));
  v("notes", notes);
}

}  // namespace cleave::report
