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

  /// In place of `settle`: continuous heads alone.
  std::expected<void, FlowError> settle_continuous() {
    find_wet();
    CLEAVE_CHECK(check_heads());
    find_ceilings();
    continuous_ = {.heads = Eigen::MatrixXd::Zero(rows(corners_), 1),
                   .held = std::vector<std::uint8_t>(corners_.count)};
    for_each_open([&](std::size_t b, Index side) {
      for_each_corner(side, mesh_.borders[b], [&](Index corner, Index point) {
        if (drained(b) && standing_corners_[corner] != 0) return;
        continuous_.heads(corner, 0) = head_at(mesh_.borders[b].surface, mesh_.points[point]);
        continuous_.held[corner] = drained(b) ? 1 : 0;
      });
    });
    return press(corners_, standing_corners_, ceiling_of_corners_, false, continuous_);
  }

  /// After `settle`: rates with bounds where just what is dry now is closed, and continuous heads that lie nowhere
  /// above a drained surface.
  std::expected<void, FlowError> bound();
  [[nodiscard]] bool settled() const noexcept { return balanced_.settled && continuous_.settled && shifts_settled_; }

  /// After `bound`: what leaves through drained surfaces is no more than `Basin::above`, whatever is dry.
  ///
  /// Let V(t) be the least energy (half of a(u, u)) with all drained surfaces raised by t. Its derivative is -Q(t), and
  /// what leaves is Q(t) = the most over sets A of what leaves where just A is open; each falls in a straight line with
  /// t, so Q is convex: Q(0) <= (V(-t) - V(t)) / (2 t). Continuous heads give too much for V, balanced rates too
  /// little.
  std::expected<void, FlowError> bound_above();
  /// Some drained surface is wet.
  [[nodiscard]] bool drains() const { return std::ranges::any_of(basins_, &Basin::drains); }

  /// After `bound_above`: out of all drained surfaces.
  [[nodiscard]] Rate out_of_drained() const;
  /// Half of the bounds' width over the rate; where no water comes out on this mesh, over what passes by.
  [[nodiscard]] double width_of_drained() const;

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
  void mark_worst(std::span<const Column> wanted, std::vector<std::uint8_t>& marked) const;

  /// How far the two solutions' gradients lie apart in the flat piece of joint where they do most, over the largest
  /// head of pressure there: the mean square, whatever its transmissivity. Marks triangles of those above `tolerance`.
  double gap_of_pressures(double tolerance, std::vector<std::uint8_t>& marked) const;

  /// After `settle_continuous`.
  [[nodiscard]] Flow heads() const {
    Flow flow{.mesh = mesh_, .wet = wet_, .open = open_, .residual = residual_};
    if (!continuous_.settled) flow.status = FlowStatus::unsettled;
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      auto& head = flow.head.emplace_back();
      auto& held = flow.held.emplace_back();
      flow.area += square_metres(areas_[t]);
      if (wet_[t] == 0) continue;
      flow.wet_area += square_metres(areas_[t]);
      for (std::size_t k = 0; k < 3; ++k) {
        const Index corner = corners_.of[t][k];
        head[k] = metres(continuous_.heads(corner, 0));
        held[k] = standing_corners_[corner] | continuous_.held[corner];
      }
    }
    for (const Index side : side_of_border_) flow.triangle_of_border.push_back(sides_.triangles(side).front());
    return flow;
  }
  [[nodiscard]] Flow result() const {
    Flow flow = heads();
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      Vec3& q = flow.q.emplace_back();
      if (wet_[t] != 0) q = -transmissivity(t) * gradient(t, in_middles(low_, t, 0));
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
    bool touches = false;        ///< a drained surface meets standing water of its head
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
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      for (const Index n : corners_.of[t]) {
        if (wet_[t] == 0 || standing_corners_[n] == 0) continue;
        if (std::isfinite(ceiling_of_corners_.at[n])) basins_[basin_of_[t]].touches = true;
        ceiling_of_corners_.at[n] = infinite;
      }
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

  void find_gaps();

  /// Bounds of what leaves each basin through these groups together, where just what is dry now is closed.
  [[nodiscard]] std::vector<Rate> rates_of(std::span<const Column> groups) const;

  /// m, how far to raise and lower drained surfaces for a bound: the further, the less gaps count and the more what
  /// turns wet and dry on the way.
  [[nodiscard]] static double rise_of(const Basin& basin);

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
