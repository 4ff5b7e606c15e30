#pragma once

#include <cstdint>
#include <expected>
#include <string>
#include <variant>
#include <vector>

#include "cleave/exchange/exports.hpp"
#include "cleave/io/mesh.hpp"

namespace cleave::cli {

/// What `cleave convert` has read: faces, or blocks.
struct ConvertInput {
  std::variant<io::MeshData, report::Cells> content;
  std::vector<std::string> notes;
};

/// Reads IN: a folder of results, its blocks.vtu, a file of faces or joints, or a scene, by its ending. The error is
/// the whole message "FILE:LINE: KEY: what; remedy". A scene gives the joints of one of its realizations, with its sets
/// as groups; endless planes up to the domain's box.
[[nodiscard]] std::expected<ConvertInput, std::string> read_convert_input(const std::string& in,
                                                                          std::uint64_t realization);

struct ConvertedBlocks {
  report::Cells cells;
  std::vector<std::string> notes;
};
/// Each group of the mesh as a block, when all are closed; else what is wrong. Bent faces become triangles.
[[nodiscard]] std::expected<ConvertedBlocks, std::string> blocks_of(const io::MeshData& mesh, const std::string& in);

}  // namespace cleave::cli
