#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstdint>
#include <utility>

#include "cleave/exact/predicates.hpp"
#include "cleave/exact/wide.hpp"
#include "cleave/geometry/box_tree.hpp"
#include "cleave/geometry/predicates.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::topology {
namespace {

using boost::multiprecision::cpp_int;
using exact::Sign;
using geometry::Vec3;

/// A finite double as mantissa times a power of two.
struct Parts {
  std::int64_t mantissa = 0;
  int exponent = 0;
  explicit Parts(double x) {
    if (x == 0) return;
    mantissa = static_cast<std::int64_t>(std::ldexp(std::frexp(x, &exponent), 53));
    exponent -= 53;
  }
};

/// Side of a plane on which a point lies, exact. n . (p - origin) + d pitch, in which all are doubles.
class SideOf final {
 public:
  SideOf(const BlockComplex& complex, Vec3 point)
      : point_{point}, origin_{complex.origin()}, pitch_{complex.report().lattice_pitch_m} {
    const Vec3 r = (1 / (pitch_ * 0x1p48)) * (point - origin_);  // one rounding: the scale is a power of two
    at_ = {r.x, r.y, r.z};
  }
  [[nodiscard]] Sign operator()(const exact::Plane& plane) const {
    const auto& n = plane.approx();
    const double value = n[0] * at_[0] + n[1] * at_[1] + n[2] * at_[2] + n[3];
    // As Plane::side_of, and the position has a relative error of 2^-53.
    if (const auto sign = exact::sign_filtered(value, 128 * exact::unit_roundoff)) return *sign;
    return exactly(plane);
  }

 private:
  [[nodiscard]] Sign exactly(const exact::Plane& plane) const {
    const std::array<Parts, 3> p{Parts{point_.x}, Parts{point_.y}, Parts{point_.z}};
    const std::array<Parts, 3> o{Parts{origin_.x}, Parts{origin_.y}, Parts{origin_.z}};
    const Parts pitch{pitch_};
    int least = pitch.exponent;
    for (std::size_t k = 0; k < 3; ++k) {
      if (p[k].mantissa != 0) least = std::min(least, p[k].exponent);
      if (o[k].mantissa != 0) least = std::min(least, o[k].exponent);
    }
    const auto whole = [&](const Parts& x) {
      return x.mantissa == 0 ? cpp_int{0} : cpp_int{x.mantissa} << static_cast<unsigned>(x.exponent - least);
    };
    cpp_int sum = cpp_int{exact::widened(plane.offset())} * whole(pitch);
    for (std::size_t k = 0; k < 3; ++k) sum += cpp_int{plane.normal()[k]} * (whole(p[k]) - whole(o[k]));
    return exact::sign_of(sum);
  }

  Vec3 point_, origin_;
  double pitch_;
  std::array<double, 3> at_{};
};

/// Whether a point lies within the outline of a face and outside its holes, both seen along an axis. A point on an edge
/// is on the same side of it for the faces on both sides.
bool within(const BlockComplex& complex, const Face& face, Vec3 point, int axis) {
  const Vec2 q = geometry::drop(point, axis);
  bool odd = false;
  for (const auto& loop : complex.loops(face)) {
    for (std::size_t i = 0; i < loop.size(); ++i) {
      Vec2 a = geometry::drop(complex.vertices()[loop[i]], axis);
      Vec2 b = geometry::drop(complex.vertices()[loop[i + 1 < loop.size() ? i + 1 : 0]], axis);
      if ((a.y > q.y) == (b.y > q.y)) continue;
      if (a.y > b.y) std::swap(a, b);
      if (geometry::orient2d(a, b, q) == Sign::positive) odd = !odd;
    }
  }
  return odd;
}

/// Whether a point in the plane of a face lies on its outline.
bool on_outline(const BlockComplex& complex, const Face& face, Vec3 point, int axis) {
  const Vec2 q = geometry::drop(point, axis);
  for (const auto& loop : complex.loops(face)) {
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Vec2 a = geometry::drop(complex.vertices()[loop[i]], axis);
      const Vec2 b = geometry::drop(complex.vertices()[loop[i + 1 < loop.size() ? i + 1 : 0]], axis);
      if (geometry::segments_meet(a, b, q, q)) return true;
    }
  }
  return false;
}

