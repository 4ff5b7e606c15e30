#pragma once

#include <vector>

#include "cleave/scene/table_reader.hpp"
#include "cleave/scene/time_course.hpp"

namespace cleave::scene {

inline constexpr NumberRule time_rule{0, true, 1e12, false, " s"};

/// The largest of a ground that moves: weak earthquakes have 0.05 g, and none has 5 g.
inline constexpr NumberRule ground_rule = rule::acceleration.usually(0.5, 50);

/// Of a `time`.
[[nodiscard]] const KeyTable& time_function_keys();
/// `time = { kind, duration, frequency, follows }` of a load; a constant when absent.
[[nodiscard]] TimeFunction parse_time_function(const TableReader& load, bool& follows);

/// step, scale, and one list of accelerations an axis: "x" with "m/s2 to the right".
[[nodiscard]] std::vector<Key> record_keys(const std::vector<std::pair<std::string_view, std::string_view>>& axes);
/// `record` of a table, or `amplitude` times its `time`.
[[nodiscard]] TimeCourse<Vec2> parse_course(const TableReader& table, Vec2 amplitude);
[[nodiscard]] TimeCourse<geometry::Vec3> parse_course(const TableReader& table, geometry::Vec3 amplitude);

}  // namespace cleave::scene
