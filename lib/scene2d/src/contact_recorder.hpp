#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "carriers.hpp"
#include "cleave/dbem/world.hpp"
#include "cleave/scene2d/contact.hpp"
#include "contact_bodies.hpp"
#include "motion_trail.hpp"

namespace cleave::scene {

/// What a recorder adds up from step to step beside the result.
struct ContactTally {
  dbem::PerMethod<std::uint64_t> shares{}, solves{};
  double lowest = 0;                             ///< energy less the work done, J/m
  double scale = 0;                              ///< of momentum, N s/m
  bem::Vec2 expected;                            ///< momentum that weight and supports gave
  std::vector<double> largest;                   ///< force of each tie, N/m
  std::vector<std::optional<double>> broken_at;  ///< s
  MotionTrail trail;
  bool hit = false;  ///< something hit, or slip turned round: errors of first order
};

/// Follows a run and writes down what is asked for.
class Recorder final {
 public:
  /// `world` at its start.
  Recorder(const ContactScene& scene, const PreparedBodies& prepared, const dbem::World& world, ContactResult& result);

  [[nodiscard]] bool something_hit() const { return tally_.hit; }
  [[nodiscard]] const ContactTally& tally() const { return tally_; }
  /// Goes on from what another one added up; the result is that one's, too.
  void go_on(const ContactTally& tally) { tally_ = tally; }

  void step(const dbem::StepReport& report);
  void row(const dbem::StepReport& report);
  void frame(double time);
  /// After the last step.
  void finish();

 private:
  [[nodiscard]] std::vector<bem::Vec2> displacements() const;
  void finish_bolts();
  /// Where bodies lie, and where they would if their supports had not taken them along.
  struct Places {
    std::vector<ContactPlacement> now, own;
  };
  [[nodiscard]] Places places() const;
  /// What a step made of the bodies.
  void bodies_moved(double time);
  /// At the corners of an elastic body.
  [[nodiscard]] std::vector<NodeStress> stress_of(std::size_t body) const;

  const ContactScene& scene_;
  const PreparedBodies& prepared_;
  const dbem::World& world_;
  ContactResult& result_;
  std::vector<bem::Vec2> local_;
  std::vector<std::vector<std::uint32_t>> carriers_;  // of each body, see carriers_of
  std::vector<double> capacities_;                    // of each tie, N/m
  std::vector<std::uint8_t> touching_;                // bodies, after the last step
  ContactTally tally_;
  double gravity_ = 0, angular_ = 0;
  bem::Vec2 momentum_, weight_;
  bool grounded_ = false, loaded_ = false;
};

}  // namespace cleave::scene
