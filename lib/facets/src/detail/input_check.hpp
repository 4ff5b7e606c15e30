#pragma once

#include <expected>

#include "cleave/facets/cut_input.hpp"

namespace cleave::topology::detail {

/// What the types of the input leave open: numbers that are none, and names of what is not there.
[[nodiscard]] std::expected<void, CutError> check_input(const CutInput& input);

}  // namespace cleave::topology::detail
