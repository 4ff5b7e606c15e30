#pragma once

/// Random systems of blocks in contact, as a list that can be built again with some blocks taken out or turned in
/// space.

#include <array>
#include <cstdint>
#include <set>
#include <vector>

#include "cleave/core/rng.hpp"
#include "handmade.hpp"
#include "statics.hpp"

namespace cleave::testing_complex {

using geometry::Vec3;
using topology::BlockId;

struct Contact {
  BlockId block, other;
  Vec3 inward;
  double area;
  std::uint32_t joint;
};

struct Description {
  std::vector<double> volumes;
  std::vector<bool> fixed, free;
  std::vector<Contact> contacts;

  /// Without the blocks `gone`: their neighbours get free faces, they themselves become rock that touches nothing.
  [[nodiscard]] topology::BlockComplex build(const std::set<BlockId>& gone = {}) const {
    handmade::Complex complex;
    for (std::size_t i = 0; i < volumes.size(); ++i) {
      const bool out = gone.contains(BlockId{i});
      const auto id = fixed[i] || out ? complex.fixed_block(volumes[i]) : complex.block(volumes[i]);
      if (free[i] && !out) complex.free_face(id);
    }
    for (const Contact& c : contacts) {
      const bool block_gone = gone.contains(c.block), other_gone = gone.contains(c.other);
      if (!block_gone && !other_gone) complex.contact(c.block, c.other, c.inward, c.area, c.joint);
      if (block_gone && !other_gone) complex.free_face(c.other);
      if (other_gone && !block_gone) complex.free_face(c.block);
    }
    return complex.build();
  }
};

/// A heap: block i leans on earlier blocks (0 is rock) from random sides, mostly from below.
inline Description random(std::uint64_t seed, std::size_t count) {
  Rng rng{seed};
  Description d;
  d.volumes.push_back(1);
  d.fixed.push_back(true);
  d.free.push_back(false);
  for (std::size_t i = 1; i < count; ++i) {
    d.volumes.push_back(0.5 + rng.uniform());
    d.fixed.push_back(false);
    d.free.push_back(rng.between(0, 2) == 0);
    const auto contacts = rng.between(1, 5);
    for (std::int64_t c = 0; c < contacts; ++c) {
      const auto other = rng.between(0, 3) == 0
                             ? 0
                             : rng.between(std::max<std::int64_t>(0, static_cast<std::int64_t>(i) - 6),
                                           static_cast<std::int64_t>(i) - 1);
      const bool small = rng.between(0, 3) == 0;
      const auto digit = [&] { return static_cast<double>(rng.between(-1, 1)); };
      Vec3 n = small ? Vec3{digit(), digit(), digit()} : Vec3{rng.normal(), rng.normal(), rng.normal() + 0.5};
      if (n == Vec3{}) n = {0, 0, 1};
      d.contacts.push_back({BlockId{i}, BlockId{static_cast<std::size_t>(other)}, n, 0.2 + rng.uniform(),
                            static_cast<std::uint32_t>(rng.between(0, 4))});
    }
  }
  return d;
}

inline stability::Settings random_settings(std::uint64_t seed) {
  Rng rng{StreamKey{.seed = seed, .purpose = 1}};
  const auto one = [&] {
    return statics::strength(50 * rng.uniform(), rng.between(0, 1) == 0 ? 0 : 0.3 * rng.uniform());
  };
  return statics::settings({one(), one(), one(), one(), one()});
}

}  // namespace cleave::testing_complex
