#pragma once

#include <cstdint>

namespace cleave::stability {

/// Where the force transfer of Fu (2014, 4.3) can be read in two ways. The first of each is the default; it never lets
/// a force vanish without saying so.
struct TransferReadings {
  enum class Reach : std::uint8_t {
    any_earlier,  ///< to blocks of every earlier batch
    adjacent,     ///< to the batch just before only; the shares of others are lost (`Transferred::lost`)
  };
  enum class Force : std::uint8_t {
    net,      ///< T - R, what friction does not hold
    driving,  ///< T: an upper bound
  };
  enum class Along : std::uint8_t {
    motion,   ///< in line: along the direction of motion, by projected area
    normals,  ///< across each face only compression along its normal; planes that press take up the rest
  };
  enum class Receiver : std::uint8_t {
    judged_anew,  ///< mode and direction under the forces received
    keeps_mode,   ///< the mode from before, with its formulas
  };
  enum class Stabilised : std::uint8_t {
    keeps_batch,   ///< a block that the forces received make stable stays in its batch, and is listed as such
    batches_anew,  ///< it holds its place, and the batches are found again
  };
  enum class Interface : std::uint8_t {
    ignored,   ///< any shear crosses a face; `Transferred::shear_ratio` tells
    strength,  ///< no more shear than friction and cohesion of the face allow; the rest is lost
  };
  Reach reach = Reach::any_earlier;
  Force force = Force::net;
  Along along = Along::motion;
  Receiver receiver = Receiver::judged_anew;
  Stabilised stabilised = Stabilised::keeps_batch;
  Interface interface = Interface::ignored;
  friend bool operator==(const TransferReadings&, const TransferReadings&) = default;
};

}  // namespace cleave::stability
