#include <algorithm>
#include <cmath>
#include <utility>

#include "cleave/core/overloaded.hpp"
#include "cleave/geometry/predicates.hpp"
#include "cleave/geometry/triangulate.hpp"
#include "cleave/realize/block_sizes.hpp"
#include "cleave/scene3d/bounds.hpp"

/// What a scanline or borehole meets: which joints it crosses by exact signs, where in doubles.
namespace cleave::scene {
namespace {

using exact::Sign;
using geometry::orient3d;
using geometry::Vec3;

/// The straight line through two points, with a third beside it from which turns about it are counted.
struct Straight {
  Vec3 from, to, beside;
};
Straight straight(Vec3 from, Vec3 to) {
  const Vec3 d = to - from;
  const Vec3 some = std::abs(d.x) <= std::abs(d.y) && std::abs(d.x) <= std::abs(d.z) ? Vec3{1, 0, 0}
                    : std::abs(d.y) <= std::abs(d.z)                                 ? Vec3{0, 1, 0}
                                                                                     : Vec3{0, 0, 1};
  return {from, to, from + norm(d) * some};
}

/// Whether the line goes through the closed loop: by the sides of half a plane that starts in the line. Of two loops
/// that share an edge which the line meets exactly one is crossed.
bool through(const Straight& line, std::span<const Vec3> loop) {
  bool inside = false;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec3 p = loop[i], q = loop[(i + 1) % loop.size()];
    const bool p_above = orient3d(line.from, line.to, line.beside, p) == Sign::positive;
    const bool q_above = orient3d(line.from, line.to, line.beside, q) == Sign::positive;
    if (p_above == q_above) continue;
    const Sign turn = orient3d(line.from, line.to, p, q);
    if (turn == (q_above ? Sign::positive : Sign::negative)) inside = !inside;
  }
  return inside;
}

/// Where the line meets a plane, as a share of the way; empty when it runs along it.
std::optional<double> share_at(const Straight& line, Vec3 point, Vec3 normal) {
  const double along = dot(normal, line.to - line.from);
  if (along == 0) return std::nullopt;
  return dot(normal, point - line.from) / along;
}

/// Shares of the way at which the line crosses the faces of a solid, in order.
std::vector<double> crossings_of(const Straight& line, const geometry::Solid& solid) {
  std::vector<double> at;
  for (const geometry::SolidFace& face : solid.faces()) {
    std::vector<Vec3> corners;
    for (const std::uint32_t corner : face.corners) corners.push_back(solid.vertices()[corner]);
    const auto triangles = geometry::triangulate(corners);
    if (!triangles) continue;
    for (const auto& t : *triangles) {
      const std::array<Vec3, 3> triangle{corners[t[0]], corners[t[1]], corners[t[2]]};
      if (!through(line, triangle)) continue;
      const Vec3 normal = cross(triangle[1] - triangle[0], triangle[2] - triangle[0]);
      if (const auto share = share_at(line, triangle[0], normal)) at.push_back(*share);
    }
  }
  std::ranges::sort(at);
  return at;
}

using Spans = std::vector<std::pair<double, double>>;

Spans inside_of(const std::vector<double>& crossings) {
  Spans spans;
  for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) spans.emplace_back(crossings[i], crossings[i + 1]);
  return spans;
}

Spans without(const Spans& spans, const Spans& taken) {
  Spans left = spans;
  for (const auto& [low, high] : taken) {
    Spans next;
    for (const auto& [from, to] : left) {
      if (from < std::min(to, low)) next.emplace_back(from, std::min(to, low));
      if (std::max(from, high) < to) next.emplace_back(std::max(from, high), to);
    }
    left = std::move(next);
  }
  return left;
}

/// What of a leg lies in the rock, m from its start. The line is drawn out beyond the bodies so that it begins outside.
Spans in_rock(const Scene& scene, Vec3 from, Vec3 to) {
  const double length = norm(to - from);
  Box box = box_of(scene.domain);
  for (const Excavation& excavation : scene.excavations) {
    const Box other = box_of(excavation.solid);
    for (double Vec3::* p : {&Vec3::x, &Vec3::y, &Vec3::z}) {
      box.min.*p = std::min(box.min.*p, other.min.*p);
      box.max.*p = std::max(box.max.*p, other.max.*p);
    }
  }
  const double beyond = norm(box.max - box.min) + norm(from - box.min) + length;
  const Vec3 way = (1 / length) * (to - from);
  const Straight line = straight(from - beyond * way, to + beyond * way);
  const double whole = length + 2 * beyond;
  Spans spans = inside_of(crossings_of(line, scene.domain));
  for (const Excavation& excavation : scene.excavations) {
    spans = without(spans, inside_of(crossings_of(line, excavation.solid)));
  }
  Spans along;
  for (auto [low, high] : spans) {
    low = std::max(0.0, low * whole - beyond);
    high = std::min(length, high * whole - beyond);
    if (low < high) along.emplace_back(low, high);
  }
  return along;
}

/// Whether a point of a joint is still there, where the joint ends on others: on the side of their planes where its
/// middle lies.
class Endings final {
 public:
  explicit Endings(const topology::CutInput& input) : input_{input} {}
  [[nodiscard]] bool keep(std::size_t joint, Vec3 point) const {
    return std::ranges::all_of(input_.terminations, [&](const topology::Termination& end) {
      if (end.joint.index() != joint) return true;
      const auto [through, normal] = plane_of(end.at.index());
      return dot(normal, point - through) * dot(normal, middle_of(joint) - through) >= 0;
    });
  }

