#pragma once

#include <string>
#include <string_view>

#include "integer_scene.hpp"

namespace cleave::testing {

/// The scene as a file for `cleave run`, with `note` as a comment on top: how crashes of the fuzzer and finds of the
/// comparison with the oracle are kept. An own domain solid (no box) cannot be written; its box is.
[[nodiscard]] std::string scene_to_toml(const IntegerScene& scene, std::string_view note = {});

}  // namespace cleave::testing
