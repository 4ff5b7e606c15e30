#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "cleave/topology/audit.hpp"
#include "cleave/topology/block_complex.hpp"
#include "detail/exact_block.hpp"

namespace cleave::topology::detail {

struct BlockMeasure {
  double volume = 0;
  double closure = 0;  ///< |sum A_f| / sum |A_f|
  std::uint64_t misfits = 0;
};

/// Measures blocks from the corners of their faces, and checks every stored measure, side and flag against those and
/// the exact planes.
class FitAuditor final {
  using Vec3 = geometry::Vec3;

 public:
  explicit FitAuditor(const BlockComplex& complex)
      : complex_{complex},
        side_{complex.report().lattice_pitch_m * 0x1p48},
        tolerance_{std::max(side_ * 0x1p-40, 4 * complex.report().bend_m)},  // positions are good to that
        // Where polygons share edges their bend adds to the rounding of positions: at a corner of planes that meet at a
        // small angle it counts over the angle's sine, as for what the assembler takes to be straight.
        off_plane_{side_ * 0x1p-40 + 64 * complex.report().bend_m},
        exactly_{complex, tolerance_} {
    normals_.reserve(complex.planes().size());
    for (const exact::Plane& plane : complex.planes()) {
      const auto& q = plane.approx();
      const auto n = plane.unit_normal();
      const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
      normals_.push_back({{n[0], n[1], n[2]}, q[3] / length * side_});
    }
  }

  /// Misfits are put behind `named`, if there is one.
  BlockMeasure measure(BlockId b, std::vector<Misfit>* named = nullptr) const {
    const Block& block = complex_.blocks()[b];
    BlockMeasure out;
    const auto misfit = [&](Misfit::Of of, std::optional<FaceId> face = {}) {
      ++out.misfits;
      if (named != nullptr) named->push_back({of, b, face});
    };
    if (block.faces.empty() || complex_.loops(block.faces[0]).empty()) {
      misfit(Misfit::Of::corners);
      out.closure = 1;
      return out;
    }
    const Vec3 apex = complex_.vertices()[complex_.loops(block.faces[0])[0][0]];
    Vec3 sum{};
    double size = 0, surface = 0;
    bool fixed = false, free = false, truncated = false;
    for (const FaceId f : block.faces) {
      const Face& face = complex_.faces()[f];
      Vec3 area{};
      if (face.block != b) {
        misfit(Misfit::Of::owner, f);
      } else if (const auto of = misfit_of(face, apex, area)) {
        misfit(*of, f);
      }
      sum += area;
      size += geometry::norm(area);
      if (face.corner_count > 0) {
        out.volume += geometry::dot(complex_.vertices()[complex_.loops(face)[0][0]] - apex, area);
      }
      surface += face.area.si();
      fixed = fixed || face.role == Role::fixed;
      free = free || face.role == Role::free;
      truncated = truncated || face.role == Role::window;
    }
    out.volume /= 3;
    out.closure = size > 0 ? geometry::norm(sum) / size : 0;
    if (!closes(out.closure, block.faces.size())) out.closure = geometry::norm(sum_again(block, apex)) / size;
    if (out.misfits == 0 && !equal(block.volume.si(), out.volume, surface) && !volume_holds(b, surface, out.volume)) {
      misfit(Misfit::Of::volume);
    }
    if (block.fixed != fixed || block.free != free || block.truncated != truncated) misfit(Misfit::Of::flags);
    return out;
  }
  /// Whether face vectors add up to nothing but roundings.
  [[nodiscard]] static bool closes(double closure, std::size_t faces) {
    return closure <= 1e-12 * std::sqrt(static_cast<double>(faces));
  }
  /// `measured`, or the volume by integers where doubles are not good to `relative`.
  [[nodiscard]] double volume(BlockId b, double measured, double relative) const {
    double surface = 0;
    for (const FaceId f : complex_.blocks()[b].faces) surface += complex_.faces()[f].area.si();
    return tolerance_ * surface <= relative * measured ? measured : exactly_.measure(b).volume;
  }
  /// Faces that are not among those of the block they name.
  [[nodiscard]] std::vector<Misfit> faces_without_block() const {
    std::vector<Misfit> lost;
    for (const FaceId f : complex_.faces().ids()) {
      const BlockId block = complex_.faces().block(f);
      const FaceRange own = block.index() < complex_.blocks().size() ? complex_.blocks()[block].faces : FaceRange{};
      if (own.empty() || f < own.front() || f.index() >= own.front().index() + own.size()) {
        lost.push_back({Misfit::Of::owner, block, f});
      }
    }
    return lost;
  }

 private:
  struct UnitPlane {
    Vec3 normal;
    double offset;  ///< m
  };

