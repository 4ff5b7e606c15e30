#include "cleave/topology/audit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numeric>
#include <tuple>

#include "detail/pieces.hpp"

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

/// Recomputes closedness and Euler-Poincare of blocks, one after another, from the loops of their faces alone.
class BlockAuditor {
 public:
  explicit BlockAuditor(const BlockComplex& complex) : complex_{complex}, local_(complex.vertices().size(), unset) {}

  /// Is every side used once in each direction?
  [[nodiscard]] bool closed(const Block& block) {
    block_ = &block;
    sides_.clear();
    loops_ = 0;
    for (const std::uint32_t v : known_) local_[v] = unset;
    known_.clear();
    first_record_.clear();
    const auto local = [&](VertexId v) {
      std::uint32_t& number = local_[v.index()];
      if (number == unset) {
        number = static_cast<std::uint32_t>(known_.size());
        known_.push_back(v.value());
        first_record_.push_back(unset);
      }
      return number;
    };
    for (std::uint32_t f = 0; f < block.faces.size(); ++f) {
      for (const auto loop : complex_.loops(complex_.faces()[block.faces[f]])) {
        const auto first = static_cast<std::uint32_t>(sides_.size());
        const auto count = static_cast<std::uint32_t>(loop.size());
        std::uint32_t from = local(loop[0]);
        for (std::uint32_t i = 0; i < count; ++i) {
          const std::uint32_t to = local(loop[i + 1 < count ? i + 1 : 0]);
          sides_.push_back({from, to, i + 1 < count ? first + i + 1 : first, f, unset});
          from = to;
        }
        ++loops_;
      }
    }
    closed_ = pair_sides();
    return closed_;
  }

  /// (B1) shell by shell: an odd or negative genus means an open or wrongly joined shell. Of the block last given to
  /// `closed`.
  [[nodiscard]] bool euler_holds() {
    if (!closed_) return false;
    // Shells: faces joined over their sides.
    parent_.resize(block_->faces.size());
    std::iota(parent_.begin(), parent_.end(), 0U);
    const auto find = [&](std::uint32_t a) {
      while (parent_[a] != a) a = parent_[a] = parent_[parent_[a]];
      return a;
    };
    for (const Side& s : sides_) {
      const std::uint32_t a = find(s.face), b = find(sides_[s.partner].face);
      parent_[std::max(a, b)] = std::min(a, b);
    }
    sums_.assign(block_->faces.size(), {});
    std::uint32_t shells = 0;
    for (std::uint32_t f = 0; f < block_->faces.size(); ++f) {
      const std::uint32_t root = find(f);
      if (root == f) ++shells;
      sums_[root].faces_less_loops +=
          2 - static_cast<std::int64_t>(complex_.loops(complex_.faces()[block_->faces[f]]).size());
    }
    // Fans: turning round a vertex from face to face; a pinched vertex has several.
    seen_.assign(sides_.size(), 0);
    std::int64_t fans = 0;
    for (std::uint32_t s = 0; s < sides_.size(); ++s) {
      Sum& sum = sums_[find(sides_[s].face)];
      ++sum.sides;
      if (seen_[s] != 0) continue;
      ++fans;
      ++sum.vertices;
      std::uint32_t at = s;
      do {
        seen_[at] = 1;
        at = sides_[sides_[at].next].partner;
      } while (at != s);
    }
    std::int64_t genus = 0;
    for (std::uint32_t f = 0; f < sums_.size(); ++f) {
      if (parent_[f] != f) continue;
      const std::int64_t twice = 2 - (sums_[f].vertices - sums_[f].sides / 2 + sums_[f].faces_less_loops);
      if (twice < 0 || twice % 2 != 0) return false;
      genus += twice / 2;
    }
    const EulerCounts& c = block_->counts;
    return c.vertices == fans && c.edges == sides_.size() / 2 && c.faces == block_->faces.size() && c.loops == loops_ &&
           c.shells == shells && c.genus == genus;
  }

