#include "cleave/scene/saved_run.hpp"

#include <fmt/format.h>

#include <utility>

namespace cleave::scene {

Problem refused(const SavedRun& saved, const StateKind& kind, SavedFault fault) {
  const auto because = [&](std::string what, std::string remedy) {
    return Problem{saved.name, 1, "state", std::move(what), std::move(remedy)};
  };
  switch (fault) {
    case SavedFault::foreign:
      return because(fmt::format("is no state of {}", kind.run),
                     fmt::format("name a {}, or the folder of its result", kind.file));
    case SavedFault::other_version:
      return because("was written by another version of cleave", "go on with that version, or begin again");
    case SavedFault::damaged:
    case SavedFault::inconsistent: return because("is cut short or damaged", "restore the file, or begin again");
    case SavedFault::other_world:
      return because(fmt::format("is of another scene: {} differ", kind.ties),
                     "run the scene it was written for, or begin again");
  }
  std::unreachable();
}

Problem too_far(const SavedRun& saved, const std::string& scene, const std::string& key, double duration, double time) {
  return {scene, 1, key, fmt::format("ends at {:.6g} s, but {} is of {:.6g} s", duration, saved.name, time),
          "give a longer duration, or begin again"};
}

}  // namespace cleave::scene
