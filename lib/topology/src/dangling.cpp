#include "detail/dangling.hpp"

#include <algorithm>

namespace cleave::topology::detail {
namespace {

using geometry::Vec3;

/// The first joint that covers the face; none.
Index joint_of(const Prepared& prepared, const Arrangement& arrangement, Index face) {
  const PlaneFace& f = arrangement.faces[face];
  Index joint = none;
  for (Index c = f.first_cover; c < f.first_cover + f.cover_count; ++c) {
    const Facet& facet = prepared.facets[arrangement.covers[c]];
    if (facet.owner == Owner::joint) joint = std::min(joint, facet.owner_index);
  }
  return joint;
}

}  // namespace

Dangling find_dangling(const Prepared& prepared, const Graph& graph, const Arrangement& arrangement,
                       std::span<const Index> block_of, std::span<const Vec3> points,
                       const std::function<VertexId(Index)>& vertex_id) {
  Dangling out;
  const auto faces = static_cast<Index>(arrangement.faces.size());
  std::vector<Index> joint(faces, none);
  std::vector<std::uint8_t> dangles(faces, 0), stands(faces, 0);
  for (Index f = 0; f < faces; ++f) {
    if (arrangement.faces[f].cover_count == 0) continue;
    joint[f] = joint_of(prepared, arrangement, f);
    const Index a = block_of[2 * f], b = block_of[2 * f + std::size_t{1}];
    dangles[f] = joint[f] != none && a == b && a != none ? 1 : 0;
    stands[f] = a != b ? 1 : 0;
  }

  // Around each edge: a joint is not alone where any other face stands, or where another joint dangles.
  std::vector<std::uint8_t> met(prepared.joint_count, 0);
  for (const Edge& edge : graph.edges) {
    std::size_t around = 0;
    Index only = none;
    bool several = false, standing = false;
    for (Index u = edge.first_use; u < edge.first_use + edge.use_count; ++u) {
      for (const Index h : {2 * u, 2 * u + 1}) {
        const Index f = arrangement.face[h];
        if (f == none) continue;
        if (stands[f] != 0) standing = true;
        if (dangles[f] == 0) continue;
        ++around;
        several = several || (only != none && only != joint[f]);
        only = joint[f];
      }
    }
    if (around == 1 && !standing) {
      ++out.free_edges;
      out.free_edge_length += metres(geometry::norm(points[edge.to] - points[edge.from]));
    }
    if (around == 0 || (!several && !standing)) continue;
    for (Index u = edge.first_use; u < edge.first_use + edge.use_count; ++u) {
      for (const Index h : {2 * u, 2 * u + 1}) {
        const Index f = arrangement.face[h];
        if (f != none && dangles[f] != 0) met[joint[f]] = 1;
      }
    }
  }

  const auto start_of = [&](Index h) {
    const Edge& edge = graph.edges[graph.uses[h / 2].edge];
    return h % 2 == 0 ? edge.from : edge.to;
  };
  std::vector<std::uint8_t> seen(prepared.joint_count, 0);
  for (Index f = 0; f < faces; ++f) {
    if (dangles[f] == 0) continue;
    const PlaneFace& face = arrangement.faces[f];
    DanglingPiece piece{.joint = JointId{joint[f]},
                        .block = BlockId{block_of[2 * f]},
                        .plane = PlaneId{face.plane},
                        .area = {},
                        .loops = {},
                        .isolated = met[joint[f]] == 0};
    const Vec3 apex = points[start_of(arrangement.loops[face.first_loop])];
    Vec3 area{};
    for (Index l = face.first_loop; l < face.first_loop + face.loop_count; ++l) {
      std::vector<VertexId> corners;
      const Index start = arrangement.loops[l];
      Index h = start;
      do {
        const Index g = arrangement.next[h];
        area += 0.5 * geometry::cross(points[start_of(h)] - apex, points[start_of(g)] - apex);
        corners.push_back(vertex_id(start_of(h)));
        h = g;
      } while (h != start);
      piece.loops.push_back(std::move(corners));
    }
    piece.area = square_metres(geometry::norm(area));
    out.area += piece.area;
    if (seen[joint[f]] == 0) {
      seen[joint[f]] = 1;
      ++out.joints;
      if (piece.isolated) ++out.isolated_joints;
    }
    out.pieces.push_back(std::move(piece));
  }
  return out;
}

}  // namespace cleave::topology::detail
