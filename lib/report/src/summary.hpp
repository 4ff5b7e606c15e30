#pragma once

#include <string>

#include "cleave/scene/bodies.hpp"
#include "cleave/scene/contact.hpp"
#include "cleave/scene/run_result.hpp"

namespace cleave::report {

/// summary.json; keys in the order of docs/summary.schema.json, which is `summary_schema()`.
[[nodiscard]] std::string summary_json(const scene::RunResult& result);
[[nodiscard]] std::string summary_json(const scene::BodiesResult& result);
[[nodiscard]] std::string summary_json(const scene::ContactResult& result);
[[nodiscard]] std::string summary_schema();

}  // namespace cleave::report
