#pragma once

#include <optional>
#include <string>

#include "cleave/geometry/vec3.hpp"
#include "cleave/scene/common_keys.hpp"
#include "cleave/scene/file_input.hpp"
#include "survey_table.hpp"

/// Orientations as rows of a field table state them.
namespace cleave::scene {

/// Unit vectors from degrees as measured (trends and dip directions from true north).
[[nodiscard]] geometry::Vec3 line_of(const InputContext& context, double trend, double plunge);
[[nodiscard]] geometry::Vec3 normal_of(const InputContext& context, double dip, double direction);

[[nodiscard]] bool has_orientation(const SurveyTable& table);
/// The normal that a row states: dip with dip direction or strike (right-hand rule), or the pole's trend and plunge.
[[nodiscard]] std::optional<geometry::Vec3> normal_of_row(InputContext& context, const LoadedFile& file,
                                                          const SurveyTable& table, const SurveyTable::Row& row,
                                                          bool wrap);
[[nodiscard]] std::string set_of_row(const SurveyTable& table, const SurveyTable::Row& row,
                                     const std::string& otherwise);

}  // namespace cleave::scene
