#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cleave/core/rng.hpp"
#include "cleave/dfn/sample.hpp"

namespace cleave::dfn::detail {

/// Names a set in a realization: where its streams come from.
struct SetStreams {
  std::uint64_t seed, realization;
  std::size_t set;
  [[nodiscard]] Rng of(Draw what, std::uint32_t index) const {
    return Rng{{.seed = seed, .realization = realization, .purpose = stream_purpose(set, what), .index = index}};
  }
};

/// Joints on Poisson planes: Veneziano, Dershowitz, hierarchical, MIT. `planes` are the planes that meet the domain,
/// `older` the joints of the sets that the model names.
[[nodiscard]] std::vector<SampledJoint> on_planes(const JointSet& set, std::span<const SampledJoint> planes,
                                                  std::span<const std::span<const SampledJoint>> older,
                                                  const DomainBox& domain, const SetStreams& streams);
[[nodiscard]] std::vector<SampledJoint> orthogonal(const JointSet& set, const DomainBox& domain,
                                                   const SetStreams& streams);
[[nodiscard]] std::vector<SampledJoint> mosaic(const JointSet& set, const DomainBox& domain, const SetStreams& streams);
/// Cuts the joints where they end on older ones.
void terminate(std::vector<SampledJoint>& joints, std::span<const std::span<const SampledJoint>> older,
               double probability, const SetStreams& streams);

/// How far from where they are drawn polygons come that are shifted and turned (MIT); 0 for other models.
[[nodiscard]] double reach_of_moves(const JointSet& set);

/// Box grown by a part of its diagonal, so that what is drawn in it reaches beyond the domain.
[[nodiscard]] DomainBox slightly_grown(const DomainBox& domain) noexcept;

}  // namespace cleave::dfn::detail
