#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "cleave/core/quantity.hpp"
#include "cleave/geometry/vec3.hpp"
#include "cleave/topology/ids.hpp"

namespace cleave::stability {

/// How a block would move without friction: the projection of the resultant on the cone of admissible directions.
enum class Mode : std::uint8_t {
  falling,  ///< along the resultant, which has a part along gravity (theory: resultant in the cone)
  lifting,  ///< along the resultant, against gravity
  sliding,  ///< on one plane
  wedge,    ///< along the line of two planes
  stable,   ///< removable, but safe without friction (projection is zero)
  tapered,  ///< not removable: no admissible direction
};

/// A pressing joint plane of a block.
struct Pressing {
  topology::FaceId face;  ///< a face on that plane
  Force reaction;         ///< effective normal reaction, > 0 in compression
};

/// What the analysis says of one block in one state.
struct Judgement {
  topology::BlockId block;
  Mode mode = Mode::stable;
  bool key = false;                    ///< removable and unstable (net force > 0)
  std::optional<std::uint32_t> batch;  ///< 1, 2, ...: when it leaves; none for a block that stays (judged in the final state)
  geometry::Vec3 direction;            ///< unit vector of first motion; zero for stable and tapered
  Force weight;
  Force driving;                       ///< T >= 0
  Force resistance;                    ///< R >= 0
  Force net;                           ///< F = T - R, positive = unstable
  double factor_of_safety = 0;         ///< R/T; +inf when T = 0; 0 for falling without strength
  std::vector<Pressing> pressing;
  std::uint8_t cone_dimension = 0;     ///< 3 opens in a solid cone, 2 or 1 can only slide in a plane or along a line, 0 tapered
  bool tie = false;                    ///< two modes coincide to rounding; the one with fewer faces was taken
};

struct Batch {
  std::uint32_t number;  ///< from 1
  std::vector<topology::BlockId> blocks;
  Volume volume;
};

struct Analysis {
  /// One a block that has a free face in the state it is judged in, is not fixed, and is removable; in order of block id.
  std::vector<Judgement> judgements;
  std::vector<Batch> batches;
  bool stopped_at_max_batches = false;
};

}  // namespace cleave::stability
