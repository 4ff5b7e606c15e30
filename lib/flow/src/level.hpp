#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <expected>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "cleave/core/disjoint_sets.hpp"
#include "cleave/core/expected.hpp"
#include "cleave/flow/flow.hpp"
#include "discretisation.hpp"
#include "seepage.hpp"
#include "shape.hpp"
#include "space.hpp"

/// One mesh of the series: heads, what is open, rates with bounds, and where the error is.
namespace cleave::flow {

using Column = Eigen::Index;

/// Heads that differ by less, of the extent of the network, are one.
inline constexpr double same_head = 1e-9;

/// A mesh with what is open on its borders, solved.
class Level final {
 public:
  Level(const Mesh& mesh, const Network& network, const std::vector<std::uint8_t>& open)
      : mesh_{mesh},
        network_{network},
        sides_{mesh},
        corners_{corners_of(mesh, sides_)},
        middles_{middles_of(mesh, sides_)},
        open_{open} {
    areas_.reserve(mesh.triangles.size());
    stiffness_.reserve(mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto [stiffness, area] = shape_of(mesh, t);
      areas_.push_back(area);
      Stiffness& s = stiffness_.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) s[k] = transmissivity(t) * stiffness[k];
    }
    side_of_border_.reserve(mesh.borders.size());
    for (const Border& border : mesh.borders) side_of_border_.push_back(*sides_.find(border.ends[0], border.ends[1]));
  }

  /// Heads in the middles of sides, and where water comes out of drained surfaces there.
  std::expected<void, FlowError> settle() {
    find_wet();
    CLEAVE_CHECK(check_heads());
    find_ceilings();
    balanced_ = {.heads = Eigen::MatrixXd::Zero(rows(middles_), 1), .held = std::vector<std::uint8_t>(middles_.count)};
    for_each_open([&](std::size_t b, Index side) {
      balanced_.heads(side, 0) = head_at(mesh_.borders[b].surface, middle_of(mesh_.borders[b]));
      (drained(b) ? balanced_.held : standing_middles_)[side] = 1;
    });
    CLEAVE_CHECK(press(middles_, standing_middles_, ceiling_of_middles_, false, balanced_));
    for (std::size_t b = 0; b < mesh_.borders.size(); ++b) {
      const Index side = side_of_border_[b];
      if (drained(b) && is_wet(side)) open_[b] = balanced_.held[side];
    }
    return {};
  }
  [[nodiscard]] const std::vector<std::uint8_t>& open() const noexcept { return open_; }

  /// After `settle`: rates with bounds where just what is dry now is closed, and continuous heads that lie nowhere
  /// above a drained surface.
  std::expected<void, FlowError> bound() {
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
  [[nodiscard]] bool settled() const noexcept { return balanced_.settled && continuous_.settled && shifts_settled_; }

  /// After `bound`: what leaves through drained surfaces is no more than `Basin::above`, whatever is dry.
  ///
  /// Let V(t) be the least energy (half of a(u, u)) with all drained surfaces raised by t. Its derivative is -Q(t), and
  /// what leaves is Q(t) = the most over sets A of what leaves where just A is open; each falls in a straight line with
  /// t, so Q is convex: Q(0) <= (V(-t) - V(t)) / (2 t). Continuous heads give too much for V, balanced rates too
  /// little.
  std::expected<void, FlowError> bound_above() {
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
    }
    return {};
  }
  /// Some drained surface is wet.
  [[nodiscard]] bool drains() const { return std::ranges::any_of(basins_, &Basin::drains); }

