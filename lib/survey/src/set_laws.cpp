#include "set_laws.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

namespace cleave::survey::detail {

Estimate scaled(Estimate e, std::string name, double factor, std::string method) {
  e.name = std::move(name);
  if (e.value) *e.value *= factor;
  e.low *= factor;
  e.high *= factor;
  e.method = std::move(method);
  return e;
}

namespace {

template <class Laws, class Key>
void undecided(SetResult& set, std::string_view of, Key key, const Laws& laws) {
  if (laws.size() < 2) return;
  const auto [first, aic] = key(laws[0]);
  const auto [second, next] = key(laws[1]);
  if (next - aic >= 2) return;
  set.notes.push_back(fmt::format("the laws of {} {} and {} are undecided (AIC differs by {:.1f})", of, name_of(first),
                                  name_of(second), next - aic));
}

/// Round joints by the likelihood of their traces, rectangles by moments.
void fit_sizes(SetResult& set, const std::vector<SeenLength>& lengths, const Meeting& meeting, double confidence) {
  if (!set.chords.disc) {
    for (const FittedLaw& law : set.lengths) {
      if (!law.sizes) continue;
      set.sizes.push_back(
          {*law.sizes, law.size_mean.value_or(Estimate{"mean size", law.sizes->mean, 0, INFINITY, "", ""}),
           law.size_std.value_or(Estimate{"standard deviation of the sizes", law.sizes->std, 0, INFINITY, "", ""}),
           law.fit.aic, "moments of the traces"});
    }
    return;
  }
  for (const Family family : {Family::exponential, Family::lognormal, Family::gamma, Family::power}) {
    const auto fit = fit_discs(lengths, meeting, family);
    if (!fit) continue;
    const double scale = 1 / *set.chords.disc;
    SizeOfJoints law = size_of(*fit);
    for (double* length : {&law.mean, &law.std, &law.min, &law.max}) *length *= scale;
    const Estimate mean = estimate_of(*fit, "mean size", [](const Fit& f) { return f.moment(1); }, confidence);
    const Estimate spread =
        estimate_of(*fit, "standard deviation of the sizes", [](const Fit& f) { return std_of(f); }, confidence);
    set.sizes.push_back({law, scaled(mean, mean.name, scale, mean.method),
                         scaled(spread, spread.name, scale, spread.method), fit->aic, "likelihood of the traces"});
  }
  std::ranges::stable_sort(set.sizes, {}, &FittedSize::aic);
  undecided(set, "size", [](const FittedSize& l) { return std::pair{l.law.family, l.aic}; }, set.sizes);
}

}  // namespace

void fit_laws(SetResult& set, const std::vector<SeenLength>& lengths, const Meeting& meeting,
              const std::optional<double>& mean, double confidence) {
  for (const Family family : {Family::exponential, Family::lognormal, Family::gamma, Family::power}) {
    // Pooled windows of equal shape: area over width of the sums.
    auto fit = fit_lengths(lengths, meeting, family);
    if (!fit) continue;
    FittedLaw law{.fit = *std::move(fit), .sizes = {}, .mean = {}, .std = {}, .size_mean = {}, .size_std = {}};
    law.sizes = size_law(family, law.fit.moment(1), law.fit.moment(2), set.chords);
    if (family == Family::power) {
      law.sizes = power_size(size_moments(law.fit.moment(1), 1, set.chords).m2, law.fit.min, law.fit.max);
    }
    law.mean = estimate_of(law.fit, "mean length", [](const Fit& f) { return f.moment(1); }, confidence);
    law.std = estimate_of(law.fit, "standard deviation", [](const Fit& f) { return std_of(f); }, confidence);
    if (law.sizes && family != Family::power) {
      law.size_mean = size_mean_by_moments(law.fit, set.chords, confidence);
      law.size_std = size_std_by_moments(law.fit, set.chords, confidence);
    }
    set.lengths.push_back(std::move(law));
  }
  std::ranges::stable_sort(set.lengths, {}, [](const FittedLaw& l) { return l.fit.aic; });
  if (set.lengths.empty()) return;
  undecided(set, "trace length", [](const FittedLaw& l) { return std::pair{l.fit.family, l.fit.aic}; }, set.lengths);
  fit_sizes(set, lengths, meeting, confidence);
  const Fit& best = set.lengths.front().fit;
  const auto moment = [&](int order) {
    return estimate_of(
        best, order == 1 ? "E L^2 / E L" : "E L^3 / E L",
        [&, order](const Fit& f) {
          const SizeMoments m = size_moments(f.moment(1), f.moment(2), set.chords);
          return std::optional{order == 1 ? m.m2 : m.m3};
        },
        confidence);
  };
  set.m2 = moment(1);
  set.m3 = moment(2);
  for (Estimate* e : {&*set.m2, &*set.m3}) e->method = "from the traces' moments, whatever the law of sizes";
  const SizeMoments m = size_moments(best.moment(1), best.moment(2), set.chords);
  if (m.ratio() < 1) {
    set.notes.push_back(fmt::format(
        "no law of sizes has traces of these moments (m3/m2^2 = {:.2f} < 1): joints are not of this shape, or traces "
        "are of more than one set",
        m.ratio()));
  }
  if (!set.sizes.empty()) {
    set.size = set.sizes.front().law;
    set.size_mean = set.sizes.front().mean;
    set.size_std = set.sizes.front().std;
  } else if (mean) {
    set.notes.emplace_back("the exponential law of sizes with the same mean trace is taken");
    set.size = size_law(Family::exponential, *mean, 0, set.chords);
  }
}

}  // namespace cleave::survey::detail
