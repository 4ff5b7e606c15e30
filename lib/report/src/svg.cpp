#include "svg.hpp"

#include <cmath>

#include "cleave/exchange/text.hpp"

namespace cleave::report::detail {

std::string fixed(double value) { return number(std::round(value * 100) / 100); }

std::string text(double x, double y, std::string_view anchor, std::string_view content) {
  std::string out = "<text x=\"" + fixed(x) + "\" y=\"" + fixed(y) + "\" text-anchor=\"";
  out += anchor;
  out += "\">";
  out += content;
  return out + "</text>";
}

std::string power_of_ten(int exponent) {
  if (exponent >= -3 && exponent <= 5) return display(std::pow(10.0, exponent));
  return "10<tspan dy=\"-6\" font-size=\"11\">" + std::string{exponent < 0 ? "−" : ""} +
         std::to_string(std::abs(exponent)) + "</tspan>";
}

double tick_step(double length, double parts) {
  const double raw = length / parts, power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double times : {1.0, 2.0, 5.0}) {
    if (times * power >= raw) return times * power;
  }
  return 10 * power;
}

}  // namespace cleave::report::detail
