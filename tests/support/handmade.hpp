#pragma once

/// Block complexes put together contact by contact, without geometry: enough for statics, where a block is its
/// volume and the normals and areas of its faces. Not closed bodies: `audit` would refuse them, rightly.

#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

#include "cleave/exact/plane.hpp"
#include "cleave/stability/block_theory.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::handmade {

using geometry::Vec3;

inline double radians(double degrees) { return degrees * (std::numbers::pi / 180.0); }

/// Upward unit normal of a plane (x east, y north, z up).
inline Vec3 upward(double dip, double dip_direction) {
  const double d = radians(dip);
  const double a = radians(dip_direction);
  return {std::sin(d) * std::sin(a), std::sin(d) * std::cos(a), std::cos(d)};
}
/// Line of steepest descent.
inline Vec3 dip_vector(double dip, double dip_direction) {
  const double d = radians(dip);
  const double a = radians(dip_direction);
  return {std::cos(d) * std::sin(a), std::cos(d) * std::cos(a), -std::sin(d)};
}

/// The doubles of v, exactly, as an integer direction (parts below 2^-90 are cut).
inline stability::Direction direction(Vec3 v) {
  const auto integer = [](double c) { return static_cast<exact::Int128>(std::ldexp(c, 90)); };
  return stability::Direction::make({integer(v.x), integer(v.y), integer(v.z)}).value();
}

/// A lattice plane through the origin with normal n to about 2^-46; exact for small integer normals.
inline exact::Plane plane_with_normal(Vec3 n) {
  const auto site = [](Vec3 p) {
    const double scale = std::ldexp(1.0, 46) / std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    const auto round = [&](double c) { return static_cast<std::int64_t>(std::llround(c * scale)); };
    return exact::LatticePoint{round(p.x), round(p.y), round(p.z)};
  };
  // Two directions in the plane: across the smallest component first.
  const Vec3 axis = std::abs(n.x) <= std::abs(n.y) && std::abs(n.x) <= std::abs(n.z) ? Vec3{1, 0, 0}
                    : std::abs(n.y) <= std::abs(n.z)                                 ? Vec3{0, 1, 0}
                                                                                     : Vec3{0, 0, 1};
  const Vec3 u = geometry::cross(axis, n);
  const Vec3 v = geometry::cross(n, u);
  return exact::Plane::through({0, 0, 0}, site(u), site(v)).value();
}

class Complex final {
 public:
  topology::BlockId block(double volume) {
    return data_.blocks.push_back(topology::Block{.faces = {},
                                                  .counts = {},
                                                  .volume = cubic_metres(volume),
                                                  .centroid = {},
                                                  .convex = true,
                                                  .fixed = false,
                                                  .free = false,
                                                  .thickness = metres(1),
                                                  .sliver = false});
  }
  topology::BlockId fixed_block(double volume = 1) {
    const auto id = block(volume);
    data_.blocks[id].fixed = true;
    return id;
  }
  void free_face(topology::BlockId block) {
    data_.blocks[block].free = true;
    face(block, plane({0, 0, 1}), true, topology::Role::free, {});
  }
  /// A contact of `area` m2; `inward` points into `block`, away from `other`.
  void contact(topology::BlockId block, topology::BlockId other, Vec3 inward, double area, std::uint32_t joint) {
    const auto plane_id = plane(inward);
    face(block, plane_id, true, topology::Role::joint, {patch(joint, other, area)});
    face(other, plane_id, false, topology::Role::joint, {patch(joint, block, area)});
  }
  /// One face of `block` on two neighbours.
  void shared_contact(topology::BlockId block, topology::BlockId first, topology::BlockId second, Vec3 inward,
                      double first_area, double second_area, std::uint32_t joint) {
    const auto plane_id = plane(inward);
    face(block, plane_id, true, topology::Role::joint,
         {patch(joint, first, first_area), patch(joint, second, second_area)});
    face(first, plane_id, false, topology::Role::joint, {patch(joint, block, first_area)});
    face(second, plane_id, false, topology::Role::joint, {patch(joint, block, second_area)});
  }
  [[nodiscard]] topology::BlockComplex build() const {
    auto data = data_;
    for (const topology::BlockId b : data.blocks.ids()) {
      const topology::FaceId first{data.faces.size()};
      for (const auto& [face, patches] : faces_) {
        if (face.block == b) data.set_patches(data.faces[data.faces.push_back(face)], patches);
      }
      data.blocks[b].faces = {first, static_cast<std::uint32_t>(data.faces.size() - first.index())};
    }
    return topology::BlockComplex{std::move(data)};
  }

 private:
  static topology::Patch patch(std::uint32_t joint, topology::BlockId neighbour, double area) {
    return {.joint = topology::JointId{joint}, .neighbour = neighbour, .area = square_metres(area), .centroid = {}};
  }
  topology::PlaneId plane(Vec3 normal) { return data_.planes.push_back(plane_with_normal(normal)); }
  void face(topology::BlockId block, topology::PlaneId plane, bool positive, topology::Role role,
            std::vector<topology::Patch> patches) {
    Area area;
    for (const auto& p : patches) area += p.area;
    const std::array<double, 3> n = data_.planes[plane].unit_normal();
    const double sense = positive ? -1 : 1;
    const auto joint = patches.empty() ? std::nullopt : patches.front().joint;
    faces_.emplace_back(topology::Face{.block = block,
                                       .plane = plane,
                                       .block_on_positive_side = positive,
                                       .role = role,
                                       .shell = 0,
                                       .joint = joint,
                                       .excavation = std::nullopt,
                                       .tag = std::nullopt,
                                       .outward = sense * Vec3{n[0], n[1], n[2]},
                                       .area = area,
                                       .centroid = {}},
                        std::move(patches));
  }
  std::vector<std::pair<topology::Face, std::vector<topology::Patch>>> faces_;
  topology::BlockComplex::Data data_;
};

}  // namespace cleave::handmade
