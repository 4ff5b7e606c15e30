#pragma once

#include <optional>
#include <string>

#include "cleave/dbem/world.hpp"
#include "cleave/scene/problem.hpp"
#include "cleave/scene2d/contact.hpp"
#include "contact_recorder.hpp"

/// The state of a run in contact as bytes: what a later run goes on from.
namespace cleave::scene {

/// Where a run has come to, beside its world and its records.
struct ContactPlace {
  double step = 0;        ///< s, the first one of the scene
  double next = 0;        ///< s, the longest that was not cut: what the next one may be
  double unbalanced = 1;  ///< of a run to rest
  double last_time = 0, last_step = 0, last_residual = 0;
  std::uint64_t last_iterations = 0;
};

/// All of a run so far: the world, and what was written down of it.
[[nodiscard]] std::string state_of(const ContactScene& scene, const dbem::World& world, const ContactTally& tally,
                                   const ContactPlace& place, const ContactResult& result);

/// Takes it up again, in a world and a result that are at their start. Nothing: it was taken up. Where it is none of
/// this scene, world, recorder and place are as they were.
[[nodiscard]] std::optional<Problem> go_on_from(const SavedRun& saved, const ContactScene& scene, dbem::World& world,
                                                Recorder& recorder, ContactPlace& place, ContactResult& result);

}  // namespace cleave::scene