 private:
  [[nodiscard]] std::pair<Vec3, Vec3> plane_of(std::size_t joint) const {
    return std::visit(
        overloaded{[](const topology::Joint& polygons) {
                     const auto corners = polygons.polygons.front().corners();
                     return std::pair{corners[0], area_vector(polygons.polygons.front())};
                   },
                   [](const topology::PersistentJoint& plane) { return std::pair{plane.through, plane.normal}; }},
        input_.joints[joint]);
  }
  [[nodiscard]] Vec3 middle_of(std::size_t joint) const {
    return std::visit(overloaded{[](const topology::Joint& polygons) {
                                   Vec3 sum{0, 0, 0};
                                   double count = 0;
                                   for (const geometry::Polygon& polygon : polygons.polygons) {
                                     for (const Vec3 corner : polygon.corners()) {
                                       sum += corner;
                                       ++count;
                                     }
                                   }
                                   return (1 / count) * sum;
                                 },
                                 [](const topology::PersistentJoint& plane) { return plane.through; }},
                      input_.joints[joint]);
  }

  const topology::CutInput& input_;
};

/// Shares of the way at which the line crosses a joint, as far as its own polygons go.
void add_crossings(const Straight& line, const std::variant<topology::Joint, topology::PersistentJoint>& joint,
                   std::vector<double>& at) {
  std::visit(overloaded{[&](const topology::Joint& polygons) {
                          for (std::size_t i = 0; i < polygons.polygons.size(); ++i) {
                            const auto corners = polygons.polygons[i].corners();
                            if (!through(line, corners)) continue;
                            const bool in_hole =
                                i < polygons.holes.size() &&
                                std::ranges::any_of(
                                    polygons.holes[i],
                                    [&](const geometry::Polygon& hole) { return through(line, hole.corners()); });
                            if (in_hole) continue;
                            const auto share = share_at(line, corners[0], area_vector(polygons.polygons[i]));
                            if (share) at.push_back(*share);
                          }
                        },
                        [&](const topology::PersistentJoint& plane) {
                          if (const auto share = share_at(line, plane.through, plane.normal)) at.push_back(*share);
                        }},
             joint);
}

}  // namespace

std::vector<LineInRock> lines_in_rock(const Scene& scene) {
  std::vector<LineInRock> lines;
  for (const ScanLine& given : scene.lines) {
    LineInRock& line = lines.emplace_back();
    line.name = given.name;
    for (std::size_t i = 1; i < given.points.size(); ++i) {
      const Vec3 from = given.points[i - 1], to = given.points[i];
      if (norm(to - from) > 0) line.legs.push_back({from, to, in_rock(scene, from, to)});
    }
  }
  return lines;
}

LinePieces pieces_on(const LineInRock& line, const topology::CutInput& input) {
  LinePieces found;
  double open = 0;  // rock since the last joint or void
  bool ended = true;
  const Endings endings{input};
  for (const LineInRock::Leg& leg : line.legs) {
    const double length = norm(leg.to - leg.from);
    const Straight way = straight(leg.from, leg.to);
    std::vector<double> at;
    for (std::size_t j = 0; j < input.joints.size(); ++j) {
      std::vector<double> own;
      add_crossings(way, input.joints[j], own);
      for (const double share : own) {
        if (share >= 0 && share < 1 && endings.keep(j, leg.from + share * (leg.to - leg.from))) {
          at.push_back(share * length);
        }
      }
    }
    std::ranges::sort(at);
    for (const auto& [low, high] : leg.rock) {
      if (low > 0 && !ended) found.pieces.push_back(std::exchange(open, 0));
      double last = low;
      for (auto next = std::ranges::lower_bound(at, low); next != at.end() && *next < high; ++next) {
        ++found.joints;
        found.pieces.push_back(open + *next - last);
        open = 0;
        last = *next;
      }
      open += high - last;
      found.length += metres(high - low);
      ended = high < length;
      if (ended) found.pieces.push_back(std::exchange(open, 0));
    }
    if (leg.rock.empty() && !ended) {
      found.pieces.push_back(std::exchange(open, 0));
      ended = true;
    }
  }
  if (!ended) found.pieces.push_back(open);
  return found;
}

std::vector<std::string> notes_on_lines(const Scene& scene) {
  std::vector<std::string> notes;
  for (const LineInRock& line : lines_in_rock(scene)) {
    const bool met = std::ranges::any_of(line.legs, [](const LineInRock::Leg& leg) { return !leg.rock.empty(); });
    if (!met) notes.push_back("scanline " + line.name + " meets no rock and is left out: it lies outside the domain");
  }
  return notes;
}

std::vector<LineFigures> count_lines(const Scene& scene, const topology::CutInput& input) {
  std::vector<LineFigures> all;
  for (const LineInRock& line : lines_in_rock(scene)) {
    const LinePieces found = pieces_on(line, input);
    const double length = found.length.si();
    if (!(length > 0)) continue;
    all.push_back({.name = line.name,
                   .length = found.length,
                   .joints = found.joints,
                   .frequency = survey::frequency(found.joints, length),
                   .rqd = survey::rqd(found.pieces, length),
                   .mean_piece = found.length / static_cast<double>(found.pieces.size()),
                   .longest_piece = metres(std::ranges::max(found.pieces))});
  }
  return all;
}

}  // namespace cleave::scene
