#include "cleave/topology/block_complex.hpp"

#include "detail/face_packer.hpp"

namespace cleave::topology {

void BlockComplex::Data::set_loops(Face& face, const std::vector<std::vector<VertexId>>& loops) {
  face.first_corner = static_cast<std::uint32_t>(corners.size());
  face.first_hole = static_cast<std::uint32_t>(hole_starts.size());
  for (const auto& loop : loops) {
    const auto before = static_cast<std::uint32_t>(corners.size()) - face.first_corner;
    if (before > 0) hole_starts.push_back(before);
    corners.insert(corners.end(), loop.begin(), loop.end());
  }
  face.corner_count = static_cast<std::uint32_t>(corners.size()) - face.first_corner;
  face.hole_count = static_cast<std::uint32_t>(hole_starts.size()) - face.first_hole;
}

void BlockComplex::Data::set_patches(Face& face, std::span<const Patch> own) {
  face.first_patch = static_cast<std::uint32_t>(patches.size());
  face.patch_count = static_cast<std::uint32_t>(own.size());
  patches.insert(patches.end(), own.begin(), own.end());
}

BlockComplex::BlockComplex(Data data) {
  std::vector<geometry::Vec3> normals;
  normals.reserve(data.planes.size());
  for (const exact::Plane& plane : data.planes) {
    const auto n = plane.unit_normal();
    normals.push_back({n[0], n[1], n[2]});
  }
  detail::FacePacker packer{kept_.faces, normals};
  packer.reserve(data.faces.size());
  for (const Face& face : data.faces) {
    const std::span<const Patch> own = data.patches_of(face);
    std::uint32_t twin = detail::FacePacker::none;
    if (own.size() == 1 && own[0].neighbour && own[0].neighbour->index() < data.blocks.size()) {
      twin = packer.twin_of(face, own, data.blocks[*own[0].neighbour].faces);
    }
    packer.add(face, own, twin);
  }
  detail::FacePacker::finish(kept_.faces, std::move(normals));
  data.faces = {};
  std::vector<Patch>{}.swap(data.patches);
  kept_.rest = std::move(data);
}

BlockComplex::Data BlockComplex::data() const {
  Data out = kept_.rest;
  out.faces.reserve(faces().size());
  std::uint32_t holes = 0;
  for (Face face : faces()) {
    const PatchRange own = patches(face);
    if (face.hole_count == 0) face.first_hole = holes;
    holes = face.first_hole + face.hole_count;
    face.first_patch = static_cast<std::uint32_t>(out.patches.size());
    face.patch_count = static_cast<std::uint32_t>(own.size());
    out.patches.insert(out.patches.end(), own.begin(), own.end());
    out.faces.push_back(face);
  }
  return out;
}

}  // namespace cleave::topology
