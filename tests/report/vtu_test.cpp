#include "cleave/exchange/exports.hpp"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <span>
#include <string>

#include "hand_made.hpp"

namespace cleave::report {
namespace {

using namespace testing;

std::string decode_base64(std::string_view text) {
  constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  std::uint32_t bits = 0, held = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6U | static_cast<std::uint32_t>(alphabet.find(c));
    held += 6;
    if (held >= 8) {
      held -= 8;
      out += static_cast<char>(bits >> held & 255U);
    }
  }
  return out;
}

// The values of the array of this name, read back from the file's text.
template <class T>
std::vector<T> read_array(const std::string& vtu, const std::string& type, const std::string& name) {
  const std::size_t tag = vtu.find("<DataArray type=\"" + type + "\" Name=\"" + name + "\"");
  EXPECT_NE(tag, std::string::npos) << name;
  if (tag == std::string::npos) return {};
  const std::size_t begin = vtu.find('>', tag) + 1, end = vtu.find('<', begin);
  const std::string raw = decode_base64(std::string_view{vtu}.substr(begin, end - begin));
  std::uint64_t bytes = 0;
  std::memcpy(&bytes, raw.data(), sizeof bytes);
  EXPECT_EQ(bytes + sizeof bytes, raw.size()) << name;
  std::vector<T> values(bytes / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), std::span{raw}.subspan(sizeof bytes).data(), bytes);
  return values;
}

// The unit cube of the format description: 4 points a face, six faces, 31 numbers.
TEST(Vtu, UnitCube) {
  const std::string vtu = blocks_vtu(make_cells(grid(1)), nullptr, {.title = "a < b -- c", .scene_file = "cube.toml"});
  EXPECT_EQ(read_array<std::int64_t>(vtu, "Int64", "offsets"), (std::vector<std::int64_t>{8}));
  EXPECT_EQ(read_array<std::int64_t>(vtu, "Int64", "faceoffsets"), (std::vector<std::int64_t>{31}));
  EXPECT_EQ(read_array<std::uint8_t>(vtu, "UInt8", "types"), (std::vector<std::uint8_t>{42}));
  EXPECT_EQ(read_array<std::int64_t>(vtu, "Int64", "connectivity"),
            (std::vector<std::int64_t>{0, 1, 2, 3, 4, 5, 6, 7}));
  EXPECT_EQ(read_array<double>(vtu, "Float64", "volume"), (std::vector<double>{1}));
  EXPECT_EQ(read_array<double>(vtu, "Float64", "Points").size(), 24U);
  const auto faces = read_array<std::int64_t>(vtu, "Int64", "faces");
  ASSERT_EQ(faces.size(), 31U);
  EXPECT_EQ(faces.front(), 6);
  EXPECT_NE(vtu.find("a &lt; b - - c"), std::string::npos);
  EXPECT_EQ(vtu.find("nan"), std::string::npos);
}

TEST(Vtu, AnalysisIsSpreadOverTheCellsOfABlock) {
  stability::Analysis analysis;
  analysis.judgements = {judgement(1, stability::Mode::wedge, 2, 0.5),
                         judgement(3, stability::Mode::sliding, std::nullopt, std::numeric_limits<double>::infinity())};
  const std::string vtu = blocks_vtu(make_cells(grid(2)), &analysis, {});
  EXPECT_EQ(read_array<std::int32_t>(vtu, "Int32", "batch"),
            (std::vector<std::int32_t>{-1, 2, -1, -1, -1, -1, -1, -1}));
  EXPECT_EQ(read_array<std::uint8_t>(vtu, "UInt8", "mode"),
            (std::vector<std::uint8_t>{255, 3, 255, 2, 255, 255, 255, 255}));
  EXPECT_EQ(read_array<std::uint8_t>(vtu, "UInt8", "key"), (std::vector<std::uint8_t>{0, 1, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(read_array<double>(vtu, "Float64", "factor_of_safety"),
            (std::vector<double>{-1, 0.5, -1, 1e9, -1, -1, -1, -1}));
  EXPECT_EQ(read_array<std::uint8_t>(vtu, "UInt8", "factor_known"),
            (std::vector<std::uint8_t>{0, 1, 0, 2, 0, 0, 0, 0}));
  EXPECT_EQ(read_array<std::int64_t>(vtu, "Int64", "block"), (std::vector<std::int64_t>{0, 1, 2, 3, 4, 5, 6, 7}));
}

TEST(Vtu, SameBytesTwice) {
  EXPECT_EQ(blocks_vtu(make_cells(grid(3)), nullptr, {}), blocks_vtu(make_cells(grid(3)), nullptr, {}));
}

}  // namespace
}  // namespace cleave::report
