#include "cleave/stability/analyse.hpp"

#include <cstddef>
#include <utility>

#include "cleave/core/assert.hpp"
#include "contacts.hpp"
#include "verdict.hpp"

namespace cleave::stability {
namespace {

Settings with_factors(Settings settings, double friction, double cohesion, double water) {
  const PartialFactors& p = settings.partial;
  auto partial = PartialFactors::make(p.friction() / friction, p.cohesion() / cohesion, p.weight());
  ActionSpec spec = settings.actions.spec();
  if (spec.water) spec.water->unit_weight *= water;
  if (spec.flow) spec.flow->unit_weight *= water;
  for (auto& pressure : spec.joint_pressure) {
    if (pressure) *pressure *= water;
  }
  auto actions = Actions::make(std::move(spec));
  CLEAVE_ASSERT(partial.has_value() && actions.has_value());
  settings.partial = *partial;
  settings.actions = *std::move(actions);
  return settings;
}

}  // namespace

std::vector<Sensitivity> sensitivity(const topology::AuditedComplex& complex, const Settings& settings,
                                     const Analysis& analysis, double share) {
  std::vector<Sensitivity> rows;
  if (analysis.batches.empty()) return rows;
  for (const topology::BlockId id : analysis.batches.front().blocks) rows.push_back({.block = id, .share = share});
  const auto fill = [&](const Settings& with, auto&& put) {
    Model model{complex.complex(), with};
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const Verdict v = judge(model.contacts(rows[i].block, 1), model.applied_forces(rows[i].block, 1), with);
      put(rows[i], v.factor_of_safety);
    }
  };
  fill(settings, [](Sensitivity& row, double f) { row.base = f; });
  for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
    const double factor = side == 0 ? 1 - share : 1 + share;
    fill(with_factors(settings, factor, 1, 1), [&](Sensitivity& row, double f) { row.friction[side] = f; });
    fill(with_factors(settings, 1, factor, 1), [&](Sensitivity& row, double f) { row.cohesion[side] = f; });
    if (settings.actions.dry()) {
      for (Sensitivity& row : rows) row.water[side] = row.base;
    } else {
      fill(with_factors(settings, 1, 1, factor), [&](Sensitivity& row, double f) { row.water[side] = f; });
    }
  }
  return rows;
}

}  // namespace cleave::stability
