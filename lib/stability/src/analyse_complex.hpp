#pragma once

#include "cleave/stability/analyse.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::stability {

/// `analyse` without the certificate: for the module's own tests on complexes made by hand.
[[nodiscard]] Analysis analyse_complex(const topology::BlockComplex& complex, const Settings& settings);

}  // namespace cleave::stability
