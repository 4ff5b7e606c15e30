#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cleave/topology/block_complex.hpp"

namespace cleave::topology::detail {

/// Puts faces into a PackedFaces, one behind the other.
class FacePacker final {
 public:
  static constexpr std::uint32_t none = UINT32_MAX;

  /// What is packed looks up its normals in `normals`, those of the planes.
  FacePacker(PackedFaces& out, std::span<const geometry::Vec3> normals) noexcept : out_{out}, normals_{normals} {}

  /// Room for as many faces as there may be; what is not used is never touched.
  void reserve(std::size_t faces, std::size_t measures);
  /// `patches` are the face's own; what it says of them and of its corners is relative to all that is packed here.
  /// `twin`: where area and centroid of the face on the other side are, when it has the same; becomes where they are.
  void add(const Face& face, std::span<const Patch> patches, std::uint32_t& twin);
  void add(const Face& face, std::span<const Patch> patches) {
    std::uint32_t twin = none;
    add(face, patches, twin);
  }
  /// All of `more` behind what there is. `corners` and `holes` are how many there were before; `key` says of each
  /// measure of `more` what it is of, and `twins` where that was put.
  void append(PackedFaces more, std::uint32_t corners, std::uint32_t holes, std::span<const std::uint32_t> keys,
              std::vector<std::uint32_t>& twins);

  [[nodiscard]] std::size_t measures() const noexcept { return out_.measures_.size(); }
  /// The neighbour of a face that has one alone, by its number; none.
  static void finish(PackedFaces& out, std::vector<geometry::Vec3> normals);
  /// Where area and centroid of the face's twin are: that of its only neighbour, in the same plane with the same
  /// measures; none. Faces of the neighbour have been put in already, and are few.
  [[nodiscard]] std::uint32_t twin_of(const Face& face, std::span<const Patch> patches, FaceRange of_neighbour) const;

 private:
  [[nodiscard]] bool follows(const Face& face, std::span<const Patch> patches) const;
  [[nodiscard]] std::uint32_t place_of(const PackedFaces::Measure& measure, std::uint32_t twin);

  PackedFaces& out_;
  std::span<const geometry::Vec3> normals_;
};

}  // namespace cleave::topology::detail
