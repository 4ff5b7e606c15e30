#include "plane_split.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "cleave/exchange/triangulate.hpp"

namespace cleave::report::detail {
namespace {

using geometry::Vec3;

class Splitter {
 public:
  Splitter(double Vec3::* axis, double position, std::vector<Vec3>& points)
      : axis_{axis}, position_{position}, points_{points} {}

  void add(const Polygon& triangle) {
    const std::array<bool, 3> above{is_above(triangle.corners[0]), is_above(triangle.corners[1]),
                                    is_above(triangle.corners[2])};
    if (above[0] == above[1] && above[1] == above[2]) {
      half(above[0]).push_back(triangle);
      return;
    }
    // Corner a is alone on its side.
    const std::size_t alone = above[1] == above[2] ? 0 : (above[0] == above[2] ? 1 : 2);
    const std::uint32_t a = triangle.corners[alone], b = triangle.corners[(alone + 1) % 3],
                        c = triangle.corners[(alone + 2) % 3];
    const std::uint32_t p = cut_point(a, b), q = cut_point(a, c);
    const auto piece = [&](bool upper, std::vector<std::uint32_t> corners) {
      half(upper).push_back({.corners = std::move(corners), .outward = triangle.outward, .face = triangle.face});
    };
    piece(above[alone], {a, p, q});
    piece(!above[alone], {p, b, c});
    piece(!above[alone], {p, c, q});
    // The cap of the lower half runs against the lower piece's own edge.
    if (above[alone]) {
      cap_edges_.emplace(p, q);
    } else {
      cap_edges_.emplace(q, p);
    }
    faces_ = std::max(faces_, triangle.face + 1);
  }

  std::pair<std::vector<Polygon>, std::vector<Polygon>> halves() && {
    Vec3 up{};
    up.*axis_ = 1;
    for (const Triangle& t : triangulate(cap_loops(), points_, up)) {
      lower_.push_back({.corners = {t[0], t[1], t[2]}, .outward = up, .face = faces_});
      upper_.push_back({.corners = {t[2], t[1], t[0]}, .outward = -up, .face = faces_});
    }
    return {std::move(lower_), std::move(upper_)};
  }

 private:
  bool is_above(std::uint32_t point) const { return points_[point].*axis_ > position_; }
  std::vector<Polygon>& half(bool upper) { return upper ? upper_ : lower_; }

  // One point an edge, for all triangles that use it.
  std::uint32_t cut_point(std::uint32_t i, std::uint32_t j) {
    const auto [found, added] = cut_points_.try_emplace(std::minmax(i, j), static_cast<std::uint32_t>(points_.size()));
    if (added) {
      const Vec3 from = points_[std::min(i, j)], to = points_[std::max(i, j)];
      const double t = (position_ - from.*axis_) / (to.*axis_ - from.*axis_);
      Vec3 point = from + t * (to - from);
      point.*axis_ = position_;
      points_.push_back(point);
    }
    return found->second;
  }

  FaceLoops cap_loops() {
    FaceLoops loops;
    while (!cap_edges_.empty()) {
      std::vector<std::uint32_t> loop;
      const std::uint32_t start = cap_edges_.begin()->first;
      std::uint32_t at = start;
      do {
        loop.push_back(at);
        const auto edge = cap_edges_.find(at);
        at = edge->second;
        cap_edges_.erase(edge);
      } while (at != start);
      loops.push_back(std::move(loop));
    }
    return loops;
  }

  double Vec3::* axis_;
  double position_;
  std::vector<Vec3>& points_;
  std::vector<Polygon> lower_, upper_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> cut_points_;
  std::multimap<std::uint32_t, std::uint32_t> cap_edges_;
  std::uint32_t faces_ = 0;  // number of the cap, after all faces met
};

}  // namespace

std::pair<std::vector<Polygon>, std::vector<Polygon>> split(const std::vector<Polygon>& triangles, double Vec3::* axis,
                                                            double position, std::vector<Vec3>& points) {
  Splitter splitter{axis, position, points};
  for (const Polygon& triangle : triangles) splitter.add(triangle);
  return std::move(splitter).halves();
}

}  // namespace cleave::report::detail
