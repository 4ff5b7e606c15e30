#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "cleave/realize/run_result.hpp"
#include "cleave/topology/block_complex.hpp"

/// Block systems written down by hand, so that the writers are tested without the cutter.
namespace cleave::report::testing {

using geometry::Vec3;
using topology::Role;
using Loop = std::vector<Vec3>;

struct FaceSpec {
  std::vector<Loop> loops;  ///< outer counter-clockwise seen from outside, holes clockwise
  Role role = Role::fixed;
  std::optional<std::uint32_t> joint = std::nullopt;
  std::optional<std::uint32_t> excavation = std::nullopt;
  std::uint32_t shell = 0;
};

inline Vec3 face_vector(const std::vector<Loop>& loops) {
  Vec3 sum{};
  const Vec3 o = loops.front().front();
  for (const Loop& loop : loops) {
    for (std::size_t i = 0; i < loop.size(); ++i) sum += 0.5 * cross(loop[i] - o, loop[(i + 1) % loop.size()] - o);
  }
  return sum;
}

/// Whether all of `before` stand in `now`, in that order: names that users have neither go nor change places.
inline bool keeps(const std::vector<std::string>& before, const std::vector<std::string>& now) {
  auto at = now.begin();
  for (const std::string& name : before) {
    at = std::find(at, now.end(), name);
    if (at == now.end()) return false;
    ++at;
  }
  return true;
}

class HandMade {
 public:
  explicit HandMade(Vec3 origin = {}) { data_.origin = origin; }

  topology::BlockId block(const std::vector<FaceSpec>& faces, topology::EulerCounts counts, bool convex = false) {
    const topology::BlockId id{data_.blocks.size()};
    topology::Block block{.faces = {topology::FaceId{data_.faces.size()}, static_cast<std::uint32_t>(faces.size())},
                          .counts = counts,
                          .volume = {},
                          .centroid = {},
                          .convex = convex,
                          .fixed = false,
                          .free = false,
                          .thickness = metres(1),
                          .sliver = false};
    double volume = 0;
    const Vec3 o = faces.front().loops.front().front();
    for (const FaceSpec& spec : faces) {
      const Vec3 area = face_vector(spec.loops);
      volume += dot(spec.loops.front().front() - o, area) / 3;
      block.fixed |= spec.role == Role::fixed;
      block.free |= spec.role == Role::free;
      topology::Face face{.block = id,
                          .plane = topology::PlaneId{0U},
                          .block_on_positive_side = false,
                          .role = spec.role,
                          .shell = spec.shell,
                          .joint = std::nullopt,
                          .excavation = spec.excavation,
                          .tag = std::nullopt,
                          .outward = normalized(area),
                          .area = square_metres(norm(area)),
                          .centroid = data_.origin + middle_of(spec.loops.front())};
      if (spec.joint) face.joint = topology::JointId{*spec.joint};
      std::vector<std::vector<topology::VertexId>> loops;
      for (const Loop& loop : spec.loops) {
        loops.emplace_back();
        for (const Vec3 p : loop) loops.back().push_back(vertex(p));
      }
      data_.set_loops(face, loops);
      data_.faces.push_back(face);
    }
    block.volume = cubic_metres(volume);
    block.centroid = data_.origin + o;
    data_.rock_volume += block.volume;
    return data_.blocks.push_back(block);
  }

  topology::CutReport& report() { return data_.report; }
  topology::BlockComplex complex() && { return topology::BlockComplex{std::move(data_)}; }

