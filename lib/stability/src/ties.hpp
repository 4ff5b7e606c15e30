#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "cleave/assembly/assembly.hpp"
#include "cleave/stability/key_groups.hpp"
#include "cleave/stability/support.hpp"
#include "contacts.hpp"

namespace cleave::stability {

/// Support between blocks judged together: bolts pull along their axes only, between the pieces of rock that they go
/// through; sprayed concrete holds a block along each edge of its sprayed faces against the block beyond it, straight
/// against the way in which the edge parts without support where that leads out of the face, as it does for a block by
/// itself, and where nothing parts against what would come straight out of the face.
class Ties final {
 public:
  /// `unsupported`: how blocks move without; by it falling and sliding blocks have their own target, and bolts with an
  /// angle law their efficiency. Capacities are over the targets.
  Ties(const topology::BlockComplex& complex, const Settings& settings, const SupportPlan& plan,
       std::span<const BoltResult> bolts, const KeyGroups& unsupported);

  /// Those between the blocks named (ascending), and with rock that stays, in this batch's state of `model`.
  [[nodiscard]] std::vector<assembly::Contact> among(const Model& model, std::span<const topology::BlockId> blocks,
                                                     std::uint32_t batch) const;

  /// The same with sprayed concrete straight against what would come out of its faces. What turns may need that, and a
  /// layer can do either.
  [[nodiscard]] Ties straight_out() const;
  /// Whether that is any different.
  [[nodiscard]] bool slants() const;

  /// Those of the blocks given, and what a bolt or a seam of sprayed concrete ties to them. Ascending.
  [[nodiscard]] std::vector<topology::BlockId> with_tied(std::vector<topology::BlockId> blocks) const;

 private:
  /// An edge of a free face, or part of one, with sprayed concrete across it.
  struct Seam {
    topology::BlockId block, beyond;
    geometry::Vec3 at, outward;
    double force = 0;  ///< N
    /// Of the face of `beyond` at the same edge, where it has one that is sprayed: one layer goes round both.
    std::optional<geometry::Vec3> outward_beyond = {};
  };
  struct Pull {
    geometry::Vec3 against;  ///< unit
    double force = 0;        ///< N
  };

  void add_seams(const Shotcrete& layer, const std::function<bool(topology::BlockId)>& gone);
  [[nodiscard]] geometry::Vec3 movement_at(topology::BlockId block, geometry::Vec3 at) const;
  [[nodiscard]] Pull pull_of(const Seam& seam) const;
  [[nodiscard]] double target(topology::BlockId block, topology::BlockId other) const;

  const topology::BlockComplex* complex_;
  std::vector<BoltResult> bolts_;  ///< through more than one block
  std::vector<Seam> seams_;
  bool straight_out_ = false;
  IdVector<topology::BlockId, assembly::Rate> movement_;  ///< without support; zero: rests
  IdVector<topology::BlockId, double> target_;
};

}  // namespace cleave::stability
