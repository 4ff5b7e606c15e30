#include <algorithm>
#include <cmath>
#include <numeric>

#include "cleave/core/special.hpp"
#include "cleave/stochastic/ensemble.hpp"
#include "number.hpp"

/// Sizes of the rock's blocks, amounts of its joints and scanlines over realizations.
namespace cleave::stochastic {
namespace {

/// By samples of ten realizations (`./x study coverage`): few of them hold the large blocks.
constexpr double tail_widening = 0.5;

/// Volume at which a curve that rises through the upper ends of the bins reaches the share `p`, logarithms of volumes
/// between two ends taken as straight; empty where it does not reach it.
template <class Share>
std::optional<double> volume_at(const std::vector<SizeShare>& curve, double lowest, double p, Share share) {
  double before = 0, from = lowest;
  for (const SizeShare& point : curve) {
    const double at = std::max(before, share(point));
    if (at >= p) {
      const double part = at > before ? std::clamp((p - before) / (at - before), 0.0, 1.0) : 1;
      return from * std::pow(point.volume.si() / from, part);
    }
    before = at;
    from = point.volume.si();
  }
  return std::nullopt;
}

}  // namespace

void BlockSizeSums::add_numbers(const Record& record, std::vector<double>& numbers) const {
  const WholeBlocks none, &whole = record.whole ? *record.whole : none;
  numbers.push_back(number(whole.count));
  numbers.push_back(whole.volume.si());
  numbers.push_back(record.rock_m3);
  numbers.insert(numbers.end(), whole.shapes.begin(), whole.shapes.end());
  double count = 0, volume = 0;
  auto next = whole.bins.begin();
  for (std::uint32_t bin = 0; bin < SizeHistogram::bins; ++bin) {
    if (next != whole.bins.end() && next->bin == bin) {
      count += static_cast<double>(next->number);
      volume += static_cast<double>(next->volume_m3);
      ++next;
    }
    numbers.push_back(count);
    numbers.push_back(volume);
  }
  double all_sets = 0;
  for (std::size_t i = 0; i < sets_.size(); ++i) {
    const SetTally set = i < record.sets.size() ? record.sets[i] : SetTally{};
    for (const double x : {number(set.joints), set.p32, set.p10, set.p21}) numbers.push_back(x);
    all_sets += set.p10;
  }
  numbers.push_back(all_sets);
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    const LineTally line = i < record.lines.size() ? record.lines[i] : LineTally{};
    numbers.push_back(line.length.si() > 0 ? number(line.joints) / line.length.si() : 0);
    numbers.push_back(line.rqd);
    numbers.push_back(line.length.si());
  }
}

void BlockSizeSums::add_unit(std::span<const double> sums, std::size_t& next, double realizations) {
  const auto take = [&] { return sums[next++]; };
  blocks_ += take();
  const double met = take(), rock = take();
  met_.add(met, rock);
  std::array<double, 4> shapes{};
  for (double& shape : shapes) shape = take();
  const double counted = std::accumulate(shapes.begin(), shapes.end(), 0.0);
  for (std::size_t i = 0; i < shapes.size(); ++i) shapes_.at(i).add(shapes.at(i), counted);
  constexpr std::size_t last = 2 * (SizeHistogram::bins - 1);
  const double number = sums[next + last], volume = sums[next + last + 1];
  mean_volume_.add(volume, number);
  if (number > 0) mean_volume_tail_.add(volume / number, number);
  for (std::size_t bin = 0; bin < SizeHistogram::bins; ++bin) {
    number_below_[bin].add(take(), number);
    volume_below_[bin].add(take(), volume);
  }
  for (OfSet& set : sets_) {
    for (Summed* figure : {&set.joints, &set.p32, &set.p10, &set.p21}) figure->add(take() / realizations);
  }
  all_sets_.add(take() / realizations);
  for (OfLine& line : lines_) {
    for (Summed* figure : {&line.frequency, &line.rqd}) figure->add(take() / realizations);
    line.met = take() > 0 || line.met;
  }
}

