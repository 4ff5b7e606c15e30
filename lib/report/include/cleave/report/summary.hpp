#pragma once

#include <string>

#include "cleave/realize/run_result.hpp"
#include "cleave/scene2d/bodies.hpp"
#include "cleave/scene2d/contact.hpp"

namespace cleave::report {

/// summary.json; keys in the order of docs/summary.schema.json, which is `summary_schema()`.
[[nodiscard]] std::string summary_json(const scene::RunResult& result);
[[nodiscard]] std::string summary_json(const scene::BodiesResult& result);
[[nodiscard]] std::string summary_json(const scene::ContactResult& result);
[[nodiscard]] std::string summary_schema();

}  // namespace cleave::report
