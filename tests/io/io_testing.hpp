#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <string_view>

#include "cleave/io/file.hpp"
#include "cleave/io/mesh.hpp"

namespace cleave::io::testing {

inline std::filesystem::path data_file(std::string_view name) {
  return std::filesystem::path{CLEAVE_SOURCE_DIR} / "tests" / "data" / name;
}

inline std::string bytes_of(std::string_view name) { return read_file(data_file(name)).value(); }

inline double volume_of(const MeshData& mesh) {
  const auto solid = solid_of(mesh);
  EXPECT_TRUE(solid.has_value()) << describe(solid.error());
  return solid ? solid->volume().si() : 0;
}

/// A tetrahedron of volume 1/6.
inline constexpr std::string_view tetrahedron_obj =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

}  // namespace cleave::io::testing
