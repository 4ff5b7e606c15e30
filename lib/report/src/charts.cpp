#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "cleave/exchange/text.hpp"
#include "drawings.hpp"
#include "plot.hpp"
#include "svg.hpp"

namespace cleave::report {
using detail::fixed, detail::text;

std::string size_curve(std::vector<double> volumes) {
  std::erase_if(volumes, [](double v) { return !(v > 0) || !std::isfinite(v); });
  if (volumes.empty()) return {};
  std::ranges::sort(volumes);
  detail::Plot plot{
      detail::decades(std::max(1e-12, volumes.front()), std::max(1e-12, volumes.back()), "block volume V (m³)"),
      detail::Axis{0, 1, false, "share in blocks smaller than V"},
      "Share of blocks and of rock volume in blocks smaller than a given volume"};
  // At most about 400 points of each curve.
  const double total = std::accumulate(volumes.begin(), volumes.end(), 0.0);
  const std::size_t stride = std::max<std::size_t>(1, volumes.size() / 400);
  std::vector<detail::PlotPoint> by_number{{volumes.front(), 0}}, by_volume = by_number;
  double sum = 0;
  for (std::size_t i = 0; i < volumes.size(); ++i) {
    sum += volumes[i];
    if ((i + 1) % stride != 0 && i + 1 != volumes.size()) continue;
    by_number.push_back({volumes[i], static_cast<double>(i + 1) / static_cast<double>(volumes.size())});
    by_volume.push_back({volumes[i], sum / total});
  }
  plot.line(by_number);
  plot.line(by_volume, detail::LineStyle::dashed);
  return std::move(plot).svg();
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
