#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <expected>
#include <numeric>
#include <optional>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "cleave/core/disjoint_sets.hpp"
#include "cleave/core/expected.hpp"
#include "cleave/flow/flow.hpp"
#include "discretisation.hpp"
#include "space.hpp"

/// One mesh of the series: heads, what is open, rates with bounds, and where the error is.
namespace cleave::flow {

using geometry::Vec3;
using Column = Eigen::Index;

/// Heads that differ by less, of the extent of the network, are one.
inline constexpr double same_head = 1e-9;

/// Stiffness and area of a triangle of unit transmissivity. A needle so thin that its corners' positions do not tell
/// its height any more counts as high as they can tell: what it lets through hardly hangs on it.
struct Shape {
  Stiffness stiffness{};
  double area = 0;
};
inline Shape shape_of(const Mesh& mesh, std::size_t t) {
  constexpr double thinnest = 1e-12;
  const auto& corners = mesh.triangles[t];
  std::array<Vec3, 3> across;
  double longest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    across[k] = mesh.points[corners[(k + 2) % 3]] - mesh.points[corners[(k + 1) % 3]];
    longest = std::max(longest, geometry::dot(across[k], across[k]));
  }
  const double twice = std::max(geometry::norm(geometry::cross(across[0], across[1])), thinnest * longest);
  Shape shape{.area = 0.5 * twice};
  for (std::size_t k = 0; k < 3; ++k) {
    shape.stiffness[k] = geometry::dot(across[(k + 1) % 3], across[(k + 2) % 3]) / (2 * twice);
  }
  return shape;
}

