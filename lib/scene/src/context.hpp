#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cleave/core/quantity.hpp"
#include "cleave/scene/parse.hpp"
#include "cleave/scene/scene.hpp"
#include "table_reader.hpp"

namespace cleave::scene {

/// What the parsers of the sections share.
struct Context {
  Problems& problems;
  const ReadFile& read_file;
  double north = 0;          ///< degrees; added to every dip direction
  bool triangulate = false;  ///< nonplanar = "triangulate"
  IdVector<SetId, NamedSet> sets{};
  std::vector<InputFile> files{};
  std::vector<topology::Termination> terminations{};

  /// The set of that name, made when new.
  [[nodiscard]] SetId set_named(const std::string& name);
  /// Reads a file named under `key`; reports a refusal there. Each file is listed once.
  [[nodiscard]] std::optional<LoadedFile> file(const TableReader& table, std::string_view key);
  /// Dip direction clockwise from +y, in [0, 360).
  [[nodiscard]] DipDirection turned(double dip_direction) const;
};

// One a section; every problem is reported, and the result is then not to be used.
[[nodiscard]] std::optional<geometry::Solid> parse_domain(Context& context, const TableReader& root);
void parse_joints(Context& context, const TableReader& root, std::vector<MeasuredJoint>& joints);
void parse_joint_sets(Context& context, const TableReader& root, std::vector<RandomSet>& joint_sets);
void parse_properties(Context& context, const TableReader& root);
[[nodiscard]] Rock parse_rock(const TableReader& root);
void parse_excavations(Context& context, const TableReader& root, const std::optional<geometry::Solid>& domain,
                       std::vector<Excavation>& excavations);
struct ParsedStability {
  std::optional<StabilitySettings> settings;
  std::vector<std::uint32_t> free_domain_tags;
};
[[nodiscard]] ParsedStability parse_stability(const TableReader& root, const std::optional<geometry::Solid>& domain,
                                              bool has_excavations);
/// Stages of the excavations and [sequence]; empty when all are of one stage.
[[nodiscard]] std::optional<SequenceSettings> parse_sequence(const TableReader& root,
                                                             const std::vector<Excavation>& excavations);
[[nodiscard]] MicroBlocks parse_micro_blocks(const TableReader& root);
[[nodiscard]] OutputSettings parse_output(const TableReader& root);

/// Adds notes on a scene that is not wrong: joints outside the domain, no joints at all, strengths that nobody stated.
void find_notes(const Scene& scene, const TableReader& root);

/// Friction as a number of degrees or a distribution table.
[[nodiscard]] std::optional<FrictionLaw> parse_friction(const TableReader& table, std::string_view key);

}  // namespace cleave::scene