 private:
  /// A pair of vertices joined by sides; those of one lower vertex form a chain.
  struct Record {
    std::uint32_t high, next;
    std::uint32_t forward, backward;  ///< a side from the lower to the higher vertex, and one back
  };

  /// Each side needs one in the opposite direction. Where the boundary touches itself along an edge there are several:
  /// the partner of a face is then the next one met when turning from it through the inside of the block.
  bool pair_sides() {
    records_.clear();
    bool several = false;
    for (std::uint32_t s = 0; s < sides_.size() && !several; ++s) {
      const std::uint32_t low = std::min(sides_[s].from, sides_[s].to), high = std::max(sides_[s].from, sides_[s].to);
      std::uint32_t r = first_record_[low];
      while (r != unset && records_[r].high != high) r = records_[r].next;
      if (r == unset) {
        r = static_cast<std::uint32_t>(records_.size());
        records_.push_back({high, first_record_[low], unset, unset});
        first_record_[low] = r;
      }
      std::uint32_t& own = sides_[s].from == low ? records_[r].forward : records_[r].backward;
      several = own != unset || low == high;
      own = s;
    }
    if (several) return pair_groups();
    for (const Record& r : records_) {
      if (r.forward == unset || r.backward == unset) return false;
      sides_[r.forward].partner = r.backward;
      sides_[r.backward].partner = r.forward;
    }
    return true;
  }

