#include "set_laws.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "cleave/core/rng.hpp"
#include "cleave/core/special.hpp"
#include "disc_fit.hpp"
#include "ratio.hpp"

namespace cleave::survey::detail {

Estimate scaled(Estimate e, std::string name, double factor, std::string method) {
  e.name = std::move(name);
  if (e.value) *e.value *= factor;
  e.low *= factor;
  e.high *= factor;
  e.method = std::move(method);
  return e;
}

Estimate over_orientations(const FisherFit& fit, const std::function<double(geometry::Vec3, double)>& figure,
                           double confidence) {
  using geometry::Vec3;
  Estimate e{"", figure(fit.mean, fit.kappa), 0, 0, "", ""};
  e.low = e.high = *e.value;
  if (fit.count < 3 || !std::isfinite(fit.kappa) || !(*e.value > 0)) return e;
  const double turn = 1 / std::sqrt(fit.kappa * fit.effective_count);
  const Vec3 some = std::abs(fit.mean.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 e1 = normalized(cross(fit.mean, some)), e2 = cross(fit.mean, e1);
  const double wider = std::exp(1 / std::sqrt(std::max(1.0, fit.effective_count - 1)));
  double square = 0;
  for (const double moved :
       {figure(normalized(fit.mean + turn * e1), fit.kappa), figure(normalized(fit.mean + turn * e2), fit.kappa),
        figure(fit.mean, fit.kappa * wider)}) {
    square += moved > 0 ? std::pow(std::log(moved / *e.value), 2) : 0;
  }
  const double half = std::exp(normal_quantile(0.5 + confidence / 2) * std::sqrt(square));
  e.low = *e.value / half;
  e.high = *e.value * half;
  return e;
}

std::optional<Estimate> length_per_end(const std::vector<SeenLength>& lengths, double confidence) {
  double sum = 0, ends = 0, square = 0;
  for (const SeenLength& l : lengths) {
    sum += l.length;
    ends += l.ends;
  }
  if (!(ends > 0)) return std::nullopt;
  for (const SeenLength& l : lengths) square += std::pow(l.length / sum - l.ends / ends, 2);
  return ratio_of_sums("mean trace length", sum / ends, square, lengths.size(), confidence, "S/m, delta method");
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

/// What a joint offers to be met, but for the angle it makes: in windows the area of places of its trace times its
/// size, on lines its area (as shares of the shape of size 1).
double offered(const Meeting& meeting, double chance, double mean, double square) {
  return meeting.area > 0 ? chance * mean : square;
}

/// Share of the joints met on these lines that is recorded; `met(l0)`: in proportion to those with traces above l0.
template <class Met>
double recorded(const std::vector<RecordedOn>& lines, const Met& met) {
  double all = 0, above = 0;
  for (const RecordedOn& line : lines) {
    all += line.length * met(0);
    above += line.length * met(line.truncation);
  }
  return above / all;
}

/// The law of sizes of shapes without a likelihood of their traces, by moments of a law of these.
std::optional<SizeOfJoints> size_by_moments(const Fit& f, const Chords& chords) {
  return f.family == Family::power ? power_size(size_moments(f.moment(1), 1, chords).m2, f.min, f.max)
                                   : size_law(f.family, f.moment(1), f.moment(2), chords);
}

FittedSize sizes_by_moments(const FittedLaw& law, const Chords& chords, const Meeting& meeting, double confidence,
                            const std::vector<RecordedOn>& lines) {
  FittedSize size{.law = *law.sizes,
                  .mean = *law.size_mean,
                  .std = *law.size_std,
                  .exponent = {},
                  .offered = {},
                  .aic = law.fit.aic,
                  .method = "moments of the traces"};
  const auto figure = [&](auto&& of) {
    return [&chords, of](const Fit& f) {
      const auto sizes = size_by_moments(f, chords);
      return sizes ? std::optional<double>{of(f, *sizes)} : std::nullopt;
    };
  };
  if (law.fit.family == Family::power) {
    size.exponent = estimate_of(law.fit, "exponent",
                                figure([](const Fit&, const SizeOfJoints& l) { return l.exponent; }), confidence);
  }
  const auto share = [&lines](const Fit& f) {
    return recorded(lines,
                    [&](double l0) { return Meeting{.truncation = l0}.chance(1 - f.below(l0), f.mean_excess(l0)); });
  };
  if (!lines.empty()) {
    size.recorded =
        estimate_of(law.fit, "share recorded", [&](const Fit& f) { return std::optional{share(f)}; }, confidence);
  }
  size.offered = estimate_of(law.fit, "offered", figure([&](const Fit& f, const SizeOfJoints& l) {
                               const double l0 = meeting.truncation;
                               return offered(meeting, meeting.chance(1 - f.below(l0), f.mean_excess(l0)), l.mean,
                                              size_moment(l, 2)) *
                                      (lines.empty() ? 1 : share(f));
                             }),
                             confidence);
  return size;
}

/// As `estimate_of`, down to the widest law that is allowed.
Estimate estimate_to_edge(const DiscFit& discs, std::string name,
                          const std::function<std::optional<double>(const Fit&)>& figure, double confidence) {
  Estimate e = estimate_of(discs.fit, std::move(name), figure, confidence);
  if (!discs.widest) return e;
  Fit widest = discs.fit;
  widest.a = (*discs.widest)[0];
  widest.b = (*discs.widest)[1];
  if (const auto value = figure(widest); value && *value > 0) {
    e.low = std::min(e.low, *value);
    e.high = std::max(e.high, *value);
  }
  return e;
}

/// Round joints by the likelihood of their traces, rectangles by moments.
///
/// Gives the gamma law at its widest where the likelihood rises up to there: it is no law to take, but an interval has
/// to reach it.
std::vector<FittedSize> fit_sizes(SetResult& set, const std::vector<SeenLength>& lengths, const Meeting& meeting,
                                  double confidence, const std::vector<RecordedOn>& lines) {
  std::vector<FittedSize> edges;
  if (!set.chords.disc) {
    for (const FittedLaw& law : set.lengths) {
      if (law.sizes) set.sizes.push_back(sizes_by_moments(law, set.chords, meeting, confidence, lines));
    }
    return edges;
  }
  std::string left_out;
  for (const Family family : {Family::exponential, Family::lognormal, Family::gamma, Family::power, Family::constant}) {
    const auto discs = fit_discs_to_edges(lengths, meeting, family, confidence);
    const Fit* const fit = discs ? &discs->fit : nullptr;
    if ((!discs || discs->at_widest) && (family == Family::lognormal || family == Family::gamma)) {
      left_out += (left_out.empty() ? "" : " and ") + std::string{name_of(family)};
    }
    if (!fit) continue;
    const double scale = 1 / *set.chords.disc;
    SizeOfJoints law = size_of(*fit);
    for (double* length : {&law.mean, &law.std, &law.min, &law.max}) *length *= scale;
    const Estimate mean = estimate_to_edge(*discs, "mean size", [](const Fit& f) { return f.moment(1); }, confidence);
    Estimate spread =
        estimate_to_edge(*discs, "standard deviation of the sizes", [](const Fit& f) { return std_of(f); }, confidence);
    if (family == Family::constant) {
      spread.high = fit->max;
      spread.method = "one size; the largest spread that the traces allow";
    }
    FittedSize size{.law = law,
                    .mean = scaled(mean, mean.name, scale, mean.method),
                    .std = scaled(spread, spread.name, scale, spread.method),
                    .exponent = {},
                    .offered = {},
                    .aic = fit->aic,
                    .method = "likelihood of the traces"};
    if (family == Family::power) {
      size.exponent = estimate_of(*fit, "exponent", [](const Fit& f) { return f.a; }, confidence);
    }
    const auto share = [&lines](const Fit& f) {
      return recorded(lines, [&](double l0) { return disc_chance(f, Meeting{.truncation = l0}); });
    };
    if (!lines.empty()) {
      size.recorded =
          estimate_to_edge(*discs, "share recorded", [&](const Fit& f) { return std::optional{share(f)}; }, confidence);
    }
    size.offered = estimate_to_edge(
        *discs, "offered",
        [&](const Fit& f) {
          return offered(meeting, disc_chance(f, meeting), scale * f.moment(1), scale * scale * f.moment(2)) *
                 (lines.empty() ? 1 : share(f));
        },
        confidence);
    (discs->at_widest ? edges : set.sizes).push_back(std::move(size));
  }
  std::ranges::stable_sort(set.sizes, {}, &FittedSize::aic);
  if (!set.sizes.empty() && set.sizes.front().law.family == Family::constant) {
    set.notes.push_back(
        fmt::format("sizes: the traces are those of joints all of one size; a standard deviation of up to "
                    "{:.2g} m cannot be told from it",
                    set.sizes.front().std.high));
  } else if (!left_out.empty() && !set.sizes.empty()) {
    set.notes.push_back(
        "sizes: " + left_out +
        " left out: the likelihood of the traces has no maximum between nearly equal sizes and a spread of four means");
  }
  undecided(set, "size", [](const FittedSize& l) { return std::pair{l.law.family, l.aic}; }, set.sizes);
  return edges;
}

/// A figure under one law.
struct UnderLaw {
  double aic;
  Estimate figure;
};

/// Interval of a figure over laws of which none is certain: the tails of all, weighted by exp(-AIC/2), hold together
/// what one law's would (Turek & Fletcher 2012), on the logarithm.
void average(Estimate& taken, const std::vector<UnderLaw>& laws, double confidence) {
  struct Law {
    double weight, middle, below, above;  // errors to either side
  };
  const double z = normal_quantile(0.5 + confidence / 2);
  std::vector<Law> known;
  for (const auto& [aic, e] : laws) {
    if (!e.value || !(*e.value > 0) || !(e.high > *e.value) || !std::isfinite(e.high)) continue;
    const double above = std::log(e.high / *e.value) / z;
    const double below = e.low > 0 && e.low < *e.value ? std::log(*e.value / e.low) / z : above;
    known.push_back({std::exp((laws.front().aic - aic) / 2), std::log(*e.value), below, above});
  }
  if (known.size() < 2) return;
  const auto end = [&](double level) {
    double low = INFINITY, high = -INFINITY, sum = 0;
    for (const Law& law : known) {
      low = std::min(low, law.middle - 10 * law.below);
      high = std::max(high, law.middle + 10 * law.above);
      sum += law.weight;
    }
    for (int i = 0; i < 100; ++i) {
      const double middle = (low + high) / 2;
      double below = 0;
      for (const Law& law : known) {
        const double off = middle - law.middle;
        below += law.weight / sum * special::normal_cdf(off / (off < 0 ? law.below : law.above));
      }
      (below < level ? low : high) = middle;
    }
    return std::exp(low);
  };
  taken.low = std::min(*taken.value, end((1 - confidence) / 2));
  taken.high = std::max(*taken.value, end((1 + confidence) / 2));
  taken.method += ", over all laws by their AIC";
  taken.note.clear();
}

/// The same, a figure of each law of sizes.
template <class Of>
void average(Estimate& taken, const std::vector<FittedSize>& laws, const std::vector<FittedSize>& edges, Of of,
             double confidence) {
  std::vector<UnderLaw> all;
  const auto add = [&](const FittedSize& law) { all.push_back({law.aic, of(law)}); };
  std::ranges::for_each(laws, add);
  std::ranges::for_each(edges, add);
  average(taken, all, confidence);
}

/// E L^2/E L (order 1) or E L^3/E L (2) by the moments of the traces, under the law of these that fits best; the
/// interval is over all of them, but for laws whose likelihood has next to no curvature (a normal law cut far above its
/// mean is nearly exponential).
Estimate moment_of_sizes(const SetResult& set, int order, double confidence) {
  constexpr double flat = 30;  // times the value
  std::vector<UnderLaw> laws;
  for (const FittedLaw& law : set.lengths) {
    laws.push_back({law.fit.aic, estimate_of(
                                     law.fit, order == 1 ? "E L^2 / E L" : "E L^3 / E L",
                                     [&](const Fit& f) {
                                       const SizeMoments m = size_moments(f.moment(1), f.moment(2), set.chords);
                                       return std::optional{order == 1 ? m.m2 : m.m3};
                                     },
                                     confidence)});
  }
  Estimate taken = laws.front().figure;
  taken.method = "from the traces' moments, whatever the law of sizes";
  std::erase_if(laws, [&](const UnderLaw& l) { return l.figure.value && l.figure.high > flat * *l.figure.value; });
  average(taken, laws, confidence);
  return taken;
}

/// One size has no spread to be averaged: where it is taken, the largest that it or a law nearly as good allows; where
/// it is nearly as good as the one that is taken, there may be none.
void average_spread(SetResult& set, const std::vector<FittedSize>& edges, double confidence) {
  constexpr double close = 6;
  const double best = set.sizes.front().aic;
  if (set.sizes.front().law.family != Family::constant) {
    average(*set.size_std, set.sizes, edges, [](const FittedSize& law) { return law.std; }, confidence);
  }
  for (const FittedSize& law : set.sizes) {
    if (law.aic > best + close) continue;
    if (law.law.family == Family::constant) set.size_std->low = 0;
    if (set.sizes.front().law.family == Family::constant)
      set.size_std->high = std::max(set.size_std->high, law.std.high);
  }
}

void average_over_laws(SetResult& set, const std::vector<FittedSize>& edges, double confidence) {
  average(*set.size_mean, set.sizes, edges, [](const FittedSize& law) { return law.mean; }, confidence);
  average_spread(set, edges, confidence);
  set.offered = set.sizes.front().offered;
  average(*set.offered, set.sizes, edges, [](const FittedSize& law) { return law.offered; }, confidence);
  set.recorded = set.sizes.front().recorded;
  if (!set.recorded) return;
  average(*set.recorded, set.sizes, edges, [](const FittedSize& law) { return *law.recorded; }, confidence);
  set.recorded->high = std::min(set.recorded->high, 1.0);
}

/// One trace, or traces all alike, say nothing of how others scatter: their likelihood is a spike, not an error.
bool alike(const std::vector<SeenLength>& lengths) {
  const auto [low, high] = std::ranges::minmax(lengths, {}, &SeenLength::length);
  return high.length <= low.length * (1 + 1e-9);
}
void without_interval(std::optional<Estimate>& e) {
  if (!e) return;
  e->low = 0;
  e->high = INFINITY;
  e->note = "no interval: traces all alike say nothing of how others scatter";
}
void without_intervals(SetResult& set) {
  for (auto* e : {&set.m2, &set.m3, &set.size_mean, &set.size_std, &set.offered, &set.recorded}) without_interval(*e);
}

}  // namespace

void fit_laws(SetResult& set, const std::vector<SeenLength>& lengths, const Meeting& meeting,
              const std::optional<Estimate>& mean, double confidence, const std::vector<RecordedOn>& lines) {
  for (const Family family : {Family::exponential, Family::lognormal, Family::gamma, Family::power, Family::normal}) {
    // Pooled windows of equal shape: area over width of the sums.
    auto fit = fit_lengths(lengths, meeting, family);
    if (!fit) continue;
    if (alike(lengths)) fit->moved.clear();
    FittedLaw law{
        .fit = *std::move(fit), .sizes = {}, .mean = {}, .std = {}, .size_mean = {}, .size_std = {}, .test = {}};
    law.sizes = size_by_moments(law.fit, set.chords);
    law.mean = estimate_of(law.fit, "mean length", [](const Fit& f) { return f.moment(1); }, confidence);
    law.std = estimate_of(law.fit, "standard deviation", [](const Fit& f) { return std_of(f); }, confidence);
    if (law.sizes) {
      law.size_mean = size_mean_by_moments(law.fit, set.chords, confidence);
      law.size_std = size_std_by_moments(law.fit, set.chords, confidence);
    }
    set.lengths.push_back(std::move(law));
  }
  std::ranges::stable_sort(set.lengths, {}, [](const FittedLaw& l) { return l.fit.aic; });
  if (set.lengths.empty()) return;
  undecided(set, "trace length", [](const FittedLaw& l) { return std::pair{l.fit.family, l.fit.aic}; }, set.lengths);
  const std::vector<FittedSize> edges = fit_sizes(set, lengths, meeting, confidence, lines);
  const Fit& best = set.lengths.front().fit;
  set.m2 = moment_of_sizes(set, 1, confidence);
  set.m3 = moment_of_sizes(set, 2, confidence);
  const SizeMoments m = size_moments(best.moment(1), best.moment(2), set.chords);
  if (m.ratio() < 1) {
    set.notes.push_back(fmt::format(
        "no law of sizes has traces of these moments (m3/m2^2 = {:.4g} < 1): joints are not of this shape, or traces "
        "are of more than one set",
        m.ratio()));
  }
  if (!set.sizes.empty()) {
    set.size = set.sizes.front().law;
    set.size_mean = set.sizes.front().mean;
    set.size_std = set.sizes.front().std;
    average_over_laws(set, edges, confidence);
  } else if (mean && mean->value) {
    set.notes.emplace_back("the exponential law of sizes with the same mean trace is taken");
    set.size = size_law(Family::exponential, *mean->value, 0, set.chords);
    // Mean and standard deviation are both half the mean trace over that of the chords.
    set.size_mean = scaled(*mean, "mean size", set.size->mean / *mean->value, mean->method);
    set.size_std = scaled(*mean, "standard deviation of the sizes", set.size->std / *mean->value, mean->method);
  }
  if (alike(lengths)) without_intervals(set);
}

}  // namespace cleave::survey::detail
