/// Any bytes as a table of joints, and as a map of traces in each of its formats: figures that are finite or an error
/// that names the place, never a crash. A table that was read is written and read back as the same.

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

}  // namespace

CLEAVE_FUZZ_TARGET(bytes) {
  const std::string text{bytes.begin(), bytes.end()};
  for (const bool wrap : {false, true}) {
    for (const bool need_position : {false, true}) check_table(text, {.wrap = wrap, .need_position = need_position});
  }
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
