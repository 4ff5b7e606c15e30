#include <utility>

#include "cleave/core/fields.hpp"
#include "cleave/stochastic/ensemble.hpp"
#include "number.hpp"

/// What is averaged over realizations: quantities of one, and ratios of sums over all.
namespace cleave::stochastic {

double pressure_over_area(const Record& r) { return r.free_m2 > 0 ? r.all.support_transferred_n / r.free_m2 : 0; }

namespace {

/// Key blocks that the stress across their joints does not hold, or of which it is not known.
double clamped_count(const Record& r) { return r.clamped ? number(r.all.count - r.clamped->held) : 0; }
/// Nothing where blocks were not judged together.
SupportedTogether together_of(const Record& r) {
  return r.support ? r.support->groups.value_or(SupportedTogether{}) : SupportedTogether{};
}
Quantity by_case(Quantity quantity) {
  quantity.by_case = true;
  return quantity;
}
Quantity at_part(Quantity quantity) {
  quantity.at_parts = true;
  return by_case(quantity);
}
Quantity of_lifting(Quantity quantity) {
  quantity.lifted = true;
  return by_case(quantity);
}
Quantity at_stages(Quantity quantity) {
  quantity.stages = true;
  return quantity;
}
Quantity of_turning(Quantity quantity) {
  quantity.turning = true;
  return by_case(quantity);
}
Quantity of_target(Quantity quantity) {
  quantity.at_target = true;
  return by_case(quantity);
}
StayingAtTarget target_of(const Record& r) { return r.at_target.value_or(StayingAtTarget{}); }
Quantity over_openings(Quantity quantity) {
  quantity.openings = true;
  return quantity;
}
PartTally tally_at(const Record& r, Part part) {
  const auto at = static_cast<std::size_t>(std::to_underlying(part));
  return at < r.at_parts.size() ? r.at_parts[at] : PartTally{};
}
template <Part part>
double fails_at(const Record& r) {
  return tally_at(r, part).count > 0 ? 1 : 0;
}
template <Part part>
double volume_at(const Record& r) {
  return tally_at(r, part).volume.si();
}
template <Part part>
double pressure_at(const Record& r) {
  return r.support ? r.support->pressures[std::to_underlying(part)].si() : 0;
}
Quantity of_joints(Quantity quantity) {
  quantity.flow = true;
  return quantity;
}
Quantity of_water(Quantity quantity) {
  quantity.water = true;
  return of_joints(quantity);
}
FlowTally flow_of(const Record& r) { return r.flow.value_or(FlowTally{}); }
WaterTally water_of(const Record& r) { return flow_of(r).water.value_or(WaterTally{}); }
/// Key blocks that move away from all their joints against gravity.
double lifted_count(const Record& r) { return number(r.all.modes[std::to_underlying(stability::Mode::lifting)]); }
/// Something is not held when all is excavated.
bool support_fails(const Record& r) {
  return r.support && (r.support->not_held > 0 || r.support->failing_bodies > 0 || together_of(r).not_held > 0);
}
double clamped_volume(const Record& r) { return r.clamped ? r.all.volume_m3 - r.clamped->held_volume.si() : 0; }

}  // namespace

bool Quantity::asked_in(const Record& record) const noexcept {
  if (whole_system && !record.whole) return false;
  if (clamped && !record.clamped) return false;
  if (at_parts && record.at_parts.empty()) return false;
  if (openings && !(record.free_m2 > 0)) return false;
  if (flow && !record.flow) return false;
  if (water && !(record.flow && record.flow->water)) return false;
  if (stages && !record.supported_stages) return false;
  if (turning && !record.turning) return false;
  if (at_target && !record.at_target) return false;
  if (support) return record.support && (!groups || record.support->groups);
  return !groups || record.groups.has_value();
}

namespace {

/// Of blocks one by one, and of the network.
const std::vector<Quantity>& block_quantities() {
  static const std::vector<Quantity> all{
      by_case({"key_block_volume_m3", [](const Record& r) { return r.all.volume_m3; }, true, false, true}),
      by_case({"key_block_count", [](const Record& r) { return number(r.all.count); }, true, false, true}),
      by_case({"key_block_largest_m3", [](const Record& r) { return r.all.largest_m3; }, true, false, true}),
      by_case({"support_force_n", [](const Record& r) { return r.all.support_n; }, true, false, true}),
      {"support_force_transferred_n", [](const Record& r) { return r.all.support_transferred_n; }, true, false, false},
      {"first_batch_volume_m3", [](const Record& r) { return r.first.volume_m3; }, true, false, true},
      {"first_batch_count", [](const Record& r) { return number(r.first.count); }, true, false, true},
      {"first_batch_largest_m3", [](const Record& r) { return r.first.largest_m3; }, true, false, true},
      {"first_batch_support_force_n", [](const Record& r) { return r.first.support_n; }, true, false, false},
      {"first_batch_support_force_transferred_n", [](const Record& r) { return r.first.support_transferred_n; }, true,
       false, false},
      {"batches", [](const Record& r) { return static_cast<double>(r.batches); }, true, false, false},
      by_case({"probability_of_failure", [](const Record& r) { return r.all.count > 0 ? 1.0 : 0.0; }, true, false,
               false, false, true}),
      at_part({"probability_of_failure_roof", fails_at<Part::roof>, true, false, false, false, true}),
      at_part({"key_block_volume_roof_m3", volume_at<Part::roof>, true, false, true}),
      at_part({"probability_of_failure_walls", fails_at<Part::walls>, true, false, false, false, true}),
      at_part({"key_block_volume_walls_m3", volume_at<Part::walls>, true, false, true}),
      at_part({"probability_of_failure_floor", fails_at<Part::floor>, true, false, false, false, true}),
      at_part({"key_block_volume_floor_m3", volume_at<Part::floor>, true, false, true}),
      at_part({"probability_of_failure_faces", fails_at<Part::faces>, true, false, false, false, true}),
      at_part({"key_block_volume_faces_m3", volume_at<Part::faces>, true, false, true}),
      over_openings({"support_pressure_pa", pressure_over_area, true, false, true}),
      {"largest_support_pressure_pa", [](const Record& r) { return r.largest_pressure_pa; }, true, false, true, false,
       false, false, false, true},
      of_lifting({"lifted_count", lifted_count, true, false, false}),
      of_turning({"probability_of_turning", [](const Record& r) { return r.turning.value_or(0) > 0 ? 1.0 : 0.0; }, true,
                  false, false, false, true}),
      by_case({"domain_held_count", [](const Record& r) { return r.border ? number(r.border->count) : 0; }, true, false,
               true}),
      by_case({"domain_held_volume_m3", [](const Record& r) { return r.border ? r.border->volume.si() : 0; }, true,
               false, true}),
      by_case({"slight_taper_count", [](const Record& r) { return r.tapered ? number(r.tapered->count) : 0; }, true,
               false, false}),
      by_case({"slight_taper_volume_m3", [](const Record& r) { return r.tapered ? r.tapered->volume.si() : 0; }, true,
               false, false}),
      of_target({"domain_held_at_target_count", [](const Record& r) { return number(target_of(r).border.count); }, true,
                 false, true}),
      of_target({"domain_held_at_target_volume_m3", [](const Record& r) { return target_of(r).border.volume.si(); },
                 true, false, true}),
      of_target({"slight_taper_at_target_count", [](const Record& r) { return number(target_of(r).tapered.count); },
                 true, false, false}),
      of_target({"slight_taper_at_target_volume_m3", [](const Record& r) { return target_of(r).tapered.volume.si(); },
                 true, false, false}),
      {"block_count", [](const Record& r) { return number(r.blocks); }, false, true, true},
      {"block_mean_volume_m3", [](const Record& r) { return r.blocks > 0 ? r.rock_m3 / number(r.blocks) : 0; }, false,
       true, false},
      {"concave_block_count", [](const Record& r) { return number(r.concave_blocks); }, false, true, false},
      {"joint_count", [](const Record& r) { return number(r.joints); }, false, false, false},
  };
  return all;
}

/// Of a support design.
const std::vector<Quantity>& support_quantities() {
  static const std::vector<Quantity> all{
      by_case({"support_blocks_needing", [](const Record& r) { return r.support ? number(r.support->needing) : 0; },
               true, false, false, true}),
      by_case({"support_needed", [](const Record& r) { return r.support && r.support->needing > 0 ? 1.0 : 0.0; }, true,
               false, false, true, true}),
      by_case({"support_blocks_not_held", [](const Record& r) { return r.support ? number(r.support->not_held) : 0; },
               true, false, true, true}),
      by_case({"support_not_held_m3", [](const Record& r) { return r.support ? r.support->not_held_m3 : 0; }, true,
               false, true, true}),
      by_case({"support_missing_force_n", [](const Record& r) { return r.support ? r.support->missing_n : 0; }, true,
               false, true, true}),
      at_part({"required_pressure_roof_pa", pressure_at<Part::roof>, true, false, true, true}),
      at_part({"required_pressure_walls_pa", pressure_at<Part::walls>, true, false, true, true}),
      at_part({"required_pressure_floor_pa", pressure_at<Part::floor>, true, false, true, true}),
      by_case({"required_pressure_faces_pa", pressure_at<Part::faces>, true, false, true, true}),
      by_case({"support_fails", [](const Record& r) { return support_fails(r) ? 1.0 : 0.0; }, true, false, false, true,
               true}),
      at_stages({"support_fails_at_a_stage",
                 [](const Record& r) {
                   const bool before = r.supported_stages && r.supported_stages->failing > 0;
                   return before || support_fails(r) ? 1.0 : 0.0;
                 },
                 true, false, false, true, true}),
      by_case({"support_spot_bolts", [](const Record& r) { return r.support ? number(r.support->spot_bolts) : 0; },
               true, false, false, true}),
      by_case({"support_groups_not_held", [](const Record& r) { return number(together_of(r).not_held); }, true, false,
               true, true, false, true}),
      by_case({"support_groups_not_held_m3", [](const Record& r) { return together_of(r).not_held_volume.si(); }, true,
               false, true, true, false, true}),
      by_case({"support_leaves_doubt",
               [](const Record& r) { return together_of(r).in_doubt > 0 || together_of(r).too_many ? 1.0 : 0.0; }, true,
               false, false, true, true, true}),
  };
  return all;
}

/// Of blocks judged together, and of the stress across joints.
const std::vector<Quantity>& group_quantities() {
  static const std::vector<Quantity> all{
      by_case({"key_group_count", [](const Record& r) { return r.groups ? number(r.groups->moving) : 0; }, true, false,
               true, false, false, true}),
      by_case({"key_group_volume_m3", [](const Record& r) { return r.groups ? r.groups->moving_volume.si() : 0; }, true,
               false, true, false, false, true}),
      by_case({"groups_in_doubt_count", [](const Record& r) { return r.groups ? number(r.groups->in_doubt) : 0; }, true,
               false, true, false, false, true}),
      by_case({"groups_in_doubt_m3", [](const Record& r) { return r.groups ? r.groups->in_doubt_volume.si() : 0; },
               true, false, true, false, false, true}),
      by_case({"groups_leave_doubt",
               [](const Record& r) { return r.groups && (r.groups->in_doubt > 0 || r.groups->too_many) ? 1.0 : 0.0; },
               true, false, false, false, true, true}),
      {"clamped_key_block_count", clamped_count, true, false, true, false, false, false, true},
      {"clamped_key_block_volume_m3", clamped_volume, true, false, true, false, false, false, true},
      {"clamped_undecided_count", [](const Record& r) { return r.clamped ? number(r.clamped->undecided) : 0; }, true,
       false, true, false, false, false, true},
      {"clamped_probability_of_failure", [](const Record& r) { return clamped_count(r) > 0 ? 1.0 : 0.0; }, true, false,
       false, false, true, false, true},
  };
  return all;
}

/// Of joints that hang together, and of the water in them.
const std::vector<Quantity>& flow_quantities() {
  static const std::vector<Quantity> all{
      of_joints({"cluster_count", [](const Record& r) { return number(flow_of(r).clusters); }, false, false, true}),
      of_joints(
          {"largest_cluster_share", [](const Record& r) { return flow_of(r).largest_share; }, false, false, true}),
      of_joints({"opening_share", [](const Record& r) { return flow_of(r).opening_share; }, false, false, true}),
      of_joints({"backbone_share", [](const Record& r) { return flow_of(r).backbone_share; }, false, false, true}),
      of_joints({"probability_of_connection", [](const Record& r) { return flow_of(r).backbone_share > 0 ? 1.0 : 0.0; },
                 false, false, false, false, true}),
      of_water({"inflow_m3_s", [](const Record& r) { return water_of(r).inflow.si(); }, false, false, true}),
      of_water({"inflow_low_m3_s", [](const Record& r) { return water_of(r).low.si(); }, false, false, false}),
      of_water({"inflow_high_m3_s", [](const Record& r) { return water_of(r).high.si(); }, false, false, false}),
      of_water({"probability_of_inflow", [](const Record& r) { return water_of(r).inflow > FlowRate{} ? 1.0 : 0.0; },
                false, false, false, false, true}),
      of_water({"wet_share", [](const Record& r) { return water_of(r).wet_share; }, false, false, true}),
      of_water({"inflow_not_settled", [](const Record& r) { return water_of(r).settled ? 0.0 : 1.0; }, false, false,
                false, false, true}),
  };
  return all;
}

}  // namespace

const std::vector<Quantity>& quantities() {
  static const std::vector<Quantity> all = [] {
    std::vector<Quantity> list;
    for (const auto* part : {&block_quantities(), &support_quantities(), &group_quantities(), &flow_quantities()}) {
      list.insert(list.end(), part->begin(), part->end());
    }
    return list;
  }();
  return all;
}

const std::vector<double>& pressures_pa() {
  static const std::vector<double> all{1e2, 2e2, 5e2, 1e3, 2e3, 5e3, 1e4, 2e4, 5e4,
                                       1e5, 2e5, 5e5, 1e6, 2e6, 5e6, 1e7, 2e7, 5e7};
  return all;
}

const Quantity* quantity_named(std::string_view word) {
  for (const Quantity& q : quantities()) {
    if (q.name == word) return &q;
  }
  for (const Quantity& q : quantities()) {
    for (const std::string_view unit : {"_m3_s", "_m3", "_n", "_pa"}) {
      if (q.name.ends_with(unit) && q.name.substr(0, q.name.size() - unit.size()) == word) return &q;
    }
  }
  return nullptr;
}

std::string_view name_of(Method method) noexcept { return enum_name(method); }

const std::vector<Ensemble::Ratio>& Ensemble::ratios() {
  static const auto all_count = [](const Record& r) { return number(r.all.count); };
  static const auto first_count = [](const Record& r) { return number(r.first.count); };
  static const std::vector<Ratio> list{
      {"key_block_mean_volume_m3", [](const Record& r) { return r.all.volume_m3; }, all_count, true, false},
      {"support_force_per_block_n", [](const Record& r) { return r.all.support_n; }, all_count, true, false},
      {"support_force_transferred_per_block_n", [](const Record& r) { return r.all.support_transferred_n; }, all_count,
       true, false},
      {"share_falling", [](const Record& r) { return number(r.all.modes[0]); }, all_count, true, false},
      {"share_lifting", [](const Record& r) { return number(r.all.modes[1]); }, all_count, true, false},
      {"share_sliding", [](const Record& r) { return number(r.all.modes[2]); }, all_count, true, false},
      {"share_wedge", [](const Record& r) { return number(r.all.modes[3]); }, all_count, true, false},
      {"share_tetrahedral", [](const Record& r) { return number(r.all.shapes[0]); }, all_count, true, false},
      {"share_pentahedral", [](const Record& r) { return number(r.all.shapes[1]); }, all_count, true, false},
      {"share_hexahedral", [](const Record& r) { return number(r.all.shapes[2]); }, all_count, true, false},
      {"share_higher", [](const Record& r) { return number(r.all.shapes[3]); }, all_count, true, false},
      {"share_other", [](const Record& r) { return number(r.all.shapes[4]); }, all_count, true, false},
      {"share_concave", [](const Record& r) { return number(r.all.concave); }, all_count, true, false},
      {"sphericity", [](const Record& r) { return r.all.sphericity_sum; }, all_count, true, false},
      {"first_batch_mean_volume_m3", [](const Record& r) { return r.first.volume_m3; }, first_count, true, false},
      {"first_batch_support_force_per_block_n", [](const Record& r) { return r.first.support_n; }, first_count, true,
       false},
      {"first_batch_share_falling", [](const Record& r) { return number(r.first.modes[0]); }, first_count, true, false},
      {"first_batch_share_lifting", [](const Record& r) { return number(r.first.modes[1]); }, first_count, true, false},
      {"first_batch_share_sliding", [](const Record& r) { return number(r.first.modes[2]); }, first_count, true, false},
      {"first_batch_share_wedge", [](const Record& r) { return number(r.first.modes[3]); }, first_count, true, false},
      {"first_batch_share_tetrahedral", [](const Record& r) { return number(r.first.shapes[0]); }, first_count, true,
       false},
      {"first_batch_share_pentahedral", [](const Record& r) { return number(r.first.shapes[1]); }, first_count, true,
       false},
      {"first_batch_share_hexahedral", [](const Record& r) { return number(r.first.shapes[2]); }, first_count, true,
       false},
      {"first_batch_share_higher", [](const Record& r) { return number(r.first.shapes[3]); }, first_count, true, false},
      {"first_batch_share_other", [](const Record& r) { return number(r.first.shapes[4]); }, first_count, true, false},
      {"first_batch_sphericity", [](const Record& r) { return r.first.sphericity_sum; }, first_count, true, false},
      {"concave_block_share", [](const Record& r) { return number(r.concave_blocks); },
       [](const Record& r) { return number(r.blocks); }, false, true},
  };
  return list;
}

}  // namespace cleave::stochastic