/// Values at the corners of a triangle, or of what is linear there.
using Values = std::array<double, 3>;
/// The energy that two such functions share.
inline double energy(const Stiffness& s, const Values& u, const Values& v) {
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    sum -= s[k] * (u[i] - u[j]) * (v[i] - v[j]);
  }
  return sum;
}

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

  /// Heads, and where water comes out of drained surfaces. False where that was not settled.
  std::expected<bool, FlowError> settle() {
    constexpr int most = 60;
    for (int pass = 0; pass < most; ++pass) {
      CLEAVE_CHECK(find_heads());
      if (!turn_borders()) return true;
    }
    CLEAVE_CHECK(find_heads());
    return false;
  }
  [[nodiscard]] const std::vector<std::uint8_t>& open() const noexcept { return open_; }

  /// After `settle`: rates with bounds.
  std::expected<void, FlowError> bound() {
    group_surfaces();
    const auto columns = static_cast<Column>(1 + group_count_);
    low_ = Eigen::MatrixXd::Zero(static_cast<Column>(middles_.count), columns);
    low_.col(0) = heads_.col(0);
    high_ = Eigen::MatrixXd::Zero(static_cast<Column>(corners_.count), columns);
    std::vector<std::uint8_t> fixed(corners_.count, 0);
    for_each_open([&](std::size_t b, Index side) {
      const Border& border = mesh_.borders[b];
      const auto column = static_cast<Column>(1 + group_of_[border.surface]);
      low_(side, column) = 1;
      for_each_corner(side, border, [&](Index corner, Index point) {
        high_(corner, 0) = head_at(border.surface, mesh_.points[point]);
        high_(corner, column) = 1;
        fixed[corner] = 1;
      });
    });
    CLEAVE_CHECK(fill(*balanced_, low_));
    CLEAVE_CHECK(fill(LeastEnergy{corners_, stiffness_, wet_, std::move(fixed)}, high_));
    find_gaps();
    return {};
  }

  /// Bounds of what leaves through these groups together.
  [[nodiscard]] Rate rate_of(std::span<const Column> groups) const {
    double product = 0, gap = 0, squared = 0;
    for (const Column g : groups) {
      product += products_(0, g);
      gap += gaps_(0, g);
      for (const Column h : groups) squared += gaps_(g, h);
    }
    // With e and d the errors of the continuous functions (a head, a weight), a(e, d) = (g, h) / 2 + a rest of at most
    // half the product of the gaps' sizes.
    const double value = 0.5 * gap - product;
    const double half = 0.5 * std::sqrt(std::max(gaps_(0, 0), 0.0) * std::max(squared, 0.0));
    return {value, value - half, value + half};
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
    return half <= rounding() ? 0 : half / sum;
  }

  /// The triangles that have half of the gaps of the heads and of the weights of these groups.
  [[nodiscard]] std::vector<std::uint8_t> worst(std::span<const Column> wanted) const {
    std::vector<Column> columns{0};
    columns.insert(columns.end(), wanted.begin(), wanted.end());
    std::vector<double> share(mesh_.triangles.size(), 0);
    double all = 0;
    for (std::size_t t = 0; t < share.size(); ++t) {
      if (wet_[t] == 0) continue;
      for (const Column c : columns) {
        if (!(gaps_(c, c) > 0)) continue;
        const Values g = gap(t, c);
        share[t] += energy(stiffness_[t], g, g) / gaps_(c, c);
      }
      all += share[t];
    }
    std::vector<Index> order(share.size());
    std::iota(order.begin(), order.end(), Index{0});
    std::ranges::stable_sort(order, std::ranges::greater{}, [&](Index t) { return share[t]; });
    std::vector<std::uint8_t> marked(share.size(), 0);
    double sum = 0;
    std::size_t count = 0;
    for (const Index t : order) {
      const bool few = count < share.size() / 25;  // rounds cost as much as triangles
      if ((sum >= 0.5 * all && !few) || !(share[t] > 0)) break;
      marked[t] = 1;
      sum += share[t];
      ++count;
    }
    return marked;
  }

  [[nodiscard]] Flow result() const {
    Flow flow{.mesh = mesh_, .wet = wet_, .residual = residual_};
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      auto& head = flow.head.emplace_back();
      Vec3& q = flow.q.emplace_back();
      flow.area += square_metres(areas_[t]);
      if (wet_[t] == 0) continue;
      flow.wet_area += square_metres(areas_[t]);
      for (std::size_t k = 0; k < 3; ++k) head[k] = metres(high_(corners_.of[t][k], 0));
      q = -transmissivity(t) * gradient(t, in_middles(low_, t, 0));
    }
    put_surfaces(flow);
    flow.drained = rate_of(groups(true));
    return flow;
  }

 private:
  [[nodiscard]] double transmissivity(std::size_t t) const { return network_.transmissivity()[mesh_.part[t]].si(); }
  [[nodiscard]] double head_at(Index surface, Vec3 p) const {
    const auto* standing = std::get_if<Standing>(&network_.surfaces()[surface]);
    return standing != nullptr ? standing->level.si() : p.z;
  }
  [[nodiscard]] Vec3 middle_of(const Border& border) const {
    return 0.5 * (mesh_.points[border.ends[0]] + mesh_.points[border.ends[1]]);
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
    for (Index t = 0; t < wet_.size(); ++t) wet_[t] = fed[together.find(t)];
  }

  std::expected<void, FlowError> find_heads() {
    if (wet_.empty()) {
      find_wet();
      CLEAVE_CHECK(check_heads());
    }
    heads_ = Eigen::MatrixXd::Zero(static_cast<Column>(middles_.count), 1);
    std::vector<std::uint8_t> fixed(middles_.count, 0);
    for_each_open([&](std::size_t b, Index side) {
      heads_(side, 0) = head_at(mesh_.borders[b].surface, middle_of(mesh_.borders[b]));
      fixed[side] = 1;
    });
    balanced_.emplace(middles_, stiffness_, wet_, std::move(fixed));
    return fill(*balanced_, heads_);
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
      in += energy(stiffness_[t], in_middles(heads_, t, 0), one);
    }
    return -in;
  }

  /// Water neither enters through a drained surface nor stands above it. True where something was turned.
  bool turn_borders() {
    bool turned = false;
    double largest = 0;
    for_each_open([&](std::size_t, Index side) { largest = std::max(largest, std::abs(out_of(side))); });
    const double near = 1e-12 * extent_of(mesh_);
    for (std::size_t b = 0; b < mesh_.borders.size(); ++b) {
      const Border& border = mesh_.borders[b];
      const Index side = side_of_border_[b];
      if (!std::holds_alternative<Drained>(network_.surfaces()[border.surface])) continue;
      if (wet_[sides_.triangles(side).front()] == 0) continue;
      const bool closes = open_[b] != 0 && out_of(side) < -1e-12 * largest;
      const bool opens = open_[b] == 0 && heads_(side, 0) > middle_of(border).z + near;
      if (!closes && !opens) continue;
      open_[b] = opens ? 1 : 0;
      turned = true;
    }
    return turned;
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
    const Column columns = low_.cols();
    gaps_ = Eigen::MatrixXd::Zero(columns, columns);
    products_ = Eigen::MatrixXd::Zero(1, columns);
    std::vector<Values> own(static_cast<std::size_t>(columns));
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      if (wet_[t] == 0) continue;
      const Values of_head = at_corners(high_, t, 0);
      for (Column c = 0; c < columns; ++c) {
        own[static_cast<std::size_t>(c)] = gap(t, c);
        products_(0, c) += energy(stiffness_[t], of_head, at_corners(high_, t, c));
      }
      for (Column c = 0; c < columns; ++c) {
        for (Column d = 0; d < columns; ++d) {
          gaps_(c, d) += energy(stiffness_[t], own[static_cast<std::size_t>(c)], own[static_cast<std::size_t>(d)]);
        }
      }
    }
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
      const double length = geometry::norm(mesh_.points[border.ends[1]] - mesh_.points[border.ends[0]]);
      (open_[b] != 0 ? own.open_length : own.dry_length) += metres(length);
      if (open_[b] == 0) continue;
      const double out = out_of(side_of_border_[b]);
      own.out += FlowRate::from_si(out);
      flow.out_of_border[b] = FlowRate::from_si(out);
      sum += out;
      sizes += std::abs(out);
    }
    flow.imbalance = sizes > rounding() ? std::abs(sum) / sizes : 0;
    for (std::size_t s = 0; s < flow.surfaces.size(); ++s) {
      if (shared_[s] != 0) continue;
      if (group_of_[s] == none) {
        flow.surfaces[s].bounds = Rate{};
        continue;
      }
      flow.surfaces[s].bounds = rate_of(std::array{static_cast<Column>(1 + group_of_[s])});
      flow.surfaces[s].out = FlowRate::from_si(flow.surfaces[s].bounds->value);
    }
  }

  const Mesh& mesh_;
  const Network& network_;
  Sides sides_;
  Space corners_, middles_;
  std::optional<LeastEnergy> balanced_;  ///< of heads in the middles of sides
  std::vector<double> areas_;
  std::vector<Stiffness> stiffness_;
  std::vector<Index> side_of_border_;
  std::vector<std::uint8_t> open_, wet_;
  Eigen::MatrixXd heads_;        ///< in the middles of sides
  std::vector<Index> group_of_;  ///< of each surface that water passes
  std::vector<std::uint8_t> shared_;
  Index group_count_ = 0;
  Eigen::MatrixXd low_, high_;  ///< columns: heads, weights of the groups
  Eigen::MatrixXd gaps_, products_;
  double residual_ = 0;
};

}  // namespace cleave::flow
