#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <iterator>
#include <vector>

#include "complexes.hpp"
#include "workloads.hpp"

// A complex keeps its faces packed: what it gives is what was put in, to the last bit.

namespace cleave::testing::packed_faces_test {
namespace {

using topology::BlockComplex;
using topology::Face;
using topology::FaceId;
using topology::Patch;
using Data = BlockComplex::Data;

std::uint64_t bits(double x) { return std::bit_cast<std::uint64_t>(x); }
std::vector<std::uint64_t> bits(geometry::Vec3 v) { return {bits(v.x), bits(v.y), bits(v.z)}; }

void expect_same(const Patch& a, const Patch& b) {
  EXPECT_EQ(a.joint, b.joint);
  EXPECT_EQ(a.neighbour, b.neighbour);
  EXPECT_EQ(bits(a.area.si()), bits(b.area.si()));
  EXPECT_EQ(bits(a.centroid), bits(b.centroid));
}

void expect_same(const Face& a, const Face& b) {
  EXPECT_EQ(a.block, b.block);
  EXPECT_EQ(a.plane, b.plane);
  EXPECT_EQ(a.block_on_positive_side, b.block_on_positive_side);
  EXPECT_EQ(a.role, b.role);
  EXPECT_EQ(a.shell, b.shell);
  EXPECT_EQ(a.joint, b.joint);
  EXPECT_EQ(a.excavation, b.excavation);
  EXPECT_EQ(a.tag, b.tag);
  EXPECT_EQ(bits(a.outward), bits(b.outward));
  EXPECT_EQ(bits(a.area.si()), bits(b.area.si()));
  EXPECT_EQ(bits(a.centroid), bits(b.centroid));
}

/// Of everything that faces say, put in by `data` and asked for one by one.
void expect_given_back(const Data& data) {
  const BlockComplex complex{data};
  ASSERT_EQ(complex.faces().size(), data.faces.size());
  for (const FaceId f : data.faces.ids()) {
    const Face &in = data.faces[f], out = complex.faces()[f];
    expect_same(in, out);
    const auto loops = data.loops(in), again = complex.loops(f);
    ASSERT_EQ(again.size(), loops.size());
    for (std::size_t l = 0; l < loops.size(); ++l) {
      EXPECT_TRUE(std::ranges::equal(loops[l], again[l]));
      EXPECT_TRUE(std::ranges::equal(loops[l], complex.loops(out)[l]));
    }
    const auto patches = data.patches_of(in);
    const topology::PatchRange own = complex.patches(out);
    ASSERT_EQ(own.size(), patches.size());
    for (std::size_t p = 0; p < patches.size(); ++p) expect_same(patches[p], own[p]);
    // What is to be had without the face.
    EXPECT_EQ(complex.faces().block(f), in.block);
    EXPECT_EQ(complex.faces().plane(f), in.plane);
    std::vector<Patch> beside;
    std::ranges::copy_if(patches, std::back_inserter(beside), [](const Patch& p) { return p.neighbour.has_value(); });
    std::size_t next = 0;
    complex.faces().visit_neighbours(f, [&](topology::BlockId other, Area area) {
      ASSERT_LT(next, beside.size());
      EXPECT_EQ(other, beside[next].neighbour);
      EXPECT_EQ(bits(area.si()), bits(beside[next].area.si()));
      ++next;
    });
    EXPECT_EQ(next, beside.size());
  }
}

std::vector<topology::CutInput> scenes() {
  std::vector<topology::CutInput> all;
  for (const char* name : {"grid-3", "deg-cavity", "deg-ring", "rect-13", "disc-1000"}) {
    all.push_back(support::cut_input(support::workload_named(name).value()));
  }
  all.push_back(scene(box({0, 0, 0}, {4, 4, 4}), {rectangle(2, 2, {-1, -1}, {5, 5})}, {box({1, 1, -1}, {3, 3, 5})}));
  return all;
}

TEST(PackedFaces, GiveBackWhatTheCutterMade) {
  for (const auto& input : scenes()) {
    const BlockComplex complex = topology::cut(input).value();
    expect_given_back(complex.data());
    expect_given_back(BlockComplex{complex.data()}.data());
  }
}

// Whatever of a face is changed: the rules that it is packed by must not put it right.
TEST(PackedFaces, GiveBackWhatFollowsNoRule) {
  const Data sound = topology::cut(scenes()[0]).value().data();
  const auto changed = [&](const auto& change) {
    for (const std::size_t number : {std::size_t{0}, sound.faces.size() / 2, sound.faces.size() - 1}) {
      Data data = sound;
      change(data, data.faces[FaceId{number}]);
      expect_given_back(data);
    }
  };
  changed([](Data&, Face& f) { f.outward = -f.outward; });
  changed([](Data&, Face& f) { f.outward.x += 1e-300; });
  changed([](Data&, Face& f) { f.outward.y = f.outward.y == 0 ? -f.outward.y : f.outward.y; });
  changed([](Data&, Face& f) { f.block_on_positive_side = !f.block_on_positive_side; });
  changed([](Data&, Face& f) { f.area = 2.0 * f.area; });
  changed([](Data&, Face& f) { f.centroid.z += 1; });
  changed([](Data&, Face& f) { f.shell = 3; });
  changed([](Data&, Face& f) { f.joint = topology::JointId{7}; });
  changed([](Data&, Face& f) { f.joint = std::nullopt; });
  changed([](Data&, Face& f) { f.tag = 5; });
  changed([](Data&, Face& f) { f.excavation = 2; });
  changed([](Data&, Face& f) { f.role = topology::Role::free; });
  changed([](Data&, Face& f) { f.role = topology::Role::window; });
  changed([](Data&, Face& f) {
    f.first_corner += 1;
    f.corner_count -= 1;
  });
  changed([](Data&, Face& f) { f.corner_count -= 1; });
  changed([](Data&, Face& f) { f.patch_count = 0; });
  changed([](Data& d, Face& f) { d.set_patches(f, std::vector<Patch>(3, d.patches_of(f)[0])); });
  changed([](Data& d, Face& f) { d.patches[f.first_patch].neighbour = topology::BlockId{UINT32_MAX}; });
  changed([](Data& d, Face& f) { d.patches[f.first_patch].neighbour = std::nullopt; });
  changed([](Data& d, Face& f) { d.patches[f.first_patch].joint = topology::JointId{99}; });
  changed([](Data& d, Face& f) { d.patches[f.first_patch].area = square_metres(1); });
  changed([](Data& d, Face& f) { d.set_loops(f, {{topology::VertexId{0}, topology::VertexId{1}}}); });
}

// Room: nothing of a grid is kept whole, however it comes about.
TEST(PackedFaces, OfAGridAreAllPacked) {
  const BlockComplex complex = topology::cut(support::cut_input(support::workload_named("grid-4").value())).value();
  const BlockComplex again{complex.data()};
  for (const FaceId f : complex.faces().ids()) {
    EXPECT_EQ(complex.faces().kept_whole(f), nullptr);
    EXPECT_EQ(again.faces().kept_whole(f), nullptr);
  }
}

}  // namespace
}  // namespace cleave::testing::packed_faces_test
