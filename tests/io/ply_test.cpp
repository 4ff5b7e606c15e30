#include <gtest/gtest.h>

#include <bit>
#include <string>

#include "io_testing.hpp"

namespace cleave::io {
namespace {

const std::string header_end =
    "comment made by hand\n"
    "element vertex 4\nproperty float x\nproperty uchar red\nproperty double y\nproperty list uchar short "
    "extra\nproperty int z\n"
    "element face 4\nproperty list uchar int vertex_index\nproperty float quality\nend_header\n";

/// The same tetrahedron in any encoding; `put` appends a value of a type.
template <class Put>
std::string body(Put&& put) {
  std::string out;
  const auto vertex = [&](double x, double y, double z) {
    put(out, 'f', x), put(out, 'B', 7), put(out, 'd', y), put(out, 'B', 2), put(out, 'h', -1), put(out, 'h', 5),
        put(out, 'i', z);
  };
  vertex(0, 0, 0), vertex(1, 0, 0), vertex(0, 1, 0), vertex(0, 0, -1);
  for (const auto& [a, b, c] : {std::array{0, 1, 2}, std::array{0, 3, 1}, std::array{0, 2, 3}, std::array{1, 3, 2}}) {
    put(out, 'B', 3), put(out, 'i', a), put(out, 'i', b), put(out, 'i', c), put(out, 'f', 0.5);
  }
  return out;
}

void put_text(std::string& out, char, double value) {
  out += std::to_string(value) + (out.size() % 3 == 0 ? "\n" : " ");
}

template <bool big>
void put_binary(std::string& out, char type, double value) {
  const auto bytes = [&](std::uint64_t bits, int n) {
    for (int i = 0; i < n; ++i) out += static_cast<char>(bits >> (8 * (big ? n - 1 - i : i)) & 0xFFU);
  };
  const auto whole = static_cast<std::uint64_t>(static_cast<std::int64_t>(value));
  if (type == 'f') bytes(std::bit_cast<std::uint32_t>(static_cast<float>(value)), 4);
  if (type == 'd') bytes(std::bit_cast<std::uint64_t>(value), 8);
  if (type == 'i') bytes(whole, 4);
  if (type == 'h') bytes(whole, 2);
  if (type == 'B') bytes(whole, 1);
}

ReadFault fault_of(std::string_view bytes) {
  const auto mesh = parse_ply(bytes, "a.ply");
  EXPECT_FALSE(mesh.has_value()) << bytes;
  return mesh ? ReadFault::cannot_open : mesh.error().fault;
}

TEST(PlyTest, AllEncodingsHoldTheSame) {
  const std::string text = "ply\nformat ascii 1.0\n" + header_end + body(put_text);
  const std::string little = "ply\nformat binary_little_endian 1.0\n" + header_end + body(put_binary<false>);
  const std::string big = "ply\nformat binary_big_endian 1.0\n" + header_end + body(put_binary<true>);
  for (const std::string& bytes : {text, little, big}) {
    const auto mesh = parse_ply(bytes, "a");
    ASSERT_TRUE(mesh.has_value()) << describe(mesh.error());
    EXPECT_EQ(mesh->vertices.size(), 4U);
    EXPECT_EQ(mesh->vertices[3], (geometry::Vec3{0, 0, -1}));
    EXPECT_DOUBLE_EQ(testing::volume_of(*mesh), 1.0 / 6);
    EXPECT_TRUE(mesh->notes.empty());
    EXPECT_EQ(parse_ply(bytes + "x", "a").value().notes.size(), 1U);
  }
  for (std::size_t cut = 1; cut < 60; ++cut) {
    EXPECT_EQ(fault_of(std::string_view{little}.substr(0, little.size() - cut)), ReadFault::truncated);
  }
}

TEST(PlyTest, HeadersWithDosLineEnds) {
  std::string header = "ply\nformat binary_little_endian 1.0\n" + header_end;
  for (std::size_t at = 0; (at = header.find('\n', at)) != std::string::npos; at += 2) header.insert(at, 1, '\r');
  const auto mesh = parse_ply(header + body(put_binary<false>), "a");
  ASSERT_TRUE(mesh.has_value()) << describe(mesh.error());
  EXPECT_DOUBLE_EQ(testing::volume_of(*mesh), 1.0 / 6);
}

TEST(PlyTest, FaultsAreTyped) {
  const std::string start = "ply\nformat ascii 1.0\n";
  const std::string vertices = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string faces = "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n";
  EXPECT_TRUE(parse_ply(start + vertices + faces + "3 0 1 2\n", "a").has_value());
  EXPECT_EQ(fault_of(""), ReadFault::unknown_format);
  EXPECT_EQ(fault_of("solid\n"), ReadFault::unknown_format);
  EXPECT_EQ(fault_of("ply\nformat utf8 1.0\n"), ReadFault::unknown_format);
  EXPECT_EQ(fault_of(start + vertices), ReadFault::truncated);
  EXPECT_EQ(fault_of(start + vertices + faces), ReadFault::truncated);
  EXPECT_EQ(fault_of(start + vertices + faces + "3 0 1 3\n"), ReadFault::out_of_range);
  EXPECT_EQ(fault_of(start + vertices + faces + "3 0 1 -1\n"), ReadFault::out_of_range);
  EXPECT_EQ(fault_of(start + vertices + faces + "3 0 1 0.5\n"), ReadFault::out_of_range);
  EXPECT_EQ(fault_of(start + vertices + faces + "-3 0 1 2\n"), ReadFault::out_of_range);
  EXPECT_EQ(fault_of(start + vertices + faces + "3 0 1 x\n"), ReadFault::bad_number);
  EXPECT_EQ(fault_of(start + "element vertex -1\n"), ReadFault::bad_number);
  EXPECT_EQ(fault_of(start + "element vertex 99999999999\n"), ReadFault::too_large);
  EXPECT_EQ(fault_of(start + "property float x\n"), ReadFault::syntax);
  EXPECT_EQ(fault_of(start + "element vertex 3\nproperty quad x\n"), ReadFault::syntax);
  EXPECT_EQ(fault_of(start + "element vertex 3\nproperty list float int x\n"), ReadFault::syntax);
  EXPECT_EQ(fault_of(start + vertices + vertices), ReadFault::syntax);
  EXPECT_EQ(fault_of(start + "element vertex 1\nproperty float x\nproperty float y\n" + faces), ReadFault::syntax);
  EXPECT_EQ(fault_of(start + vertices +
                     "element face 0\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n"),
            ReadFault::empty);
  // a promise of 4e9 vertices costs nothing when the bytes are not there
  EXPECT_EQ(fault_of("ply\nformat binary_big_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float "
                     "y\nproperty float z\nend_header\nabc"),
            ReadFault::truncated);
}

}  // namespace
}  // namespace cleave::io
