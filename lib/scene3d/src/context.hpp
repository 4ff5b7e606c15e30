#pragma once

#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "cleave/core/quantity.hpp"
#include "cleave/scene/common_keys.hpp"
#include "cleave/scene3d/scene.hpp"

namespace cleave::scene {

/// What the parsers of the sections share.
struct Context : InputContext {
  bool triangulate = false;  ///< nonplanar = "triangulate"
  IdVector<SetId, NamedSet> sets{};
  std::vector<topology::Termination> terminations{};

  /// The set of that name, made when new.
  [[nodiscard]] SetId set_named(const std::string& name);
};

// One a section; every problem is reported, and the result is then not to be used.
[[nodiscard]] std::optional<geometry::Solid> parse_domain(Context& context, const TableReader& root);
void parse_joints(Context& context, const TableReader& root, std::vector<MeasuredJoint>& joints);
void parse_joint_sets(Context& context, const TableReader& root, const std::vector<MeasuredJoint>& given,
                      std::vector<RandomSet>& joint_sets);
void parse_properties(Context& context, const TableReader& root);
[[nodiscard]] Rock parse_rock(const TableReader& root);
void parse_excavations(Context& context, const TableReader& root, const std::optional<geometry::Solid>& domain,
                       std::vector<Excavation>& excavations);
struct ParsedStability {
  std::optional<StabilitySettings> settings;
  std::vector<std::uint32_t> free_domain_tags;
};
[[nodiscard]] ParsedStability parse_stability(const Context& context, const TableReader& root,
                                              const std::optional<geometry::Solid>& domain,
                                              const std::vector<Excavation>& excavations);
/// Refuses largest key blocks of fewer than three sets, or of sets that have no one orientation.
void check_maximum_blocks(const Context& context, const std::optional<StabilitySettings>& stability,
                          const std::set<SetId>& used, const std::vector<RandomSet>& joint_sets);
/// Loads as a table states them, before they are added up.
struct StatedLoads {
  geometry::Vec3 seismic{0, 0, 0};  ///< force / weight, in the direction the rock is pushed
  std::optional<stability::WaterTable> water = {};
  std::optional<NumberLaw> water_level = {};  ///< m, where it is drawn; `water` has the median
  /// Mean water pressure in the joints of a set, in place of the table; `or_table`: the larger of both.
  struct SetPressure {
    SetId set;
    double pa;
    bool or_table = false;
  };
  std::vector<SetPressure> pressures = {};
  std::optional<UnitWeight> flow = {};  ///< of water whose pressures [flow] finds
  std::vector<stability::Surcharge> surcharges = {};
  std::vector<stability::PointForce> points = {};
  std::vector<stability::LineForce> lines = {};
  std::uint32_t line = 1;  ///< in the scene file
};
/// The free surface of that name; an error of `key` where neither an excavation nor a face of the domain has it.
[[nodiscard]] std::optional<stability::FreeSurface> free_surface(const TableReader& table, std::string_view key,
                                                                 const std::string& name,
                                                                 const std::optional<geometry::Solid>& domain,
                                                                 const std::vector<Excavation>& excavations);
/// Keys seismic, water, surcharge, point and line of [stability] or of one [[load]].
[[nodiscard]] StatedLoads parse_load_set(const Context& context, const TableReader& table,
                                         const std::optional<geometry::Solid>& domain,
                                         const std::vector<Excavation>& excavations);
[[nodiscard]] LoadSet checked(const Context& context, const StatedLoads& loads, geometry::Vec3 gravity);
/// The [[load]] tables, each with the loads of `base`.
[[nodiscard]] std::vector<LoadCase> parse_load_cases(const Context& context, const TableReader& root,
                                                     const std::optional<geometry::Solid>& domain,
                                                     const std::vector<Excavation>& excavations,
                                                     const StatedLoads& base, const std::optional<Targets>& target,
                                                     geometry::Vec3 gravity);
[[nodiscard]] std::optional<SupportSettings> parse_support(const Context& context, const TableReader& root,
                                                           const std::optional<geometry::Solid>& domain,
                                                           const std::vector<Excavation>& excavations,
                                                           const ParsedStability& stability);
/// support.shotcrete.
[[nodiscard]] const KeyTable& shotcrete_keys();
/// `free`: the sides of the domain that are.
void parse_shotcrete(const TableReader& owner, const std::optional<geometry::Solid>& domain,
                     const std::vector<Excavation>& excavations, const std::vector<std::uint32_t>& free,
                     SupportSettings& support);
/// Stages of the excavations and [sequence]; empty when all are of one stage. `supported`: there is a [support].
[[nodiscard]] std::optional<SequenceSettings> parse_sequence(const TableReader& root,
                                                             const std::vector<Excavation>& excavations,
                                                             bool supported);
/// [field_stress]; after [rock], the excavations and the sets that have joints.
[[nodiscard]] std::optional<FieldStressSettings> parse_field_stress(const TableReader& root, const Context& context,
                                                                    const std::set<SetId>& used, const Rock& rock,
                                                                    const std::vector<Excavation>& excavations);
/// [motion]; after what it releases.
[[nodiscard]] std::optional<MotionSettings> parse_motion(const TableReader& root,
                                                         const std::optional<StabilitySettings>& stability,
                                                         const std::optional<SequenceSettings>& sequence);
/// [flow]; after the sets that have joints.
[[nodiscard]] std::optional<FlowSettings> parse_flow(const TableReader& root, const Context& context,
                                                     const std::set<SetId>& used,
                                                     const std::optional<geometry::Solid>& domain);
/// Refuses water of [flow] in loads where none is found.
void check_flow_water(const Context& context, const std::optional<StabilitySettings>& stability,
                      const std::optional<FlowSettings>& flow, bool stages);
/// [mapped]; after the joint sets and the excavations.
[[nodiscard]] std::optional<MappedSettings> parse_mapped(Context& context, const TableReader& root,
                                                         const std::vector<RandomSet>& joint_sets,
                                                         const std::vector<Excavation>& excavations,
                                                         const std::optional<geometry::Solid>& domain);
[[nodiscard]] std::vector<ScanLine> parse_lines(const Context& context, const TableReader& root);
[[nodiscard]] MicroBlocks parse_micro_blocks(const TableReader& root);

/// Adds notes on a scene that is not wrong: joints outside the domain, no joints at all, strengths that nobody stated.
void find_notes(const Scene& scene, const TableReader& root);

/// Friction as a number of degrees or a distribution table.
[[nodiscard]] std::optional<FrictionLaw> parse_friction(const TableReader& table, std::string_view key);
/// A number or a distribution table of numbers; `min`, `max` are its limits where it states none.
[[nodiscard]] std::optional<NumberLaw> parse_number_law(const TableReader& table, std::string_view key, double min = 0,
                                                        double max = 1e3);
/// [monte_carlo]; empty when the scene has none.
[[nodiscard]] std::optional<MonteCarloSettings> parse_monte_carlo(const TableReader& root);

}  // namespace cleave::scene
