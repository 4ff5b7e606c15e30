#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <expected>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "cleave/assembly/assembly.hpp"
#include "cleave/assembly/groups.hpp"
#include "cleave/motion/world.hpp"
#include "shapes.hpp"

/// Random assemblies of oblique blocks, as `assembly` judges them and as `motion` lets them go.
namespace cleave::motion::shapes {

struct RandomAssembly {
  assembly::AssemblySpec statics;
  SceneSpec scene;  ///< the same bodies first, then those that never move
  Vec3 gravity{0, 0, -9.81};
};

/// A body that moves, in the scene and in the statics.
inline void add_body(Polyhedron shape, RandomAssembly& out) {
  const MassProperties m = mass_properties(shape).value();
  const Symmetric& i = m.inertia;
  out.statics.bodies.push_back({.centroid = m.centroid,
                                .force = m.volume * out.gravity,
                                .moment = {},
                                .mass = m.volume,
                                .inertia = {i.xx, i.yy, i.zz, i.xy, i.yz, i.zx}});
  out.scene.bodies.push_back({.shape = std::move(shape)});
}

/// A box of cells of random widths, mapped by a random linear map so that joints are oblique; some cells are rock that
/// never moves, some are void. Every number is of the generator's bits alone.
class AssemblyMaker final {
 public:
  explicit AssemblyMaker(std::uint64_t seed) : random_{seed} {}

  RandomAssembly make() {
    RandomAssembly out;
    const double friction = std::tan(between(0, 45) * degree);
    out.scene.surfaces = {{friction, 0}};
    // Rows of the map, near the unit map: joints up to some 30 degrees off.
    for (Vec3* column : {&x_, &y_, &z_}) *column = {between(-0.5, 0.5), between(-0.5, 0.5), between(-0.5, 0.5)};
    x_ += {1, 0, 0};
    y_ += {0, 1, 0};
    z_ += {0, 0, 1};
    if (dot(x_, cross(y_, z_)) < 0.2) return make();
    for (auto& lines : lines_) {
      lines = {0};
      for (int k = 0; k < cells; ++k) lines.push_back(lines.back() + between(0.6, 1.4));
    }
    const bool tight = between(0, 1) < 0.5;
    const double held = tight ? between(0.8, 1) : between(0.2, 0.8), open = tight ? between(0, 0.1) : between(0.1, 0.4);
    std::vector<std::array<int, 3>> fixed;
    std::array<std::optional<std::uint32_t>, cells * cells * cells> body;
    std::array<int, cells * cells * cells> kind{};  // 0 void, 1 moves, 2 never
    for (int k = 0; k < cells * cells * cells; ++k) {
      const std::array<int, 3> at{k % cells, k / cells % cells, k / cells / cells};
      const double u = between(0, 1);
      const bool inside = at == std::array{1, 1, 1};
      const std::size_t n = static_cast<std::size_t>(k);
      kind[n] = inside ? 1 : u < open ? 0 : u < open + (1 - open) * held ? 2 : 1;
      if (kind[n] == 1) {
        body[n] = static_cast<std::uint32_t>(out.statics.bodies.size());
        add_body(cell(at), out);
      }
      if (kind[n] == 2) fixed.push_back(at);
    }
    for (const auto& at : fixed) out.scene.bodies.push_back({.shape = cell(at), .fixed = true});
    for (int k = 0; k < cells * cells * cells; ++k) {
      const std::array<int, 3> at{k % cells, k / cells % cells, k / cells / cells};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        auto next = at;
        if (++next[axis] == cells) continue;
        const auto n = static_cast<std::size_t>(k),
                   m = static_cast<std::size_t>(next[0] + cells * (next[1] + cells * next[2]));
        if (kind[n] == 0 || kind[m] == 0 || kind[n] + kind[m] == 4) continue;
        add_contact(at, axis, body[n], body[m], friction, out.statics);
      }
    }
    return out;
  }

 private:
  static constexpr int cells = 3;

  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(random_() >> 11U) * 0x1p-53;
  }
  [[nodiscard]] Vec3 place(double x, double y, double z) const { return x * x_ + y * y_ + z * z_; }
  [[nodiscard]] double line(std::size_t axis, int k) const { return lines_[axis][static_cast<std::size_t>(k)]; }
  [[nodiscard]] Polyhedron cell(const std::array<int, 3>& at) const {
    Polyhedron out = box({line(0, at[0]), line(1, at[1]), line(2, at[2])},
                         {line(0, at[0] + 1), line(1, at[1] + 1), line(2, at[2] + 1)});
    for (Vec3& v : out.vertices) v = place(v.x, v.y, v.z);
    return out;
  }
  /// Between a cell and the next one along an axis.
  void add_contact(const std::array<int, 3>& at, std::size_t axis, std::optional<std::uint32_t> low,
                   std::optional<std::uint32_t> high, double friction, assembly::AssemblySpec& out) const {
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    const std::array<Vec3, 3> columns{x_, y_, z_};
    assembly::Contact contact{
        .normal = geometry::normalized(cross(columns[u], columns[v])), .points = {}, .friction = friction};
    for (const auto& [a, b] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
      std::array<double, 3> p{};
      p[axis] = line(axis, at[axis] + 1);
      p[u] = line(u, at[u] + a);
      p[v] = line(v, at[v] + b);
      contact.points.push_back(place(p[0], p[1], p[2]));
    }
    contact.body = high ? *high : *low;
    if (high) contact.other = low;
    if (!high) contact.normal = -contact.normal;
    out.contacts.push_back(std::move(contact));
  }

  std::mt19937_64 random_;
  Vec3 x_, y_, z_;
  std::array<std::vector<double>, 3> lines_;
};

enum class Certain : std::uint8_t { moves, stands, in_doubt };

/// What certificates say of it: that it moves whatever the law of flow, or stands under every law of friction.
inline Certain certified(const assembly::AssemblySpec& statics) {
  const auto made = assembly::Assembly::make(statics).value();
  if (assembly::check_motion(made, 1, assembly::project(made, 1).motion)) return Certain::moves;
  constexpr double none = std::numeric_limits<double>::infinity();
  for (const double prestress : {0.0, 1e-3, 1e-2}) {
    if (assembly::check_rest(made, none, assembly::holding_forces(made, none, prestress))) return Certain::stands;
  }
  return Certain::in_doubt;
}

/// Whether it moves from rest, as scenes let blocks go: the largest displacement over some steps, or why there is none.
inline std::expected<double, std::string> moved_from_rest(const RandomAssembly& random) {
  WorldOptions options{.gravity = random.gravity, .step = 0.01, .sleep = false};
  options.solver.accept = 1e-5;
  options.solver.tolerate = 1e-3;
  auto world = World::make(random.scene, options);
  if (!world) return std::unexpected(describe(world.error()));
  double most = 0;
  for (int k = 0; k < 3 && most < 1e-5; ++k) {
    if (const auto report = world->step(); !report) return std::unexpected(describe(report.error()));
    for (std::size_t b = 0; b < random.statics.bodies.size(); ++b) {
      most = std::max(most, norm(world->displacement(b)) + angle_of(world->turn(b)));
    }
  }
  return most;
}

}  // namespace cleave::motion::shapes
