#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cleave/core/rng.hpp"
#include "cleave/core/special.hpp"
#include "cleave/stochastic/ensemble.hpp"
#include "number.hpp"

/// Sizes of the rock's blocks and amounts of joint sets over the realizations of an ensemble.
namespace cleave::stochastic {

RockReduction::RockReduction(std::size_t sets)
    : number_below_(SizeBin::bins), volume_below_(SizeBin::bins), sets_(sets) {}

void RockReduction::add(const Record& record) {
  if (record.sizes) {
    const RockSizes& s = *record.sizes;
    blocks_ += s.blocks;
    volume_ += s.volume_m3;
    at_openings_ += s.at_openings_m3;
    rock_ += record.rock_m3;
    double number = 0, volume = 0;
    for (const SizeBin& bin : s.bins) {
      number += bin.number;
      volume += bin.volume_m3;
    }
    weights_ += number;
    double number_below = 0, volume_below = 0;
    auto next = s.bins.begin();
    for (std::uint32_t i = 0; i < SizeBin::bins; ++i) {
      for (; next != s.bins.end() && next->bin <= i; ++next) {
        number_below += next->number;
        volume_below += next->volume_m3;
      }
      number_below_[i].add(number_below, number);
      volume_below_[i].add(volume_below, volume);
    }
    for (std::size_t i = 0; i < shapes_.size(); ++i) shapes_.at(i).add(s.shapes.at(i), number);
    for (std::size_t i = 0; i < levels_.size() && s.blocks > 0; ++i) {
      levels_.at(i).number.add(s.by_number.at(i));
      levels_.at(i).volume.add(s.by_volume.at(i));
    }
  }
  double jv = 0;
  for (std::size_t i = 0; i < sets_.size(); ++i) {
    const SetAmount amount = i < record.sets.size() ? record.sets[i] : SetAmount{};
    sets_[i].joints.add(amount.joints);
    sets_[i].p10.add(amount.p10);
    sets_[i].p21.add(amount.p21);
    sets_[i].p32.add(amount.p32);
    jv += amount.p10;
  }
  jv_.add(jv);
}

namespace {

/// Where a share that grows with the volume reaches `level`, between the ends of two bins; empty: nowhere, or before
/// the first end.
std::optional<double> volume_at(const std::vector<std::pair<double, double>>& shares, double level) {
  for (std::size_t i = 0; i < shares.size(); ++i) {
    if (shares[i].second < level) continue;
    if (i == 0) return std::nullopt;
    const auto [from, below] = shares[i - 1];
    const auto [to, above] = shares[i];
    return std::exp(std::lerp(std::log(from), std::log(to), (level - below) / (above - below)));
  }
  return std::nullopt;
}

struct Curves {
  std::vector<std::pair<double, double>> share, low, high;  ///< by volume
  void add(double volume, double below, const Interval& interval) {
    share.emplace_back(volume, below);
    low.emplace_back(volume, interval.low);
    high.emplace_back(volume, interval.high);
  }
};

/// Of the levels by volume those above it cover 80 to 90 % at 60 realizations of rock cut by three Poisson sets
/// in a box
/// eight spacings wide (`./x study coverage`).
constexpr double few_decide = 0.7;

std::vector<SizeLevel> levels_of(const Curves& curves, bool of_volume) {
  std::vector<SizeLevel> levels;
  for (const auto& [name, level] : size_levels) {
    // The upper end of the share's interval reaches the level first.
    levels.push_back({.name = std::string{name},
                      .volume_m3 = volume_at(curves.share, level).value_or(0),
                      .low = volume_at(curves.high, level),
                      .high = volume_at(curves.low, level),
                      .optimistic = of_volume && level > few_decide,
                      .alone = {}});
  }
  return levels;
}

}  // namespace

/// Of a share of the blocks or of their volume: with the effective number of blocks, at most `most`.
Interval Ensemble::size_interval(const PairMoments& pair, double most) const {
  const double p = std::clamp(pair.ratio(), 0.0, 1.0), se = pair.ratio_standard_error();
  double effective = pair.equal_parts();
  if (p > 0 && p < 1 && se > 0) {
    const double level = 0.5 + options_.confidence / 2;
    const double wider = special::student_t_quantile(level, number(pair.count() - 1)) / normal_quantile(level);
    effective = std::min(p * (1 - p) / (se * se * wider * wider), most);
  }
  return clopper_pearson_effective(p, std::max(effective, 1e-6), options_.confidence);
}

void Ensemble::add_rock(Figures& figures) const {
  const std::uint64_t samples = rock_.jv_.count();
  if (samples == 0) return;
  for (std::size_t i = 0; i < rock_.sets_.size(); ++i) {
    const RockReduction::Set& set = rock_.sets_[i];
    if (!(set.joints.largest() > 0)) continue;  // not in the box in any realization
    figures.sets.push_back({.name = options_.sets[i],
                            .joints = estimate("joints", set.joints, Method::mean),
                            .p10 = estimate("p10", set.p10, Method::mean),
                            .p21 = estimate("p21", set.p21, Method::mean),
                            .p32 = estimate("p32", set.p32, Method::mean)});
  }
  if (!figures.sets.empty()) figures.jv = estimate("jv", rock_.jv_, Method::mean);
  // With one realization nothing is known of the spread.
  if (rock_.blocks_ == 0 || samples < 2) return;
  const double blocks = number(rock_.blocks_);
  BlockSizeFigures sizes{.blocks = rock_.blocks_,
                         .corrected = options_.box_domain,
                         .mean_weight = rock_.weights_ / blocks,
                         .measured_share = rock_.rock_ > 0 ? rock_.volume_ / rock_.rock_ : 0,
                         .at_openings_share = rock_.at_openings_ / (rock_.volume_ + rock_.at_openings_),
                         .by_number = {},
                         .by_volume = {},
                         .shapes = {},
                         .curve = {}};
  const auto first = static_cast<std::uint32_t>(
      std::ranges::find_if(rock_.number_below_, [](const PairMoments& pair) { return pair.ratio() > 0; }) -
      rock_.number_below_.begin());
  // No block lies below the first bin that holds one. How many might is not known better than at its upper end, where
  // the curve of the upper ends begins.
  Curves by_number, by_volume;
  for (Curves* curves : {&by_number, &by_volume}) {
    curves->share.emplace_back(SizeBin::edge(first), 0);
    curves->low.emplace_back(SizeBin::edge(first), 0);
  }
  for (std::uint32_t i = first; i < SizeBin::bins; ++i) {
    const PairMoments &number_below = rock_.number_below_[i], &volume_below = rock_.volume_below_[i];
    const SizeCurvePoint point{.volume_m3 = SizeBin::edge(i + 1),
                               .by_number = std::min(1.0, number_below.ratio()),
                               .by_volume = std::min(1.0, volume_below.ratio()),
                               .number_interval = size_interval(number_below, blocks),
                               .volume_interval = size_interval(volume_below, blocks)};
    by_number.add(point.volume_m3, point.by_number, point.number_interval);
    by_volume.add(point.volume_m3, point.by_volume, point.volume_interval);
    sizes.curve.push_back(point);
    if (point.by_number >= 1 - 1e-12) break;
  }
  sizes.by_number = levels_of(by_number, false);
  sizes.by_volume = levels_of(by_volume, true);
  for (std::size_t i = 0; i < size_levels.size(); ++i) {
    sizes.by_number[i].alone = estimate(sizes.by_number[i].name, rock_.levels_.at(i).number, Method::mean_of_ratios);
    sizes.by_volume[i].alone = estimate(sizes.by_volume[i].name, rock_.levels_.at(i).volume, Method::mean_of_ratios);
  }
  for (std::size_t i = 0; i < zingg_names.size(); ++i) {
    const PairMoments& shape = rock_.shapes_.at(i);
    sizes.shapes.push_back({std::string{zingg_names.at(i)}, shape.ratio(), size_interval(shape, blocks)});
  }
  figures.block_sizes = std::move(sizes);
}

void Ensemble::add_size_notes(Figures& figures) const {
  if (!figures.block_sizes) return;
  const BlockSizeFigures& sizes = *figures.block_sizes;
  if (!sizes.corrected) {
    figures.notes.push_back(
        "block sizes: the domain is no box, so blocks that touch its sides are left out without a correction: large "
        "ones more often, the sizes are on the small side");
  }
  if (sizes.at_openings_share > 0.02) {
    figures.notes.push_back(fmt::format(
        "block sizes: {:.0f} % of the rock that no side of the domain holds lies in blocks which openings cut; they "
        "are "
        "left out, large ones more often: run the rock without openings for the sizes of undisturbed blocks",
        100 * sizes.at_openings_share));
  }
  if (sizes.measured_share < 0.5) {
    figures.notes.push_back(fmt::format(
        "block sizes are those of {:.0f} % of the rock: the rest lies in blocks that touch the sides of the "
        "domain{}",
        100 * sizes.measured_share, sizes.corrected ? "; blocks longer than the domain are never seen" : ""));
  }
  if (sizes.mean_weight > 2) {
    figures.notes.push_back(
        fmt::format("block sizes: a block stands for {:.1f} on average, as so many touch the sides of the domain: make "
                    "it larger",
                    sizes.mean_weight));
  }
}

}  // namespace cleave::stochastic