std::vector<geometry::Box> boxes_of(const BlockComplex& complex) {
  std::vector<geometry::Box> out;
  out.reserve(complex.blocks().size());
  const double origin = norm(complex.origin());
  for (const Block& block : complex.blocks()) {
    geometry::Box box;
    for (const FaceId number : block.faces) {
      const LoopRange loops = complex.loops(number);
      if (loops.empty()) continue;
      for (const VertexId corner : loops.front()) box.add(complex.vertices()[corner]);
    }
    // Corners are rounded, and so is the place of a point that is asked for.
    out.push_back(box.grown(0x1p-50 * (origin + std::max(norm(box.min), norm(box.max)))));
  }
  return out;
}

}  // namespace

std::vector<BlockId> neighbours_of(const BlockComplex& complex, BlockId block) {
  std::vector<BlockId> out;
  for (const FaceId face : complex.blocks()[block].faces) {
    for (const Patch& patch : complex.patches(complex.faces()[face])) {
      if (patch.neighbour) out.push_back(*patch.neighbour);
    }
  }
  std::ranges::sort(out);
  const auto repeated = std::ranges::unique(out);
  out.erase(repeated.begin(), repeated.end());
  return out;
}

/// Of the blocks, relative to the complex's origin, grown by a rounding.
struct BlockLocator::Boxes {
  explicit Boxes(std::vector<geometry::Box> of_blocks) : boxes{std::move(of_blocks)}, tree{boxes} {}
  std::vector<geometry::Box> boxes;
  geometry::BoxTree tree;
};

BlockLocator::BlockLocator(const BlockComplex& complex)
    : complex_{&complex}, boxes_{std::make_unique<const Boxes>(boxes_of(complex))} {}
BlockLocator::BlockLocator(BlockLocator&& other) noexcept = default;
BlockLocator& BlockLocator::operator=(BlockLocator&& other) noexcept = default;
BlockLocator::~BlockLocator() = default;

std::optional<BlockId> BlockLocator::block_at(Vec3 point) const {
  if (!geometry::is_finite(point)) return std::nullopt;
  const Vec3 relative = point - complex_->origin();
  std::optional<BlockId> best;
  boxes_->tree.overlapping({relative, relative}, [&](std::uint32_t number) {
    const BlockId block{number};
    if ((!best || block < *best) && holds(block, point)) best = block;
  });
  return best;
}

bool BlockLocator::holds(BlockId id, Vec3 point) const {
  const Block& block = complex_->blocks()[id];
  const SideOf side{*complex_, point};
  const Vec3 relative = point - complex_->origin();
  int ahead = 0;  // faces that a ray along x leaves through less those it enters through
  for (const FaceId number : block.faces) {
    const Face& face = complex_->faces()[number];
    const exact::Plane& plane = complex_->planes()[face.plane];
    const Sign sign = side(plane);
    const bool inner = sign == (face.block_on_positive_side ? Sign::positive : Sign::negative);
    if (block.convex) {
      if (!inner && sign != Sign::zero) return false;
      continue;
    }
    const int flat = geometry::dominant_axis(face.outward);
    if (sign == Sign::zero &&
        (within(*complex_, face, relative, flat) || on_outline(*complex_, face, relative, flat))) {
      return true;
    }
    const Sign along = exact::sign_of(plane.normal()[0]);
    if (along == Sign::zero || !within(*complex_, face, relative, 0)) continue;
    const bool leaves = (along == Sign::positive) != face.block_on_positive_side;
    if (leaves && inner) ++ahead;
    if (!leaves && !inner && sign != Sign::zero) --ahead;
  }
  return block.convex || ahead > 0;
}

}  // namespace cleave::topology
