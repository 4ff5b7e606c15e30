#include "cleave/report/vtu.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include "cleave/report/modes.hpp"
#include "cleave/report/text.hpp"

namespace cleave::report {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are written as they lie in memory, little-endian");

template <class T>
constexpr std::string_view type_name() {
  if constexpr (std::is_same_v<T, double>) return "Float64";
  if constexpr (std::is_same_v<T, std::int64_t>) return "Int64";
  if constexpr (std::is_same_v<T, std::int32_t>) return "Int32";
  if constexpr (std::is_same_v<T, std::uint8_t>) return "UInt8";
}

// One header for the byte count, then the bytes, encoded as one run (what VTK expects of uncompressed inline data).
template <class T>
void append_array(std::string& out, std::string_view name, const std::vector<T>& values, int components = 1) {
  static_assert(!std::is_same_v<T, bool>);
  out += "<DataArray type=\"";
  out += type_name<T>();
  out += "\" Name=\"";
  out += name;
  if (components != 1) out += "\" NumberOfComponents=\"" + std::to_string(components);
  out += "\" format=\"binary\">";
  const std::uint64_t bytes = values.size() * sizeof(T);
  std::vector<std::byte> data(sizeof bytes + bytes);
  std::memcpy(data.data(), &bytes, sizeof bytes);
  if (bytes > 0) std::memcpy(std::span{data}.subspan(sizeof bytes).data(), values.data(), bytes);
  append_base64(out, data);
  out += "</DataArray>\n";
}

// Text in VTK XML: the codes of the characters, each string ended by 0.
void append_strings(std::string& out, std::string_view name, const std::vector<std::string>& texts) {
  out += "<Array type=\"String\" Name=\"";
  out += name;
  out += "\" NumberOfTuples=\"" + std::to_string(texts.size()) + "\" format=\"ascii\">";
  for (const std::string& text : texts) {
    for (const char c : text) out += std::to_string(static_cast<unsigned char>(c)) + ' ';
    out += "0 ";
  }
  out += "</Array>\n";
}

void append_points(std::string& out, const Cells& cells) {
  std::vector<double> flat;
  flat.reserve(3 * cells.points.size());
  for (const geometry::Vec3& p : cells.points) flat.insert(flat.end(), {p.x, p.y, p.z});
  out += "<Points>\n";
  append_array(out, "Points", flat, 3);
  out += "</Points>\n";
}

void append_analysis(std::string& out, const Cells& cells, const stability::Analysis& analysis) {
  struct Row {
    std::int32_t batch = -1;
    std::uint8_t mode = mode_not_judged;
    std::uint8_t key = 0;
    double factor = factor_when_unknown;
    std::uint8_t factor_known = 0;
    geometry::Vec3 net_force;
  };
  std::size_t blocks = 0;
  for (const topology::BlockId b : cells.block) blocks = std::max(blocks, b.index() + 1);
  std::vector<Row> rows(blocks);
  for (const stability::Judgement& j : analysis.judgements) {
    if (j.block.index() >= blocks) continue;
    Row& row = rows[j.block.index()];
    if (j.batch) row.batch = static_cast<std::int32_t>(*j.batch);
    row.mode = std::to_underlying(j.mode);
    row.key = j.key ? 1 : 0;
    row.net_force = j.net.si() * j.direction;
    if (!std::isnan(j.factor_of_safety)) {
      row.factor = std::isinf(j.factor_of_safety) ? factor_when_infinite : j.factor_of_safety;
      row.factor_known = std::isinf(j.factor_of_safety) ? 2 : 1;
    }
  }
  for (const topology::BlockId b : analysis.tapered) {
    if (b.index() < blocks) rows[b.index()].mode = std::to_underlying(stability::Mode::tapered);
  }
  const auto column = [&]<class T>(std::string_view name, T Row::* member) {
    std::vector<T> values;
    values.reserve(cells.size());
    for (const topology::BlockId b : cells.block) values.push_back(rows[b.index()].*member);
    append_array(out, name, values);
  };
  column("batch", &Row::batch);
  column("mode", &Row::mode);
  column("key", &Row::key);
  column("factor_of_safety", &Row::factor);
  column("factor_known", &Row::factor_known);
  std::vector<double> forces;
  for (const topology::BlockId b : cells.block) {
    const geometry::Vec3 f = rows[b.index()].net_force;
    forces.insert(forces.end(), {f.x, f.y, f.z});
  }
  append_array(out, "net_force", forces, 3);
}

}  // namespace

std::string blocks_vtu(const Cells& cells, const stability::Analysis* analysis, const VtuText& text) {
  std::string out;
  out.reserve(11 * (3 * cells.points.size() + cells.face_stream.size() + cells.connectivity.size() + 5 * cells.size()) +
              4096);
  // Two hyphens may not stand in a comment.
  std::string title = escape_xml(text.title);
  for (std::size_t i; (i = title.find("--")) != std::string::npos;) title.replace(i, 2, "- -");
  out += "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  out += "<!-- cleave " CLEAVE_VERSION "; scene: " + title +
         "; metres, x east, y north, z up, no offset subtracted; `block` counts from 0. A block with cavities is "
         "several cells of one"
         " `block`. factor_of_safety: 1e9 = infinite, -1 = none (see factor_known) -->\n";
  out +=
      "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n<UnstructuredGrid>\n";
  out += "<FieldData>\n";
  append_strings(out, "title", {text.title});
  append_strings(out, "scene_file", {text.scene_file});
  if (analysis != nullptr) {
    std::vector<std::string> names;
    for (const stability::Mode mode : all_modes) names.emplace_back(stability::name(mode));
    append_strings(out, "mode_names", names);
  }
  out += "</FieldData>\n";
  out += "<Piece NumberOfPoints=\"" + std::to_string(cells.points.size()) + "\" NumberOfCells=\"" +
         std::to_string(cells.size()) + "\">\n";
  append_points(out, cells);
  out += "<Cells>\n";
  append_array(out, "connectivity", cells.connectivity);
  append_array(out, "offsets", cells.ends);
  append_array(out, "types", std::vector<std::uint8_t>(cells.size(), 42));  // VTK_POLYHEDRON
  append_array(out, "faces", cells.face_stream);
  append_array(out, "faceoffsets", cells.face_ends);
  out += "</Cells>\n<CellData>\n";
  std::vector<std::int64_t> blocks;
  blocks.reserve(cells.size());
  for (const topology::BlockId b : cells.block) blocks.push_back(b.value());
  append_array(out, "block", blocks);
  append_array(out, "volume", cells.volume);
  if (!text.stage_of_block.empty()) {
    std::vector<std::int32_t> stages;
    stages.reserve(cells.size());
    for (const topology::BlockId b : cells.block) stages.push_back(text.stage_of_block[b.index()]);
    append_array(out, "stage", stages);
  }
  if (analysis != nullptr) append_analysis(out, cells, *analysis);
  out += "</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
  return out;
}

}  // namespace cleave::report
