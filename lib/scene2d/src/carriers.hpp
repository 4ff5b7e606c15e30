#pragma once

#include <cstdint>
#include <vector>

#include "cleave/scene2d/contact.hpp"

namespace cleave::scene {

/// Of each body: the supports that it lies on at the start, itself or through others, where one of them moves of
/// itself; else none. What such a body does is judged by the way of its supports.
[[nodiscard]] std::vector<std::vector<std::uint32_t>> carriers_of(const ContactScene& scene,
                                                                  const std::vector<ContactBodyResult>& bodies);

/// Of the supports of a body the one that it has moved from farthest: how far that one went itself.
[[nodiscard]] bem::Vec2 carried_by(const std::vector<std::uint32_t>& carriers, std::uint32_t body,
                                   const std::vector<ContactPlacement>& places,
                                   const std::vector<ContactBodyResult>& bodies);

}  // namespace cleave::scene
