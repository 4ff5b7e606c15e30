#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

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

/// Share of the rock in measured blocks; below it sizes by volume rest on what was not seen.
constexpr double mostly_measured = 0.5;

using Curve = std::vector<std::pair<double, double>>;  ///< shares by volume

/// Between the ends of two bins; empty: before the first end.
std::optional<double> crossing(const Curve& shares, Curve::const_iterator reached, double level) {
  if (reached == shares.begin() || reached == shares.end()) return std::nullopt;
  const auto [from, below] = *(reached - 1);
  const auto [to, above] = *reached;
  return std::exp(std::lerp(std::log(from), std::log(to), (level - below) / (above - below)));
}
/// Where a share first reaches `level`.
std::optional<double> first_at(const Curve& shares, double level) {
  return crossing(shares, std::ranges::find_if(shares, [&](const auto& p) { return p.second >= level; }), level);
}
/// Beyond which it stays there: ends of intervals need not grow with the volume.
std::optional<double> last_at(const Curve& shares, double level) {
  const auto below = std::find_if(shares.rbegin(), shares.rend(), [&](const auto& p) { return p.second < level; });
  return crossing(shares, below.base(), level);
}

struct Curves {
  Curve share, low, high;
  void add(double volume, double below, const Interval& interval) {
    share.emplace_back(volume, below);
    low.emplace_back(volume, interval.low);
    high.emplace_back(volume, interval.high);
  }
};

std::vector<SizeLevel> levels_of(const Curves& curves, bool optimistic) {
  std::vector<SizeLevel> levels;
  for (const auto& [name, level] : size_levels) {
    // The upper end of the share's interval reaches the level first.
    levels.push_back({.name = std::string{name},
                      .volume = cubic_metres(first_at(curves.share, level).value_or(0)),
                      .low = first_at(curves.high, level),
                      .high = last_at(curves.low, level),
                      .optimistic = optimistic,
                      .alone = {}});
  }
  return levels;
}

}  // namespace

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
  if (rock_.blocks_ == 0 || rock_.number_below_.front().count() < 2) return;
  const double blocks = number(rock_.blocks_);
  BlockSizeFigures sizes{
      .blocks = rock_.blocks_,
      .corrected = options_.box_domain,
      .mean_weight = rock_.weights_ / blocks,
      .measured_share = rock_.rock_ > 0 ? rock_.volume_ / rock_.rock_ : 0,
      .beyond_share = 1 - rock_.number_below_[SizeBin::bins - 2].ratio() + rock_.number_below_.front().ratio(),
      .at_openings_share = rock_.volume_ > 0 ? rock_.at_openings_ / (rock_.volume_ + rock_.at_openings_) : 0,
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
    const SizeCurvePoint point{.volume = cubic_metres(SizeBin::edge(i + 1)),
                               .by_number = std::min(1.0, number_below.ratio()),
                               .by_volume = std::min(1.0, volume_below.ratio()),
                               .number_interval = size_interval(number_below, blocks),
                               .volume_interval = size_interval(volume_below, blocks)};
    by_number.add(point.volume.si(), point.by_number, point.number_interval);
    by_volume.add(point.volume.si(), point.by_volume, point.volume_interval);
    sizes.curve.push_back(point);
    if (point.by_number >= 1 - 1e-12) break;
  }
  sizes.by_number = levels_of(by_number, false);
  sizes.by_volume = levels_of(by_volume, sizes.measured_share < mostly_measured);
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
  if (sizes.measured_share < mostly_measured) {
    figures.notes.push_back(fmt::format(
        "block sizes are those of {:.0f} % of the rock: the rest lies in blocks that touch the sides of the "
        "domain{}",
        100 * sizes.measured_share, sizes.corrected ? "; blocks longer than the domain are never seen" : ""));
  }
  if (sizes.beyond_share > 0) {
    figures.notes.push_back(
        fmt::format("block sizes: {:.2g} % of the blocks are smaller than {:.2g} m3 or larger than {:.2g} m3: volumes "
                    "beyond these are not told",
                    100 * sizes.beyond_share, SizeBin::edge(1), SizeBin::edge(SizeBin::bins - 1)));
  }
  if (sizes.mean_weight > 2) {
    figures.notes.push_back(
        fmt::format("block sizes: a block stands for {:.1f} on average, as so many touch the sides of the domain: make "
                    "it larger",
                    sizes.mean_weight));
  }
}

}  // namespace cleave::stochastic