  /// After `bound_above`: out of all drained surfaces.
  [[nodiscard]] Rate out_of_drained() const {
    Rate sum;
    for (const Basin& basin : basins_) {
      const double low = std::max(basin.drained.low, 0.0), high = std::max(basin.above, low);
      sum.value += std::clamp(basin.drained.value, low, high);
      sum.low += low;
      sum.high += high;
    }
    return sum;
  }
  /// Half of the bounds' width over the rate; where no water comes out on this mesh, over what passes by.
  [[nodiscard]] double width_of_drained() const {
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

  /// Bounds of what leaves through these groups together.
  [[nodiscard]] Rate rate_of(std::span<const Column> groups) const {
    Rate sum;
    for (const Rate& rate : rates_of(groups)) {
      sum.value += rate.value;
      sum.low += rate.low;
      sum.high += rate.high;
    }
    return sum;
  }
  /// The columns of the groups of drained surfaces; of standing water where nothing is drained.
  [[nodiscard]] std::vector<Column> groups(bool drained) const {
    std::vector<Column> found;
    for (std::size_t s = 0; s < group_of_.size(); ++s) {
      if (group_of_[s] == none || std::holds_alternative<Drained>(network_.surfaces()[s]) != drained) continue;
      const auto column = static_cast<Column>(1 + group_of_[s]);
      if (std::ranges::find(found, column) == found.end()) found.push_back(column);
    }
    return found;
  }
  /// Half widths over rates, of these groups.
  [[nodiscard]] double width_of(std::span<const Column> wanted) const {
    double half = 0, sum = 0;
    for (const Column g : wanted) {
      const Rate rate = rate_of(std::array{g});
      half += 0.5 * (rate.high - rate.low);
      sum += std::abs(rate.value);
    }
    double rounds_off = 0;
    for (const Basin& basin : basins_) rounds_off += basin.rounds_off;
    return half <= rounds_off ? 0 : half / sum;
  }

  /// Marks the triangles that have half of the gaps of the heads and of the weights of these groups.
  void mark_worst(std::span<const Column> wanted, std::vector<std::uint8_t>& marked) const {
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

  /// How far the two solutions' gradients lie apart in the flat piece of joint where they do most, over the largest
  /// head of pressure there: the mean square, whatever its transmissivity. Marks triangles of those above `tolerance`.
  double gap_of_pressures(double tolerance, std::vector<std::uint8_t>& marked) const {
    const std::size_t parts = network_.transmissivity().size();
    std::vector<double> gap(parts, 0), pressure(parts, 0), count(parts, 0), share(mesh_.triangles.size(), 0);
    for (std::size_t t = 0; t < share.size(); ++t) {
      if (wet_[t] == 0) continue;
      const Index part = mesh_.part[t];
      share[t] = gap_of_heads_[t] / transmissivity(t);
      gap[part] += share[t];
      count[part] += 1;
      for (std::size_t k = 0; k < 3; ++k) {
        const double head = continuous_.heads(corners_.of[t][k], 0) - mesh_.points[mesh_.triangles[t][k]].z;
        pressure[part] = std::max(pressure[part], head);
      }
    }
    const double least = 1e-9 * extent_of(mesh_);
    double widest = 0;
    for (std::size_t p = 0; p < parts; ++p) {
      const double head = std::max(pressure[p], least);
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

  [[nodiscard]] Flow result() const {
    Flow flow{.mesh = mesh_, .wet = wet_, .residual = residual_};
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      auto& head = flow.head.emplace_back();
      Vec3& q = flow.q.emplace_back();
      flow.area += square_metres(areas_[t]);
      if (wet_[t] == 0) continue;
      flow.wet_area += square_metres(areas_[t]);
      for (std::size_t k = 0; k < 3; ++k) head[k] = metres(continuous_.heads(corners_.of[t][k], 0));
      q = -transmissivity(t) * gradient(t, in_middles(low_, t, 0));
    }
    put_surfaces(flow);
    flow.drained = out_of_drained();
    return flow;
  }

 private:
  /// What hangs together and is wet.
  struct Basin {
    double level = -infinite;    ///< the highest of standing water
    double lowest = infinite;    ///< the lowest z of a drained surface
    bool drains = false;         ///< it reaches one
    bool held = false;           ///< and water comes out there, in one of the solutions at least
    bool dries = false;          ///< some of it is dry
    double energy = 0, gap = 0;  ///< of heads: a(u, u), and how much more the continuous one has
    double passes = 0;           ///< m3/s, in at standing water
    double transmissivity = 0;   ///< sum over triangles
    double rounds_off = 0;       ///< m3/s
    double open = 0, dry = 0;    ///< m, of drained surfaces
    Rate drained = {};           ///< out of drained surfaces, where just what is dry now is closed
    double above = 0;            ///< bound of the same, whatever is dry
  };
  static constexpr double infinite = std::numeric_limits<double>::infinity();

  [[nodiscard]] static Column rows(const Space& space) { return static_cast<Column>(space.count); }
  [[nodiscard]] bool drained(std::size_t border) const {
    return std::holds_alternative<Drained>(network_.surfaces()[mesh_.borders[border].surface]);
  }
  [[nodiscard]] bool is_wet(Index side) const { return wet_[sides_.triangles(side).front()] != 0; }
  [[nodiscard]] double transmissivity(std::size_t t) const { return network_.transmissivity()[mesh_.part[t]].si(); }
  [[nodiscard]] double head_at(Index surface, Vec3 p) const {
    const auto* standing = std::get_if<Standing>(&network_.surfaces()[surface]);
    return standing != nullptr ? standing->level.si() : p.z;
  }
  [[nodiscard]] Vec3 middle_of(const Border& border) const {
    return 0.5 * (mesh_.points[border.ends[0]] + mesh_.points[border.ends[1]]);
  }
  [[nodiscard]] double length_of(const Border& border) const {
    return geometry::norm(mesh_.points[border.ends[1]] - mesh_.points[border.ends[0]]);
  }
  /// Borders that water passes.
  void for_each_open(const auto& visit) const {
    for (std::size_t b = 0; b < mesh_.borders.size(); ++b) {
      const Index side = side_of_border_[b];
      if (open_[b] != 0 && wet_[sides_.triangles(side).front()] != 0) visit(b, side);
    }
  }
  void for_each_corner(Index side, const Border& border, const auto& visit) const {
    const Index t = sides_.triangles(side).front();
    for (std::size_t k = 0; k < 3; ++k) {
      const Index point = mesh_.triangles[t][k];
      if (point == border.ends[0] || point == border.ends[1]) visit(corners_.of[t][k], point);
    }
  }

  /// What is connected with open standing water, by sides.
  void find_wet() {
    DisjointSets<Index> together{mesh_.triangles.size()};
    for (Index s = 0; s < sides_.count(); ++s) {
      const auto around = sides_.triangles(s);
      for (std::size_t k = 1; k < around.size(); ++k) together.join(around[0], around[k]);
    }
    std::vector<std::uint8_t> fed(mesh_.triangles.size(), 0);
    for (std::size_t b = 0; b < mesh_.borders.size(); ++b) {
      if (open_[b] == 0 || !std::holds_alternative<Standing>(network_.surfaces()[mesh_.borders[b].surface])) continue;
      fed[together.find(sides_.triangles(side_of_border_[b]).front())] = 1;
    }
    wet_.resize(mesh_.triangles.size());
    basin_of_.assign(mesh_.triangles.size(), none);
    std::vector<Index> number(mesh_.triangles.size(), none);
    for (Index t = 0; t < wet_.size(); ++t) {
      const Index root = together.find(t);
      wet_[t] = fed[root];
      if (wet_[t] == 0) continue;
      if (number[root] == none) {
        number[root] = static_cast<Index>(basins_.size());
        basins_.emplace_back();
      }
      basin_of_[t] = number[root];
    }
  }

  /// Where heads may not lie above z, and where they are given.
  void find_ceilings() {
    const double near = 1e-12 * extent_of(mesh_);
    ceiling_of_middles_ = {.at = std::vector<double>(middles_.count, infinite), .near = near};
    ceiling_of_corners_ = {.at = std::vector<double>(corners_.count, infinite), .near = near};
    standing_middles_.assign(middles_.count, 0);
    standing_corners_.assign(corners_.count, 0);
    for (std::size_t b = 0; b < mesh_.borders.size(); ++b) {
      const Border& border = mesh_.borders[b];
      const Index side = side_of_border_[b];
      if (!is_wet(side)) continue;
      Basin& basin = basins_[basin_of_[sides_.triangles(side).front()]];
      if (drained(b)) {
        basin.drains = true;
        ceiling_of_middles_.at[side] = middle_of(border).z;
      }
      for_each_corner(side, border, [&](Index corner, Index point) {
        const double z = mesh_.points[point].z;
        if (drained(b)) {
          basin.lowest = std::min(basin.lowest, z);
          ceiling_of_corners_.at[corner] = z;
        } else if (open_[b] != 0) {
          basin.level = std::max(basin.level, head_at(border.surface, mesh_.points[point]));
          standing_corners_[corner] = 1;
        }
      });
    }
    for (Index n = 0; n < corners_.count; ++n) {
      if (standing_corners_[n] != 0) ceiling_of_corners_.at[n] = infinite;
    }
  }

  std::expected<void, FlowError> press(const Space& space, std::span<const std::uint8_t> standing,
                                       const Ceiling& ceiling, bool solved, Seepage& seepage) {
    if (!flow::settle({space, stiffness_, wet_}, standing, ceiling, solved, seepage)) {
      return std::unexpected(FlowError{NotSolved{}});
    }
    residual_ = std::max(residual_, seepage.residual);
    return {};
  }
  std::expected<void, FlowError> fill(const LeastEnergy& energy, Eigen::MatrixXd& values) {
    const auto residual = energy.fill(values);
    if (!residual) return std::unexpected(FlowError{NotSolved{}});
    residual_ = std::max(residual_, *residual);
    return {};
  }

  /// A corner has one head.
  [[nodiscard]] std::expected<void, FlowError> check_heads() const {
    struct Given {
      Index surface = none;
      double head = 0;
    };
    std::vector<Given> given(corners_.count);
    const double near = same_head * extent_of(mesh_);
    std::optional<HeadsMeet> clash;
    for_each_open([&](std::size_t b, Index side) {
      const Border& border = mesh_.borders[b];
      for_each_corner(side, border, [&](Index corner, Index point) {
        const double head = head_at(border.surface, mesh_.points[point]);
        Given& known = given[corner];
        if (known.surface == none) known = {border.surface, head};
        if (std::abs(known.head - head) > near && !clash) {
          clash = HeadsMeet{known.surface, border.surface, mesh_.points[point], known.head, head};
        }
      });
    });
    if (clash) return std::unexpected(FlowError{*clash});
    return {};
  }

  /// m3/s out of the rock at a border, from the balanced rates.
  [[nodiscard]] double out_of(Index side) const {
    const Index t = sides_.triangles(side).front();
    const auto& own = middles_.of[t];
    double in = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      Values one{};
      one[k] = own[k] == side ? -2 : 0;
      in += energy(stiffness_[t], in_middles(balanced_.heads, t, 0), one);
    }
    return -in;
  }

  /// Surfaces of one kind that share a corner where water passes both are told apart by no bound.
  void group_surfaces() {
    const std::size_t count = network_.surfaces().size();
    DisjointSets<Index> together{count};
    std::vector<Index> of_corner(corners_.count, none);
    std::vector<std::uint8_t> is_open(count, 0);
    shared_.assign(count, 0);
    for_each_open([&](std::size_t b, Index side) {
      const Border& border = mesh_.borders[b];
      is_open[border.surface] = 1;
      for_each_corner(side, border, [&](Index corner, Index) {
        Index& known = of_corner[corner];
        if (known == none) known = border.surface;
        if (known == border.surface) return;
        shared_[known] = shared_[border.surface] = 1;
        if (network_.surfaces()[known].index() == network_.surfaces()[border.surface].index()) {
          together.join(known, border.surface);
        }
      });
    });
    group_of_.assign(count, none);
    group_count_ = 0;
    for (Index s = 0; s < count; ++s) {
      if (is_open[s] == 0) continue;
      Index& of_root = group_of_[together.find(s)];
      if (of_root == none) of_root = group_count_++;
      group_of_[s] = of_root;
    }
  }

  /// What is given in the middles of sides, as values at corners of the same gradient.
  [[nodiscard]] Values in_middles(const Eigen::MatrixXd& functions, std::size_t t, Column c) const {
    Values values;
    for (std::size_t k = 0; k < 3; ++k) values[k] = -2 * functions(middles_.of[t][k], c);
    return values;
  }
  [[nodiscard]] Values at_corners(const Eigen::MatrixXd& functions, std::size_t t, Column c) const {
    Values values;
    for (std::size_t k = 0; k < 3; ++k) values[k] = functions(corners_.of[t][k], c);
    return values;
  }
  [[nodiscard]] Values gap(std::size_t t, Column c) const {
    Values gap = in_middles(low_, t, c);
    const Values high = at_corners(high_, t, c);
    for (std::size_t k = 0; k < 3; ++k) gap[k] -= high[k];
    return gap;
  }
  [[nodiscard]] Vec3 gradient(std::size_t t, const Values& values) const {
    const auto& corners = mesh_.triangles[t];
    const Vec3 a = mesh_.points[corners[0]], b = mesh_.points[corners[1]], c = mesh_.points[corners[2]];
    const Vec3 up = geometry::cross(b - a, c - a);
    const double square = geometry::dot(up, up), twice = 2 * areas_[t];
    if (square < 0.99 * twice * twice) return {};  // a needle
    return geometry::cross(up, values[0] * (c - b) + values[1] * (a - c) + values[2] * (b - a)) / square;
  }

  void find_gaps() {
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

  /// Bounds of what leaves each basin through these groups together, where just what is dry now is closed.
  [[nodiscard]] std::vector<Rate> rates_of(std::span<const Column> groups) const {
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

  /// m, how far to raise and lower drained surfaces for a bound: the further, the less gaps count and the more what
  /// turns wet and dry on the way.
  [[nodiscard]] static double rise_of(const Basin& basin) {
    if (!basin.drains || basin.level <= basin.lowest) return 0;  // no head is above the highest level
    const double out = basin.drained.value, fall = basin.level - basin.lowest;
    const double head = out > 0 ? std::min(basin.energy / out, fall) : fall;
    const double dry = std::max(basin.dry / (basin.open + basin.dry), basin.dries ? 1e-3 : 0);
    const double share = std::cbrt(1.5 * basin.gap / (basin.energy * dry));
    return head * (share > 0 ? std::clamp(share, 0.005, 0.5) : 0.5);
  }

  /// m3/s: what is rounding, of what the network could carry at a gradient of 1.
  [[nodiscard]] double rounding() const {
    double largest = 0;
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) largest = std::max(largest, transmissivity(t));
    return 1e-12 * largest * extent_of(mesh_);
  }

  void put_surfaces(Flow& flow) const {
    flow.surfaces.assign(network_.surfaces().size(), {});
    double sum = 0, sizes = 0;
    flow.out_of_border.assign(mesh_.borders.size(), FlowRate{});
    for (std::size_t b = 0; b < mesh_.borders.size(); ++b) {
      flow.triangle_of_border.push_back(sides_.triangles(side_of_border_[b]).front());
      const Border& border = mesh_.borders[b];
      if (wet_[sides_.triangles(side_of_border_[b]).front()] == 0) continue;
      SurfaceFlow& own = flow.surfaces[border.surface];
      const double length = length_of(border);
      (open_[b] != 0 ? own.open_length : own.dry_length) += metres(length);
      if (open_[b] == 0) continue;
      const double out = out_of(side_of_border_[b]);
      own.out += FlowRate::from_si(out);
      flow.out_of_border[b] = FlowRate::from_si(out);
      sum += out;
      sizes += std::abs(out);
    }
    flow.imbalance = sizes > rounding() ? std::abs(sum) / sizes : 0;
    const bool dries = std::ranges::any_of(basins_, &Basin::dries);
    for (std::size_t s = 0; s < flow.surfaces.size(); ++s) {
      if (shared_[s] != 0) continue;
      if (group_of_[s] == none) {
        flow.surfaces[s].bounds = Rate{};
        continue;
      }
      flow.surfaces[s].bounds = rate_of(std::array{static_cast<Column>(1 + group_of_[s])});
      flow.surfaces[s].out = FlowRate::from_si(flow.surfaces[s].bounds->value);
      if (dries) flow.surfaces[s].bounds.reset();
    }
  }

  const Mesh& mesh_;
  const Network& network_;
  Sides sides_;
  Space corners_, middles_;
  std::vector<double> areas_;
  std::vector<Stiffness> stiffness_;
  std::vector<Index> side_of_border_;
  std::vector<std::uint8_t> open_, wet_;
  std::vector<Basin> basins_;
  std::vector<Index> basin_of_;  ///< of each triangle
  std::vector<std::uint8_t> standing_middles_, standing_corners_;
  Ceiling ceiling_of_middles_, ceiling_of_corners_;
  Seepage balanced_, continuous_;
  bool same_dry_ = false;  ///< continuous heads hold what the balanced ones do
  bool shifts_settled_ = true;
  std::vector<double> gap_of_heads_;  ///< of each triangle
  std::vector<Index> group_of_;       ///< of each surface that water passes
  std::vector<std::uint8_t> shared_;
  Index group_count_ = 0;
  Eigen::MatrixXd low_, high_;  ///< columns: heads, weights of the groups
  double residual_ = 0;
};

}  // namespace cleave::flow
