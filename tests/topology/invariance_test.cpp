#include <gtest/gtest.h>

#include <algorithm>

#include "complexes.hpp"
#include "workloads.hpp"

// Relations that keep the block system: no answer needs to be known.

namespace cleave::testing {
namespace {

using Corners = std::vector<Vec3>;

template <class Map>
support::Workload mapped(support::Workload workload, const Map& map) {
  for (Vec3& p : workload.corners) p = map(p);
  for (Corners& polygon : workload.polygons) std::ranges::transform(polygon, polygon.begin(), map);
  return workload;
}

/// Counts of all blocks, sorted: the same whatever the unit of length.
std::vector<std::array<unsigned, 6>> counts(const topology::CutInput& input) {
  std::vector<std::array<unsigned, 6>> out;
  for (const Shape& s : shapes(input)) out.push_back(s.counts);
  std::ranges::sort(out);
  return out;
}

constexpr std::array names{"rect-13",   "gridr-4",      "persist-8", "deg-cavity", "deg-ring",
                           "deg-touch", "deg-coplanar", "deg-fan12", "deg-fan12r"};

TEST(Invariance, OrderAndRepetitionOfTheJoints) {
  for (const char* name : names) {
    const support::Workload workload = support::workload_named(name).value();
    const auto reference = hash_of(support::cut_input(workload));
    auto other = workload;
    std::ranges::reverse(other.polygons);
    EXPECT_EQ(hash_of(support::cut_input(other)), reference) << name << ", backwards";
    std::ranges::rotate(other.polygons,
                        other.polygons.begin() + static_cast<std::ptrdiff_t>(other.polygons.size() / 3));
    EXPECT_EQ(hash_of(support::cut_input(other)), reference) << name << ", rotated";
    other = workload;
    other.polygons.insert(other.polygons.end(), workload.polygons.begin(), workload.polygons.end());
    other.polygons.insert(other.polygons.begin(), workload.polygons.rbegin(), workload.polygons.rend());
    EXPECT_EQ(hash_of(support::cut_input(other)), reference) << name << ", three times";
  }
}

TEST(Invariance, SenseOfThePolygons) {
  for (const char* name : names) {
    const support::Workload workload = support::workload_named(name).value();
    auto other = workload;
    // The first corner stays first: which corners fix the plane is part of the input.
    for (Corners& polygon : other.polygons) std::reverse(polygon.begin() + 1, polygon.end());
    EXPECT_EQ(shapes(support::cut_input(other)), shapes(support::cut_input(workload))) << name;
  }
}

TEST(Invariance, ExactScaling) {
  for (const char* name : names) {
    const support::Workload workload = support::workload_named(name).value();
    const auto reference = hash_of(support::cut_input(workload));
    for (const double factor : {0x1p-10, 0x1p10, 0x1p30}) {
      EXPECT_EQ(hash_of(support::cut_input(mapped(workload, [&](Vec3 p) { return factor * p; }))), reference)
          << name << " x " << factor;
    }
  }
}

TEST(Invariance, ScalingByAThousand) {
  for (const char* name : {"rect-13", "persist-8", "grid-4", "deg-cavity", "deg-ring", "deg-touch"}) {
    const support::Workload workload = support::workload_named(name).value();
    const auto reference = support::cut_input(workload);
    const auto reference_volumes = volumes(reference);
    for (const double factor : {1e-3, 1e3}) {
      const auto scaled = support::cut_input(mapped(workload, [&](Vec3 p) { return factor * p; }));
      EXPECT_EQ(counts(scaled), counts(reference)) << name << " x " << factor;
      const auto found = volumes(scaled);
      ASSERT_EQ(found.size(), reference_volumes.size());
      const double whole = factor * factor * factor;
      for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_NEAR(found[i], whole * reference_volumes[i],
                    whole * (1e-12 * reference_volumes.back() + 1e-9 * reference_volumes[i]));
      }
    }
  }
}

TEST(Invariance, FarFromTheOrigin) {
  for (const char* name : {"rect-13", "persist-8", "deg-cavity", "deg-ring", "deg-touch"}) {
    const support::Workload workload = support::workload_named(name).value();
    const auto reference = support::cut_input(workload);
    const auto reference_volumes = volumes(reference);
    for (const double by : {1e7, -1e7}) {
      const auto moved = support::cut_input(mapped(workload, [&](Vec3 p) { return p + Vec3{by, by, by / 1000}; }));
      EXPECT_EQ(counts(moved), counts(reference)) << name;
      const auto found = volumes(moved);
      ASSERT_EQ(found.size(), reference_volumes.size());
      // Coordinates are rounded to 2e-9 m; a side of a block is at most 80 m wide.
      for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], reference_volumes[i], 1e-8 * 6 * 80 * 80);
    }
  }
}

