#include "convex_parts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace cleave::report::detail {
namespace {

using geometry::Vec3;

struct Plane {
  Vec3 normal;  ///< unit, out of the block
  double offset = 0;
  [[nodiscard]] double height(Vec3 p) const { return dot(normal, p) - offset; }
};

/// A convex piece of a face of the block.
struct Fragment {
  std::vector<Vec3> corners;
  Plane plane;
};

enum class Side : std::uint8_t { behind, on, front, both };

/// Where the points lie; nearer than `tolerance` is on the plane.
Side side_of(const std::vector<Vec3>& corners, const Plane& plane, double tolerance) {
  bool behind = false;
  bool front = false;
  for (const Vec3& p : corners) {
    const double height = plane.height(p);
    behind = behind || height < -tolerance;
    front = front || height > tolerance;
  }
  if (behind && front) return Side::both;
  return behind ? Side::behind : front ? Side::front : Side::on;
}

Vec3 between(Vec3 a, double height_a, Vec3 b, double height_b) {
  return a + (b - a) * (height_a / (height_a - height_b));
}

/// Cuts a convex polygon; corners on the plane go to both.
std::array<std::vector<Vec3>, 2> split(const std::vector<Vec3>& corners, const Plane& plane, double tolerance) {
  std::array<std::vector<Vec3>, 2> parts;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3 a = corners[i];
    const Vec3 b = corners[(i + 1) % corners.size()];
    const double height_a = plane.height(a);
    const double height_b = plane.height(b);
    if (height_a <= tolerance) parts[0].push_back(a);
    if (height_a >= -tolerance) parts[1].push_back(a);
    if ((height_a < -tolerance && height_b > tolerance) || (height_a > tolerance && height_b < -tolerance)) {
      const Vec3 p = between(a, height_a, b, height_b);
      parts[0].push_back(p);
      parts[1].push_back(p);
    }
  }
  return parts;
}

/// Cuts a convex polyhedron in two (behind, in front); empty when the new face does not close.
class PolyhedronSplitter final {
 public:
  PolyhedronSplitter(const ConvexPart& part, const Plane& plane, double tolerance)
      : part_{part}, tolerance_{tolerance}, points_{part.points} {
    for (const Vec3& p : part.points) heights_.push_back(plane.height(p));
  }

  [[nodiscard]] Side side() const {
    const bool behind = std::ranges::any_of(heights_, [&](double h) { return h < -tolerance_; });
    const bool front = std::ranges::any_of(heights_, [&](double h) { return h > tolerance_; });
    if (behind && front) return Side::both;
    return behind ? Side::behind : front ? Side::front : Side::on;
  }

  std::optional<std::array<ConvexPart, 2>> run() {
    std::array<std::vector<std::vector<std::uint32_t>>, 2> faces;
    for (const auto& face : part_.faces) {
      std::array<std::vector<std::uint32_t>, 2> loops;
      std::array<bool, 2> strictly{false, false};
      for (std::size_t i = 0; i < face.size(); ++i) {
        const std::uint32_t a = face[i];
        const std::uint32_t b = face[(i + 1) % face.size()];
        if (!in_front(a)) loops[0].push_back(a);
        if (!behind(a)) loops[1].push_back(a);
        strictly[0] = strictly[0] || behind(a);
        strictly[1] = strictly[1] || in_front(a);
        if ((behind(a) && in_front(b)) || (in_front(a) && behind(b))) {
          const std::uint32_t p = crossing(a, b);
          loops[0].push_back(p);
          loops[1].push_back(p);
        }
      }
      for (std::size_t s = 0; s < 2; ++s) {
        if (strictly[s] && loops[s].size() >= 3) faces[s].push_back(std::move(loops[s]));
      }
    }
    std::array<ConvexPart, 2> parts;
    for (std::size_t s = 0; s < 2; ++s) {
      auto cap = cap_of(faces[s]);
      if (!cap) return std::nullopt;
      faces[s].push_back(std::move(*cap));
      parts[s] = compact(faces[s]);
    }
    return parts;
  }

 private:
  [[nodiscard]] bool behind(std::uint32_t p) const { return p < heights_.size() && heights_[p] < -tolerance_; }
  [[nodiscard]] bool in_front(std::uint32_t p) const { return p < heights_.size() && heights_[p] > tolerance_; }

