#include "cleave/topology/block_complex.hpp"

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

}  // namespace cleave::topology
