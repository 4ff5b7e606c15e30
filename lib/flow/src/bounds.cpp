#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "cleave/core/expected.hpp"
#include "level.hpp"

/// Rates with bounds, and where the two solutions differ.
namespace cleave::flow {

std::expected<void, FlowError> Level::bound() {
  group_surfaces();
  const auto columns = static_cast<Column>(1 + group_count_);
  low_ = Eigen::MatrixXd::Zero(rows(middles_), columns);
  low_.col(0) = balanced_.heads.col(0);
  high_ = Eigen::MatrixXd::Zero(rows(corners_), columns);
  continuous_ = {.heads = {}, .held = std::vector<std::uint8_t>(corners_.count)};
  std::vector<std::uint8_t> fixed(corners_.count, 0);
  for (const bool of_drained : {true, false}) {  // where they touch, standing water counts
    for_each_open([&](std::size_t b, Index side) {
      if (drained(b) != of_drained) return;
      const Border& border = mesh_.borders[b];
      const auto column = static_cast<Column>(1 + group_of_[border.surface]);
      low_(side, column) = 1;
      for_each_corner(side, border, [&](Index corner, Index point) {
        if (!of_drained) high_.row(corner).setZero();
        high_(corner, 0) = head_at(border.surface, mesh_.points[point]);
        high_(corner, column) = fixed[corner] = 1;
        continuous_.held[corner] = of_drained ? 1 : 0;
      });
    });
  }
  CLEAVE_CHECK(fill(*balanced_.equations, low_));
  CLEAVE_CHECK(fill(LeastEnergy{corners_, stiffness_, wet_, std::move(fixed)}, high_));
  continuous_.heads = high_.col(0);
  const std::vector<std::uint8_t> held = continuous_.held;
  CLEAVE_CHECK(press(corners_, standing_corners_, ceiling_of_corners_, true, continuous_));
  same_dry_ = held == continuous_.held;
  find_gaps();
  return {};
}

std::expected<void, FlowError> Level::bound_above() {
  std::vector<double> raised(basins_.size(), 0);
  for (std::size_t c = 0; c < basins_.size(); ++c) raised[c] = rise_of(basins_[c]);
  Eigen::VectorXd weight = Eigen::VectorXd::Zero(low_.rows()), weight_above = Eigen::VectorXd::Zero(high_.rows());
  for (const Column g : groups(true)) {
    weight += low_.col(g);
    weight_above += high_.col(g);
  }
  Seepage low = balanced_, high = continuous_;
  Ceiling of_low = ceiling_of_middles_, of_high = ceiling_of_corners_;
  std::vector<std::uint8_t> low_seen(middles_.count, 0), high_seen(corners_.count, 0);
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    if (wet_[t] == 0) continue;
    const double rise = raised[basin_of_[t]];
    for (std::size_t k = 0; k < 3; ++k) {
      const Index side = middles_.of[t][k], corner = corners_.of[t][k];
      if (std::exchange(low_seen[side], std::uint8_t{1}) == 0) {
        of_low.at[side] += rise;
        low.heads(side, 0) += rise * weight(side);
      }
      if (std::exchange(high_seen[corner], std::uint8_t{1}) == 0) {
        of_high.at[corner] -= rise;
        high.heads(corner, 0) -= rise * weight_above(corner);
      }
    }
  }
  CLEAVE_CHECK(press(middles_, standing_middles_, of_low, true, low));
  CLEAVE_CHECK(press(corners_, standing_corners_, of_high, same_dry_, high));
  shifts_settled_ = low.settled && high.settled;
  std::vector<double> difference(basins_.size(), 0);
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    if (wet_[t] == 0) continue;
    const Values u = at_corners(high.heads, t, 0), v = in_middles(low.heads, t, 0);
    difference[basin_of_[t]] += 0.5 * (energy(stiffness_[t], u, u) - energy(stiffness_[t], v, v));
  }
  for (std::size_t c = 0; c < basins_.size(); ++c) {
    basins_[c].above = raised[c] > 0 ? difference[c] / (2 * raised[c]) : 0;
    if (basins_[c].touches) basins_[c].above = basins_[c].drained.high;
  }
  return {};
}

