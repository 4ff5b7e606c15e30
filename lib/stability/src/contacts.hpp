#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "cleave/core/id.hpp"
#include "cleave/stability/analyse.hpp"
#include "cleave/stability/motion.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::stability {

/// What the faces of one group (same inward normal) offer together, N and m2, partial factors applied.
struct Contact {
  topology::FaceId face;    ///< the first one
  double area = 0;          ///< of the patches still in contact
  double tan_friction = 0;  ///< area-weighted mean, or the smallest
  double cohesion = 0;      ///< sum c A, N
  double tension = 0;       ///< sum sigma_t A, N
};

/// A block's joint faces that still have a neighbour: row -> group of the cone, and the group's strength.
struct Contacts {
  Cone cone;
  std::vector<Contact> groups;  ///< parallel to cone.groups()
  bool exposed = false;         ///< a free face, or a patch whose neighbour is gone
};

/// Which blocks are there in which state, and the exact directions of the planes met so far.
class Model final {
 public:
  /// Both outlive the model.
  Model(const topology::BlockComplex& complex, const Settings& settings);

  [[nodiscard]] const topology::BlockComplex& complex() const noexcept { return *complex_; }
  [[nodiscard]] const Settings& settings() const noexcept { return *settings_; }

  static constexpr std::uint32_t stays = std::numeric_limits<std::uint32_t>::max();
  void remove(topology::BlockId block, std::uint32_t batch) { removed_in_[block] = batch; }
  [[nodiscard]] std::uint32_t removed_in(topology::BlockId block) const { return removed_in_[block]; }
  /// Whether the block is there while batch `batch` is judged (state batch - 1).
  [[nodiscard]] bool present(topology::BlockId block, std::uint32_t batch) const { return removed_in_[block] >= batch; }

  /// Inward normal of a face.
  [[nodiscard]] Direction inward(const topology::Face& face);
  [[nodiscard]] Contacts contacts(topology::BlockId block, std::uint32_t batch);
  /// Weight and seismic force. Water, surcharge and point forces will be added to the resultant here.
  [[nodiscard]] Resultant applied_forces(const topology::Block& block) const;
  [[nodiscard]] Force weight(const topology::Block& block) const;

 private:
  const topology::BlockComplex* complex_;
  const Settings* settings_;
  IdVector<topology::BlockId, std::uint32_t> removed_in_;
  IdVector<topology::PlaneId, std::optional<Direction>> directions_;
};

}  // namespace cleave::stability
