#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis.hpp"
#include "line.hpp"
#include "over_poles.hpp"
#include "set_laws.hpp"

namespace cleave::survey::detail {

using geometry::Vec3;

namespace {

/// Of Fisher's law where it holds, else of the poles as they were measured.
bool by_poles(const SetResult& set) {
  return !set.orientation.fisher && !set.orientation_stated && !set.normals.empty();
}

double length_along(Vec3 normal, const LineSurvey& line) {
  double sum = 0;
  for (const auto& [direction, length] : line.pieces) sum += length * std::abs(dot(normal, direction));
  return sum;
}

double length_by_law(Vec3 mean, double kappa, const LineSurvey& line) {
  double sum = 0;
  for (const auto& [direction, length] : line.pieces) sum += length * mean_line_cosine(mean, kappa, direction);
  return sum;
}

}  // namespace

double Analysis::length_met(const SetResult& set, const LineSurvey& line) {
  if (!by_poles(set)) return length_by_law(set.orientation.mean, set.orientation.kappa, line);
  return mean_over_poles(set.normals, set.weights, [&](Vec3 n) { return length_along(n, line); });
}

Estimate Analysis::length_of_lines(const SetResult& set, bool along_normal) const {
  if (by_poles(set)) {
    return over_poles(
        set.normals, set.weights,
        [&](Vec3 n) {
          double sum = 0;
          for (const LineSurvey& line : in_.lines) sum += length_along(n, line);
          return sum;
        },
        [&](Vec3 n) { return along_normal ? std::abs(dot(n, set.orientation.mean)) : 1; }, in_.confidence);
  }
  return over_orientations(set, [&](Vec3 mean, double kappa) {
    double sum = 0;
    for (const LineSurvey& line : in_.lines) sum += length_by_law(mean, kappa, line);
    return along_normal ? sum / mean_line_cosine(mean, kappa, mean) : sum;
  });
}

void Analysis::assign_on_lines() {
  const std::size_t none = out_.sets.size();
  const bool one = none == 1 && out_.unassigned == 0;
  const auto stated = [&](const std::string& name) -> std::optional<std::size_t> {
    if (one || in_.clusters || name.empty()) return one ? std::optional<std::size_t>{0} : std::nullopt;
    return static_cast<std::size_t>(std::ranges::find(out_.sets, name, &SetResult::name) - out_.sets.begin());
  };
  std::vector<std::vector<double>> lengths(none + 1);
  for (const LineSurvey& line : in_.lines) {
    SetsOnLine& sets = line_sets_.emplace_back();
    for (std::size_t i = 0; i < line.positions.size(); ++i) {
      if (i < line.joints.size() && line.joints[i]) {
        sets.push_back(out_.set_of[*line.joints[i]].value_or(none));
      } else {
        sets.push_back(stated(i < line.sets.size() ? line.sets[i] : ""));
      }
    }
    lengths[none].push_back(line.length());
  }
  for (std::size_t k = 0; k < none; ++k) {
    for (const LineSurvey& line : in_.lines) {
      lengths[k].push_back(has_mean(out_.sets[k]) ? length_met(out_.sets[k], line) : 0);
    }
  }
  shared_ = share_out(line_sets_, lengths);
}

std::vector<MetOnLine> Analysis::met_on_lines(std::size_t k) const {
  std::vector<MetOnLine> met;
  for (std::size_t l = 0; l < in_.lines.size(); ++l) {
    if (std::ranges::any_of(line_sets_[l], [](const auto& set) { return !set; })) continue;
    met.push_back({l, static_cast<double>(std::ranges::count(line_sets_[l], std::optional{k})),
                   length_met(out_.sets[k], in_.lines[l])});
  }
  return met;
}

void Analysis::lines(std::size_t k) {
  SetResult& set = out_.sets[k];
  if (!has_mean(set)) return;
  for (std::size_t l = 0; l < in_.lines.size(); ++l) {
    const LineSurvey& line = in_.lines[l];
    std::vector<double> positions;
    for (std::size_t i = 0; i < line.positions.size(); ++i) {
      if (line_sets_[l][i] == k) positions.push_back(line.positions[i]);
    }
    const std::vector<double> gaps = gaps_across(line, std::move(positions), set.orientation.mean);
    set.gaps.insert(set.gaps.end(), gaps.begin(), gaps.end());
  }
  const Estimate normal_length = length_of_lines(set, true), area_length = length_of_lines(set, false);
  const std::size_t known = shared_.known[k];
  if (known == 0 || !(*area_length.value > 0)) return;
  const double joints = static_cast<double>(known) + shared_.shared[k];
  const Estimate met = counted(joints, shared_.effective(k), in_.confidence);
  if (shared_.shared[k] > 0) {
    set.notes.push_back(
        fmt::format("{} joints on lines are known to be of this set; {:.1f} of the {} that have neither orientation "
                    "nor set are counted for its P10 and P32, as each line meets the sets; spacings leave them out "
                    "and are too long, {:.2g} times if they lack by chance",
                    known, shared_.shared[k], shared_.unknown, joints / static_cast<double>(known)));
  }
  set.p10_normal = over(met, normal_length, "P10 along the mean normal",
                        "sum N E|n.n0| / sum(L E|n.l|), exact Poisson interval with the error of the orientation");
  set.p32_lines =
      over(met, area_length, "P32", "sum N / sum(L E|n.l|), exact Poisson interval with the error of the orientation");
  if (auto note = unlike_lines_note(in_.lines, met_on_lines(k))) set.notes.push_back(*std::move(note));
  for (const Family family : {Family::exponential, Family::lognormal, Family::gamma}) {
    if (auto fit = fit_complete(set.gaps, family, set.gaps.size() <= 500 ? 199 : 0, in_.seed)) {
      set.spacings.push_back(*std::move(fit));
    }
  }
  std::ranges::stable_sort(set.spacings, {}, &Fit::aic);
  if (set.spacings.empty()) return;
  if (auto note = short_lines_note(in_.lines, known, set.spacings.front().moment(1))) {
    set.notes.push_back(*std::move(note));
  }
}

void Analysis::line_lengths(std::size_t k) {
  SetResult& set = out_.sets[k];
  if (set.traces > 0) return;
  std::vector<SeenLength> lengths;
  double truncation = 0;
  for (std::size_t l = 0; l < in_.lines.size(); ++l) {
    const LineSurvey& line = in_.lines[l];
    for (std::size_t i = 0; i < line.lengths.size(); ++i) {
      if (line.lengths[i] && line_sets_[l][i] == k) lengths.push_back(*line.lengths[i]);
    }
    if (!line.lengths.empty()) truncation = std::max(truncation, line.truncation.si());
  }
  if (lengths.empty()) return;
  for (const SeenLength& l : lengths) set.seen_lengths.push_back(l.length);
  set.traces_on_lines = lengths.size();
  std::vector<RecordedOn> recorded;
  for (const LineSurvey& line : in_.lines) {
    if (truncation > 0) recorded.push_back({has_mean(set) ? length_met(set, line) : 0, line.truncation.si()});
  }
  const bool met = std::ranges::any_of(recorded, [](const auto& line) { return line.length > 0; });
  if (!met) recorded.clear();
  set.chords = chords_of(set.shape, 0);
  if (set.shape.shape != JointShape::disc) {
    set.notes.emplace_back("traces on lines are taken as on a level outcrop: along the strike");
  }
  // Seen from the line both parts of a trace are drawn alike: S/m is the mean of an exponential law.
  fit_laws(set, lengths, {0, 1, truncation}, length_per_end(lengths, in_.confidence), in_.confidence, recorded);
  if (!set.size || !set.p32_lines || !set.p32_lines->value) return;
  if (!set.sizes.empty()) {
    set.p30 = over(*set.p32_lines, scaled(*set.offered, "", shape_area(set.shape), ""), "P30", "P32 / E area");
  } else {
    const double area = shape_area(set.shape) * size_moment(*set.size, 2);
    const double low = set.size_mean->low / set.size->mean, high = set.size_mean->high / set.size->mean;
    set.p30 = over(*set.p32_lines, {"", area, area * low * low, area * high * high, "", ""}, "P30", "P32 / E area");
  }
}

void Analysis::recorded_on_lines(SetResult& set) const {
  double truncation = 0;
  for (const LineSurvey& line : in_.lines) truncation = std::max(truncation, line.truncation.si());
  if (!(truncation > 0) || !set.p32_lines || !set.p32_lines->value) return;
  const std::string missing =
      fmt::format("joints whose traces are below {} m were not recorded on lines: ", truncation);
  if (set.recorded && set.recorded->value && bounded(*set.recorded)) {
    const Estimate& share = *set.recorded;
    set.notes.push_back(missing + fmt::format("under the law of sizes {:.0f} % of those met were ({:.0f} to {:.0f} "
                                              "%); P10 along the normal, P32 and P30 are those of all, spacings and "
                                              "frequencies those of the longer ones",
                                              100 * *share.value, 100 * share.low, 100 * share.high));
    for (auto* e : {&set.p10_normal, &set.p32_lines}) {
      if (*e) *e = over(**e, share, (*e)->name, (*e)->method + ", over the share that is recorded");
    }
    return;
  }
  set.notes.push_back(missing +
                      "P10, P32 and spacings of lines are those of the longer ones, as no law of sizes "
                      "from lines says how many are missing");
  if (!set.p32_windows || !set.p32_windows->value) set.cautions.push_back(set.notes.back());
}

}  // namespace cleave::survey::detail
