#include "cleave/exchange/dangling.hpp"

#include <algorithm>
#include <string_view>

#include "cleave/core/text.hpp"
#include "cleave/core/version.hpp"
#include "cleave/exchange/text.hpp"
#include "cleave/exchange/triangulate.hpp"
#include "cleave/exchange/vtu_writer.hpp"

namespace cleave::report {
namespace {

std::vector<std::uint32_t> without_spikes(const std::vector<topology::VertexId>& loop) {
  std::vector<std::uint32_t> out;
  for (const topology::VertexId v : loop) out.push_back(v.value());
  for (bool changed = true; changed && out.size() >= 3;) {
    changed = false;
    for (std::size_t i = 0; i < out.size() && out.size() >= 3; ++i) {
      const std::size_t count = out.size();
      if (out[(i + count - 1) % count] != out[(i + 1) % count]) continue;
      // ... a, tip, a ...: the tip and one a go.
      const std::size_t next = (i + 1) % count;
      out.erase(out.begin() + static_cast<std::ptrdiff_t>(std::max(i, next)));
      out.erase(out.begin() + static_cast<std::ptrdiff_t>(std::min(i, next)));
      changed = true;
      break;
    }
  }
  return out;
}

const topology::Dangling& dangling_of(const topology::BlockComplex& complex) {
  static const topology::Dangling nothing{};
  return complex.dangling() ? *complex.dangling() : nothing;
}

std::string one_line(std::string_view text) {
  std::string out = on_one_line(text);
  std::ranges::replace(out, '\\', ' ');
  return out;
}

}  // namespace

DanglingMesh make_dangling_mesh(const topology::BlockComplex& complex) {
  DanglingMesh mesh;
  std::vector<geometry::Vec3> positions;
  positions.reserve(complex.vertices().size());
  for (const topology::VertexId v : complex.vertices().ids()) positions.push_back(complex.position(v));
  std::vector<std::uint32_t> number(positions.size(), UINT32_MAX);
  const auto& pieces = dangling_of(complex).pieces;
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    FaceLoops loops;
    for (const auto& loop : pieces[p].loops) {
      auto clean = without_spikes(loop);
      if (clean.size() >= 3) loops.push_back(std::move(clean));
    }
    if (loops.empty()) continue;
    const auto n = complex.planes()[pieces[p].plane].unit_normal();
    for (const Triangle& triangle : triangulate(loops, positions, {n[0], n[1], n[2]})) {
      std::array<std::uint32_t, 3> corners{};
      for (std::size_t k = 0; k < 3; ++k) {
        std::uint32_t& own = number[triangle[k]];
        if (own == UINT32_MAX) {
          own = static_cast<std::uint32_t>(mesh.points.size());
          mesh.points.push_back(positions[triangle[k]]);
        }
        corners[k] = own;
      }
      mesh.triangles.push_back(corners);
      mesh.piece.push_back(static_cast<std::uint32_t>(p));
    }
  }
  return mesh;
}

std::string dangling_vtu(const topology::BlockComplex& complex, std::string_view title) {
  const DanglingMesh mesh = make_dangling_mesh(complex);
  const auto& pieces = dangling_of(complex).pieces;
  std::vector<std::int64_t> connectivity, ends, piece, joint, block;
  std::vector<std::uint8_t> isolated;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const topology::DanglingPiece& own = pieces[mesh.piece[t]];
    for (const std::uint32_t v : mesh.triangles[t]) connectivity.push_back(v);
    ends.push_back(static_cast<std::int64_t>(3 * (t + 1)));
    piece.push_back(mesh.piece[t]);
    joint.push_back(own.joint.value());
    block.push_back(own.block.value());
    isolated.push_back(own.isolated ? 1 : 0);
  }
  VtuWriter vtu{VtuFormat::ascii};
  vtu.begin("FieldData");
  vtu.strings("title", {std::string{title}});
  vtu.end("FieldData");
  vtu.begin_piece(mesh.points.size(), mesh.triangles.size());
  vtu.points(mesh.points);
  vtu.cells(connectivity, ends, std::vector<std::uint8_t>(mesh.triangles.size(), 5));  // VTK_TRIANGLE
  vtu.begin("CellData");
  vtu.array("piece", piece);
  vtu.array("joint", joint);
  vtu.array("block", block);
  vtu.array("isolated", isolated);
  vtu.end("CellData");
  return std::move(vtu).finish();
}

std::string dangling_obj(const topology::BlockComplex& complex, std::string_view title) {
  const DanglingMesh mesh = make_dangling_mesh(complex);
  const auto& pieces = dangling_of(complex).pieces;
  std::string out = "# cleave " CLEAVE_VERSION ": parts of joints that bound no block\n# " + one_line(title) +
                    "\n# metres, x east, y north, z up, no offset subtracted; joints and blocks count from 0\n";
  for (const geometry::Vec3& p : mesh.points) {
    out += "v " + number(p.x) + ' ' + number(p.y) + ' ' + number(p.z) + '\n';
  }
  std::uint32_t group = UINT32_MAX;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.piece[t] != group) {
      group = mesh.piece[t];
      out += "g joint_" + std::to_string(pieces[group].joint.value()) + "_block_" +
             std::to_string(pieces[group].block.value()) + '\n';
    }
    out += 'f';
    for (const std::uint32_t v : mesh.triangles[t]) out += ' ' + std::to_string(v + 1);
    out += '\n';
  }
  return out;
}

}  // namespace cleave::report
