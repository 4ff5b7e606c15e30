#include <algorithm>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "cell_faces.hpp"
#include "cleave/exchange/text.hpp"
#include "convex_parts.hpp"
#include "export_writers.hpp"

namespace cleave::report::detail {
namespace {

using geometry::Vec3;

/// Edges shorter than this share of the model's size make 3DEC drop blocks.
constexpr double shortest_edge_share = 1e-4;
constexpr std::size_t blocks_named = 20;

/// One command that makes the part; loops clockwise seen from outside.
void append_part(std::string& out, const ConvexPart& part, std::uint32_t block, ThreedecVersion version) {
  const bool seven = version == ThreedecVersion::seven;
  const std::string number_text = std::to_string(block);
  out +=
      seven ? "block create polyhedron group 'block_" + number_text + "'" : "poly region " + std::to_string(block + 1);
  for (const auto& face : part.faces) {
    out += " &\n  face";
    for (auto point = face.rbegin(); point != face.rend(); ++point) {
      const Vec3 p = part.points[*point];
      if ((point - face.rbegin()) % 3 == 0 && point != face.rbegin()) out += " &\n   ";
      out += seven ? " (" : " ";
      append_number(out, p.x);
      out += ',';
      append_number(out, p.y);
      out += ',';
      append_number(out, p.z);
      if (seven) out += ')';
    }
  }
  out += '\n';
}

void append_join(std::string& out, std::uint32_t block, ThreedecVersion version) {
  switch (version) {
    case ThreedecVersion::seven: out += "block join on range group 'block_" + std::to_string(block) + "'\n"; return;
    case ThreedecVersion::five: out += "hide\nshow region " + std::to_string(block + 1) + "\njoin on\nshow\n"; return;
  }
}

ConvexPart as_it_is(const Cells& cells, std::size_t cell) {
  ConvexPart part;
  std::map<std::uint32_t, std::uint32_t> numbers;
  for (const CellFace& face : faces_of_cell(cells, cell)) {
    auto& corners = part.faces.emplace_back();
    for (const std::uint32_t point : face) {
      const auto [at, is_new] = numbers.try_emplace(point, static_cast<std::uint32_t>(part.points.size()));
      if (is_new) part.points.push_back(cells.points[point]);
      corners.push_back(at->second);
    }
  }
  return part;
}

/// Every corner lies behind the planes of all faces, to rounding.
bool looks_convex(const ConvexPart& part) {
  double size = 0;
  for (const Vec3& p : part.points) size = std::max(size, norm(p - part.points[0]));
  for (const auto& face : part.faces) {
    Vec3 area;
    const Vec3 o = part.points[face[0]];
    for (std::size_t i = 1; i + 1 < face.size(); ++i) {
      area += cross(part.points[face[i]] - o, part.points[face[i + 1]] - o);
    }
    if (!(norm(area) > 0)) return false;
    const Vec3 normal = geometry::normalized(area);
    for (const Vec3& p : part.points) {
      if (dot(p - o, normal) > 1e-11 * size) return false;
    }
  }
  return true;
}

double shortest_edge(const ConvexPart& part) {
  double shortest = std::numeric_limits<double>::infinity();
  for (const auto& face : part.faces) {
    for (std::size_t i = 0; i < face.size(); ++i) {
      shortest = std::min(shortest, norm(part.points[face[i]] - part.points[face[(i + 1) % face.size()]]));
    }
  }
  return shortest;
}

std::string list_of(const std::vector<std::uint32_t>& blocks) {
  std::string text;
  for (std::size_t i = 0; i < std::min(blocks.size(), blocks_named); ++i) {
    text += (i == 0 ? "" : ", ") + std::to_string(blocks[i]);
  }
  return text + (blocks.size() > blocks_named ? ", ..." : "");
}

}  // namespace

Exported blocks_threedec(const Cells& cells, std::string_view title, ThreedecVersion version) {
  const double size = cells.size() == 0 ? 0 : norm(extent_of(cells).size());
  Exported result;
  std::string& out = result.bytes;
  out += "; " + header_of(title) +
         "\n; metres, x east, y north, z up, no offset subtracted; experimental: not run in 3DEC\n";
  out += version == ThreedecVersion::seven
             ? "; commands of version 7 and later; group 'block_N' is block N; concave blocks are joined convex parts\n"
             : "; commands of version 5 and before; region N + 1 is block N; concave blocks are joined convex parts\n";
  std::vector<std::uint32_t> short_edges;
  std::vector<std::uint32_t> left_out;
  for (std::size_t first = 0; first < cells.size();) {
    const std::uint32_t block = cells.block[first].value();
    std::string text;
    std::size_t parts = 0;
    double shortest = std::numeric_limits<double>::infinity();
    bool whole = true;
    std::size_t cell = first;
    for (; cell < cells.size() && cells.block[cell].value() == block; ++cell) {
      std::vector<ConvexPart> convex{as_it_is(cells, cell)};
      if (!looks_convex(convex.front())) {
        auto cut = convex_parts(cells, cell);
        whole = whole && cut.has_value();
        convex = cut ? std::move(*cut) : std::vector<ConvexPart>{};
      }
      for (const ConvexPart& part : convex) {
        append_part(text, part, block, version);
        shortest = std::min(shortest, shortest_edge(part));
      }
      parts += convex.size();
    }
    first = cell;
    if (!whole) {
      left_out.push_back(block);
      out += "; block " + std::to_string(block) + " left out: it could not be cut into convex parts\n";
      continue;
    }
    out += "; block " + std::to_string(block) + "\n" + text;
    if (parts > 1) append_join(out, block, version);
    if (shortest < shortest_edge_share * size) short_edges.push_back(block);
  }
  if (!short_edges.empty()) {
    result.notes.push_back("3DEC may drop " + std::to_string(short_edges.size()) +
                           " blocks with edges shorter than 1e-4 of the model: " + list_of(short_edges));
  }
  if (!left_out.empty()) {
    result.notes.push_back(std::to_string(left_out.size()) +
                           " blocks could not be cut into convex parts and are left out: " + list_of(left_out));
  }
  return result;
}

}  // namespace cleave::report::detail
