#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "cleave/stability/key_groups.hpp"
#include "cleave/stability/result.hpp"
#include "cleave/stability/support.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::report {

/// What the 3D view of report.html shows, packed: positions in 16 bits an axis over the view's box (1.2 mm for 80 m),
/// triangles by index, one record a face and a block; all as base64 in one JSON object.
struct View3d {
  std::string json;
  std::size_t shown = 0;  ///< blocks in the view; the others would not fit the budget and lie farthest from what moves
  std::size_t total = 0;
};

/// The joint sets that colour faces: names, and the set of each joint.
struct ViewSets {
  std::vector<std::string> names;
  std::vector<std::uint16_t> of;  ///< by the joint's number: into `names`
};

/// About how many bytes of text a block adds to the view.
[[nodiscard]] std::size_t view_bytes(const topology::BlockComplex& complex, topology::BlockId block);

/// Packs at most `budget` bytes: key blocks first, then judged blocks, blocks with a free face, blocks at the domain's
/// sides, the rest; each group in the order of block numbers. `analysis` may be null.
/// With `support` its bolts too: collar and end, what became of each, and the block it serves. With `groups` the
/// blocks of each key group, centroids and first motions; they come before all other blocks. With `sets` the set of the
/// joint behind each face.
[[nodiscard]] View3d pack_view(const topology::BlockComplex& complex, const stability::Analysis* analysis,
                               std::size_t budget, const stability::SupportResult* support = nullptr,
                               const stability::KeyGroups* groups = nullptr, const ViewSets* sets = nullptr);

}  // namespace cleave::report
