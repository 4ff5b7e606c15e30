#include "detail/folds.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace cleave::topology::detail {
namespace {

using exact::Int128;
using exact::LatticePoint;
using exact::Sign;
using Triangle = std::array<LatticePoint, 3>;

std::array<Int128, 3> cross(LatticePoint u, LatticePoint v) {
  const auto product = [](std::int64_t p, std::int64_t q) { return static_cast<Int128>(p) * q; };
  return {product(u.y, v.z) - product(u.z, v.y), product(u.z, v.x) - product(u.x, v.z),
          product(u.x, v.y) - product(u.y, v.x)};
}

bool on_one_line(LatticePoint a, LatticePoint b, LatticePoint c) {
  return cross(b - a, c - a) == std::array<Int128, 3>{};
}

double squared(LatticePoint p) {
  const double x = static_cast<double>(p.x), y = static_cast<double>(p.y), z = static_cast<double>(p.z);
  return x * x + y * y + z * z;
}

/// Smallest height of a triangle.
double height(LatticePoint a, LatticePoint b, LatticePoint c) {
  const auto n = cross(b - a, c - a);
  const double x = static_cast<double>(n[0]), y = static_cast<double>(n[1]), z = static_cast<double>(n[2]);
  return std::sqrt((x * x + y * y + z * z) / std::max({squared(b - a), squared(c - b), squared(a - c)}));
}

/// Without corners inside straight sides and without spikes; from the smallest corner towards its smaller neighbour.
void tidy(std::vector<LatticePoint>& ring) {
  for (std::size_t i = 0; i < ring.size() && ring.size() >= 3;) {
    const std::size_t count = ring.size();
    if (on_one_line(ring[(i + count - 1) % count], ring[i], ring[(i + 1) % count])) {
      ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(i));
      i = 0;
    } else {
      ++i;
    }
  }
  if (ring.size() < 3) return ring.clear();
  std::ranges::rotate(ring, std::ranges::min_element(ring));
  if (ring.back() < ring[1]) std::reverse(ring.begin() + 1, ring.end());
}

/// Along the vector area, at most 2^46 long.
std::optional<LatticePoint> facing(std::span<const LatticePoint> ring) {
  std::array<Int128, 3> sum{};
  for (std::size_t i = 1; i + 1 < ring.size(); ++i) {
    const auto part = cross(ring[i] - ring[0], ring[i + 1] - ring[0]);
    for (std::size_t k = 0; k < 3; ++k) sum[k] += part[k];
  }
  double most = 0;
  for (const Int128 c : sum) most = std::max(most, std::abs(static_cast<double>(c)));
  if (most == 0) return std::nullopt;
  const auto scaled = [&](Int128 c) {
    return static_cast<std::int64_t>(std::nearbyint(static_cast<double>(c) / most * 0x1p46));
  };
  return LatticePoint{scaled(sum[0]), scaled(sum[1]), scaled(sum[2])};
}

/// Triangulations of the chain from corner i to corner j, from short chains to long ones.
class Best {
 public:
  Best(std::span<const LatticePoint> ring, LatticePoint along)
      : ring_{ring}, along_{along}, count_{ring.size()}, least_(count_ * count_, -1), apex_(count_ * count_, 0) {
    for (std::size_t i = 0; i + 1 < count_; ++i) least_[at(i, i + 1)] = INFINITY;
    for (std::size_t span = 2; span < count_; ++span) {
      for (std::size_t i = 0; i + span < count_; ++i) choose(i, i + span);
    }
  }
  /// False when the chain crosses itself.
  [[nodiscard]] bool collect(std::vector<Triangle>& out) const {
    return least_[at(0, count_ - 1)] >= 0 && collect(0, count_ - 1, out);
  }

 private:
  [[nodiscard]] std::size_t at(std::size_t i, std::size_t j) const { return i * count_ + j; }
  void choose(std::size_t i, std::size_t j) {
    for (std::size_t k = i + 1; k < j; ++k) {
      const double parts = std::min(least_[at(i, k)], least_[at(k, j)]);
      if (parts <= least_[at(i, j)]) continue;
      const double least = std::min(parts, height(ring_[i], ring_[k], ring_[j]));
      if (least <= least_[at(i, j)] || orient2d(ring_[i], ring_[k], ring_[j], along_) != Sign::positive) continue;
      least_[at(i, j)] = least;
      apex_[at(i, j)] = k;
    }
  }
  bool collect(std::size_t i, std::size_t j, std::vector<Triangle>& out) const {
    if (j == i + 1) return true;
    const std::size_t k = apex_[at(i, j)];
    out.push_back({ring_[i], ring_[k], ring_[j]});
    return collect(i, k, out) && collect(k, j, out);
  }

  std::span<const LatticePoint> ring_;
  LatticePoint along_;
  std::size_t count_;
  std::vector<double> least_;  ///< smallest height of the best triangles so far; less than 0: there are none
  std::vector<std::size_t> apex_;
};

}  // namespace

double distance_sites(const exact::Plane& plane, LatticePoint p) {
  const auto n = plane.unit_normal();
  const auto& a = plane.approx();
  const double scale = std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
  return std::abs(n[0] * static_cast<double>(p.x) + n[1] * static_cast<double>(p.y) + n[2] * static_cast<double>(p.z) +
                  std::ldexp(a[3] / scale, 48));
}

namespace {

/// Triangles that fill a tidy ring; empty where it crosses itself on the lattice.
std::vector<Triangle> filling(const std::vector<LatticePoint>& corners) {
  constexpr std::size_t largest = 96;  // the best choice costs the cube of the corners
  std::vector<Triangle> out;
  if (corners.size() == 3) return {{corners[0], corners[1], corners[2]}};
  const auto along = facing(corners);
  if (along && !corners.empty() && corners.size() <= largest && Best{corners, *along}.collect(out)) return out;
  if (along && corners.size() > largest) {
    if (auto polygon = make_lattice_polygon(corners)) {
      polygon->corners = corners;
      polygon->along = *along;
      for (const auto& [a, b, c] : triangulate(*polygon)) out.push_back({corners[a], corners[b], corners[c]});
    }
    if (out.size() + 2 == corners.size()) return out;
    out.clear();
  }
  return {};
}

}  // namespace

bool crosses_itself(std::vector<LatticePoint> corners) {
  tidy(corners);
  return filling(corners).empty();
}

std::vector<Triangle> fold(std::vector<LatticePoint> corners) {
  tidy(corners);
  std::vector<Triangle> out = filling(corners);
  if (!out.empty()) return out;
  // It crosses itself on the lattice. A fan has the same rim whatever its triangles do.
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    if (!on_one_line(corners[0], corners[i], corners[i + 1])) out.push_back({corners[0], corners[i], corners[i + 1]});
  }
  return out;
}

}  // namespace cleave::topology::detail
