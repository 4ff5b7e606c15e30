#include "detail/exact_block.hpp"

#include <algorithm>
#include <cmath>

#include "cleave/exact/predicates.hpp"
#include "detail/fixed_measure.hpp"
#include "detail/pieces.hpp"

namespace cleave::topology::detail {

using exact::FixedPoint;
using exact::Plane;
using geometry::Vec3;

void ExactBlocks::find_planes() const {
  begin_.assign(complex_.vertices().size() + 1, 0);
  const auto for_each = [&](const auto& visit) {
    for (const Face& face : complex_.faces()) {
      for (const VertexId v : complex_.loops(face).all_corners()) visit(v, face.plane.value());
    }
  };
  for_each([&](VertexId v, std::uint32_t) { ++begin_[v.index() + 1]; });
  begin_from_counts(begin_);
  planes_.resize(begin_.back());
  auto next = begin_;
  for_each([&](VertexId v, std::uint32_t plane) { planes_[next[v.index()]++] = plane; });
  for (std::size_t v = 0; v + 1 < begin_.size(); ++v) {
    std::ranges::sort(std::span{planes_}.subspan(begin_[v], begin_[v + 1] - begin_[v]));
  }
}

std::span<const std::uint32_t> ExactBlocks::planes_of(VertexId vertex) const {
  std::call_once(found_, [this] { find_planes(); });
  const std::uint32_t first = begin_[vertex.index()];
  return std::span{planes_}.subspan(first, begin_[vertex.index() + 1] - first);
}

std::optional<FixedPoint> ExactBlocks::meet(std::span<const std::uint32_t> planes) const {
  const auto plane = [&](std::size_t k) -> const Plane& { return complex_.planes()[PlaneId{planes[k]}]; };
  std::size_t second = 1;
  while (second < planes.size() && plane(second).parallel_to(plane(0))) ++second;
  for (std::size_t third = second + 1; third < planes.size(); ++third) {
    if (planes[third] == planes[third - 1] && third > second + 1) continue;
    if (exact::orientation(plane(0), plane(second), plane(third)) == exact::Sign::zero) continue;
    const auto point = exact::fixed_meet(plane(0), plane(second), plane(third));
    if (!point) return std::nullopt;
    // All the others pass through it too.
    for (std::size_t k = 0; k < planes.size(); ++k) {
      if (k > 0 && planes[k] == planes[k - 1]) continue;
      if (exact::side_exact(plane(0), plane(second), plane(third), plane(k)) != exact::Sign::zero) return std::nullopt;
    }
    return point;
  }
  return std::nullopt;
}

ExactBlocks::Corner ExactBlocks::corner(VertexId vertex) const {
  const Vec3 stored = complex_.vertices()[vertex];
  const auto point = meet(planes_of(vertex));
  if (point) {
    const auto at = exact::as_position(*point);
    const Vec3 off = unit_ * Vec3{at[0], at[1], at[2]} - stored;
    return {*point, true, geometry::norm(off) <= 2 * tolerance_};
  }
  const bool near = std::max({std::abs(stored.x), std::abs(stored.y), std::abs(stored.z)}) < unit_;
  if (!near) return {{}, false, false};
  const auto fixed = [&](double metres) { return static_cast<exact::Int128>(std::ldexp(metres / unit_, 112)); };
  return {{fixed(stored.x), fixed(stored.y), fixed(stored.z)}, false, true};
}

ExactBlock ExactBlocks::measure(BlockId id) const {
  std::unordered_map<std::uint32_t, FixedPoint> corners;
  ExactBlock out;
  const Block& block = complex_.blocks()[id];
  const auto at = [&](VertexId v) -> const FixedPoint& {
    const auto [entry, added] = corners.try_emplace(v.value());
    if (added) {
      const Corner found = corner(v);
      entry->second = found.at;
      out.all_exact = out.all_exact && found.exact;
      out.fits = out.fits && found.fits;
    }
    return entry->second;
  };
  const VertexId base = complex_.loops(block.faces.front())[0][0];
  FixedMeasure measure{at(base)};
  for (const FaceId f : block.faces) {
    const LoopRange loops = complex_.loops(f);
    const VertexId apex = loops[0][0];
    double perimeter = 0;
    for (const auto loop : loops) {
      VertexId last = loop.back();
      for (const VertexId v : loop) {
        perimeter += geometry::norm(complex_.vertices()[v] - complex_.vertices()[last]);
        if (last != apex && v != apex) measure.add(at(apex), at(last), at(v));
        last = v;
      }
    }
    out.reach += perimeter * geometry::norm(complex_.vertices()[apex] - complex_.vertices()[base]);
  }
  out.volume = measure.volume() * unit_ * unit_ * unit_;
  return out;
}

}  // namespace cleave::topology::detail