Rate Level::out_of_drained() const {
  Rate sum;
  for (const Basin& basin : basins_) {
    const double low = std::max(basin.drained.low, 0.0), high = std::max(basin.above, low);
    sum.value += std::clamp(basin.drained.value, low, high);
    sum.low += low;
    sum.high += high;
  }
  return sum;
}

double Level::width_of_drained() const {
  const Rate rate = out_of_drained();
  const double half = 0.5 * (rate.high - rate.low);
  double passes = 0, rounds_off = 0;
  bool held = false;
  for (const Basin& basin : basins_) {
    if (!basin.drains) continue;
    passes += basin.passes;
    rounds_off += basin.rounds_off;
    held = held || basin.held;
  }
  if (half <= rounds_off) return 0;
  if (!held) return rate.high / std::max(passes, rate.high);
  return rate.value > 0 ? half / rate.value : 1;
}

void Level::mark_worst(std::span<const Column> wanted, std::vector<std::uint8_t>& marked) const {
  std::vector<double> share(mesh_.triangles.size(), 0), own(share.size(), 0);
  const auto add = [&](const auto& squared) {
    double sum = 0;
    for (std::size_t t = 0; t < own.size(); ++t) sum += own[t] = wet_[t] != 0 ? squared(t) : 0;
    for (std::size_t t = 0; t < own.size() && sum > 0; ++t) share[t] += own[t] / sum;
  };
  add([&](std::size_t t) { return gap_of_heads_[t]; });
  for (const Column c : wanted) {
    add([&](std::size_t t) {
      const Values g = gap(t, c);
      return energy(stiffness_[t], g, g);
    });
  }
  mark_half(share, marked);
}

double Level::gap_of_pressures(double tolerance, std::vector<std::uint8_t>& marked) const {
  const std::size_t parts = network_.transmissivity().size();
  std::vector<double> gap(parts, 0), pressure(parts, 0), count(parts, 0), area(parts, 0),
      share(mesh_.triangles.size(), 0);
  for (std::size_t t = 0; t < share.size(); ++t) {
    if (wet_[t] == 0) continue;
    const Index part = mesh_.part[t];
    share[t] = gap_of_heads_[t] / transmissivity(t);
    gap[part] += share[t];
    count[part] += 1;
    area[part] += areas_[t];
    for (std::size_t k = 0; k < 3; ++k) {
      const double head = continuous_.heads(corners_.of[t][k], 0) - mesh_.points[mesh_.triangles[t][k]].z;
      pressure[part] = std::max(pressure[part], head);
    }
  }
  double widest = 0;
  for (std::size_t p = 0; p < parts; ++p) {
    if (!(pressure[p] > 0)) {
      gap[p] = 0;
      continue;
    }
    // Less than half a joint's size of water weighs little beside the block on it.
    const double head = std::max(pressure[p], 0.5 * std::sqrt(area[p]));
    widest = std::max(widest, gap[p] / (head * head));
    pressure[p] = head * head;
  }
  for (std::size_t t = 0; t < share.size(); ++t) {
    const Index p = mesh_.part[t];
    const double most = tolerance * pressure[p];
    if (gap[p] > most && share[t] > most / count[p]) marked[t] = 1;
  }
  return widest;
}