/// Of a share of volumes, most of which few large blocks have: no narrower than Student's interval moved by the
/// skewness, of the realizations.
Interval Ensemble::volume_share_interval(const PairMoments& pair, double most) const {
  Interval interval = share_interval(pair, most);
  const double se = pair.ratio_standard_error();
  if (pair.count() < 2 || !(se > 0)) return interval;
  const Interval skewed =
      skew_interval(pair.ratio(), se, pair.ratio_skewness(), pair.count(), options_.confidence, tail_widening);
  interval.low = std::max(0.0, std::min(interval.low, skewed.low));
  interval.high = std::min(1.0, std::max(interval.high, skewed.high));
  return interval;
}

void Ensemble::add_block_sizes(Figures& figures) const {
  const BlockSizeSums& sums = block_sizes_;
  const auto mean = [&](std::string name, const BlockSizeSums::Summed& of) {
    return estimate(std::move(name), of.moments, of.tail, Method::mean);
  };
  for (std::size_t i = 0; i < sums.sets_.size() && units_ > 0; ++i) {
    const BlockSizeSums::OfSet& set = sums.sets_[i];
    if (!(set.joints.moments.largest() > 0)) continue;
    figures.sets.push_back({options_.sets[i], mean("joints", set.joints), mean("p32", set.p32), mean("p10", set.p10),
                            mean("p21", set.p21)});
  }
  if (!figures.sets.empty()) figures.jv = mean("jv", sums.all_sets_);
  for (std::size_t i = 0; i < sums.lines_.size() && units_ > 0; ++i) {
    const BlockSizeSums::OfLine& line = sums.lines_[i];
    if (!line.met) continue;
    figures.lines.push_back({options_.lines[i], mean("frequency", line.frequency), mean("rqd", line.rqd)});
    double& high = figures.lines.back().rqd.high;
    high = std::min(100.0, high);
  }
  if (!options_.whole_system || !(sums.blocks_ > 0)) return;
  BlockSizeFigures& sizes = figures.block_sizes.emplace();
  sizes.blocks = static_cast<std::uint64_t>(sums.blocks_);
  sizes.corrected = options_.undisturbed;
  sizes.mean_volume = ratio_estimate("mean_volume_m3", sums.mean_volume_, sums.mean_volume_tail_, false);
  sizes.met_share = ratio_estimate("met_share", sums.met_, {}, false);
  sizes.met_share.high = std::min(1.0, sizes.met_share.high);
  for (std::size_t i = 0; i < sizes.shapes.size(); ++i) {
    const PairMoments& shape = sums.shapes_.at(i);
    Estimate& share = sizes.shapes.at(i) = ratio_estimate(std::string{shape_class_names.at(i)}, shape, {}, false);
    const Interval interval = share_interval(shape, sums.blocks_);
    share.low = interval.low;
    share.high = interval.high;
  }
  std::size_t first = 0;
  while (!(sums.number_below_[first].ratio() > 0)) ++first;
  for (std::size_t bin = first; bin < SizeHistogram::bins; ++bin) {
    const PairMoments &number = sums.number_below_[bin], &volume = sums.volume_below_[bin];
    sizes.curve.push_back({.volume = cubic_metres(SizeHistogram::edge(bin + 1)),
                           .by_number = number.ratio(),
                           .by_volume = volume.ratio(),
                           .by_number_interval = share_interval(number, sums.blocks_),
                           .by_volume_interval = volume_share_interval(volume, sums.blocks_)});
    if (number.ratio() >= 1) break;
  }
  const double lowest = SizeHistogram::edge(first);
  const auto levels = [&](double SizeShare::* share, Interval SizeShare::* interval) {
    std::vector<SizeLevel> rows;
    for (const double p : options_.size_levels) {
      SizeLevel row{.p = p, .volume_m3 = {}, .low = {}, .high = {}};
      row.volume_m3 = volume_at(sizes.curve, lowest, p, [&](const SizeShare& s) { return s.*share; }).value_or(0);
      if (units_ >= 2) {
        row.low = volume_at(sizes.curve, lowest, p, [&](const SizeShare& s) { return (s.*interval).high; });
        row.high = volume_at(sizes.curve, lowest, p, [&](const SizeShare& s) { return (s.*interval).low; });
      }
      rows.push_back(row);
    }
    return rows;
  };
  sizes.by_number = levels(&SizeShare::by_number, &SizeShare::by_number_interval);
  sizes.by_volume = levels(&SizeShare::by_volume, &SizeShare::by_volume_interval);
}

}  // namespace cleave::stochastic
