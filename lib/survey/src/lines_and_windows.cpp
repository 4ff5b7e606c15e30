#include "lines_and_windows.hpp"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "cleave/survey/comparison.hpp"
#include "line.hpp"

namespace cleave::survey::detail {

LineResult result_of(const LineSurvey& line, double confidence) {
  const double length = line.length();
  const auto gaps = gaps_of(line.positions), pieces = pieces_of(line.positions, length);
  LineResult result{line.name,
                    length,
                    frequency(line.positions.size(), length, confidence),
                    rqd_measured(pieces, length),
                    0,
                    rqd(pieces, length, confidence),
                    {},
                    {}};
  result.rqd_of_frequency = rqd_of_frequency(result.frequency.value.value_or(0));
  result.rqd_by_frequency = rqd(result.frequency);
  if (gaps.size() > 1) {
    result.comparisons = {frequency_from_gaps(gaps, length, confidence),
                          frequency_by_truncated_exponential(gaps, length, confidence)};
  }
  return result;
}

WindowResult result_of(const WindowSurvey& window, std::span<const SeenTrace> seen, double confidence) {
  WindowResult result{window.name, count(window.window, seen), {}, std::nullopt};
  for (const auto estimate : {p20, p21, mean_length, mean_length_by_counts, p20_plain}) {
    result.estimates.push_back(estimate(result.counts, confidence));
  }
  if (result.counts.circle) {
    result.estimates.push_back(p21_by_crossings(result.counts, confidence));
    result.estimates.push_back(mean_length_by_number(result.counts, confidence));
  } else {
    result.estimates.push_back(mean_length_by_pahl(result.counts, confidence));
  }
  const double mean = result.estimates[2].value.value_or(1);
  if (seen.size() <= most_traces_of_nodes) {
    result.nodes = nodes(window.window, window.traces, 1e-3 * mean, confidence);
  }
  return result;
}

std::optional<std::string> border_note(const WindowSurvey& window) {
  const CutOffEnds cut = cut_off_by_border(window.window, window.traces);
  if (cut.ends == 0 || window.border >= cut.within) return std::nullopt;
  const double magnitude = std::pow(10, std::floor(std::log10(cut.border.si()))), share = cut.border.si() / magnitude;
  const double border = (share <= 1 ? 1 : share <= 2 ? 2 : share <= 5 ? 5 : 10) * magnitude;
  return fmt::format(
      "window {}: {} ends of traces lie within {:.2g} m of its border, where {:.1f} would by chance, and count as "
      "seen, though the border has cut them off, it seems: P21 from crossings is too small; border = {:.1g} takes "
      "them so",
      window.name, cut.ends, cut.within.si(), cut.by_chance, border);
}

std::optional<std::string> short_lines_note(std::span<const LineSurvey> lines, std::size_t joints, double mean) {
  std::vector<double> lengths;
  double all = 0;
  for (const LineSurvey& line : lines) {
    lengths.push_back(line.length());
    all += line.length();
  }
  constexpr double little = 0.95;
  const double share = mean_gap_share(static_cast<double>(joints) / all, lengths);
  if (share > little) return std::nullopt;
  return fmt::format(
      "spacings: the lines are short for them: only gaps that fit on a line are seen, on average {:.2f} of the whole "
      "ones (if joints lie by chance), and the laws are those of these; a mean of {:.3g} m, not of {:.3g} m, goes with "
      "P10",
      share, mean / share, mean);
}

std::optional<std::string> outside_note(const WindowSurvey& window, std::size_t seen) {
  const std::size_t all = window.traces.size();
  if (seen >= all) return std::nullopt;
  const auto note = fmt::format("window {}: {} of {} traces ({:.0f} %) lie outside it and are left out", window.name,
                                all - seen, all, 100 * static_cast<double>(all - seen) / static_cast<double>(all));
  return seen > 0 ? note : note + ": are both in the same units? `scale` is that of the window's outline, too";
}

}  // namespace cleave::survey::detail
