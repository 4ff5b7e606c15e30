#pragma once

#include <cstddef>
#include <optional>

#include "cleave/scene/common_keys.hpp"
#include "cleave/scene/file_input.hpp"
#include "cleave/scene/table_reader.hpp"
#include "cleave/survey/analyse.hpp"
#include "survey_rows.hpp"

/// [[orientations]] of a survey, and what lines and boreholes share with them.
namespace cleave::scene {

inline constexpr NumberRule trend_rule{0, false, 360, false, " degrees"};
inline constexpr NumberRule plunge_rule{-90, false, 90, false, " degrees"};

[[nodiscard]] const KeyTable& orientations_keys();
[[nodiscard]] Key core_reference_key();
/// The core of a line by its key `reference`; a vertical hole without an azimuth is reported.
[[nodiscard]] std::optional<Core> parse_core(InputContext& context, const TableReader& table, geometry::Vec3 line);
/// Reports a survey that grew beyond a million joints (by the column quantity).
[[nodiscard]] bool too_many(InputContext& context, const LoadedFile& file, std::size_t joints);

/// `empty`: counts rows without an orientation.
void parse_orientations(InputContext& context, const TableReader& table, survey::SurveyInput& input,
                        std::size_t& empty);

}  // namespace cleave::scene
