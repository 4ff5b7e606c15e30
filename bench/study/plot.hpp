#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace cleave::study {

struct Series {
  std::string name;
  std::vector<std::pair<double, double>> points;  ///< both positive: the axes are logarithmic; others are left out
  bool line = false;                              ///< points joined in the order given
  bool fit = false;                               ///< with its fitted power law, the slope written beside its name
};

/// A plot on logarithmic axes.
struct Plot {
  std::string title, x_label, y_label;
  std::vector<Series> series;
};

/// Power p and factor c of y = c x^p by least squares of the logarithms; none below two different x.
struct PowerLaw {
  double power, factor;
};
[[nodiscard]] std::optional<PowerLaw> fit_power_law(const std::vector<std::pair<double, double>>& points);

/// The plot as one SVG file.
[[nodiscard]] std::string svg(const Plot& plot);

}  // namespace cleave::study
