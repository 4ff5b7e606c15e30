#include "block_summary.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>
#include <utility>
#include <variant>

#include "cleave/flow/flow.hpp"
#include "cleave/topology/audit.hpp"
#include "cleave/topology/cut.hpp"
#include "integer_scene_input.hpp"

namespace cleave::testing {

namespace {

void sort_volumes(BlockSummary& summary) {
  for (auto& entry : summary) std::ranges::sort(entry.second);
}

}  // namespace

BlockSummary summary_of(const topology::BlockComplex& complex) {
  BlockSummary out;
  for (const topology::Block& b : complex.blocks()) {
    const auto& c = b.counts;
    out[{c.vertices, c.edges, c.faces, c.loops, c.shells, c.genus}].push_back(b.volume.si());
  }
  sort_volumes(out);
  return out;
}

BlockSummary summary_of(const std::vector<oracle::OracleBlock>& blocks) {
  BlockSummary out;
  for (const oracle::OracleBlock& b : blocks) {
    out[{b.vertices, b.edges, b.faces, b.loops, b.shells, b.genus}].push_back(b.volume.convert_to<double>());
  }
  sort_volumes(out);
  return out;
}

std::string describe(const BlockSummary& summary) {
  std::ostringstream out;
  out.precision(12);
  for (const auto& [counts, volumes] : summary) {
    out << '(';
    for (const std::uint32_t n : counts) out << ' ' << n;
    out << " ):";
    for (const double v : volumes) out << ' ' << v;
    out << '\n';
  }
  return out.str();
}

bool agree(const BlockSummary& a, const BlockSummary& b) {
  const auto near = [](double x, double y) { return std::abs(x - y) <= 1e-9 * std::max(x, y); };
  return std::ranges::equal(a, b, [&](const auto& p, const auto& q) {
    return p.first == q.first && std::ranges::equal(p.second, q.second, near);
  });
}

FastCut fast_cut(const IntegerScene& scene) {
  auto complex = topology::cut(to_cut_input(scene));
  if (!complex) {
    if (std::holds_alternative<topology::DomainSwallowed>(complex.error())) return {};
    return {{}, "cut: " + topology::describe(complex.error())};
  }
  FastCut out{summary_of(*complex), {}};
  const double rock = complex->rock_volume().si();
  const auto audited = topology::audit(*std::move(complex));
  std::ostringstream problem;
  if (!audited) {
    const topology::Certificate& c = audited.error();
    problem << "audit: euler " << c.euler_violations << " open shells " << c.open_shells << " unpaired "
            << c.unpaired_patches << " face vector " << c.face_vector_max_relative << " volume "
            << c.volume_relative_error << '\n';
  }
  double sum = 0;
  for (const auto& entry : out.summary) sum = std::accumulate(entry.second.begin(), entry.second.end(), sum);
  if (std::abs(sum - rock) > 1e-9 * rock) problem << "blocks have " << sum << " m3 of " << rock << " m3 of rock\n";
  out.problem = problem.str();
  return out;
}

std::string difference_from_oracle(const IntegerScene& scene) {
  const FastCut fast = fast_cut(scene);
  const BlockSummary exact = summary_of(oracle::oracle_blocks(scene));
  if (fast.problem.empty() && agree(fast.summary, exact)) return {};
  return fast.problem + "cut\n" + describe(fast.summary) + "oracle\n" + describe(exact);
}

std::string broken_invariance(const IntegerScene& scene) {
  const FastCut plain = fast_cut(scene);
  if (!plain.problem.empty()) return plain.problem;
  std::string problem;
  const auto expect_same = [&](const char* what, const IntegerScene& other) {
    const FastCut cut = fast_cut(other);
    if (cut.problem.empty() && agree(cut.summary, plain.summary)) return;
    problem += std::string{what} + ": " + cut.problem + "\nplain\n" + describe(plain.summary) + "changed\n" +
               describe(cut.summary);
  };
  IntegerScene other = scene;
  std::ranges::reverse(other.joints);
  for (IntegerPolygon& joint : other.joints) std::ranges::rotate(joint, joint.begin() + 1);
  expect_same("other order of joints and corners", other);
  if (!scene.joints.empty()) {
    other = scene;
    other.joints.push_back(scene.joints.front());
    std::ranges::reverse(other.joints.back());
    expect_same("a joint twice", other);
  }
  expect_same("translated", translated(scene, {5, -7, 3}));
  expect_same("axes rotated", axes_rotated(scene));
  expect_same("axes swapped", axes_swapped(scene));
  return problem;
}

namespace {

struct SeenBlock {
  Counts counts;
  std::array<double, 6> figures;  ///< volume, centroid, joint area, free area
  bool whole, strictly_inside;
};

std::vector<SeenBlock> seen_blocks(const topology::BlockComplex& complex, const topology::Window& window) {
  std::vector<SeenBlock> out;
  for (const topology::Block& b : complex.blocks()) {
    const auto& c = b.counts;
    SeenBlock seen{{c.vertices, c.edges, c.faces, c.loops, c.shells, c.genus},
                   {b.volume.si(), b.centroid.x, b.centroid.y, b.centroid.z, 0, 0},
                   !b.truncated,
                   true};
    for (const topology::FaceId f : b.faces) {
      const topology::Face& face = complex.faces()[f];
      if (face.role == topology::Role::joint) seen.figures[4] += face.area.si();
      if (face.role == topology::Role::free) seen.figures[5] += face.area.si();
      for (const auto& loop : complex.loops(face)) {
        for (const topology::VertexId v : loop) {
          const geometry::Vec3 p = complex.position(v);
          seen.strictly_inside = seen.strictly_inside && p.x > window.min.x && p.x < window.max.x &&
                                 p.y > window.min.y && p.y < window.max.y && p.z > window.min.z && p.z < window.max.z;
        }
      }
    }
    out.push_back(seen);
  }
  return out;
}

bool same(const SeenBlock& a, const SeenBlock& b) {
  bool equal = a.counts == b.counts;
  for (std::size_t k = 0; k < a.figures.size(); ++k) equal = equal && std::abs(a.figures[k] - b.figures[k]) < 1e-7;
  return equal;
}

}  // namespace

std::string broken_network(const IntegerScene& scene) {
  auto input = to_cut_input(scene);
  input.keep_network = input.keep_dangling = true;
  const auto cut = topology::cut(input);
  if (!cut) return {};
  const topology::JointNetwork& network = *cut->network();
  double faces = cut->dangling()->area.si(), pieces = 0, triangles = 0, parts = 0, clusters = 0;
  for (const topology::Face& face : cut->faces()) {
    if (face.role == topology::Role::joint) faces += 0.5 * face.area.si();
  }
  for (const topology::JointPiece& piece : network.pieces) {
    pieces += piece.area.si();
    const auto n = cut->planes()[piece.plane].unit_normal();
    for (std::uint32_t t = piece.first_triangle; t < piece.first_triangle + piece.triangle_count; ++t) {
      const auto& [a, b, c] = network.triangles[t];
      triangles += 0.5 * geometry::dot(geometry::cross(cut->vertices()[b] - cut->vertices()[a],
                                                       cut->vertices()[c] - cut->vertices()[a]),
                                       geometry::Vec3{n[0], n[1], n[2]});
    }
  }
  const flow::Connectivity found = flow::connectivity(*cut, flow::surfaces_of(network));
  for (const flow::JointPart& part : found.parts) parts += part.area.si();
  for (const flow::Cluster& cluster : found.clusters) clusters += cluster.area.si();
  std::string problem;
  for (const double other : {pieces, triangles, parts, clusters}) {
    if (std::abs(other - faces) > 1e-9 * (1 + faces)) problem += "areas of the network and of the blocks differ\n";
  }
  return problem;
}

std::string broken_window(const IntegerScene& scene) {
  const auto whole = topology::cut(to_cut_input(scene));
  if (!whole) return {};
  const geometry::Vec3 lo = to_position(scene.min), hi = to_position(scene.max), middle = 0.5 * (lo + hi);
  const geometry::Vec3 part = 0.25 * (hi - lo);
  std::string problem;
  for (const topology::Window& window :
       {topology::Window{lo, hi}, topology::Window{lo - part, middle}, topology::Window{middle - part, middle + part},
        topology::Window{{middle.x - part.x, lo.y, lo.z + 0.3}, {middle.x + 1, hi.y, hi.z - 0.7}}}) {
    auto input = to_cut_input(scene);
    input.window = window;
    auto cut = topology::cut(input);
    if (!cut) {
      if (!std::holds_alternative<topology::DomainSwallowed>(cut.error())) problem += topology::describe(cut.error());
      continue;
    }
    const auto audited = topology::audit(*std::move(cut));
    if (!audited) {
      problem += "the certificate of a window did not pass\n";
      continue;
    }
    const auto expected = seen_blocks(*whole, window), found = seen_blocks(audited->complex(), window);
    for (const SeenBlock& block : found) {
      if (block.whole && std::ranges::none_of(expected, [&](const SeenBlock& e) { return same(e, block); }))
        problem += "a whole block of the window is none of the scene's\n";
    }
    for (const SeenBlock& block : expected) {
      if (block.strictly_inside &&
          std::ranges::none_of(found, [&](const SeenBlock& f) { return f.whole && same(f, block); }))
        problem += "a block inside the window was not found whole\n";
    }
  }
  return problem;
}

}  // namespace cleave::testing
