#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "cleave/topology/block_complex.hpp"

namespace cleave::topology::detail {

/// Puts faces into a PackedFaces, one behind the other.
class FacePacker final {
 public:
  static constexpr std::uint32_t none = UINT32_MAX;

  /// What is packed looks up its normals in `normals`, those of the planes. `plane_faces`: how many measures are known
  /// already, which are put in last (`put_measures`).
  FacePacker(PackedFaces& out, std::span<const geometry::Vec3> normals, std::uint32_t plane_faces = 0) noexcept
      : out_{out}, normals_{normals}, plane_faces_{plane_faces} {}

  /// Room for as many faces as there may be; what is not used is never touched.
  void reserve(std::size_t faces);
  /// `patches` are the face's own; what it says of them and of its corners is relative to all that is packed here.
  /// `twin`: where area and centroid of the face on the other side are, when it has the same; becomes where they are.
  void add(const Face& face, std::span<const Patch> patches, std::uint32_t& twin);
  void add(const Face& face, std::span<const Patch> patches) {
    std::uint32_t twin = none;
    add(face, patches, twin);
  }
  /// The face has the measures of a plane face, which are known already.
  void add_plane_face(const Face& face, std::span<const Patch> patches, std::uint32_t plane_face) {
    if (const auto record = add_record(face, patches)) out_.records_[*record].measure = plane_face;
  }
  /// All of `more` behind what there is. `corners` and `holes` are how many there were before.
  void append(PackedFaces more, std::uint32_t corners, std::uint32_t holes);
  /// The measures of plane faces (m^2, m); those that no face has are left out.
  void put_measures(std::vector<FaceMeasure> of_plane_faces);

  static void finish(PackedFaces& out, std::vector<geometry::Vec3> normals);
  /// Where area and centroid of the face's twin are: that of its only neighbour, in the same plane with the same
  /// measures; none. Faces of the neighbour have been put in already, and are few.
  [[nodiscard]] std::uint32_t twin_of(const Face& face, std::span<const Patch> patches, FaceRange of_neighbour) const;

 private:
  [[nodiscard]] bool follows(const Face& face, std::span<const Patch> patches) const;
  [[nodiscard]] std::uint32_t place_of(const FaceMeasure& measure, std::uint32_t twin);
  /// Where the record is of which the measure is to be filled in; none where the face is kept whole.
  [[nodiscard]] std::optional<std::size_t> add_record(const Face& face, std::span<const Patch> patches);

  PackedFaces& out_;
  std::span<const geometry::Vec3> normals_;
  std::uint32_t plane_faces_;
};

}  // namespace cleave::topology::detail
