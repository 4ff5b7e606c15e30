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

/// 1, 2 or 5 times a power of ten: about `parts` of them in the length.
[[nodiscard]] double tick_step(double length, double parts);

}  // namespace cleave::report::detail
