#include <gtest/gtest.h>

#include "complexes.hpp"
#include "workloads.hpp"

namespace cleave::testing {
namespace {

struct Case {
  const char* name;
  std::size_t blocks;
};
std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }

class BigWorkloads : public ::testing::TestWithParam<Case> {};

TEST_P(BigWorkloads, FallIntoTheKnownNumberOfBlocks) {
  const auto [name, blocks] = GetParam();
  const topology::AuditedComplex audited = certified(cut_input(make_workload(name).value()));
  EXPECT_EQ(audited.complex().blocks().size(), blocks);
  EXPECT_LE(audited.certificate().volume_relative_error, 1e-12);
}
INSTANTIATE_TEST_SUITE_P(Published, BigWorkloads,
                         ::testing::Values(Case{"grid-20", 8000}, Case{"gridr-20", 8000}, Case{"persist-26", 25599},
                                           Case{"rect-50", 22782}));

}  // namespace
}  // namespace cleave::testing