  /// The stored volume against that by integers, which becomes `volume`. The cutter's own may be off by what the
  /// rounding of corners does to heights and rims, but by a thousandth at most: what is thinner it measures by
  /// integers.
  [[nodiscard]] bool volume_holds(BlockId b, double surface, double& volume) const {
    const ExactBlock exactly = exactly_.measure(b);
    volume = exactly.volume;
    double allowed = tolerance_ * exactly.reach;
    if (exactly.all_exact) allowed = std::min(allowed, 0x1p-9 * std::abs(volume));
    allowed += 1e-9 * std::abs(volume) + tolerance_ * surface;
    return exactly.fits && std::abs(complex_.blocks()[b].volume.si() - volume) <= allowed;
  }

  /// Two volumes (areas) may differ by what the rounding of corners does along a surface (perimeter).
  [[nodiscard]] bool equal(double a, double b, double rim) const {
    return std::abs(a - b) <= 1e-9 * std::abs(b) + tolerance_ * rim;
  }

  /// What of a face is not that of its corners, if anything. `area` becomes the vector area of these, from `apex`: with
  /// one apex for all faces of a block each edge adds the same part to two of them, with opposite signs and to the last
  /// bit.
  [[nodiscard]] std::optional<Misfit::Of> misfit_of(const Face& face, Vec3 apex, Vec3& area) const {
    if (face.corner_count == 0) return Misfit::Of::corners;
    const UnitPlane& plane = normals_[face.plane.index()];
    const double sense = face.block_on_positive_side ? -1 : 1;
    const Vec3 outward = sense * plane.normal;
    double highest = 0;
    for (const auto loop : complex_.loops(face)) {
      Vec3 a = complex_.vertices()[loop.back()] - apex;
      for (const VertexId v : loop) {
        const Vec3 p = complex_.vertices()[v];
        highest = std::max(highest, std::abs(geometry::dot(plane.normal, p) + plane.offset));
        const Vec3 b = p - apex;
        area += 0.5 * geometry::cross(a, b);
        a = b;
      }
    }
    if (!(highest <= off_plane_)) return Misfit::Of::corners;
    const Vec3 off = face.outward - outward;
    if (!(geometry::dot(off, off) <= 1e-18)) return Misfit::Of::normal;
    double patches = 0;
    const bool joint = face.role == Role::joint;
    const auto own = complex_.patches(face);
    for (const Patch& patch : own) {
      if (patch.neighbour.has_value() != joint || patch.neighbour == face.block) return Misfit::Of::neighbour;
      patches += patch.area.si();
    }
    if (!joint && own.empty()) patches = face.area.si();
    // Nearly always all areas agree to rounding. Else the face is measured from a corner of its own, which is better
    // for small faces, and by what moves of its corners along its rim may do.
    const double measured = geometry::dot(area, outward);
    if (equal(face.area.si(), measured, 0) && equal(patches, face.area.si(), 0)) return std::nullopt;
    const auto [own_area, rim] = measure_alone(face);
    if (equal(face.area.si(), geometry::dot(own_area, outward), rim) && equal(patches, face.area.si(), rim)) {
      return std::nullopt;
    }
    return Misfit::Of::area;
  }

  /// The sum of a block's face vectors, kept in twice the digits: faces of slivers are small beside the parts that
  /// their edges add to two of them.
  [[nodiscard]] Vec3 sum_again(const Block& block, Vec3 apex) const {
    Vec3 sum{}, rest{};
    const auto add = [](double& total, double& lost, double part) {  // Knuth's exact sum of two
      const double next = total + part, of_part = next - total;
      lost += (total - (next - of_part)) + (part - of_part);
      total = next;
    };
    for (const FaceId f : block.faces) {
      for (const auto loop : complex_.loops(f)) {
        Vec3 a = complex_.vertices()[loop.back()] - apex;
        for (const VertexId v : loop) {
          const Vec3 b = complex_.vertices()[v] - apex, part = 0.5 * geometry::cross(a, b);
          add(sum.x, rest.x, part.x);
          add(sum.y, rest.y, part.y);
          add(sum.z, rest.z, part.z);
          a = b;
        }
      }
    }
    return sum + rest;
  }

  struct Alone {
    Vec3 area;
    double perimeter;
  };
  [[nodiscard]] Alone measure_alone(const Face& face) const {
    const Vec3 apex = complex_.vertices()[complex_.loops(face)[0][0]];
    Alone out{{}, 0};
    for (const auto loop : complex_.loops(face)) {
      VertexId last = loop.back();
      for (const VertexId v : loop) {
        const Vec3 a = complex_.vertices()[last], b = complex_.vertices()[v];
        out.area += 0.5 * geometry::cross(a - apex, b - apex);
        out.perimeter += geometry::norm(b - a);
        last = v;
      }
    }
    return out;
  }

  const BlockComplex& complex_;
  double side_, tolerance_, off_plane_;
  ExactBlocks exactly_;
  std::vector<UnitPlane> normals_;
};

}  // namespace cleave::topology::detail
