#pragma once

#include <span>
#include <string>

#include "cleave/field_data/survey_file.hpp"

namespace cleave::report::detail {

/// "value (low ... high)", or why there is none; "any" where the interval has no end.
[[nodiscard]] std::string estimate_text(const survey::Estimate& e);
/// One section a window: measured and simulated maps side by side, rosettes, figures.
[[nodiscard]] std::string survey_windows(const scene::SurveyScene& scene, const survey::SurveyResult& result,
                                         std::span<const scene::SimulatedTraceMaps> maps);

}  // namespace cleave::report::detail
