#pragma once

#include <cstddef>
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

/// A core and the line that is drawn along it, unit vectors: `down` the hole, `reference` across it to that line.
struct Core {
  geometry::Vec3 down, reference;
};
/// Where the reference line lies: on the lower or the upper side of the hole, or towards an azimuth (degrees). Empty
/// where a vertical hole has no lower side, or the azimuth is that of the hole itself.
enum class CoreReference : std::uint8_t { bottom, top };
[[nodiscard]] std::optional<Core> core_of(geometry::Vec3 line, CoreReference side);
[[nodiscard]] std::optional<Core> core_of(const InputContext& context, geometry::Vec3 line, double azimuth);
/// Normal of a plane that cuts the core at `alpha` (between the core's axis and the long axis of the ellipse; degrees),
/// the ellipse's lower end `beta` clockwise from the reference line, seen down the hole. z >= 0.
[[nodiscard]] geometry::Vec3 normal_in_core(const Core& core, double alpha, double beta);

/// How the rows of a table are to be taken.
struct RowRules {
  bool wrap = false;       ///< angles beyond their range are the same angle within
  double declination = 0;  ///< degrees, added to all trends, strikes and dip directions
  std::optional<Core> core = {};
};

[[nodiscard]] bool has_orientation(const SurveyTable& table);
/// False after a report: columns of half an orientation and no whole one. Notes half a one beside a whole one.
[[nodiscard]] bool check_halves(InputContext& context, const LoadedFile& file, const SurveyTable& table);
/// Columns alpha and beta.
[[nodiscard]] bool has_core_angles(const SurveyTable& table);
/// The normal that a row states: dip with dip direction or strike (right-hand rule), the pole's trend and plunge, or
/// alpha and beta of a core.
[[nodiscard]] std::optional<geometry::Vec3> normal_of_row(InputContext& context, const LoadedFile& file,
                                                          const SurveyTable& table, const SurveyTable::Row& row,
                                                          const RowRules& rules);
/// Notes angles without a unit that may be radians.
void note_radians(InputContext& context, const LoadedFile& file, const SurveyTable& table);
[[nodiscard]] std::string set_of_row(InputContext& context, const LoadedFile& file, const SurveyTable& table,
                                     const SurveyTable::Row& row, const std::string& otherwise);
/// Number of like joints that a row stands for (column quantity; none: 1).
[[nodiscard]] std::size_t quantity_of(InputContext& context, const LoadedFile& file, const SurveyTable& table,
                                      const SurveyTable::Row& row);

}  // namespace cleave::scene
