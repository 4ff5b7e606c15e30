#include <utility>

#include "cleave/exchange/json_fields.hpp"
#include "cleave/report/survey.hpp"
#include "cleave/report/survey_fields.hpp"

namespace cleave::report {

std::string survey_json(const scene::SurveyScene& survey, const survey::SurveyResult& result,
                        std::span<const scene::SimulatedTraceMaps> maps) {
  JsonWriter json;
  JsonFields{json}.put(group([&](auto& v) { survey_fields(v, survey, result, maps); }));
  return std::move(json).finish();
}

}  // namespace cleave::report
