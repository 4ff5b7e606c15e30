#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "contacts.hpp"
#include "supported_body.hpp"

namespace cleave::stability {

/// Pressures on open faces that bring blocks to their targets.
class FacePressures final {
 public:
  /// `pushing`: what blocks of later batches pass on.
  FacePressures(const topology::BlockComplex& complex, const Settings& settings, const Analysis& pushing,
                const SupportPlan& plan, std::function<bool(topology::BlockId)> gone);

  /// Pa on the open faces that the block moves out of; 0 where it reaches its target without, infinite where no
  /// pressure does.
  [[nodiscard]] double needed(topology::BlockId block, const Body& body) const;
  /// The same without what other blocks pass to it.
  [[nodiscard]] double needed_alone(topology::BlockId block);
  /// The same where the pressure is on the blocks that pass to it, too: at what these need themselves they pass nothing
  /// on.
  [[nodiscard]] double needed_with_givers(topology::BlockId block) { return with_givers(block, 1); }

 private:
  struct Giver {
    topology::BlockId block;
    geometry::Vec3 force;
    double enough = 0;  ///< Pa, at which it passes nothing on
  };

  /// The block as it stands while batch `batch` is judged.
  [[nodiscard]] Body body_of(topology::BlockId block, std::uint32_t batch, std::span<const Giver> givers);
  [[nodiscard]] double with_givers(topology::BlockId block, std::uint32_t batch);
  [[nodiscard]] double enough_for(const Judgement& giver);

  const topology::BlockComplex* complex_;
  const Settings* settings_;
  const Analysis* pushing_;
  const SupportPlan* plan_;
  std::function<bool(topology::BlockId)> gone_;
  Model model_;
  std::map<topology::BlockId, std::vector<const Judgement*>> givers_;  ///< by receiver
  std::map<topology::BlockId, double> enough_;                         ///< Pa, of givers that were asked
};

}  // namespace cleave::stability
