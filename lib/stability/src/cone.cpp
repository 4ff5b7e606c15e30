#include <algorithm>
#include <array>

#include "cleave/stability/block_theory.hpp"
#include "integers.hpp"

namespace cleave::stability {
namespace {

using exact::Int128;
using exact::Int512;
using exact::Sign;

bool parallel(const Direction& a, const Direction& b) noexcept { return a == b || a.opposite_to(b); }

/// One component of a x b, exact.
Sign minor_sign(const Direction& a, const Direction& b, std::size_t axis) {
  const auto& u = a.components();
  const auto& v = b.components();
  const std::size_t y = (axis + 1) % 3;
  const std::size_t z = (axis + 2) % 3;
  if (bits(u) + bits(v) + 1 < 127) return exact::sign_of<Int128>(u[y] * v[z] - u[z] * v[y]);
  return exact::sign_of<Int512>(Int512(u[y]) * Int512(v[z]) - Int512(u[z]) * Int512(v[y]));
}

/// Rank of the chosen rows, 0 to 3.
unsigned rank(std::span<const Direction> rows, const std::vector<bool>& chosen) {
  std::array<std::size_t, 3> basis{};
  unsigned size = 0;
  for (std::size_t k = 0; k < rows.size() && size < 3; ++k) {
    if (!chosen[k]) continue;
    const bool independent = size == 0 || (size == 1 && !parallel(rows[basis[0]], rows[k])) ||
                             (size == 2 && orientation(rows[basis[0]], rows[basis[1]], rows[k]) != Sign::zero);
    if (independent) basis[size++] = k;
  }
  return size;
}

/// Narrows `equalities` (rows that are zero all over K) by one candidate ray, on which row k has sign `sign(k)` or, for
/// its opposite, minus that. Nothing happens when neither is in K. False when none is left: K has a solid angle, and no
/// further ray tells more.
template <class SignOfRow>
bool try_ray(std::size_t count, SignOfRow sign, std::vector<Sign>& signs, std::vector<bool>& equalities) {
  bool positive = false;
  bool negative = false;
  for (std::size_t k = 0; k < count; ++k) {
    signs[k] = sign(k);
    positive = positive || signs[k] == Sign::positive;
    negative = negative || signs[k] == Sign::negative;
    if (positive && negative) return true;
  }
  bool left = false;
  for (std::size_t k = 0; k < count; ++k) {
    if (signs[k] != Sign::zero) equalities[k] = false;
    left = left || equalities[k];
  }
  return left;
}

}  // namespace

Cone::Cone(std::span<const Direction> inward_normals) {
  groups_.reserve(inward_normals.size());
  group_of_row_.reserve(inward_normals.size());
  for (const Direction& row : inward_normals) {
    const auto found = std::ranges::find(groups_, row);
    group_of_row_.push_back(static_cast<std::uint32_t>(found - groups_.begin()));
    if (found == groups_.end()) groups_.push_back(row);
  }
}

std::uint8_t Cone::dimension() const {
  const std::span<const Direction> rows = groups_;
  const std::size_t count = rows.size();
  // K is spanned by its extreme rays and the line space of the rows; its dimension is 3 less the rank of the rows that
  // vanish on all of it.
  std::vector<bool> equalities(count, true);
  const unsigned full = rank(rows, equalities);
  if (full <= 1) return count == 2 ? 2 : 3;  // a slot, a half-space, or all space
  std::vector<Sign> signs(count, Sign::zero);
  if (full == 3) {
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = i + 1; j < count; ++j) {
        if (rows[i].opposite_to(rows[j])) continue;
        const auto sign = [&](std::size_t k) {
          const bool on = k == i || k == j || rows[k].opposite_to(rows[i]) || rows[k].opposite_to(rows[j]);
          return on ? Sign::zero : orientation(rows[i], rows[j], rows[k]);
        };
        if (!try_ray(count, sign, signs, equalities)) return 3;
      }
    }
  } else {
    // All rows lie in one plane and K is a flat cone times the line across it. In that plane the candidate rays are the
    // perpendiculars of the rows; any component of a x b that is not zero for one pair has the sense of rotation of
    // all.
    std::size_t other = 1;
    while (parallel(rows[0], rows[other])) ++other;
    std::size_t axis = 0;
    while (minor_sign(rows[0], rows[other], axis) == Sign::zero) ++axis;
    for (std::size_t i = 0; i < count; ++i) {
      if (!try_ray(count, [&](std::size_t k) { return minor_sign(rows[i], rows[k], axis); }, signs, equalities))
        return 3;
    }
  }
  return static_cast<std::uint8_t>(3 - rank(rows, equalities));
}

}  // namespace cleave::stability
