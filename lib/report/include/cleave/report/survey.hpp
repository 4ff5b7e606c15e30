#pragma once

#include <span>
#include <string>

#include "cleave/field_data/survey_file.hpp"

namespace cleave::report {

/// survey.json: all figures of a survey with their intervals. `maps`: `scene::simulated_trace_maps`.
[[nodiscard]] std::string survey_json(const scene::SurveyScene& survey, const survey::SurveyResult& result,
                                      std::span<const scene::SimulatedTraceMaps> maps);
/// report.html of a survey: stereonets (contoured, both projections), rosettes, histograms with the fitted laws, and
/// simulated traces of the fitted sets beside the measured ones.
[[nodiscard]] std::string survey_html(const scene::SurveyScene& survey, const survey::SurveyResult& result,
                                      std::span<const scene::SimulatedTraceMaps> maps);

}  // namespace cleave::report
