#pragma once

#include <cstdint>

namespace cleave::cli {

/// How the program ends; the numbers are part of the contract.
enum class ExitCode : std::uint8_t {
  done = 0,
  bug = 1,             ///< of cleave
  wrong_input = 2,     ///< nothing was written
  machine_failed = 3,  ///< disk full, memory limit, no permission
  check_failed = 4,    ///< the run finished but a stated check did not hold
  interrupted = 130,
};

}  // namespace cleave::cli
