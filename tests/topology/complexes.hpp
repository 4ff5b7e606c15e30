#pragma once

/// Scenes in a few words, and what the tests look at in their blocks.

#include <algorithm>
#include <array>
#include <initializer_list>
#include <ostream>
#include <stdexcept>
#include <tuple>
#include <utility>
#include <vector>

#include "cleave/topology/audit.hpp"
#include "cleave/topology/cut.hpp"

namespace cleave::testing {

using geometry::Vec3;

inline topology::Joint joint(std::vector<Vec3> corners) {
  return {{geometry::Polygon::make(std::move(corners)).value()}};
}
/// Rectangle at right angles to an axis; lo and hi are those of the other two axes in order.
inline topology::Joint rectangle(int axis, double at, std::array<double, 2> lo, std::array<double, 2> hi) {
  const auto corner = [&](double u, double v) {
    return axis == 0 ? Vec3{at, u, v} : axis == 1 ? Vec3{u, at, v} : Vec3{u, v, at};
  };
  return joint({corner(lo[0], lo[1]), corner(hi[0], lo[1]), corner(hi[0], hi[1]), corner(lo[0], hi[1])});
}
/// The parallelogram centre +- u +- v.
inline topology::Joint parallelogram(Vec3 centre, Vec3 u, Vec3 v) {
  return joint({centre - u - v, centre + u - v, centre + u + v, centre - u + v});
}
inline geometry::Solid box(Vec3 lo, Vec3 hi) { return geometry::make_box(lo, hi).value(); }

inline topology::CutInput scene(geometry::Solid domain, std::initializer_list<topology::Joint> joints = {},
                                std::vector<geometry::Solid> excavations = {}) {
  topology::CutInput input{
      .domain = std::move(domain), .joints = {}, .excavations = std::move(excavations), .free_domain_tags = {}};
  for (const topology::Joint& j : joints) input.joints.emplace_back(j);
  return input;
}
inline void add_closed_box(topology::CutInput& input, Vec3 lo, Vec3 hi) {
  for (const double x : {lo.x, hi.x}) input.joints.emplace_back(rectangle(0, x, {lo.y, lo.z}, {hi.y, hi.z}));
  for (const double y : {lo.y, hi.y}) input.joints.emplace_back(rectangle(1, y, {lo.x, lo.z}, {hi.x, hi.z}));
  for (const double z : {lo.z, hi.z}) input.joints.emplace_back(rectangle(2, z, {lo.x, lo.y}, {hi.x, hi.y}));
}

/// Cut and audited; a test that cannot even do that ends here.
inline topology::AuditedComplex certified(const topology::CutInput& input) {
  auto complex = topology::cut(input);
  if (!complex) throw std::runtime_error{describe(complex.error())};
  auto audited = topology::audit(*std::move(complex));
  if (!audited) throw std::runtime_error{describe(audited.error())};
  return *std::move(audited);
}
inline std::size_t count_blocks(const topology::CutInput& input) { return certified(input).complex().blocks().size(); }
inline std::string hash_of(const topology::CutInput& input) { return canonical_hash(certified(input).complex()); }

/// Smallest first.
inline std::vector<double> volumes(const topology::BlockComplex& complex) {
  std::vector<double> out;
  for (const topology::Block& block : complex.blocks()) out.push_back(block.volume.si());
  std::ranges::sort(out);
  return out;
}
inline std::vector<double> volumes(const topology::CutInput& input) { return volumes(certified(input).complex()); }

/// Numbers of (B1), and the volume in m3.
struct Shape {
  std::array<unsigned, 6> counts;  ///< V, E, F, L, S, G
  double volume;
  friend bool operator==(const Shape& a, const Shape& b) {
    return a.counts == b.counts && std::abs(a.volume - b.volume) <= 1e-12 * std::max(a.volume, b.volume);
  }
  friend std::ostream& operator<<(std::ostream& out, const Shape& s) {
    out << "{{";
    for (std::size_t i = 0; i < 6; ++i) out << (i > 0 ? ", " : "") << s.counts.at(i);
    return out << "}, " << s.volume << "}";
  }
};
/// Smallest first.
inline std::vector<Shape> sorted(std::vector<Shape> out) {
  std::ranges::sort(out, [](const Shape& a, const Shape& b) {
    const double step = 1e-9 * std::max(a.volume, b.volume);
    return a.volume < b.volume - step || (a.volume <= b.volume + step && a.counts < b.counts);
  });
  return out;
}
inline std::vector<Shape> shapes(const topology::BlockComplex& complex) {
  std::vector<Shape> out;
  for (const topology::Block& block : complex.blocks()) {
    const topology::EulerCounts& c = block.counts;
    out.push_back({{c.vertices, c.edges, c.faces, c.loops, c.shells, c.genus}, block.volume.si()});
  }
  return sorted(std::move(out));
}
inline std::vector<Shape> shapes(const topology::CutInput& input) { return shapes(certified(input).complex()); }

inline constexpr std::array<unsigned, 6> cuboid{8, 12, 6, 6, 1, 0};

}  // namespace cleave::testing
