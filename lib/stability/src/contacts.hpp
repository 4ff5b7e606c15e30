#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "cleave/core/id.hpp"
#include "cleave/stability/analyse.hpp"
#include "cleave/stability/block_theory.hpp"
#include "cleave/topology/block_complex.hpp"
#include "surface_loads.hpp"

namespace cleave::stability {

/// What the faces of one group (same inward normal) offer together, N and m2, partial factors applied.
struct Contact {
  topology::FaceId face;     ///< the first one
  double area = 0;           ///< of the patches still in contact
  double tan_friction = 0;   ///< area-weighted mean, or the smallest; of the parts that are not curved
  double straight_area = 0;  ///< m2 that `tan_friction` stands for
  double cohesion = 0;       ///< sum c A, N
  double tension = 0;        ///< sum sigma_t A, N
  struct Curved {
    double area;
    JointStrength strength;
  };
  double tan_sum = 0;                                          ///< sum tan(friction) A of the straight parts
  double tan_least = std::numeric_limits<double>::infinity();  ///< of the straight parts
  std::vector<Curved> curved = {};                             ///< parts whose friction depends on the normal stress
  bool smallest = false;                                       ///< the smallest friction of the parts, not their mean
  double divisor = 1;                                          ///< partial factor on tan(friction) of curved parts

  /// tan(friction) of the group when it presses with `reaction` N, spread evenly over its area.
  [[nodiscard]] double tan_at(double reaction) const;
};

/// A block's joint faces that still have a neighbour: row -> group of the cone, and the group's strength.
struct Contacts {
  Cone cone;
  std::vector<Contact> groups;  ///< parallel to cone.groups()
  bool exposed = false;         ///< a free face, or a patch whose neighbour is gone
};

/// Which blocks are there in which state, and the exact directions of the planes met so far.
/// Of the cohesion and tension that two blocks share on a plane (the lesser block first) the part that counts; all
/// where nothing is said.
using BondShares = std::map<std::tuple<topology::BlockId, topology::BlockId, topology::PlaneId>, double>;

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

  /// For `assembly_of` alone.
  void keep_bonds(const BondShares& shares) { bonds_ = shares; }
  [[nodiscard]] double bond_share(topology::BlockId a, topology::BlockId b, topology::PlaneId plane) const {
    if (bonds_.empty()) return 1;
    const auto it = bonds_.find({std::min(a, b), std::max(a, b), plane});
    return it == bonds_.end() ? 1 : it->second;
  }

  /// Inward normal of a face.
  [[nodiscard]] Direction inward(const topology::Face& face);
  [[nodiscard]] Contacts contacts(topology::BlockId block, std::uint32_t batch);
  /// Inward normals of the joint faces that still have a neighbour, and whether anything else is open: all that asks
  /// whether the block can move. Of most blocks that is the last question, and strengths are not looked up. Both spans
  /// are valid until the next call of this or of `contacts`.
  struct Held {
    std::span<const Direction> rows;
    std::span<const topology::BlockId> by;  ///< the neighbours that are there, face by face, with repetitions
    bool exposed = false;
  };
  [[nodiscard]] Held held(topology::BlockId block, std::uint32_t batch);
  /// What `held` found, with strengths: `cone` is that of its rows.
  [[nodiscard]] Contacts contacts(topology::BlockId block, std::uint32_t batch, Cone cone, bool exposed) const {
    return strengths({&block, 1}, batch, std::move(cone), exposed);
  }
  /// Blocks taken as one body: faces between members are no contacts. `members` ascending.
  [[nodiscard]] Contacts contacts_of(std::span<const topology::BlockId> members, std::uint32_t batch);
  /// Weight, seismic force, water as the joints stand while batch `batch` is judged, and loads on free faces.
  [[nodiscard]] Resultant applied_forces(topology::BlockId block, std::uint32_t batch) const;
  /// The same without weight and seismic force, with moments about the block's centroid.
  [[nodiscard]] ForceSum other_forces(topology::BlockId block, std::uint32_t batch) const;
  [[nodiscard]] Force weight(const topology::Block& block) const;

 private:
  [[nodiscard]] Held rows_of(std::span<const topology::BlockId> members, std::uint32_t batch);
  [[nodiscard]] Contacts strengths(std::span<const topology::BlockId> members, std::uint32_t batch, Cone cone,
                                   bool exposed) const;

  const topology::BlockComplex* complex_;
  const Settings* settings_;
  IdVector<topology::BlockId, std::uint32_t> removed_in_;
  IdVector<topology::PlaneId, topology::PlaneId> parallel_;
  Length rounding_;  ///< of corners
  IdVector<topology::PlaneId, std::optional<Direction>> directions_;
  IdVector<topology::BlockId, ForceSum> on_surfaces_;  ///< empty when there are none
  std::vector<Direction> rows_;                        ///< of the last `held`
  std::vector<topology::BlockId> by_;                  ///< of the last `held`
  BondShares bonds_;
};

}  // namespace cleave::stability
