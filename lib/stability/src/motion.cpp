#include "cleave/stability/block_theory.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "force_signs.hpp"

namespace cleave::stability {
namespace {

using exact::Sign;
using geometry::dot;
using geometry::norm;
using geometry::Vec3;

/// Reactions from e = n_i x n_j: N_i = -(r x n_j).e / e.e, N_j = (r x n_i).e / e.e; equal to (S2), without its loss of
/// digits for nearly parallel planes.
std::pair<double, double> pair_reactions(const Direction& i, const Direction& j, Vec3 r, Vec3 e) {
  const double q = geometry::dot(e, e);
  return {-geometry::dot(geometry::cross(r, j.unit()), e) / q, geometry::dot(geometry::cross(r, i.unit()), e) / q};
}

/// Motion under less than this share of the resultant is none. Normals come from lattice points, so lines that are
/// meant to be horizontal are so to about 1e-14; what that leaves of the weight moves nothing.
constexpr double negligible = 0x1p-40;

class Projector final {
 public:
  Projector(const Cone& cone, const Resultant& resultant)
      : rows_{cone.groups()},
        r_{resultant.newtons()},
        signs_{resultant},
        count_{static_cast<std::uint32_t>(rows_.size())} {}

  Motion find() {
    // Nearly all blocks have few faces: no memory need be asked for.
    if (count_ > few_.size()) many_.resize(count_);
    along_ = count_ > few_.size() ? std::span<Along>{many_} : std::span<Along>{few_};
    result_.touching.reserve(4);
    for (std::uint32_t k = 0; k < count_; ++k) along_[k] = {signs_.along_in_double(rows_[k]), signs_.along(rows_[k])};
    const bool tie = signs_.take_tie();
    if (free(tie)) return std::move(result_);
    for (std::uint32_t i = 0; i < count_; ++i) {
      if (one_plane(i)) return std::move(result_);
    }
    for (std::uint32_t i = 0; i < count_; ++i) {
      for (std::uint32_t j = i + 1; j < count_; ++j) {
        if (two_planes(i, j)) return std::move(result_);
      }
    }
    result_ = {};
    result_.kind = MotionKind::held;
    result_.tie = vanished_by_tie_;
    return result_;
  }

 private:
  /// Row k has this sign on the candidate s; false when the row forbids s.
  bool admit(std::uint32_t k, Sign sign) {
    if (sign == Sign::negative) return false;
    if (sign == Sign::zero) result_.touching.push_back(k);
    return true;
  }

  bool vanishes(Vec3 s) {
    if (geometry::norm(s) > negligible * geometry::norm(r_)) return false;
    vanished_by_tie_ = true;
    return true;
  }

  /// k is i, or looks the other way: exactly 0 on what slides along i. Directions that are not nearly opposite cost no
  /// comparison of integers.
  [[nodiscard]] bool along(std::uint32_t k, std::uint32_t i) const {
    return k == i || (dot(rows_[k].unit(), rows_[i].unit()) < -0.5 && rows_[k].opposite_to(rows_[i]));
  }

  /// Of row i when i and j press.
  Sign reaction(std::uint32_t i, std::uint32_t j) {
    return signs_.reaction(rows_[i], rows_[j], along_[i].value, along_[j].value);
  }

  bool free(bool tie) {
    result_.touching.clear();
    for (std::uint32_t k = 0; k < count_; ++k) {
      if (!admit(k, along_[k].sign)) return false;
    }
    result_.kind = MotionKind::free;
    result_.s = r_;
    result_.tie = tie;
    return true;
  }

  bool one_plane(std::uint32_t i) {
    if (along_[i].sign != Sign::negative) return false;
    if (signs_.parallel(rows_[i])) {  // s = 0: held by this plane
      vanished_by_tie_ = signs_.take_tie() || vanished_by_tie_;
      return false;
    }
    static_cast<void>(signs_.take_tie());
    const Vec3 n = rows_[i].unit();
    const Vec3 s = geometry::cross(n, geometry::cross(r_, n));
    if (vanishes(s)) return false;
    result_.touching.clear();
    for (std::uint32_t k = 0; k < count_; ++k) {
      if (!admit(k, along(k, i) ? Sign::zero : -reaction(k, i))) {
        static_cast<void>(signs_.take_tie());
        return false;
      }
    }
    result_.kind = MotionKind::one_plane;
    result_.s = s;
    result_.groups = {i, i};
    result_.reactions = {-geometry::dot(n, r_), 0};
    result_.tie = signs_.take_tie();
    return true;
  }