  bool pair_groups() {
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
    const Vec3 a = complex_.vertices()[VertexId{known_[std::min(any.from, any.to)]}],
               b = complex_.vertices()[VertexId{known_[std::max(any.from, any.to)]}];
    // An edge shorter than doubles can tell has no direction; any will do to go on, at worst the certificate does not
    // pass.
    const Vec3 axis = b == a ? Vec3{0, 0, 1} : geometry::normalized(b - a);
    const Vec3 e1 = geometry::normalized(geometry::cross(axis, std::abs(axis.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
    const Vec3 e2 = geometry::cross(axis, e1);
    std::vector<std::pair<double, std::uint32_t>> around;
    for (const std::uint32_t s : group) {
      // Into the face: outward normal x direction of the side.
      const Vec3 m = complex_.faces()[block_->faces[sides_[s].face]].outward;
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

  struct Sum {
    std::int64_t vertices = 0, sides = 0, faces_less_loops = 0;
  };

  const BlockComplex& complex_;
  const Block* block_ = nullptr;
  std::vector<std::uint32_t> local_;  ///< number of each vertex within the block
  std::vector<std::uint32_t> known_;  ///< vertices of the block
  std::vector<std::uint32_t> first_record_;
  std::vector<Record> records_;
  std::vector<Side> sides_;
  std::vector<std::uint32_t> parent_;
  std::vector<Sum> sums_;
  std::vector<std::uint8_t> seen_;
  std::size_t loops_ = 0;
  bool closed_ = false;
};

struct BlockMeasure {
  double volume = 0;
  double closure = 0;  ///< |sum A_f| / sum |A_f|
  std::uint64_t misfits = 0;
};

/// Measures blocks from the corners of their faces, and checks every stored measure, side and flag against those and
/// the exact planes.
class FitAuditor {
 public:
  explicit FitAuditor(const BlockComplex& complex)
      : complex_{complex}, side_{complex.report().lattice_pitch_m * 0x1p48} {
    // Positions are good to 2^-43 of the lattice's extent.
    tolerance_ = side_ * 0x1p-40;
    normals_.reserve(complex.planes().size());
    for (const exact::Plane& plane : complex.planes()) {
      const auto& q = plane.approx();
      const auto n = plane.unit_normal();
      const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
      normals_.push_back({{n[0], n[1], n[2]}, q[3] / length * side_});
    }
  }

  [[nodiscard]] BlockMeasure measure(BlockId b) const {
    const Block& block = complex_.blocks()[b];
    BlockMeasure out;
    if (block.faces.empty() || complex_.faces()[block.faces[0]].corner_count == 0) return {0, 1, 1};
    const Vec3 apex = complex_.vertices()[complex_.loops(complex_.faces()[block.faces[0]])[0][0]];
    Vec3 sum{};
    double size = 0, surface = 0;
    bool fixed = false, free = false, truncated = false;
    for (const FaceId f : block.faces) {
      const Face& face = complex_.faces()[f];
      Vec3 area{};
      if (face.block != b || face.corner_count == 0 || !fits(face, apex, area)) ++out.misfits;
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
    if (!equal(block.volume.si(), out.volume, surface) || block.fixed != fixed || block.free != free ||
        block.truncated != truncated) {
      ++out.misfits;
    }
    return out;
  }
  /// Faces that are not among those of the block they name.
  [[nodiscard]] std::uint64_t faces_without_block() const {
    std::uint64_t lost = 0;
    for (const FaceId f : complex_.faces().ids()) {
      const Face& face = complex_.faces()[f];
      if (face.block.index() >= complex_.blocks().size()) {
        ++lost;
        continue;
      }
      const FaceRange own = complex_.blocks()[face.block].faces;
      if (own.empty() || f < own.front() || f.index() >= own.front().index() + own.size()) ++lost;
    }
    return lost;
  }

 private:
  struct UnitPlane {
    Vec3 normal;
    double offset;  ///< m
  };

  /// Two volumes (areas) may differ by what the rounding of corners does along a surface (perimeter).
  [[nodiscard]] bool equal(double a, double b, double rim) const {
    return std::abs(a - b) <= 1e-9 * std::abs(b) + tolerance_ * rim;
  }

  /// `area` becomes the vector area of the face's corners, from `apex`: with one apex for all faces of a block each
  /// edge adds the same part to two of them, with opposite signs and to the last bit.
  [[nodiscard]] bool fits(const Face& face, Vec3 apex, Vec3& area) const {
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
    if (!(highest <= tolerance_)) return false;
    const Vec3 off = face.outward - outward;
    if (!(geometry::dot(off, off) <= 1e-18)) return false;
    double patches = 0;
    const bool joint = face.role == Role::joint;
    const auto own = complex_.patches(face);
    for (const Patch& patch : own) {
      if (patch.neighbour.has_value() != joint || patch.neighbour == face.block) return false;
      patches += patch.area.si();
    }
    if (!joint && own.empty()) patches = face.area.si();
    // Nearly always all areas agree to rounding. Else the face is measured from a corner of its own, which is better
    // for small faces, and by what moves of its corners along its rim may do.
    const double measured = geometry::dot(area, outward);
    if (equal(face.area.si(), measured, 0) && equal(patches, face.area.si(), 0)) return true;
    const auto [own_area, rim] = measure_alone(face);
    return equal(face.area.si(), geometry::dot(own_area, outward), rim) && equal(patches, face.area.si(), rim);
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
  double side_, tolerance_;
  std::vector<UnitPlane> normals_;
};

/// Patches between two blocks in one plane whose areas are not matched from the other side.
std::uint64_t count_unpaired(const BlockComplex& complex, ThreadLimit threads) {
  struct Pair {
    std::uint32_t high, plane;
    double area;  ///< of the lower block's patches less those of the higher one's
  };
  const std::size_t blocks = complex.blocks().size();
  std::vector<std::uint32_t> begin(blocks + 1, 0);  // by lower block (CSR)
  const bool alone = threads.count() == 1;
  const auto count = [alone](std::uint32_t& number) {  // gives the number before
    return alone ? number++ : std::atomic_ref{number}.fetch_add(1, std::memory_order_relaxed);
  };
  const auto for_each = [&](const auto& visit) {
    detail::in_pieces(complex.faces().size(), 16384, threads, [&](std::size_t first, std::size_t last) {
      for (std::size_t f = first; f < last; ++f) {
        const Face& face = complex.faces()[FaceId{f}];
        for (const Patch& patch : complex.patches(face)) {
          if (patch.neighbour) visit(face, patch, face.block.value(), patch.neighbour->value());
        }
      }
    });
  };
  std::atomic<std::uint64_t> found{0};
  for_each([&](const Face&, const Patch&, std::uint32_t a, std::uint32_t b) {
    if (std::max(a, b) < blocks) {
      count(begin[std::min(a, b) + std::size_t{1}]);
    } else {
      ++found;
    }
  });
  for (std::size_t k = 1; k < begin.size(); ++k) begin[k] += begin[k - 1];
  std::vector<Pair> pairs(begin.back());
  auto next = begin;
  for_each([&](const Face& face, const Patch& patch, std::uint32_t a, std::uint32_t b) {
    if (std::max(a, b) >= blocks) return;
    pairs[count(next[std::min(a, b)])] = {std::max(a, b), face.plane.value(),
                                          a < b ? patch.area.si() : -patch.area.si()};
  });
  detail::in_pieces(blocks, 4096, threads, [&](std::size_t first_block, std::size_t last_block) {
    std::uint64_t here = 0;
    for (std::size_t b = first_block; b < last_block; ++b) {
      const std::span own = std::span{pairs}.subspan(begin[b], begin[b + 1] - begin[b]);
      const auto before = [](const Pair& x, const Pair& y) {
        return std::tie(x.high, x.plane, x.area) < std::tie(y.high, y.plane, y.area);
      };
      if (own.size() < 64) {  // insertion sort: most blocks have a few neighbours
        for (std::size_t i = 1; i < own.size(); ++i) {
          for (std::size_t j = i; j > 0 && before(own[j], own[j - 1]); --j) std::swap(own[j], own[j - 1]);
        }
      } else {
        std::ranges::sort(own, before);
      }
      for (std::size_t first = 0; first < own.size();) {
        double area = 0, size = 0;
        std::size_t last = first;
        for (; last < own.size() && own[last].high == own[first].high && own[last].plane == own[first].plane; ++last) {
          area += own[last].area;
          size += std::abs(own[last].area);
        }
        if (std::abs(area) > 1e-9 * size || last - first < 2) ++here;
        first = last;
      }
    }
    found += here;
  });
  return found;
}

}  // namespace

std::expected<AuditedComplex, Certificate> audit(BlockComplex complex, unsigned thread_count) {
  const ThreadLimit threads{std::max(1U, thread_count)};
  const std::size_t blocks = complex.blocks().size();
  struct Verdict {
    BlockMeasure measure;
    bool closed = false, euler = false;
  };
  std::vector<Verdict> verdicts(blocks);
  const FitAuditor fit{complex};
  const std::size_t grain = std::max<std::size_t>(8192, blocks / (8 * threads.count()));  // each piece is set up anew
  detail::in_pieces(blocks, grain, threads, [&](std::size_t first, std::size_t last) {
    BlockAuditor auditor{complex};
    for (std::size_t b = first; b < last; ++b) {
      const BlockId id{b};
      verdicts[b].closed = auditor.closed(complex.blocks()[id]);
      verdicts[b].euler = auditor.euler_holds();
      verdicts[b].measure = fit.measure(id);
    }
  });

  Certificate certificate;
  double volume = 0, compensation = 0;
  bool closures_hold = true;
  for (std::size_t b = 0; b < blocks; ++b) {
    const Verdict& verdict = verdicts[b];
    const BlockMeasure& m = verdict.measure;
    if (!verdict.closed) ++certificate.open_shells;
    if (!verdict.euler) ++certificate.euler_violations;
    certificate.misfits += m.misfits;
    certificate.face_vector_max_relative = std::max(certificate.face_vector_max_relative, m.closure);
    const bool closes = m.closure <= 1e-12 * std::sqrt(static_cast<double>(complex.blocks()[BlockId{b}].faces.size()));
    closures_hold = closures_hold && closes;
    const bool sound = verdict.closed && verdict.euler && m.misfits == 0 && closes;
    if (!sound && certificate.offenders.size() < 20) certificate.offenders.emplace_back(b);
    const double y = m.volume - compensation, t = volume + y;  // Kahan's sum
    compensation = (t - volume) - y;
    volume = t;
  }
  certificate.unpaired_patches = count_unpaired(complex, threads);
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
