#include "cleave/core/id.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace cleave {
namespace {

using FaceId = Id<struct FaceTag>;

TEST(IdVectorTest, PushBackNamesTheNewItem) {
  IdVector<FaceId, int> items;
  const FaceId first = items.push_back(7);
  const FaceId second = items.push_back(8);
  EXPECT_EQ(first.value(), 0U);
  EXPECT_LT(first, second);
  EXPECT_EQ(items[second], 8);
  std::vector<FaceId> ids;
  for (const FaceId id : items.ids()) ids.push_back(id);
  EXPECT_EQ(ids, (std::vector{first, second}));
}

TEST(IdVectorDeathTest, AccessPastTheEndAborts) {
  const IdVector<FaceId, int> items(3);
  EXPECT_DEATH(static_cast<void>(items[FaceId{3U}]), "");
}

TEST(IdDeathTest, ANumberThatDoesNotFitAborts) {
  EXPECT_DEATH(static_cast<void>(FaceId{std::size_t{1} << 32U}), "value <= UINT32_MAX");
}

}  // namespace
}  // namespace cleave
