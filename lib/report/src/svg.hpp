#pragma once

#include <string>
#include <string_view>

namespace cleave::report::detail {

/// A coordinate of a drawing: at most two digits after the point.
[[nodiscard]] std::string fixed(double value);

/// A text element.
[[nodiscard]] std::string text(double x, double y, std::string_view anchor, std::string_view content);
/// A power of ten as a label: digits where they are few.
[[nodiscard]] std::string power_of_ten(int exponent);

}  // namespace cleave::report::detail