 private:
  static Vec3 middle_of(const Loop& loop) {
    Vec3 sum{0, 0, 0};
    for (const Vec3 p : loop) sum += p;
    return sum / static_cast<double>(loop.size());
  }
  topology::VertexId vertex(Vec3 p) {
    const auto [found, added] =
        known_.try_emplace(std::tuple{p.x, p.y, p.z}, static_cast<std::uint32_t>(known_.size()));
    if (added) data_.vertices.push_back(p);
    return topology::VertexId{found->second};
  }
  topology::BlockComplex::Data data_{};
  std::map<std::tuple<double, double, double>, std::uint32_t> known_;
};

/// The six faces of a box, outwards; order west east south north bottom top.
inline std::vector<FaceSpec> box_faces(Vec3 lo, Vec3 hi, Role role = Role::fixed) {
  const auto p = [&](int x, int y, int z) { return Vec3{x ? hi.x : lo.x, y ? hi.y : lo.y, z ? hi.z : lo.z}; };
  std::vector<FaceSpec> faces;
  for (const Loop& loop :
       {Loop{p(0, 0, 0), p(0, 0, 1), p(0, 1, 1), p(0, 1, 0)}, Loop{p(1, 0, 0), p(1, 1, 0), p(1, 1, 1), p(1, 0, 1)},
        Loop{p(0, 0, 0), p(1, 0, 0), p(1, 0, 1), p(0, 0, 1)}, Loop{p(0, 1, 0), p(0, 1, 1), p(1, 1, 1), p(1, 1, 0)},
        Loop{p(0, 0, 0), p(0, 1, 0), p(1, 1, 0), p(1, 0, 0)}, Loop{p(0, 0, 1), p(1, 0, 1), p(1, 1, 1), p(0, 1, 1)}}) {
    faces.push_back({.loops = {loop}, .role = role});
  }
  return faces;
}

inline constexpr topology::EulerCounts box_counts{8, 12, 6, 6, 1, 0};

/// Walls of a void box, seen from the rock around it; `shell` as in Face::shell.
inline std::vector<FaceSpec> void_faces(Vec3 lo, Vec3 hi, std::uint32_t shell) {
  auto faces = box_faces(lo, hi, Role::joint);
  for (FaceSpec& face : faces) {
    std::vector<Vec3> loop(face.loops.front().rbegin(), face.loops.front().rend());
    face.loops = {loop};
    face.shell = shell;
    face.joint = 0;
  }
  return faces;
}

/// n x n x n unit boxes.
inline topology::BlockComplex grid(int n, Vec3 origin = {}) {
  HandMade made{origin};
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      for (int k = 0; k < n; ++k) {
        const Vec3 lo{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
        auto faces = box_faces(lo, lo + Vec3{1, 1, 1}, Role::joint);
        for (FaceSpec& face : faces) face.joint = 7;
        made.block(faces, box_counts, true);
      }
    }
  }
  return std::move(made).complex();
}

/// Box 4 x 4 x 4 with square shafts, each from z = `bottom` to the top; `touching` shares the vertical edge x = y = 2.
struct Shaft {
  double x0, y0, x1, y1;
};
inline topology::BlockComplex box_with_shafts(const std::vector<Shaft>& shafts, double bottom,
                                              topology::EulerCounts counts) {
  HandMade made;
  auto faces = box_faces({0, 0, 0}, {4, 4, 4});
  for (const Shaft& s : shafts) {
    auto walls = void_faces({s.x0, s.y0, bottom}, {s.x1, s.y1, 4}, 0);
    const Loop floor = walls[4].loops.front(), lid = walls[5].loops.front();
    for (std::size_t side = 0; side < 4; ++side) faces.push_back(walls[side]);
    // The lid seen from inside the rock is counter-clockwise from below, so clockwise from above: a hole of the top
    // face.
    faces[5].loops.push_back(lid);
    if (bottom > 0) {
      faces.push_back(walls[4]);
    } else {
      faces[4].loops.push_back(floor);
    }
  }
  made.block(faces, counts);
  return std::move(made).complex();
}

inline stability::Judgement judgement(std::uint32_t block, stability::Mode mode, std::optional<std::uint32_t> batch,
                                      double factor) {
  return {.block = topology::BlockId{block},
          .mode = mode,
          .key = batch.has_value(),
          .batch = batch,
          .direction = {0, 0, -1},
          .weight = newtons(1000),
          .driving = newtons(900),
          .resistance = newtons(100),
          .net = newtons(800),
          .factor_of_safety = factor,
          .pressing = {},
          .cone_dimension = 3,
          .tie = false};
}

/// A joint of a set with friction `tangent`.
inline scene::JointInfo joint(Vec3 normal, std::uint32_t set, double tangent = 0.5) {
  return {
      .set = scene::SetId{set},
      .origin = scene::JointOrigin::drawn,
      .source = {},
      .strength =
          stability::JointStrength::make(FrictionAngle::degrees(std::atan(tangent) * 180 / std::numbers::pi)).value(),
      .normal = normal,
      .dip = {},
      .dip_direction = {}};
}

}  // namespace cleave::report::testing
