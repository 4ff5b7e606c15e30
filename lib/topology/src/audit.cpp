#include "cleave/topology/audit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

namespace cleave::topology {
namespace {

using geometry::Vec3;

/// One side of a face: from corner i to corner i + 1 of a loop.
struct Side {
  std::uint32_t from, to;
  std::uint32_t next;     ///< the side after it in its loop
  std::uint32_t face;     ///< number of the face within the block
  std::uint32_t partner;  ///< the side of the neighbouring face
};
constexpr std::uint32_t unset = UINT32_MAX;

/// Recomputes closedness and Euler-Poincare of one block from the loops of its faces alone.
class BlockAuditor {
 public:
  BlockAuditor(const BlockComplex& complex, const Block& block) : complex_{complex}, block_{block} {
    for (std::uint32_t f = 0; f < block.faces.size(); ++f) {
      for (const auto loop : complex.loops(complex.faces()[block.faces[f]])) {
        const auto first = static_cast<std::uint32_t>(sides_.size());
        const auto count = static_cast<std::uint32_t>(loop.size());
        for (std::uint32_t i = 0; i < count; ++i) {
          sides_.push_back({loop[i].value(), loop[(i + 1) % count].value(), first + (i + 1) % count, f, unset});
        }
        ++loops_;
      }
    }
    closed_ = pair_sides();
  }

  [[nodiscard]] bool closed() const noexcept { return closed_; }

  /// (B1) shell by shell: an odd or negative genus means an open or wrongly joined shell.
  [[nodiscard]] bool euler_holds() const {
    if (!closed_) return false;
    // Shells: faces joined over their sides.
    std::vector<std::uint32_t> parent(block_.faces.size());
    std::iota(parent.begin(), parent.end(), 0U);
    const auto find = [&](std::uint32_t a) {
      while (parent[a] != a) a = parent[a] = parent[parent[a]];
      return a;
    };
    for (const Side& s : sides_) {
      const std::uint32_t a = find(s.face), b = find(sides_[s.partner].face);
      parent[std::max(a, b)] = std::min(a, b);
    }
    struct Sum {
      std::int64_t vertices = 0, sides = 0, faces_less_loops = 0;
    };
    std::map<std::uint32_t, Sum> shells;
    for (std::uint32_t f = 0; f < block_.faces.size(); ++f) {
      shells[find(f)].faces_less_loops +=
          2 - static_cast<std::int64_t>(complex_.loops(complex_.faces()[block_.faces[f]]).size());
    }
    // Fans: turning round a vertex from face to face; a pinched vertex has several.
    std::vector<std::uint8_t> seen(sides_.size(), 0);
    std::int64_t fans = 0;
    for (std::uint32_t s = 0; s < sides_.size(); ++s) {
      Sum& sum = shells[find(sides_[s].face)];
      ++sum.sides;
      if (seen[s] != 0) continue;
      ++fans;
      ++sum.vertices;
      std::uint32_t at = s;
      do {
        seen[at] = 1;
        at = sides_[sides_[at].next].partner;
      } while (at != s);
    }
    std::int64_t genus = 0;
    for (const auto& [root, sum] : shells) {
      const std::int64_t twice = 2 - (sum.vertices - sum.sides / 2 + sum.faces_less_loops);
      if (twice < 0 || twice % 2 != 0) return false;
      genus += twice / 2;
    }
    const EulerCounts& c = block_.counts;
    return c.vertices == fans && c.edges == sides_.size() / 2 && c.faces == block_.faces.size() && c.loops == loops_ &&
           c.shells == shells.size() && c.genus == genus;
  }

 private:
  /// Each side needs one in the opposite direction. Where the boundary touches itself along an edge there are several:
  /// the partner of a face is then the next one met when turning from it through the inside of the block.
  bool pair_sides() {
    std::vector<std::uint32_t> order(sides_.size());
    std::iota(order.begin(), order.end(), 0U);
    const auto key = [&](std::uint32_t s) {
      return std::array{std::min(sides_[s].from, sides_[s].to), std::max(sides_[s].from, sides_[s].to)};
    };
    std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) {
      const auto x = key(a), y = key(b);
      return x < y || (x == y && a < b);
    });
    for (std::size_t first = 0; first < order.size();) {
      std::size_t last = first;
      while (last < order.size() && key(order[last]) == key(order[first])) ++last;
      if (!pair_group(
              {order.begin() + static_cast<std::ptrdiff_t>(first), order.begin() + static_cast<std::ptrdiff_t>(last)}))
        return false;
      first = last;
    }
    return true;
  }

