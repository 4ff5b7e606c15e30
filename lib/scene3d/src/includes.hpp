#pragma once

#include <vector>

#include "cleave/scene/table_reader.hpp"

namespace cleave::scene {

/// Joints, joint sets and their properties of the files of `include`, as if they stood in the scene: arrays of tables
/// are put behind the scene's own, tables of [joints] beside them. Lines of problems are those of the included file.
/// What is stated twice is refused: a file, a table of [joints] in two of the files, a name of two joint sets. The
/// files, in order.
[[nodiscard]] std::vector<InputFile> take_includes(TomlTable& scene, Problems& problems, const ReadFile& read_file);

}  // namespace cleave::scene
