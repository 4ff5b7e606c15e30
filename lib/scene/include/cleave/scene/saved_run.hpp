#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "cleave/core/sha256.hpp"
#include "cleave/scene/plan.hpp"
#include "cleave/scene/problem.hpp"
#include "cleave/scene/time_course.hpp"

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

// What must be the same, as bytes.
template <class A>
void archive(A& a, const TimeFunction& t) {
  a(static_cast<std::uint8_t>(t.kind), t.duration.si(), t.frequency.si());
}
template <class A, class V>
void archive(A& a, const TimeCourse<V>& c) {
  a(c.amplitude, c.time, c.record, c.step.si());
}

}  // namespace cleave::scene
