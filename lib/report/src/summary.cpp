#include "cleave/report/summary.hpp"

#include <utility>

#include "cleave/exchange/json_fields.hpp"
#include "cleave/report/monte_carlo_fields.hpp"

template <class Tag>
struct cleave::Sample<cleave::Id<Tag>> {
  static Id<Tag> make() { return Id<Tag>{0U}; }
};

namespace cleave::report {
namespace {

using scene::head_fields;

template <class Result>
std::string written(const Result& result) {
  JsonWriter json;
  JsonFields figures{json};
  figures.put(group([&](auto& v) {
    head_fields(v, result);
    fields(v, result);
  }));
  return std::move(json).finish();
}

}  // namespace

std::string summary_json(const scene::RunResult& result) { return written(result); }
std::string summary_json(const scene::BodiesResult& result) { return written(result); }
std::string summary_json(const scene::ContactResult& result) { return written(result); }
std::string monte_carlo_json(const MonteCarloPage& page) { return written(page); }

std::string summary_schema() {
  JsonWriter json;
  json.begin_object();
  json.member("$schema", "https://json-schema.org/draft/2020-12/schema");
  json.member("title", "summary.json of cleave");
  json.member("description",
              "Figures of one run. Sections of stages that did not run are absent. A Monte Carlo run has `monte_carlo` "
              "in place of `input`, `blocks` and `key_blocks`: no one block system stands for it. Keys are only ever "
              "added. Volumes in m3, lengths in m, times in s, memory in MB.");
  json.member("type", "object");
  json.key("properties");
  json.begin_object();
  SchemaFields figures{json};
  const scene::RunResult blocks = scene::empty_result();
  head_fields(figures, blocks);
  const std::vector<std::string> head = figures.required();
  fields(figures, blocks);
  scene2d_fields(figures, scene::BodiesResult{});
  scene2d_fields(figures, scene::ContactResult{});
  fields(figures, MonteCarloPage{});
  json.end_object();
  json.key("required");
  JsonFields{json}.put(head);
  json.key("anyOf");
  json.begin_array();
  for (const char* section : {"blocks", "elastic", "contact", "monte_carlo"}) {
    json.begin_object();
    json.key("required");
    json.begin_array();
    json.value(section);
    json.end_array();
    json.end_object();
  }
  json.end_array();
  json.end_object();
  return std::move(json).finish();
}

}  // namespace cleave::report
