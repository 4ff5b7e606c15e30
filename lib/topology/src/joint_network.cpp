#include "detail/joint_network.hpp"

#include <algorithm>
#include <optional>
#include <tuple>

#include "detail/face_triangles.hpp"

namespace cleave::topology::detail {
namespace {

using geometry::Vec3;

/// The joints that cover a face, ascending.
std::vector<JointId> joints_of(const BlockParts& parts, const PlaneFace& face) {
  std::vector<JointId> joints;
  for (Index c = face.first_cover; c < face.first_cover + face.cover_count; ++c) {
    const Facet& facet = parts.prepared.facets[parts.arrangement.covers[c]];
    if (facet.owner == Owner::joint) joints.emplace_back(facet.owner_index);
  }
  std::ranges::sort(joints);
  const auto repeated = std::ranges::unique(joints);
  joints.erase(repeated.begin(), repeated.end());
  return joints;
}

/// What an edge of joints ends on, where surfaces of the rock go through it: an excavation before a free side of the
/// domain, that before a fixed one.
std::vector<Nature> surfaces_at(const BlockParts& parts, const Edge& edge) {
  const auto key = [](const Nature& n) {
    return n.excavation != none ? std::tuple{0, n.excavation, Role::free, none}
                                : std::tuple{n.role == Role::free ? 1 : 2, none, n.role, n.tag};
  };
  std::vector<Nature> found;
  for (Index u = edge.first_use; u < edge.first_use + edge.use_count; ++u) {
    for (const Index h : {2 * u, 2 * u + 1}) {
      const Index face = parts.arrangement.face[h];
      if (face == none) continue;
      const bool up = parts.block_of[2 * face] != none, down = parts.block_of[2 * face + std::size_t{1}] != none;
      if (up == down) continue;
      found.push_back(parts.nature(up ? 2 * face : 2 * face + 1));
    }
  }
  std::ranges::stable_sort(found, {}, key);
  const auto repeated = std::ranges::unique(found, {}, key);
  found.erase(repeated.begin(), repeated.end());
  return found;
}

std::optional<std::uint32_t> number_if(Index index) {
  return index == none ? std::nullopt : std::optional<std::uint32_t>{index};
}

}  // namespace

JointNetwork make_joint_network(const BlockParts& parts, const std::vector<Vec3>& points,
                                const std::function<VertexId(Index)>& vertex_id) {
  const Arrangement& arrangement = parts.arrangement;
  JointNetwork out;
  std::vector<FaceTriangle> triangles;
  std::vector<std::uint8_t> in_joint(parts.graph.edges.size(), 0);
  for (Index f = 0; f < arrangement.faces.size(); ++f) {
    const PlaneFace& face = arrangement.faces[f];
    const Index up = parts.block_of[2 * f], down = parts.block_of[2 * f + std::size_t{1}];
    if (face.cover_count == 0 || up == none || down == none) continue;
    std::vector<JointId> joints = joints_of(parts, face);
    if (joints.empty()) continue;
    triangles.clear();
    append_triangles(parts.prepared, parts.graph, arrangement, parts.positions, f, triangles);
    double area = 0;
    const auto first = static_cast<std::uint32_t>(out.triangles.size());
    for (const auto& [a, b, c] : triangles) {
      area += 0.5 * geometry::norm(geometry::cross(points[b] - points[a], points[c] - points[a]));
      out.triangles.push_back({vertex_id(a), vertex_id(b), vertex_id(c)});
    }
    out.pieces.push_back({.joints = std::move(joints),
                          .plane = PlaneId{face.plane},
                          .blocks = {BlockId{up}, BlockId{down}},
                          .area = square_metres(area),
                          .first_triangle = first,
                          .triangle_count = static_cast<std::uint32_t>(triangles.size())});
    for (Index l = face.first_loop; l < face.first_loop + face.loop_count; ++l) {
      const Index start = arrangement.loops[l];
      Index h = start;
      do {
        in_joint[parts.graph.uses[h / 2].edge] = 1;
        h = arrangement.next[h];
      } while (h != start);
    }
  }
  for (Index e = 0; e < parts.graph.edges.size(); ++e) {
    if (in_joint[e] == 0) continue;
    const Edge& edge = parts.graph.edges[e];
    const auto number = static_cast<std::uint32_t>(out.borders.size());
    for (const Nature& surface : surfaces_at(parts, edge)) {
      const auto excavation = number_if(surface.excavation), tag = number_if(surface.tag);
      if (out.borders.size() == number) {
        out.borders.push_back({.ends = {vertex_id(edge.from), vertex_id(edge.to)},
                               .role = surface.role,
                               .excavation = excavation,
                               .tag = tag});
      } else {
        out.others.push_back({.border = number, .role = surface.role, .excavation = excavation, .tag = tag});
      }
    }
  }
  return out;
}

}  // namespace cleave::topology::detail