  bool pair_group(std::vector<std::uint32_t> group) {
    const auto forward = [&](std::uint32_t s) { return sides_[s].from < sides_[s].to; };
    if (group.size() % 2 != 0 || static_cast<std::size_t>(std::ranges::count_if(group, forward)) * 2 != group.size())
      return false;
    if (group.size() == 2) {
      sides_[group[0]].partner = group[1];
      sides_[group[1]].partner = group[0];
      return true;
    }
    const Side& any = sides_[group[0]];
    const Vec3 a = complex_.vertices()[VertexId{std::min(any.from, any.to)}],
               b = complex_.vertices()[VertexId{std::max(any.from, any.to)}];
    // An edge shorter than doubles can tell has no direction; any will do to go on, at worst the certificate does not
    // pass.
    const Vec3 axis = b == a ? Vec3{0, 0, 1} : geometry::normalized(b - a);
    const Vec3 e1 = geometry::normalized(geometry::cross(axis, std::abs(axis.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
    const Vec3 e2 = geometry::cross(axis, e1);
    std::vector<std::pair<double, std::uint32_t>> around;
    for (const std::uint32_t s : group) {
      // Into the face: outward normal x direction of the side.
      const Vec3 m = complex_.faces()[block_.faces[sides_[s].face]].outward;
      const Vec3 into = geometry::cross(m, forward(s) ? axis : -axis);
      around.emplace_back(std::atan2(geometry::dot(into, e2), geometry::dot(into, e1)), s);
    }
    std::ranges::sort(around);
    // Turning counter-clockwise about the axis leaves a forward side towards the outside: the inside is met clockwise.
    for (std::size_t i = 0; i < around.size(); ++i) {
      const std::uint32_t s = around[i].second;
      if (!forward(s)) continue;
      const std::uint32_t t = around[(i + around.size() - 1) % around.size()].second;
      if (forward(t)) return false;
      sides_[s].partner = t;
      sides_[t].partner = s;
    }
    return std::ranges::none_of(group, [&](std::uint32_t s) { return sides_[s].partner == unset; });
  }

  const BlockComplex& complex_;
  const Block& block_;
  std::vector<Side> sides_;
  std::size_t loops_ = 0;
  bool closed_ = false;
};

struct BlockMeasure {
  double volume, closure;
};
BlockMeasure measure(const BlockComplex& complex, const Block& block) {
  const Vec3 apex = complex.vertices()[complex.loops(complex.faces()[block.faces[0]])[0][0]];
  Vec3 sum{};
  double size = 0, volume = 0;
  for (const FaceId f : block.faces) {
    const Face& face = complex.faces()[f];
    Vec3 area{};
    for (const auto loop : complex.loops(face)) {
      for (std::size_t i = 0; i < loop.size(); ++i) {
        area += 0.5 * geometry::cross(complex.vertices()[loop[i]] - apex,
                                      complex.vertices()[loop[(i + 1) % loop.size()]] - apex);
      }
    }
    sum += area;
    size += geometry::norm(area);
    volume += geometry::dot(complex.vertices()[complex.loops(face)[0][0]] - apex, area);
  }
  return {volume / 3, size > 0 ? geometry::norm(sum) / size : 0};
}

/// Does every stored measure, side and flag agree with the loops and the exact planes?
class FitAuditor {
 public:
  explicit FitAuditor(const BlockComplex& complex)
      : complex_{complex}, side_{complex.report().lattice_pitch_m * 0x1p48}, uses_(complex.faces().size(), 0) {
    // Positions are good to 2^-43 of the lattice's extent.
    tolerance_ = side_ * 0x1p-40;
  }

  [[nodiscard]] std::uint64_t misfits_of(BlockId b, double volume) {
    const Block& block = complex_.blocks()[b];
    std::uint64_t misfits = 0;
    double surface = 0;
    bool fixed = false, free = false, truncated = false;
    for (const FaceId f : block.faces) {
      const Face& face = complex_.faces()[f];
      if (face.block != b || uses_[f.index()]++ != 0 || !fits(face)) ++misfits;
      surface += face.area.si();
      fixed = fixed || face.role == Role::fixed;
      truncated = truncated || face.role == Role::window;
      free = free || face.role == Role::free;
    }
    if (!equal(block.volume.si(), volume, surface) || block.fixed != fixed || block.free != free ||
        block.truncated != truncated) {
      ++misfits;
    }
    return misfits;
  }
  [[nodiscard]] std::uint64_t faces_without_block() const {
    return static_cast<std::uint64_t>(std::ranges::count(uses_, 0));
  }

 private:
  /// Two volumes (areas) may differ by what the rounding of corners does along a surface (perimeter).
  [[nodiscard]] bool equal(double a, double b, double rim) const {
    return std::abs(a - b) <= 1e-9 * std::abs(b) + tolerance_ * rim;
  }

  [[nodiscard]] bool fits(const Face& face) const {
    const exact::Plane& plane = complex_.planes()[face.plane];
    const auto n = plane.unit_normal();
    const double sense = face.block_on_positive_side ? -1 : 1;
    const Vec3 outward = sense * Vec3{n[0], n[1], n[2]};
    if (!(geometry::norm(face.outward - outward) <= 1e-9)) return false;
    const auto& q = plane.approx();
    const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
    const Vec3 apex = complex_.vertices()[complex_.loops(face)[0][0]];
    Vec3 area{};
    double perimeter = 0;
    for (const auto loop : complex_.loops(face)) {
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const Vec3 a = complex_.vertices()[loop[i]], b = complex_.vertices()[loop[(i + 1) % loop.size()]];
        const double height = (q[0] * a.x + q[1] * a.y + q[2] * a.z + q[3] * side_) / length;
        if (!(std::abs(height) <= tolerance_)) return false;
        area += 0.5 * geometry::cross(a - apex, b - apex);
        perimeter += geometry::norm(b - a);
      }
    }
    if (!equal(face.area.si(), geometry::dot(area, outward), perimeter)) return false;
    const bool joint = face.role == Role::joint;
    double patches = 0;
    for (const Patch& patch : complex_.patches(face)) {
      if (patch.neighbour.has_value() != joint || patch.neighbour == face.block) return false;
      patches += patch.area.si();
    }
    return joint || !complex_.patches(face).empty() ? equal(patches, face.area.si(), perimeter) : true;
  }

  const BlockComplex& complex_;
  double side_, tolerance_;
  std::vector<std::uint32_t> uses_;
};

std::uint64_t count_unpaired(const BlockComplex& complex) {
  struct Pair {
    std::uint32_t low, high, plane;
    double area;  ///< of the lower block's patches less those of the higher one's
    double size;
  };
  std::vector<Pair> pairs;
  for (const Face& face : complex.faces()) {
    for (const Patch& patch : complex.patches(face)) {
      if (!patch.neighbour) continue;
      const std::uint32_t a = face.block.value(), b = patch.neighbour->value();
      pairs.push_back({std::min(a, b), std::max(a, b), face.plane.value(), a < b ? patch.area.si() : -patch.area.si(),
                       patch.area.si()});
    }
  }
  const auto key = [](const Pair& p) { return std::array{p.low, p.high, p.plane}; };
  std::ranges::stable_sort(pairs, {}, key);
  std::uint64_t unpaired = 0;
  for (std::size_t first = 0; first < pairs.size();) {
    double area = 0, size = 0;
    std::size_t last = first;
    for (; last < pairs.size() && key(pairs[last]) == key(pairs[first]); ++last) {
      area += pairs[last].area;
      size += pairs[last].size;
    }
    if (std::abs(area) > 1e-9 * size || last - first < 2) ++unpaired;
    first = last;
  }
  return unpaired;
}

}  // namespace

std::expected<AuditedComplex, Certificate> audit(BlockComplex complex) {
  Certificate certificate;
  const auto offend = [&](BlockId block) {
    if (certificate.offenders.size() < 20 && (certificate.offenders.empty() || certificate.offenders.back() != block)) {
      certificate.offenders.push_back(block);
    }
  };
  double volume = 0, compensation = 0;
  bool closures_hold = true;
  FitAuditor fit{complex};
  for (const BlockId b : complex.blocks().ids()) {
    const Block& block = complex.blocks()[b];
    const BlockAuditor auditor{complex, block};
    if (!auditor.closed()) {
      ++certificate.open_shells;
      offend(b);
    }
    if (!auditor.euler_holds()) {
      ++certificate.euler_violations;
      offend(b);
    }
    const BlockMeasure m = measure(complex, block);
    certificate.face_vector_max_relative = std::max(certificate.face_vector_max_relative, m.closure);
    if (m.closure > 1e-12 * std::sqrt(static_cast<double>(block.faces.size()))) {
      closures_hold = false;
      offend(b);
    }
    if (const std::uint64_t misfits = fit.misfits_of(b, m.volume); misfits != 0) {
      certificate.misfits += misfits;
      offend(b);
    }
    const double y = m.volume - compensation, t = volume + y;  // Kahan's sum
    compensation = (t - volume) - y;
    volume = t;
  }
  certificate.unpaired_patches = count_unpaired(complex);
  certificate.misfits += fit.faces_without_block();
  certificate.volume = cubic_metres(volume);
  const double rock = complex.rock_volume().si();
  certificate.volume_relative_error = rock > 0 ? std::abs(volume - rock) / rock : 1;
  certificate.passed = certificate.euler_violations == 0 && certificate.open_shells == 0 &&
                       certificate.unpaired_patches == 0 && certificate.misfits == 0 && closures_hold &&
                       certificate.volume_relative_error <= 1e-10;
  if (!certificate.passed) return std::unexpected(std::move(certificate));
  return AuditedComplex{std::move(complex), std::move(certificate)};
}

std::string canonical_hash(const BlockComplex& complex) {
  std::vector<BlockId> all;
  all.reserve(complex.blocks().size());
  for (const BlockId id : complex.blocks().ids()) all.push_back(id);
  return canonical_hash(complex, all);
}

std::string canonical_hash(const BlockComplex& complex, std::span<const BlockId> blocks) {
  const auto mix = [](std::uint64_t h, std::uint64_t v) {
    h ^= v + 0x9E3779B97F4A7C15U + (h << 6U) + (h >> 2U);
    h ^= h >> 30U;
    h *= 0xBF58476D1CE4E5B9U;
    h ^= h >> 27U;
    h *= 0x94D049BB133111EBU;
    return h ^ (h >> 31U);
  };
  // A coarse grid of 2^-16 of the scene, shifted so that round coordinates do not lie on its borders.
  const double cell = complex.report().lattice_pitch_m * 0x1p30;
  const auto rounded = [&](double x) {
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(x / cell + 0.381966011250105)));
  };
  std::vector<std::uint64_t> digests;
  std::vector<std::uint64_t> corners;
  for (const BlockId id : blocks) {
    const Block& block = complex.blocks()[id];
    corners.clear();
    for (const FaceId f : block.faces) {
      const Face& face = complex.faces()[f];
      std::size_t size = 0;
      for (const auto loop : complex.loops(face)) {
        size += loop.size();
        for (const VertexId v : loop) {
          const Vec3& p = complex.vertices()[v];
          corners.push_back(mix(mix(rounded(p.x), rounded(p.y)), rounded(p.z)));
        }
      }
      corners.push_back(mix(mix(static_cast<std::uint64_t>(face.role), size), complex.loops(face).size()));
    }
    std::ranges::sort(corners);
    const EulerCounts& c = block.counts;
    std::uint64_t h = 0;
    for (const std::uint32_t count : {c.vertices, c.edges, c.faces, c.loops, c.shells, c.genus}) h = mix(h, count);
    for (const std::uint64_t corner : corners) h = mix(h, corner);
    digests.push_back(h);
  }
  std::ranges::sort(digests);
  std::uint64_t low = mix(1, digests.size()), high = mix(2, digests.size());
  for (const std::uint64_t d : digests) {
    low = mix(low, d);
    high = mix(high, d ^ 0xA5A5A5A5A5A5A5A5U);
  }
  return fmt::format("{:016x}{:016x}", high, low);
}

}  // namespace cleave::topology
