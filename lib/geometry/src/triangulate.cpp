#include "cleave/geometry/triangulate.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <numeric>
#include <optional>

#include "cleave/core/assert.hpp"
#include "cleave/core/expected.hpp"
#include "cleave/geometry/predicates.hpp"
#include "outline.hpp"

namespace cleave::geometry {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

/// Above this many corners any ear will do: the search for the best one would be cubic.
constexpr std::size_t careful_up_to = 64;

class Clipper final {
 public:
  explicit Clipper(const Outline& outline) : outline_{outline}, left_(outline.corners.size()) {
    std::iota(left_.begin(), left_.end(), std::size_t{0});
    ring_.reserve(left_.size());
    for (const std::size_t i : left_) ring_.push_back(outline.seen(i));
  }

  std::vector<Triangle> run() {
    std::vector<Triangle> triangles;
    triangles.reserve(left_.size() - 2);
    while (left_.size() > 3) {
      const std::optional<std::size_t> ear = next_ear();
      CLEAVE_ASSERT(
          ear.has_value());  // two-ears theorem (Meisters 1975); holds with flat corners, as no triangle here is flat
      triangles.push_back(triangle(*ear));
      left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(*ear));
      start_ = *ear;
    }
    triangles.push_back(triangle(1));
    return triangles;
  }

 private:
  [[nodiscard]] std::size_t before(std::size_t k) const { return left_[k == 0 ? left_.size() - 1 : k - 1]; }
  [[nodiscard]] std::size_t after(std::size_t k) const { return left_[k + 1 == left_.size() ? 0 : k + 1]; }

  [[nodiscard]] Triangle triangle(std::size_t k) const {
    const auto given = [&](std::size_t i) { return static_cast<std::uint32_t>(outline_.source[i]); };
    return {given(before(k)), given(left_[k]), given(after(k))};
  }

  [[nodiscard]] bool is_ear(std::size_t k) const {
    const std::size_t a = before(k);
    const std::size_t b = left_[k];
    const std::size_t c = after(k);
    if (orient2d(ring_[a], ring_[b], ring_[c]) != exact::Sign::positive) return false;
    return std::ranges::none_of(left_, [&](std::size_t i) {
      return i != a && i != b && i != c && in_closed_triangle(ring_[i], ring_[a], ring_[b], ring_[c]);
    });
  }

  [[nodiscard]] std::optional<std::size_t> next_ear() const {
    std::optional<std::size_t> best;
    double shortest = std::numeric_limits<double>::infinity();
    for (std::size_t step = 0; step < left_.size(); ++step) {
      const std::size_t k = (start_ + step) % left_.size();
      const Vec3 cut = outline_.corners[after(k)] - outline_.corners[before(k)];
      if (dot(cut, cut) >= shortest || !is_ear(k)) continue;
      if (left_.size() > careful_up_to) return k;
      best = k;
      shortest = dot(cut, cut);
    }
    return best;
  }

  const Outline& outline_;
  std::vector<std::size_t> left_;  ///< corners not yet cut off, in order
  std::vector<Vec2> ring_;
  std::size_t start_ = 0;
};

}  // namespace

std::expected<std::vector<Triangle>, PolygonError> triangulate(std::span<const Vec3> corners) {
  CLEAVE_TRY(const Outline outline, Outline::measure({corners.begin(), corners.end()}));
  return Clipper{outline}.run();
}

}  // namespace cleave::geometry
