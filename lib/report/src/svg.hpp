#pragma once

#include <string>

namespace cleave::report::detail {

/// A coordinate of a drawing: at most two digits after the point.
[[nodiscard]] std::string fixed(double value);

}  // namespace cleave::report::detail
