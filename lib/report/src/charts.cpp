#include <algorithm>
#include <cmath>
#include <numeric>

#include "cleave/exchange/text.hpp"
#include "drawings.hpp"
#include "svg.hpp"

namespace cleave::report {
using detail::fixed, detail::power_of_ten, detail::text;

std::string size_curve(std::vector<double> volumes) {
  std::erase_if(volumes, [](double v) { return !(v > 0) || !std::isfinite(v); });
  if (volumes.empty()) return {};
  std::ranges::sort(volumes);
  const int low = std::max(-12, static_cast<int>(std::floor(std::log10(volumes.front()))));
  const int high = std::max(low + 1, static_cast<int>(std::ceil(std::log10(volumes.back()))));
  constexpr double left = 62, right = 500, top = 16, bottom = 250;
  const auto x_at = [&](double volume) {
    return left + (right - left) * (std::max(std::log10(volume), static_cast<double>(low)) - low) / (high - low);
  };
  const auto y_at = [&](double share) { return bottom - (bottom - top) * share; };
  std::string out =
      "<svg viewBox=\"0 0 520 300\" role=\"img\" aria-label=\"Share of blocks and of rock volume in blocks smaller "
      "than a given volume\">";
  const int step = (high - low + 6) / 7;
  for (int e = low; e <= high; e += step) {
    const double x = x_at(std::pow(10.0, e));
    out += "<path class=\"grid\" d=\"M" + fixed(x) + ',' + fixed(top) + 'V' + fixed(bottom) + "\"/>" +
           text(x, bottom + 20, "middle", power_of_ten(e));
  }
  for (const int percent : {0, 25, 50, 75, 100}) {
    const double y = y_at(percent / 100.0);
    out += "<path class=\"grid\" d=\"M" + fixed(left) + ',' + fixed(y) + 'H' + fixed(right) + "\"/>" +
           text(left - 8, y + 5, "end", std::to_string(percent) + " %");
  }
  out += text((left + right) / 2, bottom + 44, "middle", "block volume V (m³)");
  // At most about 400 points of each curve.
  const double total = std::accumulate(volumes.begin(), volumes.end(), 0.0);
  const std::size_t stride = std::max<std::size_t>(1, volumes.size() / 400);
  std::string by_number = "M" + fixed(x_at(volumes.front())) + ',' + fixed(y_at(0)), by_volume = by_number;
  double sum = 0;
  for (std::size_t i = 0; i < volumes.size(); ++i) {
    sum += volumes[i];
    if ((i + 1) % stride != 0 && i + 1 != volumes.size()) continue;
    const double share = static_cast<double>(i + 1) / static_cast<double>(volumes.size());
    by_number += 'L' + fixed(x_at(volumes[i])) + ',' + fixed(y_at(share));
    by_volume += 'L' + fixed(x_at(volumes[i])) + ',' + fixed(y_at(sum / total));
  }
  out += "<path class=\"line-a\" d=\"" + by_number + "\"/><path class=\"line-b\" d=\"" + by_volume + "\"/>";
  return out + "</svg>";
}

std::string batch_bars(std::span<const scene::BatchFigures> batches) {
  if (batches.empty()) return {};
  constexpr double left = 96, right = 400;
  const double row = batches.size() > 12 ? 18 : 30;
  double largest = 0;
  for (const scene::BatchFigures& batch : batches) largest = std::max(largest, batch.volume_m3);
  const double height = row * static_cast<double>(batches.size()) + 20;
  std::string out =
      "<svg viewBox=\"0 0 520 " + fixed(height) + "\" role=\"img\" aria-label=\"Key block volume by batch\">";
  double y = 10;
  for (const scene::BatchFigures& batch : batches) {
    const double width = largest > 0 ? (right - left) * batch.volume_m3 / largest : 0;
    out += text(left - 10, y + row * 0.65, "end", "batch " + std::to_string(batch.batch));
    out += "<rect x=\"" + fixed(left) + "\" y=\"" + fixed(y + row * 0.12) + "\" width=\"" +
           fixed(std::max(width, 1.5)) + "\" height=\"" + fixed(row * 0.72) + "\" rx=\"2\" fill=\"" +
           batch_colour(batch.batch) + "\"/>";
    out += text(left + width + 8, y + row * 0.65, "start", display(batch.volume_m3) + " m³");
    y += row;
  }
  return out + "</svg>";
}

}  // namespace cleave::report
