#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "cleave/io/file.hpp"
#include "cleave/io/mesh.hpp"
#include "cleave/scene/common_keys.hpp"

namespace cleave::scene {

/// "obj" of "a/b.OBJ"; empty when there is none.
[[nodiscard]] std::string extension_of(std::string_view name);

/// True for the endings of files that hold polygons and surfaces: .dxf .ts .fab .dat.
[[nodiscard]] bool is_surfaces(std::string_view extension);
/// What such a file holds, when it is already read; reports what is wrong.
[[nodiscard]] std::optional<io::Surfaces> surfaces_of(InputContext& context, const LoadedFile& loaded);

/// The faces in a file that is already read: .obj .stl .ply .dxf .ts by its ending; reports what is wrong.
[[nodiscard]] std::optional<io::MeshData> mesh_of(InputContext& context, const TableReader& owner, std::string_view key,
                                                  const LoadedFile& loaded);

void report_read_error(Problems& problems, const io::ReadError& error);

}  // namespace cleave::scene
