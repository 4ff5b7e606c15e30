#pragma once

#include "cleave/linear/interior.hpp"
#include "newton.hpp"

namespace cleave::linear {
extern template class Interior<motion::Scaled>;
}  // namespace cleave::linear

namespace cleave::motion {
using Interior = linear::Interior<Scaled>;
}  // namespace cleave::motion
