#include "mapped.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <tuple>
#include <utility>

#include "cleave/core/disjoint_sets.hpp"
#include "cleave/core/overloaded.hpp"
#include "cleave/geometry/predicates.hpp"
#include "cleave/geometry/triangulate.hpp"
#include "outline.hpp"
#include "shape.hpp"

namespace cleave::dfn {

using geometry::Vec3;

namespace detail {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Parameters of `from + t (to - from)` where a line goes in and out of a simple polygon, in pairs: what touches a
/// corner alone counts by which side of the line the edges lie on.
std::vector<double> crossings(std::span<const Vec2> outline, Vec2 from, Vec2 to) {
  std::vector<double> at;
  const Vec2 along = to - from;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vec2 a = outline[i], b = outline[(i + 1) % outline.size()];
    const double left_a = cross(along, a - from), left_b = cross(along, b - from);
    if ((left_a >= 0) == (left_b >= 0)) continue;
    const Vec2 p = a + left_a / (left_a - left_b) * (b - a);
    at.push_back(dot(p - from, along) / dot(along, along));
  }
  std::ranges::sort(at);
  return at;
}

std::vector<Vec2> flattened(std::span<const Vec3> corners, const FlatFrame& frame) {
  std::vector<Vec2> flat;
  for (const Vec3& corner : corners) flat.push_back(frame.flat(corner));
  return flat;
}

/// Where a simple polygon lies in the plane of a frame.
void add_stretches(std::span<const Vec3> corners, const FlatFrame& frame, Vec3 along, std::vector<Stretch>& out) {
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3 a = corners[i], b = corners[(i + 1) % corners.size()];
    const double above_a = frame.above(a), above_b = frame.above(b);
    if ((above_a >= 0) == (above_b >= 0)) continue;
    points.push_back(a + above_a / (above_a - above_b) * (b - a));
  }
  std::ranges::sort(points, {}, [&](Vec3 p) { return dot(p, along); });
  for (std::size_t i = 0; i + 1 < points.size(); i += 2) out.emplace_back(points[i], points[i + 1]);
}

/// The line of a plane without end, beyond the face on both sides.
Stretch whole_line(const SolidJoint& joint, const Face& face, Vec3 along) {
  const Vec3 middle = (face.box.min + face.box.max) / 2;
  const Vec3 down = cross(along, face.frame.normal);  // unit, in the face, across the line
  const Vec3 on_face = middle - face.frame.above(middle) * face.frame.normal;
  const Vec3 on_line = on_face - dot(on_face - joint.centre, joint.normal) / dot(down, joint.normal) * down;
  const double far = 2 * norm(face.box.size()) + norm(on_line - on_face);
  return {on_line - far * along, on_line + far * along};
}

}  // namespace

FlatFrame flat_frame(Vec3 origin, Vec3 normal) noexcept {
  const Vec3 n = normalized(normal);
  const Vec3 other = std::abs(n.z) < 0.9 ? Vec3{0, 0, 1} : Vec3{1, 0, 0};
  const Vec3 x = normalized(cross(other, n));
  return {origin, n, x, cross(n, x)};
}

Face face_of(const MappedFace& face) {
  const std::span<const Vec3> corners = face.outline.corners();
  const FlatFrame frame = flat_frame(corners.front(), geometry::area_vector(corners));
  return {frame, flattened(corners, frame), geometry::box_of(corners)};
}

SolidJoint solid_joint(const SampledJoint& joint) {
  SolidJoint solid{joint.centre, joint.normal, {}, {}};
  const auto add = [&](const geometry::Polygon& polygon) {
    solid.polygons.emplace_back(polygon.corners().begin(), polygon.corners().end());
  };
  std::visit(overloaded{[&](const geometry::Polygon& polygon) { add(polygon); }, [](const InfinitePlane&) {},
                        [&](const std::vector<geometry::Polygon>& polygons) { std::ranges::for_each(polygons, add); },
                        [&](const JointOutline& outline) {
                          solid.polygons.push_back(corners_of(outline, joint.centre, unit_corners(outline.sides)));
                        }},
             joint.shape);
  for (const auto& polygon : solid.polygons) solid.box.grow(geometry::box_of(polygon));
  if (solid.polygons.empty()) solid.box = {{-infinity, -infinity, -infinity}, {infinity, infinity, infinity}};
  return solid;
}

