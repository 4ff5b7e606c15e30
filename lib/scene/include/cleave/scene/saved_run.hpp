#pragma once

#include <string>
#include <string_view>

#include "cleave/core/sha256.hpp"
#include "cleave/scene/plan.hpp"
#include "cleave/scene/problem.hpp"

/// States of runs that a later run goes on from.
namespace cleave::scene {

/// How a kind of states is called.
struct StateKind {
  std::string_view run;   ///< "a run in contact"
  std::string_view file;  ///< "contact.state"
  std::string_view ties;  ///< what must be the same: "its bodies, joints, loads or points"
};
/// Why nothing goes on from it.
[[nodiscard]] Problem refused(const SavedRun& saved, const StateKind& kind, SavedFault fault);
/// It has come further than the scene asks for.
[[nodiscard]] Problem too_far(const SavedRun& saved, const std::string& scene, const std::string& key, double duration,
                              double time);

}  // namespace cleave::scene
