#include <algorithm>
#include <utility>

#include "cleave/core/assert.hpp"
#include "detail/block_maker.hpp"

namespace cleave::topology::detail {

namespace {

bool comes_before(const CutInput& input, Index one, Index other) {
  const auto place = [&](Index joint) {
    return std::pair{joint < input.precedence.size() ? input.precedence[joint] : none, joint};
  };
  return place(one) < place(other);
}

}  // namespace

Nature BlockParts::nature(Index half_face) const {
  const PlaneFace& face = arrangement.faces[half_face / 2];
  Nature nature;
  const Facet* domain = nullptr;
  const Facet* excavation = nullptr;
  for (Index c = face.first_cover; c < face.first_cover + face.cover_count; ++c) {
    const Facet& facet = prepared.facets[arrangement.covers[c]];
    switch (facet.owner) {
      case Owner::joint:
        if (nature.joint == none || comes_before(input, facet.owner_index, nature.joint)) {
          nature.joint = facet.owner_index;
        }
        break;
      case Owner::domain:
        if (domain == nullptr) domain = &facet;
        break;
      case Owner::window: break;
      case Owner::excavation:
        if (excavated != nullptr && (*excavated)[facet.owner_index] == 0) break;
        if (excavation == nullptr || facet.owner_index < excavation->owner_index) excavation = &facet;
        break;
    }
  }
  if (block_of[half_face ^ 1U] != none) return nature;
  nature.joint = none;
  nature.role = Role::free;
  if (excavation != nullptr) {
    nature.excavation = excavation->owner_index;
    nature.tag = excavation->tag;
  } else if (domain == nullptr) {
    CLEAVE_ASSERT(excavated != nullptr || prepared.windowed);
    if (prepared.windowed) nature.role = Role::window;  // else on rock that has fallen: free
  } else {
    nature.tag = domain->tag;
    const auto& free = input.free_domain_tags;
    if (std::ranges::find(free, domain->tag) == free.end()) nature.role = Role::fixed;
  }
  return nature;
}

}  // namespace cleave::topology::detail
