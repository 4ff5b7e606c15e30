#pragma once

#include <string_view>

#include "cleave/exchange/exports.hpp"

/// One writer a format, for export_blocks.
namespace cleave::report::detail {

[[nodiscard]] Exported blocks_obj(const Cells& cells, std::string_view title);
[[nodiscard]] Exported blocks_ply(const Cells& cells, std::string_view title);
[[nodiscard]] Exported blocks_stl(const Cells& cells, std::string_view title);
enum class ThreedecVersion : std::uint8_t { five, seven };
[[nodiscard]] Exported blocks_threedec(const Cells& cells, std::string_view title, ThreedecVersion version);
[[nodiscard]] Exported blocks_lsdyna(const Cells& cells, std::string_view title);
[[nodiscard]] Exported blocks_nmm3d(const Cells& cells, std::string_view title);
[[nodiscard]] Exported section_dda(const Cells& cells, std::string_view title);

}  // namespace cleave::report::detail