  std::uint32_t crossing(std::uint32_t a, std::uint32_t b) {
    const auto key = std::minmax(a, b);
    const auto [at, is_new] = crossings_.try_emplace(key, static_cast<std::uint32_t>(points_.size()));
    if (is_new) {
      points_.push_back(between(points_[key.first], heights_[key.first], points_[key.second], heights_[key.second]));
    }
    return at->second;
  }

  [[nodiscard]] bool on_plane(std::uint32_t p) const { return !behind(p) && !in_front(p); }

  /// The face that closes one side: its edges are those on the plane, turned round.
  std::optional<std::vector<std::uint32_t>> cap_of(const std::vector<std::vector<std::uint32_t>>& faces) const {
    std::map<std::uint32_t, std::uint32_t> next;
    for (const auto& face : faces) {
      for (std::size_t i = 0; i < face.size(); ++i) {
        const std::uint32_t a = face[i];
        const std::uint32_t b = face[(i + 1) % face.size()];
        if (on_plane(a) && on_plane(b) && !next.emplace(b, a).second) return std::nullopt;
      }
    }
    if (next.size() < 3) return std::nullopt;
    std::vector<std::uint32_t> loop;
    std::uint32_t at = next.begin()->first;
    do {
      loop.push_back(at);
      const auto found = next.find(at);
      if (found == next.end() || loop.size() > next.size()) return std::nullopt;
      at = found->second;
    } while (at != loop.front());
    if (loop.size() != next.size()) return std::nullopt;
    return loop;
  }

  /// Without the points of the other side.
  [[nodiscard]] ConvexPart compact(const std::vector<std::vector<std::uint32_t>>& faces) const {
    ConvexPart part;
    std::map<std::uint32_t, std::uint32_t> numbers;
    for (const auto& face : faces) {
      auto& kept = part.faces.emplace_back();
      for (const std::uint32_t p : face) {
        const auto [at, is_new] = numbers.try_emplace(p, static_cast<std::uint32_t>(part.points.size()));
        if (is_new) part.points.push_back(points_[p]);
        kept.push_back(at->second);
      }
    }
    return part;
  }

  const ConvexPart& part_;
  double tolerance_;
  std::vector<Vec3> points_;
  std::vector<double> heights_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> crossings_;
};

ConvexPart part_of(const geometry::Box& box) {
  const auto& [low, high] = box;
  ConvexPart result;
  for (unsigned i = 0; i < 8; ++i) {
    result.points.push_back(
        {(i & 1U) != 0 ? high.x : low.x, (i & 2U) != 0 ? high.y : low.y, (i & 4U) != 0 ? high.z : low.z});
  }
  result.faces = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  return result;
}

class Partition final {
 public:
  Partition(double tolerance, std::size_t most) : tolerance_{tolerance}, most_{most} {}

  /// `region` is convex and holds all of `fragments`. False when it could not be cut.
  bool cut(ConvexPart region, std::vector<Fragment> fragments) {
    struct Task {
      ConvexPart region;
      std::vector<Fragment> fragments;
    };
    std::vector<Task> tasks;
    tasks.push_back({std::move(region), std::move(fragments)});
    while (!tasks.empty()) {
      Task task = std::move(tasks.back());
      tasks.pop_back();
      const Plane plane = task.fragments[best_of(task.fragments)].plane;
      std::array<std::vector<Fragment>, 2> sides;
      for (Fragment& fragment : task.fragments) distribute(std::move(fragment), plane, sides);
      PolyhedronSplitter splitter{task.region, plane, tolerance_};
      const Side side = splitter.side();
      std::array<ConvexPart, 2> regions;
      if (side == Side::both) {
        auto halves = splitter.run();
        if (!halves) return false;
        regions = std::move(*halves);
      } else if (side == Side::behind || side == Side::front) {
        regions[side == Side::behind ? 0 : 1] = std::move(task.region);
      }
      for (std::size_t s = 0; s < 2; ++s) {
        if (regions[s].faces.empty()) continue;
        if (!sides[s].empty()) {
          tasks.push_back({std::move(regions[s]), std::move(sides[s])});
        } else if (s == 0) {  // behind a face of the block and cut by no other: inside
          parts.push_back(std::move(regions[s]));
          if (parts.size() > most_) return false;
        }
      }
    }
    return true;
  }

