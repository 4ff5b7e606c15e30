#pragma once

#include <expected>
#include <optional>
#include <string>

#include "cleave/scene/run_result.hpp"
#include "cleave/topology/cut.hpp"

namespace cleave::scene {

/// The blocks and what is known of them. `window` when only the rock near free faces was cut.
struct System {
  std::expected<topology::AuditedComplex, topology::Certificate> complex;
  topology::CutReport report;
  std::optional<stability::Analysis> analysis;
  std::string hash, key_hash;
  std::optional<WindowInfo> window;
  std::optional<SequenceResult> sequence = {};
};

}  // namespace cleave::scene
