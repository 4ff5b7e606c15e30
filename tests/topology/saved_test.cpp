#include <gtest/gtest.h>

#include <string>
#include <variant>

#include "cleave/core/archive.hpp"
#include "cleave/core/rng.hpp"
#include "cleave/topology/audit.hpp"
#include "complexes.hpp"
#include "workloads.hpp"

// A block system as bytes and back: the same to the last bit, or an error.

namespace cleave::testing::saved_test {
namespace {

using topology::AuditedComplex;
using topology::SavedFault;

std::vector<topology::CutInput> inputs() {
  std::vector<topology::CutInput> out;
  for (const char* name : {"grid-3", "deg-cavity", "deg-ring", "rect-13"}) {
    out.push_back(support::cut_input(support::workload_named(name).value()));
  }
  out.back().keep_dangling = true;
  auto shaft =
      scene(box({0, 0, 0}, {4, 4, 4}), {rectangle(2, 2, {-1, -1}, {5, 5}), rectangle(1, 1.5, {-1, -1}, {5, 2})},
            {box({1, 1, -1}, {3, 3, 5})});
  shaft.free_domain_tags = {0};
  shaft.snap = metres(1e-3);
  shaft.joints.push_back(rectangle(2, 2, {-1, -1}, {5, 5}));  // twice
  out.push_back(shaft);
  shaft.window = topology::Window{{0.5, 0.5, 0.5}, {3.5, 3.5, 3.5}};
  out.push_back(shaft);
  return out;
}
AuditedComplex made(const topology::CutInput& input) { return topology::audit(topology::cut(input).value()).value(); }

void expect_same(const topology::BlockComplex& a, const topology::BlockComplex& b) {
  EXPECT_EQ(topology::canonical_hash(a), topology::canonical_hash(b));
  EXPECT_EQ(a.report().lattice_pitch_m, b.report().lattice_pitch_m);
  EXPECT_EQ(a.report().intersections, b.report().intersections);
  EXPECT_EQ(a.report().overlapping, b.report().overlapping);
  EXPECT_EQ(a.report().excavated.size(), b.report().excavated.size());
  EXPECT_TRUE(a.planes() == b.planes());
  ASSERT_EQ(a.data().dangling.has_value(), b.data().dangling.has_value());
  if (a.data().dangling) {
    EXPECT_EQ(a.data().dangling->pieces.size(), b.data().dangling->pieces.size());
    EXPECT_EQ(a.data().dangling->area, b.data().dangling->area);
  }
  for (const topology::BlockId id : a.blocks().ids()) {
    const topology::Block &x = a.blocks()[id], &y = b.blocks()[id];
    EXPECT_TRUE(x.volume == y.volume && x.centroid == y.centroid && x.thickness == y.thickness && x.counts == y.counts);
    EXPECT_TRUE(x.convex == y.convex && x.fixed == y.fixed && x.free == y.free && x.sliver == y.sliver &&
                x.truncated == y.truncated);
  }
  for (const topology::FaceId id : a.faces().ids()) {
    const topology::Face &x = a.faces()[id], &y = b.faces()[id];
    EXPECT_TRUE(x.role == y.role && x.joint == y.joint && x.excavation == y.excavation && x.tag == y.tag &&
                x.shell == y.shell && x.outward == y.outward && x.area == y.area && x.centroid == y.centroid);
  }
}

TEST(SavedBlocks, ReadBackToTheLastBit) {
  for (const topology::CutInput& input : inputs()) {
    const AuditedComplex before = made(input);
    const std::string bytes = saved(before);
    const auto after = topology::load_saved(bytes);
    ASSERT_TRUE(after.has_value()) << describe(after.error());
    expect_same(before.complex(), after->complex());
    EXPECT_EQ(saved(*after), bytes);
    EXPECT_EQ(after->certificate().volume, before.certificate().volume);
  }
}

SavedFault fault_of(std::string_view bytes) {
  const auto loaded = topology::load_saved(bytes);
  EXPECT_FALSE(loaded.has_value());
  if (loaded || !std::holds_alternative<SavedFault>(loaded.error())) return SavedFault::inconsistent;
  EXPECT_FALSE(describe(loaded.error()).empty());
  return std::get<SavedFault>(loaded.error());
}

TEST(SavedBlocks, DamageIsSeen) {
  const std::string bytes = saved(made(inputs().front()));
  EXPECT_EQ(fault_of(""), SavedFault::foreign);
  EXPECT_EQ(fault_of("[domain]\n"), SavedFault::foreign);
  EXPECT_EQ(fault_of(bytes.substr(0, bytes.size() - 1)), SavedFault::damaged);
  EXPECT_EQ(fault_of(bytes + " "), SavedFault::damaged);
  std::string other = bytes;
  other.replace(other.find(' '), 2, " 9");
  EXPECT_EQ(fault_of(other), SavedFault::other_version);
  for (std::size_t at = bytes.size() / 2; at < bytes.size(); at += bytes.size() / 50) {
    std::string changed = bytes;
    changed[at] = static_cast<char>(changed[at] ^ 1);
    EXPECT_EQ(fault_of(changed), SavedFault::damaged);
  }
  EXPECT_EQ(fault_of(sealed("cleave-blocks", 2, "")), SavedFault::inconsistent);
}

// Bytes that were changed and sealed again: no crash, and what is taken is a system that passes the audit.
TEST(SavedBlocks, WhatIsTakenPassesTheAudit) {
  const std::string bytes = saved(made(inputs().back()));
  const std::string held{unsealed("cleave-blocks", 2, bytes).value()};
  Rng rng{{.seed = 3}};
  std::size_t inconsistent = 0, failed = 0;
  for (int k = 0; k < 600; ++k) {
    std::string changed = held;
    for (int n = 0; n <= k % 3; ++n) {
      const auto at = static_cast<std::size_t>(rng.uniform() * static_cast<double>(held.size()));
      changed[at] = static_cast<char>(rng.uniform() * 256 - 128);
    }
    const auto loaded = topology::load_saved(sealed("cleave-blocks", 2, changed));
    if (loaded) {
      EXPECT_TRUE(loaded->certificate().passed);
    } else {
      ++(std::holds_alternative<SavedFault>(loaded.error()) ? inconsistent : failed);
    }
  }
  EXPECT_GT(inconsistent, 50U);
  EXPECT_GT(failed, 50U);
}

}  // namespace
}  // namespace cleave::testing::saved_test