  std::vector<ConvexPart> parts;

 private:
  void distribute(Fragment fragment, const Plane& plane, std::array<std::vector<Fragment>, 2>& sides) const {
    switch (side_of(fragment.corners, plane, tolerance_)) {
      case Side::on: return;
      case Side::behind: sides[0].push_back(std::move(fragment)); return;
      case Side::front: sides[1].push_back(std::move(fragment)); return;
      case Side::both: {
        auto halves = split(fragment.corners, plane, tolerance_);
        for (std::size_t s = 0; s < 2; ++s) {
          if (halves[s].size() >= 3) sides[s].push_back({std::move(halves[s]), fragment.plane});
        }
        return;
      }
    }
  }

  /// The plane that cuts the fewest other fragments, among some.
  [[nodiscard]] std::size_t best_of(const std::vector<Fragment>& fragments) const {
    constexpr std::size_t tried = 24;
    const std::size_t step = std::max<std::size_t>(1, fragments.size() / tried);
    std::size_t best = 0;
    std::size_t fewest = fragments.size() + 1;
    for (std::size_t i = 0; i < fragments.size(); i += step) {
      const auto cuts = static_cast<std::size_t>(std::ranges::count_if(fragments, [&](const Fragment& other) {
        return side_of(other.corners, fragments[i].plane, tolerance_) == Side::both;
      }));
      if (cuts < fewest) {
        fewest = cuts;
        best = i;
      }
      if (fewest == 0) break;
    }
    return best;
  }

  double tolerance_;
  std::size_t most_;
};

}  // namespace

double ConvexPart::volume() const {
  double six = 0;
  for (const auto& face : faces) {
    for (std::size_t i = 1; i + 1 < face.size(); ++i) {
      six += dot(points[face[0]] - points[0], cross(points[face[i]] - points[0], points[face[i + 1]] - points[0]));
    }
  }
  return six / 6;
}

std::optional<std::vector<ConvexPart>> convex_parts(const Cells& cells, std::size_t cell, std::size_t most) {
  // About a corner of the cell, so that places far from the origin lose no more digits than they have lost.
  const auto first = static_cast<std::size_t>(cells.faces_of(cell)[2]);
  const Vec3 origin = cells.points[first];
  geometry::Box around{{}, {}};
  double reach = 0;
  std::vector<Fragment> fragments;
  for (const CellFace& face : convex_faces_of_cell(cells, cell)) {
    Fragment fragment;
    for (const std::uint32_t point : face) {
      const Vec3 p = cells.points[point] - origin;
      fragment.corners.push_back(p);
      around.add(p);
      const Vec3 far = cells.points[point];
      reach = std::max({reach, std::abs(far.x), std::abs(far.y), std::abs(far.z)});
    }
    Vec3 area;
    Vec3 centre;
    for (std::size_t i = 0; i < fragment.corners.size(); ++i) {
      const Vec3 o = fragment.corners[0];
      area += cross(fragment.corners[i] - o, fragment.corners[(i + 1) % fragment.corners.size()] - o);
      centre += fragment.corners[i] / static_cast<double>(fragment.corners.size());
    }
    if (!(norm(area) > 0)) continue;  // thinner than doubles can tell
    fragment.plane.normal = geometry::normalized(area);
    fragment.plane.offset = dot(fragment.plane.normal, centre);
    fragments.push_back(std::move(fragment));
  }
  const double size = norm(around.size());
  const double tolerance = std::max(1e-11 * size, 4e-16 * reach);
  if (fragments.empty()) return std::nullopt;
  Partition partition{tolerance, most};
  if (!partition.cut(part_of(around.grown(0.1 * size)), std::move(fragments))) return std::nullopt;
  double sum = 0;
  for (ConvexPart& part : partition.parts) {
    sum += part.volume();
    for (Vec3& p : part.points) p += origin;
  }
  if (!(std::abs(sum - cells.volume[cell]) <= 1e-9 * cells.volume[cell])) return std::nullopt;
  return std::move(partition.parts);
}

}  // namespace cleave::report::detail
