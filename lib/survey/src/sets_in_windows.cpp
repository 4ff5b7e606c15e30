#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis.hpp"
#include "cleave/core/rng.hpp"
#include "cleave/survey/comparison.hpp"
#include "set_laws.hpp"

namespace cleave::survey::detail {

using geometry::Vec3;

namespace {

/// From the strike to the set's traces in the joints' plane, degrees counter-clockwise seen from above.
double trace_angle(const SetResult& set, const WindowSurvey& window) {
  const Vec3 normal = set.orientation.mean, trace = cross(normal, window.normal);
  const double steep = std::hypot(normal.x, normal.y);
  if (norm(trace) < 1e-9 || steep < 1e-9) return 0;
  const Vec3 strike = Vec3{-normal.y, normal.x, 0} / steep;
  return std::atan2(dot(trace, cross(normal, strike)), dot(trace, strike)) * degrees;
}

}  // namespace

void Analysis::assign_traces() {
  for (const WindowSurvey& window : in_.windows) {
    seen_.push_back(seen_through(window.window, window.traces, window.border.si()));
    auto& sets = trace_set_.emplace_back(seen_.back().size());
    std::vector<std::pair<std::size_t, TracesOfSet>> laws;
    std::vector<std::pair<std::size_t, std::pair<double, double>>> azimuths;
    for (std::size_t k = 0; k < out_.sets.size(); ++k) {
      const SetRule* rule = rule_of(out_.sets[k]);
      if (rule != nullptr && rule->azimuth && tells_azimuths(window)) {
        azimuths.emplace_back(k, *rule->azimuth);
      } else if (has_mean(out_.sets[k])) {
        laws.emplace_back(k, TracesOfSet{out_.sets[k].orientation, window});
      }
    }
    double doubtful = 0;  // traces of another set than the likeliest, as many as are to be expected
    for (std::size_t i = 0; i < sets.size(); ++i) {
      const MapPoint direction = seen_.back()[i].direction;
      const double azimuth = azimuth_of(window, direction);
      const auto own = std::ranges::find_if(azimuths, [&](const auto& a) { return within(azimuth, a.second); });
      if (own != azimuths.end()) {
        sets[i] = own->first;
        continue;
      }
      double best = -1, sum = 0;
      for (auto& [k, law] : laws) {
        if (out_.sets.size() > 1 && !law.may_hold(direction)) continue;
        const double density = law.density(direction);
        sum += density;
        if (!(density > best)) continue;
        best = density;
        sets[i] = k;
      }
      if (sum > 0) doubtful += 1 - best / sum;
    }
    if (auto note = doubtful_note(window, doubtful, sets.size())) out_.notes.push_back(*std::move(note));
  }
}

std::vector<double> Analysis::sines_of(const SetResult& set) const {
  std::vector<double> sines;
  for (const WindowSurvey& window : in_.windows) {
    sines.push_back(has_mean(set) ? mean_plane_sine(set.orientation.mean, set.orientation.kappa, window.normal) : 1);
  }
  return sines;
}

Analysis::SeenOfSet Analysis::seen_of(std::size_t k) const {
  const SetResult& set = out_.sets[k];
  SeenOfSet seen;
  seen.sum = {0, 0, shape_area(set.shape), 0};
  for (std::size_t w = 0; w < in_.windows.size(); ++w) {
    std::vector<SeenTrace> own;
    for (std::size_t i = 0; i < seen_[w].size(); ++i) {
      if (trace_set_[w][i] != k) continue;
      own.push_back(seen_[w][i]);
      seen.lengths.push_back({seen_[w][i].length, std::min(seen_[w][i].ends, 2U)});
      const SeenTrace& trace = seen_[w][i];
      if (trace.ends != 2 || trace.crossings > 0) continue;
      const Polyline& line = in_.windows[w].traces[trace.trace];
      const MapPoint middle{(line.front().x + line.back().x) / 2, (line.front().y + line.back().y) / 2};
      if (!holds(in_.windows[w].window, middle)) continue;  // a bent one
      seen.whole.push_back({trace.length, chord_through(in_.windows[w].window, middle, trace.direction)});
    }
    const auto traces = static_cast<double>(own.size());
    const Chords chords = chords_of(set.shape, trace_angle(set, in_.windows[w]));
    seen.sum.first += traces * chords.first;
    seen.sum.second += traces * chords.second;
    if (chords.disc) *seen.sum.disc += traces * *chords.disc;
    if (!own.empty()) seen.truncation = std::max(seen.truncation, in_.windows[w].truncation.si());
    seen.counts.push_back(count(in_.windows[w].window, own));
    if (own.empty() && seen.counts.back().width == 0)
      seen.counts.back().width = width_across(in_.windows[w].window, {1, 0});
  }
  return seen;
}

Estimate Analysis::sine_of(const SetResult& set, const std::vector<WindowCounts>& counts,
                           const WindowCounts& all) const {
  if (!has_mean(set)) return {"", 1, 1, 1, "", ""};
  return over_orientations(set, [&](Vec3 mean, double kappa) {
    double weighed = 0;
    for (std::size_t w = 0; w < counts.size(); ++w) {
      weighed += counts[w].area * mean_plane_sine(mean, kappa, in_.windows[w].normal);
    }
    return weighed / all.area;
  });
}

std::optional<Estimate> Analysis::volume_frequency(const SetResult& set, const SeenOfSet& seen, const WindowCounts& all,
                                                   const Estimate& sine) const {
  const double width = set.chords.width();
  if (!set.sizes.empty()) {
    // Given how many were seen the laws are fitted to their lengths alone: both errors are independent.
    const auto mapped = static_cast<std::size_t>(std::ranges::count_if(
        seen.lengths, [&](const SeenLength& l) { return l.length > 0 && l.length >= seen.truncation; }));
    const Estimate& offered = *set.offered;
    return over(over(frequency(mapped, 1, in_.confidence), scaled(offered, "", width, ""), "", ""), sine, "P30",
                "traces / E[(A + b l) width across the traces] E sin V under the law of sizes");
  }
  if (!set.p20->value) return std::nullopt;
  // P20 over the mean size, itself from 2S/m: m^2/(S A) but for factors.
  const auto m = static_cast<double>(all.ends()), squares = static_cast<double>(4 * all.n2 + all.n1);
  const double variance =
      4 * squares / (m * m) - 4 * all.sum_length_ends / (m * all.length) + all.sum_length2 / (all.length * all.length);
  const double half = std::exp(normal_quantile(0.5 + in_.confidence / 2) * std::sqrt(std::max(0.0, variance)));
  const double p30 = *set.p20->value / (set.size->mean * width);
  return over({"", p30, p30 / half, p30 * half, "", ""}, sine, "P30", "P20 / (E[width across the traces] E sin V)");
}

void Analysis::windows(std::size_t k) {
  SetResult& set = out_.sets[k];
  const SeenOfSet seen = seen_of(k);
  for (const SeenLength& l : seen.lengths) set.seen_lengths.push_back(l.length);
  set.traces = seen.lengths.size();
  if (seen.lengths.empty()) return;
  const auto n = static_cast<double>(seen.lengths.size());
  set.chords = {seen.sum.first / n, seen.sum.second / n, seen.sum.area, std::nullopt};
  if (set.shape.shape != JointShape::rectangle) set.chords.disc = *seen.sum.disc / n;
  if (seen.truncation > 0) {
    set.notes.push_back(fmt::format(
        "traces below {} m were not mapped: the laws of lengths and sizes allow for it; figures from counts and sums "
        "are those of the longer ones",
        seen.truncation));
  }
  const WindowCounts all = pooled(seen.counts);
  const Estimate sine = sine_of(set, seen.counts, all);
  if (auto note = unlike_windows_note(in_.windows, seen.counts, sines_of(set))) set.notes.push_back(*note);
  set.p20 = p20(all, in_.confidence);
  set.p21 = p21(all, in_.confidence);
  set.mean_length = mean_length(all, in_.confidence);
  set.mean_length_counts = mean_length_by_counts(all, in_.confidence);
  set.p32_windows = over(*set.p21, sine, "P32", fmt::format("P21 / E sin V, E sin V = {:.4f}", *sine.value));
  fit_laws(set, seen.lengths, {all.area, all.width, seen.truncation}, set.mean_length, in_.confidence);
  for (FittedLaw& law : set.lengths) law.test = test_lengths(seen.whole, seen.truncation, law.fit.family, in_.seed);
  set.comparisons = spread_as_measured(seen.lengths, set.chords, in_.confidence);
  if (!set.lengths.empty()) {
    set.comparisons.push_back(p20_by_midpoints(seen.lengths, set.lengths.front().fit, all.area, in_.confidence));
  }
  if (set.size) set.p30 = volume_frequency(set, seen, all, sine);
}

double Analysis::truncation_of_windows(std::size_t k) const {
  double truncation = 0;
  for (std::size_t w = 0; w < in_.windows.size(); ++w) {
    if (std::ranges::count(trace_set_[w], std::optional{k}) > 0) {
      truncation = std::max(truncation, in_.windows[w].truncation.si());
    }
  }
  return truncation;
}

void Analysis::caution_of_windows(SetResult& set, double truncation) {
  if (!(truncation > 0)) return;
  std::string caution =
      fmt::format("P32 is that of joints with traces of {} m and more, the size that of all", truncation);
  if (set.size && set.p30 && set.p30->value) {
    set.p32_of_all = *set.p30->value * shape_area(set.shape) * size_moment(*set.size, 2);
    caution += fmt::format("; of all joints of this law it is {:.4g}", *set.p32_of_all);
  }
  set.cautions.push_back(std::move(caution));
}

}  // namespace cleave::survey::detail
