#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cleave/survey/analyse.hpp"

/// What lines and windows say by themselves, whatever set their joints are in.
namespace cleave::survey::detail {

/// Frequency and RQD.
[[nodiscard]] LineResult result_of(const LineSurvey& line, double confidence);

/// Long gaps fit on short lines less often than short ones. `mean`: of the gaps seen of a set of so many joints, m.
[[nodiscard]] std::optional<std::string> short_lines_note(std::span<const LineSurvey> lines, std::size_t joints,
                                                          double mean);

/// Gaps between joints along a line, each piece of it by its own angle to the normal.
[[nodiscard]] std::vector<double> gaps_across(const LineSurvey& line, std::vector<double> positions,
                                              geometry::Vec3 normal);

/// Joints of a set that a line met, and its length times E|n.l|.
struct MetOnLine {
  std::size_t line;
  double joints, length;
};
/// Lines that met a set less alike than Poisson's law allows at 1 %: pooling them is the mean of different rock.
[[nodiscard]] std::optional<std::string> unlike_lines_note(std::span<const LineSurvey> lines,
                                                           const std::vector<MetOnLine>& met);
/// The same of the traces of a set in windows; `sines`: E sin V of each.
[[nodiscard]] std::optional<std::string> unlike_windows_note(std::span<const WindowSurvey> windows,
                                                             std::span<const WindowCounts> counts,
                                                             std::span<const double> sines);

/// Counts, intensities, lengths and nodes of the traces seen.
[[nodiscard]] WindowResult result_of(const WindowSurvey& window, std::span<const SeenTrace> seen, double confidence);

/// A map that was cut along its border has ends there, on this side or that by rounding, or as near as it was
/// digitised: more of them than ends that fall there by chance.
[[nodiscard]] std::optional<std::string> border_note(const WindowSurvey& window);

/// Traces of the map that lie outside the window.
[[nodiscard]] std::optional<std::string> outside_note(const WindowSurvey& window, std::size_t seen);

}  // namespace cleave::survey::detail