void Level::find_gaps() {
  const double largest = continuous_.heads.size() > 0 ? continuous_.heads.cwiseAbs().maxCoeff() : 0;
  gap_of_heads_.assign(mesh_.triangles.size(), 0);
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    if (wet_[t] == 0) continue;
    Basin& basin = basins_[basin_of_[t]];
    const Values low = in_middles(balanced_.heads, t, 0), high = at_corners(continuous_.heads, t, 0);
    const Values apart{low[0] - high[0], low[1] - high[1], low[2] - high[2]};
    gap_of_heads_[t] = energy(stiffness_[t], apart, apart);
    basin.energy += energy(stiffness_[t], high, high);
    basin.transmissivity += transmissivity(t);
  }
  for (std::size_t b = 0; b < mesh_.borders.size(); ++b) {
    const Index side = side_of_border_[b];
    if (!is_wet(side)) continue;
    const Index t = sides_.triangles(side).front();
    Basin& basin = basins_[basin_of_[t]];
    const double out = open_[b] != 0 ? out_of(side) : 0;
    if (!drained(b)) {
      basin.passes += std::max(-out, 0.0);
      continue;
    }
    basin.held = basin.held || open_[b] != 0;
    basin.dries = basin.dries || open_[b] == 0;
    (open_[b] != 0 ? basin.open : basin.dry) += length_of(mesh_.borders[b]);
    // What comes out where the continuous heads lie below the surface: the integral of q (z - u), twice.
    for_each_corner(side, mesh_.borders[b], [&](Index corner, Index point) {
      gap_of_heads_[t] += out * (mesh_.points[point].z - continuous_.heads(corner, 0));
      basin.held = basin.held || continuous_.held[corner] != 0;
      basin.dries = basin.dries || continuous_.held[corner] == 0;
    });
  }
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    gap_of_heads_[t] = std::max(gap_of_heads_[t], 0.0);
    if (wet_[t] != 0) basins_[basin_of_[t]].gap += gap_of_heads_[t];
  }
  std::vector<double> of_weights(basins_.size(), 0);
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    for (Column c = 1; c < high_.cols() && wet_[t] != 0; ++c) {
      const Values weight = at_corners(high_, t, c);
      of_weights[basin_of_[t]] += energy(stiffness_[t], weight, weight);
    }
  }
  const std::vector<Rate> rates = rates_of(groups(true));
  for (std::size_t c = 0; c < basins_.size(); ++c) {
    basins_[c].drained = rates[c];
    basins_[c].rounds_off = 1e-14 * largest * std::sqrt(basins_[c].transmissivity * std::max(of_weights[c], 0.0));
  }
}

std::vector<Rate> Level::rates_of(std::span<const Column> groups) const {
  struct Shared {
    double product = 0, gap = 0, of_heads = 0, of_weights = 0;
  };
  std::vector<Shared> sums(basins_.size());
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    if (wet_[t] == 0) continue;
    Values weight{}, weight_gap{};
    for (const Column g : groups) {
      const Values own = at_corners(high_, t, g), own_gap = gap(t, g);
      for (std::size_t k = 0; k < 3; ++k) {
        weight[k] += own[k];
        weight_gap[k] += own_gap[k];
      }
    }
    const Values of_head = gap(t, 0);
    Shared& sum = sums[basin_of_[t]];
    sum.product += energy(stiffness_[t], at_corners(high_, t, 0), weight);
    sum.gap += energy(stiffness_[t], of_head, weight_gap);
    sum.of_heads += energy(stiffness_[t], of_head, of_head);
    sum.of_weights += energy(stiffness_[t], weight_gap, weight_gap);
  }
  // With e and d the errors of the continuous functions (a head, a weight), a(e, d) = (g, h) / 2 + a rest of at most
  // half the product of the gaps' sizes.
  std::vector<Rate> rates;
  for (const auto& [product, gap, of_heads, of_weights] : sums) {
    const double value = 0.5 * gap - product;
    const double half = 0.5 * std::sqrt(std::max(of_heads, 0.0) * std::max(of_weights, 0.0));
    rates.push_back({value, value - half, value + half});
  }
  return rates;
}

double Level::rise_of(const Basin& basin) {
  if (!basin.drains || basin.touches || basin.level <= basin.lowest) return 0;  // no head is above the highest level
  const double out = basin.drained.value, fall = basin.level - basin.lowest;
  const double head = out > 0 ? std::min(basin.energy / out, fall) : fall;
  const double length = basin.open + basin.dry;
  const double dry = std::max(length > 0 ? basin.dry / length : 0, basin.dries ? 1e-3 : 0);
  if (!(basin.energy * dry > 0)) return 0.5 * head;
  const double share = std::cbrt(1.5 * basin.gap / (basin.energy * dry));
  return head * (share > 0 ? std::clamp(share, 0.005, 0.5) : 0.5);
}

}  // namespace cleave::flow
