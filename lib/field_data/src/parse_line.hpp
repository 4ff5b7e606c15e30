#pragma once

#include "cleave/scene/common_keys.hpp"
#include "cleave/scene/file_input.hpp"
#include "cleave/scene/table_reader.hpp"
#include "cleave/survey/analyse.hpp"

/// [[scanline]] and [[borehole]] of a survey.
namespace cleave::scene {

inline constexpr NumberRule truncation_rule{0, false, 1e6, false, " m"};

[[nodiscard]] const KeyTable& line_keys();
void parse_line(InputContext& context, const TableReader& table, survey::SurveyInput& input);

}  // namespace cleave::scene