TEST(Invariance, ExactTranslation) {
  for (const char* name : {"grid-4", "deg-cavity", "deg-ring", "deg-touch", "deg-coplanar"}) {
    const support::Workload workload = support::workload_named(name).value();
    const auto reference = shapes(support::cut_input(workload));
    EXPECT_EQ(shapes(support::cut_input(mapped(workload, [](Vec3 p) { return p + Vec3{0x1p20, -0x1p21, 0x1p19}; }))),
              reference)
        << name;
  }
}

TEST(Invariance, AxesTurnedAndSwapped) {
  for (const char* name : names) {
    const support::Workload workload = support::workload_named(name).value();
    const auto reference = counts(support::cut_input(workload));
    EXPECT_EQ(counts(support::cut_input(mapped(workload, [](Vec3 p) { return Vec3{p.y, p.z, p.x}; }))), reference)
        << name;
    EXPECT_EQ(counts(support::cut_input(mapped(workload, [](Vec3 p) { return Vec3{p.y, p.x, p.z}; }))), reference)
        << name;
    EXPECT_EQ(counts(support::cut_input(mapped(workload, [](Vec3 p) { return Vec3{-p.x, p.y, p.z}; }))), reference)
        << name;
  }
}

TEST(Invariance, RemovingAJointNeverAddsABlock) {
  const support::Workload workload = support::workload_named("rect-13").value();
  std::size_t last = 347;
  auto fewer = workload;
  while (fewer.polygons.size() > 3) {
    fewer.polygons.erase(fewer.polygons.begin() + 1, fewer.polygons.begin() + 4);
    const auto count = count_blocks(support::cut_input(fewer));
    EXPECT_LE(count, last);
    last = count;
  }
}

// Large enough for several shares of blocks: the same faces and corners in the same places.
TEST(Invariance, SharesOfThreadsDoNotMatter) {
  for (const char* name : {"rect-30", "grid-20"}) {
    const auto input = support::cut_input(support::workload_named(name).value());
    const auto one = topology::cut(input).value();
    for (const unsigned threads : {2U, 7U}) {
      const auto many = topology::cut(input, {.threads = threads}).value();
      EXPECT_EQ(canonical_hash(many), canonical_hash(one)) << name;
      EXPECT_EQ(many.data().corners, one.data().corners) << name;
      EXPECT_EQ(many.data().hole_starts, one.data().hole_starts) << name;
      EXPECT_EQ(many.data().vertices, one.data().vertices) << name;
      ASSERT_EQ(many.faces().size(), one.faces().size()) << name;
      bool same = true;
      for (const topology::FaceId f : one.faces().ids()) {
        const topology::Face &a = one.faces()[f], &b = many.faces()[f];
        same = same && a.block == b.block && a.area == b.area && a.first_corner == b.first_corner &&
               a.first_hole == b.first_hole && a.first_patch == b.first_patch && a.patch_count == b.patch_count;
      }
      EXPECT_TRUE(same) << name;
      EXPECT_EQ(topology::audit(many, threads).value().certificate().volume,
                topology::audit(one).value().certificate().volume);
      EXPECT_EQ(canonical_hash(one, threads), canonical_hash(one)) << name;
    }
  }
}

TEST(Invariance, ThreadsDoNotMatter) {
  const auto input = support::cut_input(support::workload_named("rect-13").value());
  const auto one = canonical_hash(topology::cut(input, {.threads = 1}).value());
  const auto two = canonical_hash(topology::cut(input, {.threads = 2}).value());
  EXPECT_EQ(one, two);
}

TEST(CanonicalHash, TellsBlockSystemsApart) {
  std::vector<std::string> hashes;
  for (const char* name : names) hashes.push_back(hash_of(support::cut_input(support::workload_named(name).value())));
  auto moved = support::workload_named("rect-13").value();
  for (Vec3& p : moved.polygons[5]) p.z += 0.1;
  hashes.push_back(hash_of(support::cut_input(moved)));
  std::ranges::sort(hashes);
  EXPECT_EQ(std::ranges::adjacent_find(hashes), hashes.end());
}

}  // namespace
}  // namespace cleave::testing
