/// Any bytes as a table of joints, of mapped traces and picks, and as a map of traces in each of its formats: figures
/// that are finite or an error that names the place, never a crash. A table that was read is written and read back as
/// the same.

#include <cmath>
#include <string>

#include "cleave/core/assert.hpp"
#include "cleave/io/joint_csv.hpp"
#include "fuzz_target.hpp"

namespace {

void check_error(const cleave::io::ReadError& error) {
  CLEAVE_ASSERT(!error.what.empty() && !error.remedy.empty() && !error.file.empty());
}

void check_table(const std::string& text, const cleave::io::JointCsvOptions& options) {
  const auto table = cleave::io::parse_joint_csv(text, "fuzz.csv", options);
  if (!table) {
    CLEAVE_ASSERT(!table.error().empty());
    for (const auto& error : table.error()) check_error(error);
    return;
  }
  CLEAVE_ASSERT(!table->rows.empty());
  const auto again = cleave::io::parse_joint_csv(cleave::io::write_joint_csv(*table), "again.csv", options);
  CLEAVE_ASSERT(again.has_value() && again->rows.size() == table->rows.size());
}

void check_mapped(const std::string& text) {
  const auto traces = cleave::io::parse_trace_csv(text, "fuzz.csv");
  if (traces) {
    for (const auto& row : traces->rows) {
      CLEAVE_ASSERT(is_finite(row.ends[0]) && is_finite(row.ends[1]) && row.line > 1);
    }
  } else {
    for (const auto& error : traces.error()) check_error(error);
  }
  const auto picks = cleave::io::parse_pick_csv(text, "fuzz.csv");
  if (picks) {
    for (const auto& row : picks->rows) CLEAVE_ASSERT(row.depth.has_value() != row.position.has_value());
  } else {
    for (const auto& error : picks.error()) check_error(error);
  }
}

}  // namespace

CLEAVE_FUZZ_TARGET(bytes) {
  const std::string text{bytes.begin(), bytes.end()};
  for (const bool wrap : {false, true}) {
    for (const bool need_position : {false, true}) check_table(text, {.wrap = wrap, .need_position = need_position});
  }
  check_mapped(text);
  for (const char* name : {"fuzz.geojson", "fuzz.csv", "fuzz.txt"}) {
    const auto map = cleave::io::parse_trace_map(text, name);
    if (!map) {
      check_error(map.error());
      continue;
    }
    for (const auto* parts : {&map->lines, &map->polygons}) {
      for (const auto& part : *parts) {
        CLEAVE_ASSERT(part.size() >= 2);
        for (const auto& point : part) CLEAVE_ASSERT(std::isfinite(point[0]) && std::isfinite(point[1]));
      }
    }
  }
}
