#include "cleave/scene/time_course_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "cleave/core/fields.hpp"

namespace cleave::scene {
namespace {

using geometry::Vec3;

constexpr NumberRule frequency_rule{0, true, 1e9, false, " Hz"};

template <class V>
struct Axis {
  std::string_view key;
  double V::* part;
};
constexpr std::array<Axis<Vec2>, 2> axes_of(Vec2) { return {{{"x", &Vec2::x}, {"y", &Vec2::y}}}; }
constexpr std::array<Axis<Vec3>, 3> axes_of(Vec3) { return {{{"x", &Vec3::x}, {"y", &Vec3::y}, {"z", &Vec3::z}}}; }

template <class V>
void parse_record(const TableReader& table, TimeCourse<V>& course) {
  course.step = Time::from_si(table.need_number("step").value_or(1));
  const double scale = table.value("scale");
  course.record.resize(1);
  bool any = false;
  std::size_t longest = 0;
  for (const Axis<V>& axis : axes_of(V{})) {
    course.amplitude.*axis.part = scale;
    any = any || table.has(axis.key);
    const std::vector<double> values = table.numbers(axis.key).value_or(std::vector<double>{});
    longest = std::max(longest, values.size());
    course.record.resize(std::max(course.record.size(), values.size()));
    for (std::size_t k = 0; k < values.size(); ++k) course.record[k].*axis.part = values[k];
  }
  if (!any) table.missing("x", "write the accelerations: x = [0, 0.5, ...]");
  if (any && longest < 2) {
    table.problems().error(
        table.line(), table.path(),
        longest == 0 ? "has no values: the ground does not move" : "has one value, which lasts no time",
        "write the accelerations, x = [0, 0.5, ...], or remove it");
    return;
  }
  double largest = 0;
  for (const V& value : course.record) largest = std::max(largest, std::abs(scale) * norm(value));
  if (ground_rule.is_usual(largest)) return;
  table.problems().note(
      table.line(), table.path(),
      fmt::format("has {:.3g} m/s2 as its largest acceleration, which is far from usual ({:g} to {:g})", largest,
                  ground_rule.usual->low, ground_rule.usual->high),
      likely_unit(largest, ground_rule) ? "if it is meant in g, write scale = 9.81"
                                        : "it is taken as it stands: check it");
}

template <class V>
TimeCourse<V> course_of(const TableReader& table, V amplitude) {
  TimeCourse<V> out{.amplitude = amplitude, .time = {}, .record = {}, .step = {}};
  if (const auto record = table.sub("record")) {
    if (table.has("time")) table.error("time", "stands beside record", "a record has its own times: remove this key");
    parse_record(*record, out);
    return out;
  }
  bool follows = false;
  out.time = parse_time_function(table, follows);
  if (follows) table.error("time", "follows no body", "remove follows");
  return out;
}

}  // namespace

const KeyTable& time_function_keys() {
  static const KeyTable keys{
      .name = "body.load.time",
      .keys = {
          {"kind", key::word<TimeFunction::Kind>(), required,
           "`step`: from the start; `ramp`: rising over `duration`; `pulse`: rising and falling in a triangle over it; "
           "`harmonic`: sine of `frequency`"},
          {"duration", key::number(time_rule), "", "s, of ramp and pulse"},
          {"frequency", key::number(frequency_rule), "", "Hz, of harmonic"},
          {"follows", key::flag(), "false", "true: the load turns with the body"}}};
  return keys;
}

TimeFunction parse_time_function(const TableReader& load, bool& follows) {
  TimeFunction out;
  const auto found = load.sub("time");
  if (!found) return out;
  const TableReader& table = *found;
  const auto kind = table.given_word<TimeFunction::Kind>("kind");
  if (!table.has("kind")) table.missing("kind", "write one of: step ramp pulse harmonic");
  out.kind = kind.value_or(TimeFunction::Kind::step);
  const bool lasts = out.kind == TimeFunction::Kind::ramp || out.kind == TimeFunction::Kind::pulse;
  if (lasts) {
    out.duration = Time::from_si(table.need_number("duration").value_or(1));
  }
  if (out.kind == TimeFunction::Kind::harmonic) {
    out.frequency = Rate::from_si(table.need_number("frequency").value_or(1));
  }
  for (const auto& [key, used] : {std::pair{std::string_view{"duration"}, lasts},
                                  std::pair{std::string_view{"frequency"}, out.kind == TimeFunction::Kind::harmonic}}) {
    if (kind && !used && table.has(key)) {
      table.error(key, fmt::format("has no meaning for kind = \"{}\"", enum_name(*kind)),
                  "duration belongs to ramp and pulse, frequency to harmonic: remove it");
    }
  }
  follows = table.boolean("follows").value_or(false);
  return out;
}

std::vector<Key> record_keys(const std::vector<std::pair<std::string_view, std::string_view>>& axes) {
  std::vector<Key> keys{
      {"step", key::number(time_rule), required, "s between two values; straight lines between them"}};
  for (const auto& [name, help] : axes) {
    keys.push_back({name, key::array(key::number(rule::acceleration), 0, 1'000'000), "[]", help});
  }
  keys.push_back({"scale", key::number({-1e6, false, 1e6, false, ""}), "1", "times the values"});
  return keys;
}

TimeCourse<Vec2> parse_course(const TableReader& table, Vec2 amplitude) { return course_of(table, amplitude); }
TimeCourse<Vec3> parse_course(const TableReader& table, Vec3 amplitude) { return course_of(table, amplitude); }

}  // namespace cleave::scene
