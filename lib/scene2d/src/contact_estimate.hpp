#pragma once

#include <array>
#include <functional>
#include <optional>

#include "body_runs.hpp"
#include "cleave/dbem/world.hpp"
#include "cleave/scene2d/contact.hpp"

/// The error of the steps of a run in contact, from runs with longer ones.
namespace cleave::scene {

/// From the changes between the run and three more, each with longer steps than the one before, relative. What falls
/// faster than the scheme does so by chance: `order` is 2, or 1 where something hit, and a change counts for no less
/// than that order leaves of those before it.
[[nodiscard]] ErrorEstimate estimate_of_steps(std::array<double, 3> changes, int order);

/// The same scene at its start, its step and the bounds of its steps so many times as long.
using WithLongerSteps = std::function<std::optional<dbem::World>(double longer)>;

/// Of a run that ended at `end`: the figures `error` and `no_estimate` of the result. False: `stop` ended it before.
[[nodiscard]] bool estimate_steps(const ContactScene& scene, const WithLongerSteps& with, const dbem::World& end,
                                  bool something_hit, const std::function<bool()>& stop, ContactResult& result);

}  // namespace cleave::scene
