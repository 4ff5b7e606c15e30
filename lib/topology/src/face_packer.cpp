#include "detail/face_packer.hpp"

#include <array>
#include <bit>
#include <utility>

namespace cleave::topology::detail {
namespace {

using geometry::Vec3;

/// To the last bit, the sign of nothing too.
bool same(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }
bool same(Vec3 a, Vec3 b) { return same(a.x, b.x) && same(a.y, b.y) && same(a.z, b.z); }

}  // namespace

void FacePacker::reserve(std::size_t faces) { out_.records_.reserve(faces); }

/// Whether all that is not kept follows from what is.
bool FacePacker::follows(const Face& face, std::span<const Patch> patches) const {
  const bool joint = face.role == Role::joint;
  if (face.shell != 0 || face.hole_count != 0 || face.first_corner != out_.corner_count_ ||
      face.plane.value() >= 1U << (32 - PackedFaces::plane_shift) || face.plane.index() >= normals_.size()) {
    return false;
  }
  const Vec3 normal = normals_[face.plane.index()];
  if (!same(face.outward, face.block_on_positive_side ? -normal : normal)) return false;
  if (joint != face.joint.has_value() || (joint && (face.excavation || face.tag))) return false;
  if (face.excavation == PackedFaces::nothing || face.tag == PackedFaces::nothing) return false;
  return joint || (patches.size() == 1 && !patches[0].joint && !patches[0].neighbour &&
                   same(patches[0].area.si(), face.area.si()) && same(patches[0].centroid, face.centroid));
}

std::uint32_t FacePacker::place_of(const FaceMeasure& measure, std::uint32_t twin) {
  if (twin != none && same(out_.measures_[twin].area, measure.area) &&
      same(out_.measures_[twin].centroid, measure.centroid)) {
    return twin;
  }
  out_.measures_.push_back(measure);
  return plane_faces_ + static_cast<std::uint32_t>(out_.measures_.size() - 1);
}

void FacePacker::add(const Face& face, std::span<const Patch> patches, std::uint32_t& twin) {
  if (const auto record = add_record(face, patches)) {
    out_.records_[*record].measure = twin = place_of({face.area.si(), face.centroid}, twin);
  }
}

std::optional<std::size_t> FacePacker::add_record(const Face& face, std::span<const Patch> patches) {
  const auto kept = [&] {
    const PackedFaces::List list{static_cast<std::uint32_t>(out_.patches_.size()),
                                 static_cast<std::uint32_t>(patches.size())};
    out_.patches_.insert(out_.patches_.end(), patches.begin(), patches.end());
    return list;
  };
  PackedFaces::Record record{face.block.value(), 0, 0, 0, 0, out_.corner_count_};
  const bool packed = follows(face, patches);
  if (face.first_corner == out_.corner_count_) out_.corner_count_ += face.corner_count;
  if (!packed) {
    record.plane = PackedFaces::whole;
    record.measure = static_cast<std::uint32_t>(out_.whole_.size());
    const auto [first, count] = kept();
    out_.whole_.push_back(face);
    out_.whole_.back().first_patch = first;
    out_.whole_.back().patch_count = count;
    out_.records_.push_back(record);
    return std::nullopt;
  }
  record.plane = face.plane.value() << PackedFaces::plane_shift | static_cast<std::uint32_t>(face.role) << 1U |
                 (face.block_on_positive_side ? 1U : 0U);
  if (face.role == Role::joint) {
    record.cause = face.joint->value();
    const bool alone = patches.size() == 1 && patches[0].joint == face.joint && patches[0].neighbour &&
                       patches[0].neighbour->value() < PackedFaces::several - 1 &&
                       same(patches[0].area.si(), face.area.si()) && same(patches[0].centroid, face.centroid);
    if (alone) {
      record.beyond = patches[0].neighbour->value();
    } else {
      record.beyond = PackedFaces::several | static_cast<std::uint32_t>(out_.lists_.size());
      out_.lists_.push_back(kept());
    }
  } else {
    record.cause = face.excavation.value_or(PackedFaces::nothing);
    record.beyond = face.tag.value_or(PackedFaces::nothing);
  }
  out_.records_.push_back(record);
  return out_.records_.size() - 1;
}

void FacePacker::append(PackedFaces more, std::uint32_t corners, std::uint32_t holes) {
  const auto patches = static_cast<std::uint32_t>(out_.patches_.size()),
             lists = static_cast<std::uint32_t>(out_.lists_.size()),
             whole = static_cast<std::uint32_t>(out_.whole_.size()),
             measures = static_cast<std::uint32_t>(out_.measures_.size());
  out_.measures_.insert(out_.measures_.end(), more.measures_.begin(), more.measures_.end());
  for (PackedFaces::Record record : more.records_) {
    record.first_corner += corners;
    if ((record.plane & PackedFaces::whole) != 0) {
      record.measure += whole;
    } else {
      if (record.measure >= plane_faces_) record.measure += measures;
      const auto role = static_cast<Role>(record.plane >> 1U & 3U);
      if (role == Role::joint && (record.beyond & PackedFaces::several) != 0) record.beyond += lists;
    }
    out_.records_.push_back(record);
  }
  for (PackedFaces::List list : more.lists_) out_.lists_.push_back({list.first + patches, list.count});
  for (Face face : more.whole_) {
    face.first_corner += corners;
    face.first_hole += holes;
    face.first_patch += patches;
    out_.whole_.push_back(face);
  }
  out_.patches_.insert(out_.patches_.end(), more.patches_.begin(), more.patches_.end());
  out_.corner_count_ = corners + more.corner_count_;
}

std::uint32_t FacePacker::twin_of(const Face& face, std::span<const Patch> patches, FaceRange of_neighbour) const {
  constexpr std::size_t few = 64;
  if (patches.size() != 1 || of_neighbour.size() > few) return none;
  for (const FaceId f : of_neighbour) {
    if (f.index() >= out_.records_.size()) return none;
    const PackedFaces::Record& record = out_.records_[f.index()];
    if ((record.plane & PackedFaces::whole) != 0 || record.plane >> PackedFaces::plane_shift != face.plane.value()) {
      continue;
    }
    const FaceMeasure& measure = out_.measures_[record.measure];
    if (same(measure.area, face.area.si()) && same(measure.centroid, face.centroid)) return record.measure;
  }
  return none;
}

void FacePacker::put_measures(std::vector<FaceMeasure> of_plane_faces) {
  std::vector<std::uint32_t> number(plane_faces_, none);
  const auto for_each_packed = [&](const auto& visit) {
    for (PackedFaces::Record& record : out_.records_) {
      if ((record.plane & PackedFaces::whole) == 0) visit(record.measure);
    }
  };
  for_each_packed([&](std::uint32_t measure) {
    if (measure < plane_faces_) number[measure] = 0;
  });
  std::uint32_t count = 0;
  for (std::uint32_t f = 0; f < plane_faces_; ++f) {
    if (number[f] == none) continue;
    of_plane_faces[count] = of_plane_faces[f];
    number[f] = count++;
  }
  of_plane_faces.resize(count);
  of_plane_faces.insert(of_plane_faces.end(), out_.measures_.begin(), out_.measures_.end());
  out_.measures_ = std::move(of_plane_faces);
  if (count < plane_faces_) {
    for_each_packed([&](std::uint32_t& measure) {
      measure = measure < plane_faces_ ? number[measure] : measure - plane_faces_ + count;
    });
  }
  if (out_.measures_.size() < out_.measures_.capacity() / 2) out_.measures_.shrink_to_fit();
}

void FacePacker::finish(PackedFaces& out, std::vector<Vec3> normals) {
  out.normals_ = std::move(normals);
  // What was reserved and not used was never touched: only what grew by doubling is worth a copy.
  out.whole_.shrink_to_fit();
  out.lists_.shrink_to_fit();
  out.patches_.shrink_to_fit();
}

}  // namespace cleave::topology::detail
