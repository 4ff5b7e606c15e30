#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "complexes.hpp"
#include "workloads.hpp"

// The certificate must notice every way in which a block system can be wrong: a sound one is changed in one place.

namespace cleave::testing::tamper_test {
namespace {

using topology::BlockComplex;
using topology::BlockId;
using topology::Face;
using topology::FaceId;
using topology::VertexId;
using Data = BlockComplex::Data;

/// A column of 14 sides in a box: blocks of 28 and 36 corners.
topology::CutInput column() {
  topology::CutInput input = scene(box({0, 0, 0}, {4, 4, 4}));
  const auto corner = [](int k, double z) {
    const double angle = 2 * std::numbers::pi * (k % 14) / 14;
    return geometry::Vec3{2 + 1.25 * std::cos(angle), 2 + 1.25 * std::sin(angle), z};
  };
  for (int k = 0; k < 14; ++k) {
    input.joints.emplace_back(joint({corner(k, -1), corner(k + 1, -1), corner(k + 1, 5), corner(k, 5)}));
  }
  return input;
}

/// 27 blocks; block systems with concave blocks, holes, cavities and many corners.
std::vector<topology::CutInput> sound_scenes() {
  auto grid = support::cut_input(support::workload_named("grid-3").value());
  auto cavity = support::cut_input(support::workload_named("deg-cavity").value());
  auto ring = support::cut_input(support::workload_named("deg-ring").value());
  auto shaft =
      scene(box({0, 0, 0}, {4, 4, 4}), {rectangle(2, 2, {-1, -1}, {5, 5}), rectangle(1, 1.5, {-1, -1}, {5, 2})},
            {box({1, 1, -1}, {3, 3, 5})});
  auto random = support::cut_input(support::workload_named("rect-13").value());
  return {grid, cavity, ring, shaft, random, column()};
}

void expect_noticed(const std::function<bool(Data&)>& change, const char* what) {
  std::size_t changed = 0;
  for (const auto& input : sound_scenes()) {
    const BlockComplex sound = topology::cut(input).value();
    ASSERT_TRUE(topology::audit(sound).has_value());
    Data data = sound.data();
    if (!change(data)) continue;
    ++changed;
    const auto audited = topology::audit(BlockComplex{std::move(data)});
    EXPECT_FALSE(audited.has_value()) << what << ", scene of " << sound.blocks().size() << " blocks";
    if (!audited) {
      EXPECT_FALSE(audited.error().passed);
    }
  }
  EXPECT_GE(changed, 1U) << what;
}

FaceId a_joint_face(const Data& data) {
  for (const FaceId f : data.faces.ids()) {
    if (data.faces[f].role == topology::Role::joint) return f;
  }
  return FaceId{0U};
}

using Loops = std::vector<std::vector<VertexId>>;
void change_loops(Data& data, FaceId f, const std::function<void(Loops&)>& change) {
  Loops loops;
  for (const auto loop : data.loops(data.faces[f])) loops.emplace_back(loop.begin(), loop.end());
  change(loops);
  data.set_loops(data.faces[f], loops);
}

TEST(Audit, NoticesALoopTurnedRound) {
  expect_noticed(
      [](Data& d) {
        change_loops(d, a_joint_face(d), [](Loops& loops) { std::ranges::reverse(loops[0]); });
        return true;
      },
      "a loop turned round");
}

TEST(Audit, NoticesAFaceOnTheWrongSide) {
  expect_noticed(
      [](Data& d) {
        Face& face = d.faces[a_joint_face(d)];
        face.block_on_positive_side = !face.block_on_positive_side;
        return true;
      },
      "block on the other side of its plane");
  expect_noticed(
      [](Data& d) {
        Face& face = d.faces[a_joint_face(d)];
        face.outward = -face.outward;
        return true;
      },
      "normal turned round");
  expect_noticed(
      [](Data& d) {
        Face& face = d.faces[a_joint_face(d)];
        face.block_on_positive_side = !face.block_on_positive_side;
        face.outward = -face.outward;
        change_loops(d, a_joint_face(d), [](Loops& loops) {
          for (auto& loop : loops) std::ranges::reverse(loop);
        });
        return true;
      },
      "the whole face turned round");
}

TEST(Audit, NoticesALostLoop) {
  expect_noticed(
      [](Data& d) {
        for (const FaceId f : d.faces.ids()) {
          if (d.loops(d.faces[f]).size() < 2) continue;
          change_loops(d, f, [](Loops& loops) { loops.pop_back(); });
          return true;
        }
        return false;
      },
      "a hole lost");
}

TEST(Audit, NoticesALostFace) {
  expect_noticed(
      [](Data& d) {
        auto& block = d.blocks[d.faces[a_joint_face(d)].block];
        block.faces = {block.faces.front(), static_cast<std::uint32_t>(block.faces.size() - 1)};
        return true;
      },
      "a face lost");
}

TEST(Audit, NoticesALostCornerAndAMovedOne) {
  expect_noticed(
      [](Data& d) {
        change_loops(d, a_joint_face(d), [](Loops& loops) { loops[0].pop_back(); });
        return true;
      },
      "a corner lost");
  for (const double by : {1e-3, 1e-6}) {
    expect_noticed(
        [by](Data& d) {
          for (std::size_t v = 0; v < d.vertices.size(); v += 7) {
            auto copy = d;
            copy.vertices[VertexId{v}] += Vec3{by, 2 * by, 3 * by};
            if (topology::audit(BlockComplex{std::move(copy)})) {
              ADD_FAILURE() << "vertex " << v << " moved by " << by;
              return true;
            }
          }
          d.vertices[VertexId{0U}] += Vec3{by, by, by};
          return true;
        },
        "a vertex moved");
  }
}

TEST(Audit, NoticesWrongCounts) {
  using Member = std::uint32_t topology::EulerCounts::*;
  for (const Member member :
       {&topology::EulerCounts::vertices, &topology::EulerCounts::edges, &topology::EulerCounts::faces,
        &topology::EulerCounts::loops, &topology::EulerCounts::shells, &topology::EulerCounts::genus}) {
    expect_noticed(
        [member](Data& d) {
          ++(d.blocks[BlockId{0U}].counts.*member);
          return true;
        },
        "a wrong count");
  }
}

TEST(Audit, NoticesAWrongNeighbour) {
  expect_noticed(
      [](Data& d) {
        if (d.blocks.size() < 3) return false;
        Face& face = d.faces[a_joint_face(d)];
        for (const BlockId b : d.blocks.ids()) {
          topology::Patch& patch = d.patches[face.first_patch];
          if (b == face.block || b == patch.neighbour) continue;
          patch.neighbour = b;
          return true;
        }
        return false;
      },
      "a wrong neighbour");
  expect_noticed(
      [](Data& d) {
        Face& face = d.faces[a_joint_face(d)];
        d.patches[face.first_patch].neighbour = face.block;
        return true;
      },
      "a block that is its own neighbour");
  expect_noticed(
      [](Data& d) {
        d.faces[a_joint_face(d)].patch_count = 0;
        return true;
      },
      "patches lost");
}

TEST(Audit, NoticesWrongMeasures) {
  expect_noticed(
      [](Data& d) {
        d.rock_volume = 1.000001 * d.rock_volume;
        return true;
      },
      "the domain larger than its blocks");
  expect_noticed(
      [](Data& d) {
        auto& block = d.blocks[BlockId{0U}];
        block.volume = 1.000001 * block.volume;
        return true;
      },
      "a wrong volume");
  expect_noticed(
      [](Data& d) {
        Face& face = d.faces[a_joint_face(d)];
        face.area = 1.000001 * face.area;
        return true;
      },
      "a wrong area");
  expect_noticed(
      [](Data& d) {
        Face& face = d.faces[a_joint_face(d)];
        d.patches[face.first_patch].area = 0.999 * d.patches[face.first_patch].area;
        return true;
      },
      "a wrong contact area");
}

TEST(Audit, NoticesFlagsThatAreNotThoseOfTheFaces) {
  expect_noticed(
      [](Data& d) {
        auto& block = d.blocks[BlockId{0U}];
        block.fixed = !block.fixed;
        return true;
      },
      "fixed or not");
  expect_noticed(
      [](Data& d) {
        auto& block = d.blocks[BlockId{0U}];
        block.free = !block.free;
        return true;
      },
      "free or not");
}

// What only one of the checks can see: the block systems are sound in every other respect.
TEST(Audit, NoticesAFaceThatNoBlockHas) {
  expect_noticed(
      [](Data& d) {
        for (const FaceId f : d.faces.ids()) {
          if (d.faces[f].role == topology::Role::joint) continue;
          const Face copy = d.faces[f];
          d.faces.push_back(copy);
          return true;
        }
        return false;
      },
      "a face that names a block but is not among its own");
}

TEST(Audit, NoticesAParallelPlane) {
  expect_noticed(
      [](Data& d) {
        for (const FaceId f : d.faces.ids()) {
          Face& face = d.faces[f];
          if (face.role == topology::Role::joint) continue;
          for (const topology::PlaneId p : d.planes.ids()) {
            if (p == face.plane || d.planes[p].normal() != d.planes[face.plane].normal()) continue;
            face.plane = p;
            return true;
          }
        }
        return false;
      },
      "a face on a plane parallel to its own");
}

TEST(Audit, NoticesALostBlock) {
  const BlockComplex sound = topology::cut(sound_scenes()[0]).value();
  Data data = sound.data();
  auto blocks = data.blocks.items();
  blocks.pop_back();
  data.blocks = IdVector<BlockId, topology::Block>{blocks};
  EXPECT_FALSE(topology::audit(BlockComplex{std::move(data)}));
}

TEST(Audit, TellsTheOffender) {
  Data data = topology::cut(sound_scenes()[0]).value().data();
  change_loops(data, data.blocks[BlockId{5U}].faces[0], [](Loops& loops) { std::ranges::reverse(loops[0]); });
  const auto audited = topology::audit(BlockComplex{std::move(data)});
  ASSERT_FALSE(audited);
  EXPECT_EQ(audited.error().open_shells, 1U);
  EXPECT_EQ(audited.error().offenders, (std::vector{BlockId{5U}}));
}

topology::Certificate refused(Data data) {
  const auto audited = topology::audit(BlockComplex{std::move(data)});
  EXPECT_FALSE(audited.has_value());
  return audited ? topology::Certificate{} : audited.error();
}

using Of = topology::Misfit::Of;

TEST(Audit, NamesEachMisfitWithItsBlockAndFace) {
  const Data sound = topology::cut(sound_scenes()[0]).value().data();
  const BlockId block{5U};
  const FaceId face = sound.blocks[block].faces[1];
  const auto expect_named = [&](Of of, bool of_face, const std::function<void(Data&)>& change) {
    Data data = sound;
    change(data);
    const auto certificate = refused(std::move(data));
    SCOPED_TRACE(describe(certificate));
    EXPECT_EQ(certificate.misfits, 1U);
    const topology::Misfit right{of, block, of_face ? std::optional{face} : std::nullopt};
    EXPECT_EQ(certificate.first_misfits, std::vector{right});
    EXPECT_EQ(certificate.offenders, std::vector{block});
    const std::string words = std::string{"(block 5: "} + std::string{name_of(of)} +
                              (of_face ? " of face " + std::to_string(face.value()) : "") + ")";
    EXPECT_NE(describe(certificate).find(words), std::string::npos) << words;
  };
  expect_named(Of::normal, true, [&](Data& d) { d.faces[face].outward = -d.faces[face].outward; });
  expect_named(Of::area, true, [&](Data& d) { d.faces[face].area = 2 * d.faces[face].area; });
  expect_named(Of::volume, false, [&](Data& d) { d.blocks[block].volume = 1.001 * d.blocks[block].volume; });
  expect_named(Of::flags, false, [&](Data& d) { d.blocks[block].truncated = !d.blocks[block].truncated; });
}

TEST(Audit, NamesBothSidesOfAContact) {
  Data data = topology::cut(sound_scenes()[0]).value().data();
  const Face& face = data.faces[a_joint_face(data)];
  const BlockId own = face.block, other = data.patches[face.first_patch].neighbour.value();
  data.patches[face.first_patch].neighbour = BlockId{26U};
  ASSERT_NE(other, BlockId{26U});
  const auto certificate = refused(std::move(data));
  EXPECT_EQ(certificate.unpaired_patches, 2U);
  std::vector<BlockId> right{own, other, BlockId{26U}};
  std::ranges::sort(right);
  EXPECT_EQ(certificate.offenders, right);
}

TEST(Audit, NamesTheOwnerOfAFaceThatIsNoneOfItsBlock) {
  Data data = topology::cut(sound_scenes()[0]).value().data();
  const FaceId face = data.blocks[BlockId{5U}].faces[0];
  data.faces[face].block = BlockId{7U};
  const auto certificate = refused(std::move(data));
  EXPECT_EQ(certificate.first_misfits, (std::vector{topology::Misfit{Of::owner, BlockId{5U}, face},
                                                    topology::Misfit{Of::owner, BlockId{7U}, face}}));
}

TEST(Audit, NamesTwentyMisfitsAtMost) {
  Data data = topology::cut(sound_scenes()[0]).value().data();
  for (topology::Block& block : data.blocks) block.truncated = true;
  const auto certificate = refused(std::move(data));
  EXPECT_EQ(certificate.misfits, 27U);
  EXPECT_EQ(certificate.first_misfits.size(), 20U);
  EXPECT_EQ(certificate.offenders.size(), 20U);
  EXPECT_NE(describe(certificate).find("; ...)"), std::string::npos);
}

}  // namespace
}  // namespace cleave::testing::tamper_test
