#include "svg.hpp"

#include <cmath>

#include "cleave/report/text.hpp"

namespace cleave::report::detail {

std::string fixed(double value) { return number(std::round(value * 100) / 100); }

}  // namespace cleave::report::detail
