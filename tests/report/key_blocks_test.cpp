#include "cleave/report/key_blocks.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "hand_made.hpp"

namespace cleave::report {
namespace {

using namespace testing;

TEST(KeyBlocksCsv, HeaderIsTheContracts) {
  EXPECT_EQ(key_blocks_csv(grid(1), {}),
            "block,batch,key,mode,volume_m3,weight_n,direction_x,direction_y,direction_z,net_force_n,factor_of_safety,"
            "faces,joints\n");
}

TEST(KeyBlocksCsv, RowsAreTheRemovableBlocksThatWouldMoveWithoutFriction) {
  HandMade made;
  auto faces = box_faces({0, 0, 0}, {0.5, 0.5, 0.5}, Role::joint);
  faces[0].joint = 12;
  faces[1].joint = 3;
  faces[2].joint = 3;
  for (int i = 0; i < 5; ++i) made.block(faces, box_counts, true);
  const auto complex = std::move(made).complex();
  stability::Analysis analysis;
  analysis.judgements = {judgement(0, stability::Mode::falling, 1, 0),
                         judgement(1, stability::Mode::stable, std::nullopt, 5),
                         judgement(2, stability::Mode::tapered, std::nullopt, 5),
                         judgement(3, stability::Mode::wedge, std::nullopt, std::numeric_limits<double>::infinity()),
                         judgement(4, stability::Mode::lifting, 2, 0.1)};
  const std::string csv = key_blocks_csv(complex, analysis);
  EXPECT_EQ(csv.substr(key_blocks_header.size() + 1),
            "0,1,1,falling,0.125,1000,0,0,-1,800,0,6,3;12\n"
            "3,,0,wedge,0.125,1000,0,0,-1,800,inf,6,3;12\n"
            "4,2,1,lifting,0.125,1000,0,0,-1,800,0.1,6,3;12\n");
}

TEST(KeyBlocksCsv, ColumnsAfterForceTransferFollow) {
  stability::Analysis analysis;
  analysis.force_transfer = true;
  analysis.judgements = {judgement(0, stability::Mode::sliding, 1, 0.5),
                         judgement(1, stability::Mode::wedge, std::nullopt, 2)};
  analysis.judgements[0].transferred = stability::Transferred{.mode = stability::Mode::wedge,
                                                              .key = true,
                                                              .direction = {1, 0, 0},
                                                              .net = newtons(900),
                                                              .factor_of_safety = 0.25,
                                                              .passed = newtons(900)};
  const std::string csv = key_blocks_csv(grid(2), analysis);
  EXPECT_EQ(
      csv,
      std::string{key_blocks_header} +
          ",key_transferred,mode_transferred,direction_x_transferred,direction_y_transferred,direction_z_transferred,"
          "net_force_n_transferred,factor_of_safety_transferred,passed_n_transferred,lost_n_transferred\n"
          "0,1,1,sliding,1,1000,0,0,-1,800,0.5,6,7,1,wedge,1,0,0,900,0.25,900,0\n"
          "1,,0,wedge,1,1000,0,0,-1,800,2,6,7,0,wedge,0,0,-1,800,2,0,0\n");
}

}  // namespace
}  // namespace cleave::report
