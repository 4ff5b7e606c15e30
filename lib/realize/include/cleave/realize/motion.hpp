#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "cleave/core/fields.hpp"
#include "cleave/core/quantity.hpp"
#include "cleave/geometry/vec3.hpp"
#include "cleave/motion/body.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::scene {

/// A block that was let go.
struct MotionBlock {
  topology::BlockId block;
  bool moved = false;                     ///< its centroid by more than a millimetre
  std::optional<Time> first_motion = {};  ///< when it had moved so far
  Length fall = {}, runout = {};          ///< of the centroid: downwards, and level
  double fastest = 0;                     ///< speed of the centroid
  geometry::Vec3 centroid;                ///< at the end, absolute
  bool left = false;                      ///< left the domain and was followed no further
};

/// Where the blocks are at one time, in the order of `MotionResult::blocks`.
struct MotionFrame {
  struct Place {
    geometry::Vec3 shift;  ///< of the centroid since the start
    motion::Turn turn;
    geometry::Vec3 velocity;
  };
  Time time;
  std::vector<Place> places;
};

struct MotionResult {
  bool converged = false;
  std::string stopped_why = {};  ///< when not
  bool at_rest = false;
  Time end = {};
  std::uint64_t steps = 0, walls = 0, contacts = 0;
  std::uint64_t may_be_locked = 0;  ///< the most blocks at a time in groups for which the law may have another answer
  std::uint64_t rough_steps = 0;    ///< in which the best answer found did not meet the law to what is accepted
  double missed_speed = 0;          ///< largest by which a contact missed the law in those
  double residual = 0;
  Length penetration = {};
  double overlap = 0;  ///< over the size of the smaller block
  double potential_lost = 0, kinetic = 0, dissipated = 0, energy_error = 0, momentum_error = 0;
  std::optional<Length> error = {};     ///< estimate: distance from a run with half the step
  std::optional<Time> determined = {};  ///< until then; chaotic impacts part the two runs after it
  std::vector<MotionBlock> blocks = {};
  std::vector<MotionFrame> frames = {};
  std::vector<std::string> notes = {};

  [[nodiscard]] std::uint64_t moved() const noexcept;
};
template <class V>
void fields(V& v, const MotionResult& x) {
  v("status",
    one_of(!x.converged        ? "stopped"
           : x.rough_steps > 0 ? "rough"
                               : "converged",
           {"converged", "rough", "stopped"}),
    "rough: the run went on with the best answers found where none met the contact law to 1e-5 (rough_steps, "
    "residual); "
    "stopped: a step could not be solved so or without overlap, and the run ends there");
  v("reason", when(!x.converged, x.stopped_why));
  v("at_rest", x.at_rest);
  v("end_s", x.end);
  v("steps", x.steps);
  v("residual", x.residual, "of the contact law, the worst of all steps");
  v("rough_steps", x.rough_steps, "steps that went on with an answer between 1e-5 and 1e-3");
  v("missed_speed_m_s", x.missed_speed, "largest velocity by which a contact missed the law in those steps");
  v("max_penetration_m", x.penetration, "deepest overlap before bodies were parted, of all steps");
  v("max_overlap_relative", x.overlap, "deepest overlap left, over the size of the smaller block");
  v("may_be_locked", x.may_be_locked,
    "the most blocks at a time in groups that rest in one answer of the contact law and move in another, or may");
  v("released", x.blocks.size(), "blocks let go");
  v("walls", x.walls, "blocks that never move and may be touched");
  v("moved", x.moved(), "blocks whose centroid moved by more than a millimetre");
  v("energy", group([&](auto& w) {
      w("potential_lost", x.potential_lost, "J");
      w("kinetic", x.kinetic, "J, at the end");
      w("dissipated", x.dissipated, "J, by friction, impacts and the scheme");
      w("relative_error", x.energy_error, "of the balance, over its largest term");
    }));
  v("momentum_relative_error", x.momentum_error);
  v("estimated_error_m", or_null(x.error ? x.error->si() : std::numeric_limits<double>::infinity()),
    "distance of corners from a run with half the step, until determined_s; null: error = false, or that run stopped");
  v("determined_s", x.determined, "time until which the two runs tell the same path: impacts are chaotic");
}

}  // namespace cleave::scene
