#pragma once

#include <gtest/gtest.h>

#include <string>

#include "cleave/topology/audit.hpp"
#include "cleave/topology/cut.hpp"
#include "workloads.hpp"

namespace cleave::support {

/// Cuts, certifies and counts; the hash must not depend on the number of threads.
inline void expect_known_count(const Workload& workload, Length snap = metres(0)) {
  SCOPED_TRACE(workload.name);
  ASSERT_TRUE(workload.blocks.has_value());
  auto input = cut_input(workload);
  input.snap = snap;
  const auto cut_with = [&](unsigned threads) { return topology::cut(input, {.threads = threads}); };
  auto one = cut_with(1);
  ASSERT_TRUE(one.has_value()) << describe(one.error());
  const std::string hash = topology::canonical_hash(*one);
  const auto audited = topology::audit(*std::move(one));
  ASSERT_TRUE(audited.has_value());
  EXPECT_EQ(audited->complex().blocks().size(), *workload.blocks);
  EXPECT_LE(audited->certificate().volume_relative_error, 1e-12);
  const auto two = cut_with(2);
  ASSERT_TRUE(two.has_value());
  EXPECT_EQ(topology::canonical_hash(*two), hash);
}

}  // namespace cleave::support
