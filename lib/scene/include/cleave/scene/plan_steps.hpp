#pragma once

#include <string>
#include <vector>

#include "cleave/scene/keys.hpp"
#include "cleave/scene/plan.hpp"

namespace cleave::scene {

/// Names at each stage that runs those keys of the scene which it takes by their declaration.
void add_inputs(const KeyTable& keys, const std::vector<std::string>& given, Plan& plan);

/// The plan of a two-dimensional scene, which does its `work` and writes `files`.
[[nodiscard]] Plan plan_of_bodies(Step work, const std::string& why, const std::string& files, bool report);

}  // namespace cleave::scene
