#pragma once

#include <string>

#include "cleave/realize/sequence.hpp"

namespace cleave::report {

/// The part of report.html about excavation in stages and the orders that were compared.
[[nodiscard]] std::string stages_section(const scene::SequenceResult& sequence);

}  // namespace cleave::report
