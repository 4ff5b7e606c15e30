#pragma once

#include "cleave/scene/keys.hpp"

namespace cleave::scene {

[[nodiscard]] const KeyTable& survey_keys();

}  // namespace cleave::scene
