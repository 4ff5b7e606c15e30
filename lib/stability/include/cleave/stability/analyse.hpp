#pragma once

#include <cstdint>

#include "cleave/stability/actions.hpp"
#include "cleave/stability/result.hpp"
#include "cleave/stability/rotation.hpp"
#include "cleave/stability/strength.hpp"
#include "cleave/stability/transfer_readings.hpp"
#include "cleave/topology/audit.hpp"

namespace cleave::stability {

/// Friction of several faces with one normal and different joints (Goodman & Shi take one joint a plane).
enum class GroupFriction : std::uint8_t {
  area_mean,  ///< tan(friction) weighted by contact area: equal normal stress on faces that move together
  smallest,   ///< lower bound
};

struct Settings {
  RockMass rock;
  StrengthTable strengths;
  Loads loads;
  PartialFactors partial = {};
  GroupFriction group_friction = GroupFriction::area_mean;
  /// Count a block removable only when it can leave all its contacts at once (cone of dimension 3).
  bool strict = false;
  /// Cohesion also on faces that are only brushed: parallel to the motion, without reaction.
  bool parallel_contact = false;
  bool force_transfer = true;
  TransferReadings transfer = {};
  std::uint32_t max_batches = 50;
  /// Blocks that count as gone from the start (micro-blocks): not judged, in no batch, and holding nothing.
  std::vector<topology::BlockId> left_out = {};
  /// Of a block that is known in part only (topology::Block::truncated) it is enough to know that it is no key block;
  /// otherwise it must be known not to move without friction either.
  bool only_key_blocks = false;
  /// The factor of safety that must be certain then: the scene's target, where blocks below it are counted.
  double least_factor = 1;
  /// Water and loads on free faces.
  Actions actions = {};
  /// With `decide` parts of a block are enough to know that it stays only when they leave it no direction.
  RotationCheck rotation = RotationCheck::off;
};

/// Key blocks of the complex in batches, after Goodman & Shi (1985) with the mode found as the projection of the
/// resultant (Fu 2014, ch. 4, corrected). Translation; rotation of single blocks where asked (`Settings::rotation`); no
/// arching, in-situ stress ignored.
///
/// All blocks of a batch are judged in the same state and removed together; faces to removed blocks are free from then
/// on. Blocks with a fixed face never move. With `force_transfer` the net force of later batches is passed on to
/// earlier ones, last batch first. Deterministic; after the first batch the cost follows what changes.
[[nodiscard]] Analysis analyse(const topology::AuditedComplex& complex, const Settings& settings);

}  // namespace cleave::stability
