#pragma once

#include "cleave/scene/keys.hpp"

namespace cleave::scene {

[[nodiscard]] const KeyTable& elastic_scene_keys();  ///< elastic bodies
[[nodiscard]] const KeyTable& elastic_keys();
[[nodiscard]] const KeyTable& contact_scene_keys();  ///< bodies in contact

}  // namespace cleave::scene