  bool two_planes(std::uint32_t i, std::uint32_t j) {
    const Direction& a = rows_[i];
    const Direction& b = rows_[j];
    if (along(j, i)) return false;
    // A pair of rows that the resultant leaves cannot press.
    if (along_[i].sign != Sign::negative && along_[j].sign != Sign::negative) return false;
    if (reaction(i, j) == Sign::negative || reaction(j, i) == Sign::negative) {
      static_cast<void>(signs_.take_tie());
      return false;
    }
    const bool tie = signs_.take_tie();
    const Sign sense = signs_.along_line(a, b);
    if (sense == Sign::zero) {  // s = 0
      vanished_by_tie_ = signs_.take_tie() || vanished_by_tie_;
      return false;
    }
    const Vec3 e = cross(a, b);
    const Vec3 s = e * (geometry::dot(e, r_) / geometry::dot(e, e));
    if (vanishes(s)) return false;
    result_.touching.clear();
    for (std::uint32_t k = 0; k < count_; ++k) {
      if (!admit(k, along(k, i) || along(k, j) ? Sign::zero : sense * orientation(a, b, rows_[k]))) return false;
    }
    const auto [ni, nj] = pair_reactions(a, b, r_, e);
    result_.kind = MotionKind::two_planes;
    result_.s = s;
    result_.groups = {i, j};
    result_.reactions = {std::max(ni, 0.0), std::max(nj, 0.0)};
    result_.tie = tie;
    return true;
  }

  std::span<const Direction> rows_;
  Vec3 r_;
  ForceSigns signs_;
  std::uint32_t count_;
  struct Along {
    double value;
    Sign sign;
  };
  std::array<Along, 24> few_;
  std::vector<Along> many_;
  std::span<Along> along_;  ///< the resultant along each row
  Motion result_;
  bool vanished_by_tie_ = false;
};

}  // namespace

Resultant Resultant::along(Vec3 direction, Force magnitude) {
  Resultant r;
  const double length = geometry::norm(direction);
  if (length > 0 && magnitude.si() != 0) {
    const double sense = magnitude.si() > 0 ? 1 : -1;
    r.direction_ = sense * direction;
    r.newtons_ = direction * (magnitude.si() / length);
    r.scale_ = std::abs(magnitude.si());
  }
  return r;
}

void Resultant::add(Vec3 newtons, double scale) {
  if (newtons == Vec3{}) return;
  newtons_ += newtons;
  scale_ += scale;
  exact_ = false;
}

Motion project(const Cone& cone, const Resultant& resultant) {
  // A sum that cancelled to its own rounding is no force.
  const double floor = resultant.exact() ? 0 : 0x1p-44 * resultant.scale();
  if (!(geometry::norm(resultant.newtons()) > floor)) return {};
  return Projector{cone, resultant}.find();
}

std::optional<std::pair<double, double>> reactions(const Cone& cone, const Resultant& resultant, std::uint32_t i,
                                                   std::uint32_t j) {
  const Direction& a = cone.groups()[i];
  const Direction& b = cone.groups()[j];
  if (a.opposite_to(b)) return std::nullopt;
  ForceSigns signs{resultant};
  if (signs.reaction(a, b) == Sign::negative || signs.reaction(b, a) == Sign::negative) return std::nullopt;
  const Vec3 r = resultant.newtons(), e = cross(a, b);
  const auto [ni, nj] = pair_reactions(a, b, r, e);
  const std::pair both{std::max(ni, 0.0), std::max(nj, 0.0)};
  // Of planes that are parallel but for rounding the signs are ties, and what they carry may be nothing at all.
  const Vec3 left = r + both.first * a.unit() + both.second * b.unit() - e * (dot(e, r) / dot(e, e));
  if (!(norm(left) <= 1e-9 * std::max(resultant.scale(), norm(r)))) return std::nullopt;
  return both;
}

}  // namespace cleave::stability
