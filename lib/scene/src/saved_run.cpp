#include "cleave/scene/saved_run.hpp"

#include <fmt/format.h>

#include "cleave/core/overloaded.hpp"

namespace cleave::scene {

Problem refused(const SavedRun& saved, const StateKind& kind, const SavedError& error) {
  const auto because = [&](std::string what, std::string remedy) {
    return Problem{saved.name, 1, "state", std::move(what), std::move(remedy)};
  };
  return std::visit(
      overloaded{[&](NoSavedWorld) {
                   return because(fmt::format("is no state of {}", kind.run),
                                  fmt::format("name a {}, or the folder of its result", kind.file));
                 },
                 [&](SavedByOtherVersion) {
                   return because("was written by another version of cleave",
                                  "go on with that version, or begin again");
                 },
                 [&](DamagedWorld) { return because("is cut short or damaged", "restore the file, or begin again"); },
                 [&](SavedOfOtherWorld) {
                   return because(fmt::format("is of another scene: {} differ", kind.ties),
                                  "run the scene it was written for, or begin again");
                 }},
      error);
}

Problem too_far(const SavedRun& saved, const std::string& scene, const std::string& key, double duration, double time) {
  return {scene, 1, key, fmt::format("ends at {:.6g} s, but {} is of {:.6g} s", duration, saved.name, time),
          "give a longer duration, or begin again"};
}

}  // namespace cleave::scene