std::vector<MappedTrace> all_traces(const SolidJoint& joint, const Face& face, std::size_t number) {
  std::vector<MappedTrace> traces;
  if (!joint.box.overlaps(face.box)) return traces;
  const Vec3 line = cross(face.frame.normal, joint.normal);
  if (!(norm(line) > 1e-12)) return traces;  // parallel to the face
  const Vec3 along = normalized(line);
  std::vector<Stretch> stretches;
  for (const auto& polygon : joint.polygons) add_stretches(polygon, face.frame, along, stretches);
  if (joint.polygons.empty()) stretches.push_back(whole_line(joint, face, along));
  for (const auto& [from, to] : stretches) {
    const std::vector<double> at = crossings(face.outline, face.frame.flat(from), face.frame.flat(to));
    for (std::size_t i = 0; i + 1 < at.size(); i += 2) {
      const double begin = std::max(0.0, at[i]), end = std::min(1.0, at[i + 1]);
      if (!(begin < end)) continue;
      traces.push_back({number, {from + begin * (to - from), from + end * (to - from)}, {begin > 0, end < 1}});
    }
  }
  return traces;
}

std::optional<Vec3> crossing(const SolidJoint& joint, const MappedHole& hole) {
  const double from = dot(hole.from - joint.centre, joint.normal), to = dot(hole.to - joint.centre, joint.normal);
  if ((from >= 0) == (to >= 0)) return std::nullopt;
  const Vec3 at = hole.from + from / (from - to) * (hole.to - hole.from);
  if (joint.polygons.empty()) return at;
  const FlatFrame frame = flat_frame(joint.centre, joint.normal);
  for (const auto& polygon : joint.polygons) {
    if (geometry::encloses(flattened(polygon, frame), frame.flat(at))) return at;
  }
  return std::nullopt;
}

}  // namespace detail

std::optional<ModelMismatch> cannot_honour(const JointSet& set) {
  if (std::holds_alternative<Persistent>(set.spec().shape)) {
    return ModelMismatch{"shape", "is \"persistent\": a joint without end that was seen is known whole",
                         "give the joints that were seen as measured joints"};
  }
  if (!std::holds_alternative<Baecher>(set.spec().model)) {
    return ModelMismatch{"model",
                         "is not \"baecher\": joints that hang together cannot be drawn one by one for what was seen",
                         "take the model \"baecher\""};
  }
  if (std::holds_alternative<Count>(set.spec().intensity)) {
    return ModelMismatch{"intensity", "is a number of joints: what was seen would change how many are elsewhere",
                         "give p32, p30, p10 or spacing"};
  }
  return std::nullopt;
}

std::vector<MappedTrace> traces_on(const SampledJoint& joint, const Mapping& mapping, std::size_t face) {
  auto traces = all_traces(detail::solid_joint(joint), detail::face_of(mapping.faces[face]), face);
  std::erase_if(traces, [&](const MappedTrace& trace) { return !(detail::length(trace) > mapping.shortest.si()); });
  return traces;
}

std::optional<MappedPick> pick_in(const SampledJoint& joint, const Mapping& mapping, std::size_t hole) {
  const auto at = detail::crossing(detail::solid_joint(joint), mapping.holes[hole]);
  if (!at) return std::nullopt;
  return MappedPick{hole, *at, joint.normal};
}

void map(std::span<const SampledJoint> joints, std::size_t set, Mapping& mapping) {
  for (const SampledJoint& joint : joints) {
    MappedJoint seen{.set = set};
    for (std::size_t face = 0; face < mapping.faces.size(); ++face) {
      std::ranges::move(traces_on(joint, mapping, face), std::back_inserter(seen.traces));
    }
    for (std::size_t hole = 0; hole < mapping.holes.size(); ++hole) {
      if (auto pick = pick_in(joint, mapping, hole)) seen.picks.push_back(*pick);
    }
    if (!seen.traces.empty() || !seen.picks.empty()) mapping.joints.push_back(std::move(seen));
  }
}

