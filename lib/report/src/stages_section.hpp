#pragma once

#include <string>

#include "cleave/report/summary.hpp"

namespace cleave::report {

/// The part of report.html about excavation in stages and the orders that were compared.
[[nodiscard]] std::string stages_section(const SequenceFigures& sequence);

}  // namespace cleave::report
