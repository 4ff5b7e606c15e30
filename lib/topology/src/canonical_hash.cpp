#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "cleave/core/parallel.hpp"
#include "cleave/topology/audit.hpp"
#include "detail/pieces.hpp"

namespace cleave::topology {

using geometry::Vec3;

std::string canonical_hash(const BlockComplex& complex, unsigned threads) {
  std::vector<BlockId> all;
  all.reserve(complex.blocks().size());
  for (const BlockId id : complex.blocks().ids()) all.push_back(id);
  return canonical_hash(complex, all, threads);
}

std::string canonical_hash(const BlockComplex& complex, std::span<const BlockId> blocks, unsigned thread_count) {
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
  const auto digest_of = [&](const Block& block, std::vector<std::uint64_t>& corners) {
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
    return h;
  };
  std::vector<std::uint64_t> digests(blocks.size());
  const ThreadLimit threads{std::max(1U, thread_count)};
  detail::in_pieces(blocks.size(), 2048, threads, [&](std::size_t first, std::size_t last) {
    std::vector<std::uint64_t> corners;
    for (std::size_t i = first; i < last; ++i) digests[i] = digest_of(complex.blocks()[blocks[i]], corners);
  });
  std::ranges::sort(digests);
  std::uint64_t low = mix(1, digests.size()), high = mix(2, digests.size());
  for (const std::uint64_t d : digests) {
    low = mix(low, d);
    high = mix(high, d ^ 0xA5A5A5A5A5A5A5A5U);
  }
  return fmt::format("{:016x}{:016x}", high, low);
}

}  // namespace cleave::topology
