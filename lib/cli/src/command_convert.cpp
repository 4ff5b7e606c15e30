#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <expected>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>

#include "cleave/core/expected.hpp"
#include "cleave/core/overloaded.hpp"
#include "cleave/core/text.hpp"
#include "cleave/core/version.hpp"
#include "cleave/exchange/exports.hpp"
#include "cleave/io/mesh.hpp"
#include "cleave/io/network_write.hpp"
#include "cleave/report/write.hpp"
#include "commands.hpp"
#include "convert_input.hpp"

namespace cleave::cli {
namespace {

bool is_network(const std::string& extension) { return extension == ".fab" || extension == ".dat"; }
bool is_mesh(const std::string& extension) {
  return extension == ".obj" || extension == ".stl" || extension == ".ply" || is_network(extension);
}

std::optional<report::ExportFormat> format_of(const std::string& extension) {
  const auto names = report::export_names();
  const auto found = std::ranges::find(names, extension, &report::ExportName::ending);
  return found == names.end() ? std::nullopt : std::optional{found->format};
}

struct Converted {
  std::string bytes;
  std::string summary;  ///< what was written, in words
  std::vector<std::string> notes;
};

Converted faces_as(const io::MeshData& mesh, const std::string& extension) {
  const std::array<std::string, 2> comments{"written by cleave " CLEAVE_VERSION,
                                            "unit as in the file it was converted from; z up; no offset"};
  Converted result;
  result.bytes = extension == ".obj"   ? io::write_obj(mesh, comments)
                 : extension == ".fab" ? io::write_fab(mesh)
                 : extension == ".dat" ? io::write_dfnworks_polygons(mesh)
                 : extension == ".ply" ? io::write_ply(mesh, comments)
                                       : io::write_stl_text(mesh);
  result.summary = fmt::format("{} faces, {} vertices", mesh.faces(), mesh.vertices.size());
  return result;
}

Converted blocks_as(const report::Cells& cells, const std::string& extension, const std::string& title) {
  Converted result;
  if (const auto format = format_of(extension)) {
    auto exported = report::export_blocks(cells, *format, title);
    result.bytes = std::move(exported.bytes);
    result.notes = std::move(exported.notes);
  } else {
    result.bytes = report::blocks_vtu(cells, nullptr, {.title = title, .scene_file = {}});
  }
  std::vector<topology::BlockId> blocks = cells.block;
  std::ranges::sort(blocks);
  const auto repeated = std::ranges::unique(blocks);
  const std::size_t count = blocks.size() - repeated.size();
  result.summary = fmt::format("{} blocks in {} cells, {} vertices", count, cells.size(), cells.points.size());
  return result;
}

std::expected<Converted, std::string> convert(const ConvertInput& input, const std::string& in,
                                              const std::string& out) {
  const std::string extension = extension_of(out);
  const std::string title = std::filesystem::path{in}.filename().string();
  if (const auto* mesh = std::get_if<io::MeshData>(&input.content)) {
    if (is_mesh(extension)) return faces_as(*mesh, extension);
    CLEAVE_TRY(ConvertedBlocks blocks, blocks_of(*mesh, in));
    Converted converted = blocks_as(blocks.cells, extension, title);
    converted.notes.insert(converted.notes.begin(), blocks.notes.begin(), blocks.notes.end());
    return converted;
  }
  if (is_network(extension))
    return std::unexpected(out + ":1: OUT: holds fractures, not blocks; give a scene or a file of joints as IN");
  return blocks_as(*std::get_if<report::Cells>(&input.content), extension, title);
}

ExitCode wrong(const std::string& message) {
  print_error(message);
  return ExitCode::wrong_input;
}

}  // namespace

std::string extension_of(const std::string& path) { return lower(std::filesystem::path{path}.extension().string()); }

ExitCode convert_file(const std::string& in, const std::string& out, std::uint64_t realization) {
  const std::string extension = extension_of(out);
  if (extension != ".vtu" && !is_network(extension) && !format_of(extension)) {
    std::string known = ".vtu .fab .dat";
    for (const report::ExportName& name : report::export_names()) known += fmt::format(" {}", name.ending);
    return wrong(fmt::format("{}:1: OUT: the ending is not known; give one of {}", out, known));
  }
  std::error_code ignored;
  if (std::filesystem::is_directory(out, ignored))
    return wrong(fmt::format("{}:1: OUT: is a folder; name a file", out));
  const auto input = read_convert_input(in, realization);
  if (!input) return wrong(input.error());
  for (const std::string& note : input->notes) print("note: " + in + ": " + note + "\n");
  const auto converted = convert(*input, in, out);
  if (!converted) return wrong(converted.error());
  for (const std::string& note : converted->notes) print("note: " + out + ": " + note + "\n");
  if (const auto written = report::write_file(out, converted->bytes); !written) {
    print_error(describe(written.error()));
    return ExitCode::machine_failed;
  }
  print(fmt::format("{}: {}\n", out, converted->summary));
  return ExitCode::done;
}

}  // namespace cleave::cli
