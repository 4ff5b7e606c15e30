#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string>
#include <system_error>

#include "cleave/io/mesh.hpp"
#include "cleave/io/mesh_write.hpp"
#include "cleave/report/write.hpp"
#include "commands.hpp"

namespace cleave::cli {
namespace {

std::string ending_of(const std::string& path) {
  std::string ending = std::filesystem::path{path}.extension().string();
  for (char& c : ending) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return ending;
}

bool is_mesh(const std::string& ending) { return ending == ".obj" || ending == ".stl" || ending == ".ply"; }

/// The bytes that `out` becomes.
std::string text_of(const io::MeshData& mesh, const std::string& out) {
  const std::array<std::string, 2> comments{"written by cleave 0.1.0",
                                            "unit as in the file it was converted from; z up; no offset"};
  const std::string ending = ending_of(out);
  if (ending == ".obj") return io::write_obj(mesh, comments);
  if (ending == ".ply") return io::write_ply(mesh, comments);
  return io::write_stl_text(mesh);
}

ExitCode wrong(const std::string& message) {
  complain(message);
  return ExitCode::wrong_input;
}

}  // namespace

ExitCode convert_file(const std::string& in, const std::string& out) {
  if (!is_mesh(ending_of(in)))
    return wrong(fmt::format("{}:1: IN: the ending is not known; give .obj, .stl or .ply", in));
  if (!is_mesh(ending_of(out)))
    return wrong(fmt::format("{}:1: OUT: the ending is not known; give .obj, .stl or .ply", out));
  std::error_code ignored;
  if (std::filesystem::is_directory(out, ignored))
    return wrong(fmt::format("{}:1: OUT: is a folder; name a file", out));
  const auto mesh = io::read_mesh(in);
  if (!mesh) {
    const io::ReadError& error = mesh.error();
    return wrong(fmt::format("{}:{}: file: {}; {}", error.file, std::max(1U, error.line), error.what, error.remedy));
  }
  for (const std::string& note : mesh->notes) say("note: " + in + ": " + note + "\n");
  if (const auto written = report::write_file(out, text_of(*mesh, out)); !written) {
    complain(describe(written.error()));
    return ExitCode::machine_failed;
  }
  say(fmt::format("{}: {} faces, {} vertices\n", out, mesh->faces(), mesh->vertices.size()));
  return ExitCode::done;
}

}  // namespace cleave::cli
