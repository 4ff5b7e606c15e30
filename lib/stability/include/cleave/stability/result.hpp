#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "cleave/core/quantity.hpp"
#include "cleave/geometry/vec3.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::stability {

enum class RotationCheck : std::uint8_t {
  off,
  flag,    ///< looked at and reported; mode, key and batches are those of translation
  decide,  ///< a block that turns is a key block too
};

/// Whether a block that cannot slide could turn (topple, or twist on its base).
///
/// It turns for certain when no forces at its contacts (compression, friction within the cone, cohesion spread evenly
/// over each contact) balance the applied forces and their moments about its centroid: then no statics holds it. That
/// such forces exist does not prove that it stands: friction of a joint behind it may hold it in one state of stress
/// and let it turn from rest in another. Where rotation decides that counts, too. Tension is not counted.
struct Rotation {
  bool turns = false;
  bool from_rest = false;    ///< forces that hold it exist, but from rest it turns
  geometry::Vec3 axis = {};  ///< unit, through the centroid, right-handed; zero when it does not turn
  double lack = 0;           ///< what is left unbalanced over the load (moments over the block's reach); 0 when nothing
};

/// How a block would move without friction: the projection of the resultant on the cone of admissible directions.
enum class Mode : std::uint8_t {
  falling,  ///< along the resultant, which has a part along gravity (theory: resultant in the cone)
  lifting,  ///< along the resultant, against gravity
  sliding,  ///< on one plane
  wedge,    ///< along the line of two planes
  stable,   ///< removable, but safe without friction (projection is zero)
  tapered,  ///< not removable: no admissible direction
};

/// "falling", "lifting", ... as files write it.
[[nodiscard]] std::string_view name(Mode mode) noexcept;
/// Whether a block of this mode would move without friction (the rows of key_blocks.csv).
[[nodiscard]] bool moves(Mode mode) noexcept;

/// A pressing joint plane of a block.
struct Pressing {
  topology::FaceId face;  ///< a face on that plane
  Force reaction = {};    ///< effective normal reaction, > 0 in compression
  /// Shear against the motion: friction and cohesion of the face, over the factor of safety where that is above 1. On
  /// two planes the share of each is not given by balance: both are mobilised alike.
  Force shear = {};
};

/// A share of a block's net force on a block of an earlier batch.
struct Passed {
  topology::BlockId onto;
  geometry::Vec3 force = {};  ///< N
};

/// The same block with the forces that blocks of later batches pass to it.
struct Transferred {
  Mode mode = Mode::stable;
  bool key = false;               ///< unstable still; false for a block that is stable after transfer
  geometry::Vec3 direction = {};  ///< unit vector; zero for stable
  Force driving = {};
  Force resistance = {};
  Force net = {};
  double factor_of_safety = 0;
  geometry::Vec3 received = {};  ///< sum of the forces passed to it, N
  Force passed = {};             ///< what it passes on along `direction`: its net (or driving) force, or 0
  /// Unstable in batch 2 or later, but it pushes no removed block: holding the earlier batch holds it too.
  bool self_held = false;
  /// Largest tan(angle between motion and the normal of a face that passes force) / tan(friction): above 1 a face
  /// without cohesion cannot carry the force in line.
  double shear_ratio = 0;
  bool tie = false;
  std::vector<Passed> passes = {};      ///< what it passes on, by face
  std::vector<Pressing> pressing = {};  ///< under the forces received
  std::vector<Pressing> added = {};     ///< reading `normals`: what its own planes take up of the force it passes on
  double lost = 0;                      ///< N of its net force that the reading of the transfer could not pass on

  /// What has to be held at this block: its net force without what blocks of earlier batches received of it. Over all
  /// blocks each force counts once, where it ends.
  [[nodiscard]] Force to_be_held() const noexcept { return newtons(std::max(0.0, net.si() - passed.si() + lost)); }
};

/// What the analysis says of one block in one state.
struct Judgement {
  topology::BlockId block;
  Mode mode = Mode::stable;
  bool key = false;  ///< removable and unstable (net force > 0; or it turns, when rotation decides)
  std::optional<std::uint32_t> batch =
      {};  ///< 1, 2, ...: when it leaves; none for a block that stays (judged in the final state)
  geometry::Vec3 direction = {};  ///< unit vector of first motion; zero for stable and tapered
  Force weight = {};
  Force driving = {};     ///< T >= 0
  Force resistance = {};  ///< R >= 0; the smallest when statics leaves it open
  /// The largest R over the pairs of planes that may press, when three or more planes through one line press and R is
  /// not unique.
  std::optional<Force> resistance_max = {};
  /// Cohesion of joints that the motion does not open but that nothing presses on: not in R.
  Force cohesion_left_out = {};
  Force net = {};               ///< F = T - R, positive = unstable
  double factor_of_safety = 0;  ///< R/T; +inf when T = 0; 0 for falling without strength
  std::vector<Pressing> pressing = {};
  std::uint8_t cone_dimension =
      0;             ///< 3 opens in a solid cone, 2 or 1 can only slide in a plane or along a line, 0 tapered
  bool tie = false;  ///< two modes coincide to rounding; the one with fewer faces was taken
  /// For blocks of a batch, when force transfer ran. Nothing is ever passed to a block that stays: it keeps its values.
  std::optional<Transferred> transferred = {};
  /// When the rotational check ran and translation alone does not move the block.
  std::optional<Rotation> rotation = {};
};

struct Batch {
  std::uint32_t number = 0;  ///< from 1
  std::vector<topology::BlockId> blocks = {};
  Volume volume = {};
};

struct Analysis {
  /// One a block that has a free face in the state it is judged in, is not fixed, and is removable; in order of block
  /// id.
  std::vector<Judgement> judgements = {};
  std::vector<Batch> batches = {};
  /// Blocks that something is open to but that no direction lets go, in the state they are judged in last; ascending.
  std::vector<topology::BlockId> tapered = {};
  /// Unstable blocks are left (key, without batch): they would have left in the next batch.
  bool stopped_at_max_batches = false;
  bool force_transfer = false;
  RotationCheck rotation = RotationCheck::off;  ///< as asked
  /// Blocks of which only a part was cut (topology::Block::truncated) and of which that part does not tell whether they
  /// move. When there is one, nothing else of the analysis holds, and a larger window is needed.
  std::vector<topology::BlockId> undecided = {};
  /// Largest |r + sum N n - s| over the sum of the applied forces, both before and after transfer: rounding of the
  /// statics.
  double equilibrium_residual = 0;
};

/// What only the border of the domain holds.
struct DomainHeld {
  std::vector<topology::BlockId> blocks = {};  ///< ascending
  /// How those of them move that move by themselves; ascending.
  struct Alone {
    topology::BlockId block;
    Mode mode = Mode::stable;
    geometry::Vec3 direction = {};
    Force net = {};
    double factor_of_safety = 0;
  };
  std::vector<Alone> alone = {};
  Volume volume = {};
  Area free_area = {};  ///< of their free faces
  Area all_free = {};   ///< of all free faces
  /// So many of `blocks` move only together with others (key_groups.hpp).
  std::size_t together = 0;
};

}  // namespace cleave::stability
