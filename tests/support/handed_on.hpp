#pragma once

/// What tests of the force transfer share: complexes written down by hand, and what a block is after transfer.

#include <gtest/gtest.h>

#include <cmath>

#include "analyse_complex.hpp"
#include "handmade.hpp"
#include "random_complex.hpp"
#include "statics.hpp"

namespace cleave::stability::handed_on {

using geometry::dot;
using geometry::norm;
using geometry::Vec3;
using handmade::Complex;
using handmade::dip_vector;
using handmade::radians;
using handmade::upward;
using statics::find;
using statics::settings;
using statics::strength;

inline const Transferred& after(const Analysis& analysis, topology::BlockId block) {
  return *find(analysis, block)->transferred;
}

}  // namespace cleave::stability::handed_on
