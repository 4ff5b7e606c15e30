#include "cleave/exchange/vtu_writer.hpp"

#include <algorithm>

namespace cleave::report {

static_assert(std::endian::native == std::endian::little, "arrays are written as they lie in memory, little-endian");

VtuWriter::VtuWriter(VtuFormat format, std::string_view comment, std::size_t reserve) : format_{format} {
  out_.reserve(reserve + 4096);
  out_ += "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  if (!comment.empty()) {
    std::string text = escape_xml(comment);
    // Two hyphens may not stand in a comment.
    for (std::size_t i; (i = text.find("--")) != std::string::npos;) text.replace(i, 2, "- -");
    out_ += "<!-- " + text + " -->\n";
  }
  out_ +=
      "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n<UnstructuredGrid>\n";
}

void VtuWriter::begin_array(std::string_view type, std::string_view name, int components) {
  out_.append("<DataArray type=\"").append(type).append("\" Name=\"").append(name);
  if (components != 1) out_ += "\" NumberOfComponents=\"" + std::to_string(components);
  out_ += format_ == VtuFormat::binary ? "\" format=\"binary\">" : "\" format=\"ascii\">";
}

// One header for the byte count, then the bytes, encoded as one run (what VTK expects of uncompressed inline data).
void VtuWriter::bytes(std::span<const std::byte> values) {
  const std::uint64_t count = values.size();
  std::vector<std::byte> data(sizeof count + count);
  std::memcpy(data.data(), &count, sizeof count);
  if (count > 0) std::memcpy(std::span{data}.subspan(sizeof count).data(), values.data(), count);
  append_base64(out_, data);
}

void VtuWriter::strings(std::string_view name, const std::vector<std::string>& texts) {
  out_.append("<Array type=\"String\" Name=\"").append(name);
  out_ += "\" NumberOfTuples=\"" + std::to_string(texts.size()) + "\" format=\"ascii\">";
  for (const std::string& text : texts) {
    for (const char c : text) out_ += std::to_string(static_cast<unsigned char>(c)) + ' ';
    out_ += "0 ";
  }
  out_ += "</Array>\n";
}

void VtuWriter::begin_piece(std::size_t points, std::size_t cells) {
  out_ += "<Piece NumberOfPoints=\"" + std::to_string(points) + "\" NumberOfCells=\"" + std::to_string(cells) + "\">\n";
}

void VtuWriter::vectors(std::string_view name, std::span<const geometry::Vec3> values) {
  std::vector<double> flat;
  flat.reserve(3 * values.size());
  for (const geometry::Vec3& v : values) flat.insert(flat.end(), {v.x, v.y, v.z});
  array(name, flat, 3);
}

void VtuWriter::points(std::span<const geometry::Vec3> points) {
  begin("Points");
  vectors("Points", points);
  end("Points");
}

void VtuWriter::begin_cells(const std::vector<std::int64_t>& connectivity, const std::vector<std::int64_t>& ends,
                            const std::vector<std::uint8_t>& types) {
  begin("Cells");
  array("connectivity", connectivity);
  array("offsets", ends);
  array("types", types);
}

void VtuWriter::cells(const std::vector<std::int64_t>& connectivity, const std::vector<std::int64_t>& ends,
                      const std::vector<std::uint8_t>& types) {
  begin_cells(connectivity, ends, types);
  end("Cells");
}

void VtuWriter::polyhedra(const std::vector<std::int64_t>& connectivity, const std::vector<std::int64_t>& ends,
                          const std::vector<std::int64_t>& faces, const std::vector<std::int64_t>& face_ends) {
  begin_cells(connectivity, ends, std::vector<std::uint8_t>(ends.size(), 42));  // VTK_POLYHEDRON
  array("faces", faces);
  array("faceoffsets", face_ends);
  end("Cells");
}

std::string VtuWriter::finish() && {
  out_ += "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
  return std::move(out_);
}

std::string pvd(std::span<const std::pair<double, std::string>> files) {
  std::string out =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" "
      "byte_order=\"LittleEndian\">\n<Collection>\n";
  for (const auto& [time, file] : files) {
    out += "<DataSet timestep=\"" + number(time) + "\" part=\"0\" file=\"" + file + "\"/>\n";
  }
  return out + "</Collection>\n</VTKFile>\n";
}

std::string frame_file(std::string_view name, std::size_t frame) {
  std::string digits = std::to_string(frame);
  digits.insert(0, 4 - std::min<std::size_t>(4, digits.size()), '0');
  return std::string{name} + "_" + digits + ".vtu";
}

}  // namespace cleave::report
