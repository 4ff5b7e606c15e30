#include "cleave/geometry/triangulate.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "cleave/core/assert.hpp"
#include "cleave/core/expected.hpp"
#include "cleave/geometry/ear_ring.hpp"
#include "cleave/geometry/predicates.hpp"
#include "outline.hpp"

namespace cleave::geometry {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

/// Above this many corners any ear will do: the search for the best one would be cubic.
constexpr std::size_t careful_up_to = 64;

/// The outline as it is seen: its corners are apart, so only those of the ear itself are in its way by being there.
class Seen final {
 public:
  explicit Seen(const Outline& outline) {
    at_.reserve(outline.corners.size());
    for (std::size_t i = 0; i < outline.corners.size(); ++i) at_.push_back(outline.seen(i));
  }
  [[nodiscard]] exact::Sign turn(std::size_t i, std::size_t j, std::size_t k) const {
    return orient2d(at_[i], at_[j], at_[k]);
  }
  [[nodiscard]] static auto ignored(std::size_t a, std::size_t b, std::size_t c) {
    return [=](std::size_t i) { return i == a || i == b || i == c; };
  }

 private:
  std::vector<Vec2> at_;
};

/// The ear with the shortest new edge, the first one behind `start` of equals.
std::optional<std::size_t> best_ear(const Outline& outline, const EarRing<Seen>& ring, std::size_t start) {
  std::optional<std::size_t> best;
  double shortest = std::numeric_limits<double>::infinity();
  for (std::size_t step = 0; step < ring.size(); ++step) {
    const std::size_t k = (start + step) % ring.size();
    const Vec3 cut = outline.corners[ring.after(k)] - outline.corners[ring.before(k)];
    if (dot(cut, cut) >= shortest || !ring.is_ear(k)) continue;
    if (ring.size() > careful_up_to) return k;
    best = k;
    shortest = dot(cut, cut);
  }
  return best;
}

}  // namespace

std::expected<std::vector<Triangle>, PolygonError> triangulate(std::span<const Vec3> corners) {
  CLEAVE_TRY(const Outline outline, Outline::measure({corners.begin(), corners.end()}));
  const Seen seen{outline};
  std::vector<std::size_t> corners_left(outline.corners.size());
  std::iota(corners_left.begin(), corners_left.end(), std::size_t{0});
  EarRing<Seen> ring{std::move(corners_left), seen};
  std::vector<Triangle> triangles;
  triangles.reserve(ring.size() - 2);
  const auto add = [&](const EarRing<Seen>::Triangle& ear) {
    const auto given = [&](std::size_t i) { return static_cast<std::uint32_t>(outline.source[i]); };
    triangles.push_back({given(ear[0]), given(ear[1]), given(ear[2])});
  };
  std::size_t start = 0;
  while (ring.size() > 3) {
    const std::optional<std::size_t> ear = best_ear(outline, ring, start);
    // Two-ears theorem (Meisters 1975); it holds with flat corners, as no triangle here is flat.
    CLEAVE_ASSERT(ear.has_value());
    add(ring.cut(*ear));
    start = *ear;
  }
  add(ring.triangle(1));
  return triangles;
}

Vec3 area_vector(std::span<const Vec3> corners) noexcept {
  Vec3 sum{};
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    sum += cross(corners[i] - corners.front(), corners[i + 1] - corners.front());
  }
  return sum;
}

}  // namespace cleave::geometry
