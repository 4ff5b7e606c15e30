#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/core/quantity.hpp"
#include "cleave/scene/output.hpp"
#include "cleave/scene/problem.hpp"
#include "cleave/scene/table_reader.hpp"

/// What scenes of all kinds read alike.
namespace cleave::scene {

/// The files that a scene names, and its north.
struct InputContext {
  Problems& problems;
  const ReadFile& read_file;
  double north = 0;  ///< degrees; added to every dip direction
  std::vector<InputFile> files{};

  /// Reads a file named under `key`; reports a refusal there. Each file is listed once.
  [[nodiscard]] std::optional<LoadedFile> file(const TableReader& table, std::string_view key);
  /// Dip direction clockwise from +y, in [0, 360).
  [[nodiscard]] DipDirection turned(double dip_direction) const;
};

/// Of files of measured directions.
[[nodiscard]] Key declination_key();

[[nodiscard]] const KeyTable& project_keys();
[[nodiscard]] Project parse_project(const TableReader& root);
[[nodiscard]] const KeyTable& output_keys();
[[nodiscard]] OutputSettings parse_output(const TableReader& root);

/// The table [joints.NAME], which none of `names` goes by: an error with `what`, and the name that was meant or
/// `otherwise`.
void report_unused_joints(Problems& problems, std::uint32_t line, const std::string& name,
                          const std::vector<std::string_view>& names, std::string what, std::string otherwise);

/// "b.toml" of "a/b.toml".
[[nodiscard]] std::string file_name_of(const std::string& shown);

}  // namespace cleave::scene
