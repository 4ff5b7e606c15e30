#include <cmath>

#include "cleave/geometry/orientation.hpp"
#include "cleave/report/json.hpp"
#include "cleave/report/survey.hpp"

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

/// NAME_low and NAME_high, where there is an interval.
void write_interval(JsonWriter& json, const std::string& name, const Estimate& e) {
  if (!e.value || !std::isfinite(e.high)) return;
  json.member(name + "_low", e.low);
  json.member(name + "_high", e.high);
}

void write_fit(JsonWriter& json, const survey::Fit& fit) {
  json.member("law", survey::name_of(fit.family));
  json.member("mean", fit.moment(1));
  json.member("std", std::sqrt(std::max(0.0, fit.moment(2) - fit.moment(1) * fit.moment(1))));
  json.member("a", fit.a);
  json.member("b", fit.b);
  json.member("aic", fit.aic);
  json.member("kolmogorov_smirnov", fit.distance);
  if (fit.p_value) json.member("p_value", *fit.p_value);
}

void write_set(JsonWriter& json, const survey::SetResult& set) {
  json.begin_object();
  json.member("name", set.name);
  json.member("joints", set.joints);
  json.member("traces", set.traces);
  if (set.joints > 0 || set.orientation_stated) {
    const geometry::Attitude mean = geometry::attitude_of(set.orientation.mean);
    json.key("orientation");
    json.begin_object();
    json.member("dip", mean.dip.degrees());
    json.member("dip_direction", mean.direction.degrees());
    json.member("measured", !set.orientation_stated);
    json.member("cone_degrees", set.orientation.cone_degrees);
    json.member("kappa", set.orientation.kappa);
    json.member("kappa_low", set.orientation.kappa_low);
    json.member("kappa_high", set.orientation.kappa_high);
    json.member("effective_count", set.orientation.effective_count);
    json.member("capped", set.orientation.capped);
    json.member("fisher", set.orientation.fisher);
    json.member("statistic", set.orientation.statistic);
    if (set.bingham) {
      json.member("bingham_k1", set.bingham->k1);
      json.member("bingham_k2", set.bingham->k2);
    }
    json.end_object();
  }
  json.key("estimates");
  json.begin_array();
  for (const auto* e : {&set.p10_normal, &set.p20, &set.p21, &set.mean_length, &set.mean_length_counts, &set.p32_lines,
                        &set.p32_windows, &set.p30}) {
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
    write_fit(json, law.fit);
    write_interval(json, "mean", law.mean);
    write_interval(json, "std", law.std);
    if (law.disc_mean) write_interval(json, "diameter_mean", *law.disc_mean);
    if (law.disc_std) write_interval(json, "diameter_std", *law.disc_std);
    if (law.discs) {
      json.member("diameter_mean", law.discs->mean);
      json.member("diameter_std", law.discs->std);
    }
    json.end_object();
  }
  json.end_array();
  json.key("spacings");
  json.begin_array();
  for (const survey::Fit& fit : set.spacings) {
    json.begin_object();
    write_fit(json, fit);
    json.end_object();
  }
  json.end_array();
  if (set.size) {
    json.key("diameter");
    json.begin_object();
    json.member("law", survey::name_of(set.size->family));
    json.member("mean", set.size->mean);
    json.member("std", set.size->std);
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

}  // namespace

std::string survey_json(const scene::SurveyScene& survey, const survey::SurveyResult& result) {
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
  for (const survey::SetResult& set : result.sets) write_set(json, set);
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
    json.end_object();
  }
  json.end_array();
  json.key("windows");
  json.begin_array();
  for (const survey::WindowResult& window : result.windows) {
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
    json.member("nodes_isolated", window.nodes.isolated);
    json.member("nodes_abutting", window.nodes.abutting);
    json.member("nodes_crossing", window.nodes.crossing);
    json.member("connections_per_trace", window.nodes.connections);
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