std::vector<SampledJoint> unseen(std::vector<SampledJoint> joints, const Mapping& mapping) {
  std::vector<detail::Face> faces;
  for (const MappedFace& face : mapping.faces) faces.push_back(detail::face_of(face));
  const double shortest = mapping.shortest.si();
  std::erase_if(joints, [&](const SampledJoint& joint) {
    const detail::SolidJoint solid = detail::solid_joint(joint);
    const auto shows = [&](const detail::Face& face) {
      return std::ranges::any_of(all_traces(solid, face, 0),
                                 [&](const MappedTrace& trace) { return detail::length(trace) > shortest; });
    };
    return std::ranges::any_of(faces, shows) || std::ranges::any_of(mapping.holes, [&](const MappedHole& hole) {
             return detail::crossing(solid, hole).has_value();
           });
  });
  return joints;
}

Length longest_trace(const JointSet& set) { return metres(2 * detail::reach(set.spec().shape)); }

namespace {

/// An end at the border of a face.
struct BorderEnd {
  std::size_t joint, face;
  Vec3 at;
};
struct Meeting {
  double apart;  ///< m
  std::size_t first, second;
};

std::vector<Meeting> meetings(std::span<const BorderEnd> ends, double error) {
  std::vector<std::size_t> order(ends.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::sort(order, {}, [&](std::size_t i) { return std::pair{ends[i].at.x, i}; });
  std::vector<Meeting> found;
  for (std::size_t a = 0; a < order.size(); ++a) {
    const BorderEnd& one = ends[order[a]];
    for (std::size_t b = a + 1; b < order.size() && ends[order[b]].at.x - one.at.x <= error; ++b) {
      const BorderEnd& other = ends[order[b]];
      const double apart = norm(other.at - one.at);
      if (one.face == other.face || one.joint == other.joint || !(apart <= error)) continue;
      found.push_back({apart, std::min(order[a], order[b]), std::max(order[a], order[b])});
    }
  }
  std::ranges::sort(found, {}, [](const Meeting& m) { return std::tuple{m.apart, m.first, m.second}; });
  return found;
}

}  // namespace

std::vector<std::size_t> join_round_corners(Mapping& mapping) {
  std::vector<BorderEnd> ends;
  for (std::size_t j = 0; j < mapping.joints.size(); ++j) {
    for (const MappedTrace& trace : mapping.joints[j].traces) {
      if (trace.goes_on[0]) ends.push_back({j, trace.face, trace.ends[0]});
      if (trace.goes_on[1]) ends.push_back({j, trace.face, trace.ends[1]});
    }
  }
  DisjointSets<std::size_t> one{mapping.joints.size()};
  std::vector<bool> used(ends.size(), false);
  for (const Meeting& meeting : meetings(ends, mapping.error.si())) {
    if (used[meeting.first] || used[meeting.second]) continue;
    const std::size_t a = one.find(ends[meeting.first].joint), b = one.find(ends[meeting.second].joint);
    auto &set_a = mapping.joints[a].set, &set_b = mapping.joints[b].set;
    if (set_a && set_b && *set_a != *set_b) continue;
    used[meeting.first] = used[meeting.second] = true;
    if (!set_a) set_a = set_b;
    if (!set_b) set_b = set_a;
    one.join(a, b);
  }
  std::vector<std::size_t> now(mapping.joints.size());
  std::vector<MappedJoint> joined;
  for (std::size_t j = 0; j < now.size(); ++j) {
    const std::size_t head = one.find(j);  // the lowest of its joints
    MappedJoint& joint = mapping.joints[j];
    if (head == j) {
      now[j] = joined.size();
      joined.push_back(std::move(joint));
      continue;
    }
    now[j] = now[head];
    MappedJoint& into = joined[now[j]];
    if (!into.set) into.set = joint.set;
    std::ranges::move(joint.traces, std::back_inserter(into.traces));
    std::ranges::move(joint.picks, std::back_inserter(into.picks));
  }
  mapping.joints = std::move(joined);
  return now;
}

}  // namespace cleave::dfn
