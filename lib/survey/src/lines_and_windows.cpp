#include "lines_and_windows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string_view>
#include <vector>

#include "cleave/core/rng.hpp"
#include "cleave/core/special.hpp"
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

std::vector<double> gaps_across(const LineSurvey& line, std::vector<double> positions, geometry::Vec3 normal) {
  std::ranges::sort(positions);
  // Metres across the joints from the line's start.
  const auto across = [&](double position) {
    double from = 0, sum = 0;
    for (const auto& [direction, length] : line.pieces) {
      const double to = from + length;
      const bool last = &direction == &line.pieces.back().first;
      sum += (last ? std::max(position, from) - from : std::clamp(position, from, to) - from) *
             std::abs(dot(normal, direction));
      from = to;
    }
    return sum;
  };
  std::vector<double> gaps;
  if (line.pieces.size() == 1) {  // no digits lost in differences
    const double cosine = std::abs(dot(normal, line.pieces.front().first));
    for (const double gap : gaps_of(std::move(positions))) gaps.push_back(gap * cosine);
    return gaps;
  }
  for (std::size_t i = 1; i < positions.size(); ++i) gaps.push_back(across(positions[i]) - across(positions[i - 1]));
  return gaps;
}

namespace {

constexpr double level = 0.01;

/// One of several intensities that should be alike.
struct Intensity {
  std::string name;
  double value;
};
std::string unlike_note(std::string_view what, double p, const std::vector<Intensity>& all) {
  const auto [least, most] = std::ranges::minmax(all, {}, &Intensity::value);
  return fmt::format(
      "{} differ beyond chance for this set (p = {:.1g}): alone, {} gives a P32 of {:.3g} 1/m and {} one of {:.3g}; "
      "what "
      "is pooled is a mean over unlike rock, and its interval is too narrow: survey them apart where they stand for "
      "different parts of the rock",
      what, p, least.name, least.value, most.name, most.value);
}

}  // namespace

std::optional<std::string> unlike_lines_note(std::span<const LineSurvey> lines, const std::vector<MetOnLine>& met) {
  // What was recorded differs where the truncation does.
  const bool alike = std::ranges::all_of(met, [&](const MetOnLine& m) {
    return lines[m.line].truncation.si() == lines[met.front().line].truncation.si();
  });
  if (met.size() < 2) return std::nullopt;
  double joints = 0, length = 0;
  for (const MetOnLine& m : met) {
    joints += m.joints;
    length += m.length;
  }
  if (!(joints > 0) || !(length > 0)) return std::nullopt;
  constexpr double enough = 5;  // joints expected: the textbook's condition for chi-squared
  double square = 0, rest_joints = 0, rest_expected = 0, classes = 0;
  std::vector<Intensity> all;
  const auto add = [&](double seen, double expected) {
    square += (seen - expected) * (seen - expected) / expected;
    ++classes;
  };
  for (const MetOnLine& m : met) {
    const double expected = joints * m.length / length;
    if (expected >= enough) {
      add(m.joints, expected);
      all.push_back({"line " + lines[m.line].name, m.joints / m.length});
    } else {
      rest_joints += m.joints;
      rest_expected += expected;
    }
  }
  if (rest_expected >= enough) {
    add(rest_joints, rest_expected);
    all.push_back({"the short lines together", rest_joints * joints / (rest_expected * length)});
  }
  if (classes < 2) return std::nullopt;
  const double p = special::chi_squared_above(square, classes - 1);
  if (!(p < level)) return std::nullopt;
  return unlike_note("lines", p, all) + (alike ? "" : "; their truncations differ, which may be part of it");
}

std::optional<std::string> unlike_windows_note(std::span<const WindowSurvey> windows,
                                               std::span<const WindowCounts> counts, std::span<const double> sines) {
  constexpr double confidence = 0.95;
  constexpr std::uint32_t enough = 10;  // traces: the delta method needs some
  std::vector<Intensity> all;
  std::vector<double> logs, weights;
  for (std::size_t w = 0; w < windows.size(); ++w) {
    if (counts[w].traces() < enough || windows[w].truncation.si() != windows[0].truncation.si()) continue;
    const Estimate e = p21(counts[w], confidence);
    if (!e.value || !bounded(e) || !(e.low > 0) || !(sines[w] > 0)) continue;
    const double error = std::log(e.high / e.low) / (2 * normal_quantile(0.5 + confidence / 2));
    all.push_back({"window " + windows[w].name, *e.value / sines[w]});
    logs.push_back(std::log(all.back().value));
    weights.push_back(1 / (error * error));
  }
  if (all.size() < 2) return std::nullopt;
  const double mean = std::inner_product(logs.begin(), logs.end(), weights.begin(), 0.0) /
                      std::accumulate(weights.begin(), weights.end(), 0.0);
  double square = 0;
  for (std::size_t i = 0; i < logs.size(); ++i) square += weights[i] * (logs[i] - mean) * (logs[i] - mean);
  const double p = special::chi_squared_above(square, static_cast<double>(logs.size() - 1));
  return p < level ? std::optional{unlike_note("windows", p, all)} : std::nullopt;
}

std::optional<std::string> outside_note(const WindowSurvey& window, std::size_t seen) {
  const std::size_t all = window.traces.size();
  if (seen >= all) return std::nullopt;
  const auto note = fmt::format("window {}: {} of {} traces ({:.0f} %) lie outside it and are left out", window.name,
                                all - seen, all, 100 * static_cast<double>(all - seen) / static_cast<double>(all));
  return seen > 0 ? note : note + ": are both in the same units? `scale` is that of the window's outline, too";
}

}  // namespace cleave::survey::detail
