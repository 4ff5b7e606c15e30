#include "cleave/exchange/exports.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "cleave/scene/output.hpp"
#include "export_writers.hpp"

namespace cleave::report {
namespace {

/// In the order of the formats, as `scene::known_exports`.
constexpr std::array<std::string_view, 8> endings{".obj", ".ply", ".stl", ".3ddat", ".3dec", ".k", ".nmm3d", ".dda"};
static_assert(endings.size() == scene::known_exports.size() && scene::known_exports.back() == "dda" &&
              static_cast<std::size_t>(ExportFormat::dda) == endings.size() - 1);
constexpr auto names = [] {
  std::array<ExportName, endings.size()> out{};
  for (std::size_t k = 0; k < out.size(); ++k) {
    out[k] = {static_cast<ExportFormat>(k), scene::known_exports[k], endings[k]};
  }
  return out;
}();

Exported written(const Cells& cells, ExportFormat format, std::string_view title) {
  switch (format) {
    case ExportFormat::obj: return detail::blocks_obj(cells, title);
    case ExportFormat::ply: return detail::blocks_ply(cells, title);
    case ExportFormat::stl: return detail::blocks_stl(cells, title);
    case ExportFormat::threedec: return detail::blocks_threedec(cells, title, detail::ThreedecVersion::seven);
    case ExportFormat::threedec5: return detail::blocks_threedec(cells, title, detail::ThreedecVersion::five);
    case ExportFormat::lsdyna: return detail::blocks_lsdyna(cells, title);
    case ExportFormat::nmm3d: return detail::blocks_nmm3d(cells, title);
    case ExportFormat::dda: return detail::section_dda(cells, title);
  }
  std::unreachable();
}

}  // namespace

std::span<const ExportName> export_names() noexcept { return names; }

const ExportName& name_of(ExportFormat format) { return names[static_cast<std::size_t>(format)]; }

Exported export_blocks(const Cells& cells, ExportFormat format, std::string_view title) {
  Exported result = written(cells, format, title);
  for (const topology::BlockId block : cells.with_cavities) {
    result.notes.push_back("block " + std::to_string(block.value()) +
                           " has so many cavities that it was not cut open: it is one surface of several shells, which "
                           "other programs may take for solid");
  }
  return result;
}

}  // namespace cleave::report
