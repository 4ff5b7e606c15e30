#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "detail/block_maker.hpp"
#include "detail/exact_volume.hpp"

namespace cleave::topology::detail {

using geometry::Vec3;

/// Volume and centroid from the cones over the faces, by integers where doubles cannot tell them to a thousandth; the
/// shell that holds the others becomes number 0.
void BlockMaker::measure(Block& block) {
  const auto half_faces = std::span{members_};
  const auto apex_of = [&](Index half_face) {
    const PlaneFace& f = parts_.arrangement.faces[half_face / 2];
    return parts_.position(parts_.arrangement.start[parts_.arrangement.loops[f.first_loop]]);
  };
  const Vec3 apex = apex_of(half_faces.front());
  shell_volumes_.assign(shell_count_, 0);
  Vec3 moment{};
  double volume = 0, size = 0, highest = 0;
  const auto faces = static_cast<Index>(face_begin_.size() - 1);
  for (Index face = 0; face < faces; ++face) {
    for (Index k = face_begin_[face]; k < face_begin_[face + 1]; ++k) {
      const Index h = half_faces[k];
      const FaceMeasure& m = parts_.measures[h / 2];
      const Vec3 from = apex_of(h) - apex;
      const double along = geometry::dot(parts_.normals[parts_.arrangement.faces[h / 2].plane], from);
      const double height = h % 2 == 0 ? -along : along;
      const double part = m.area * height;  // three volumes, exact where coordinates are round
      volume += part;
      size += std::abs(m.area);
      highest = std::max(highest, std::abs(height));
      moment += (height / 4) * (m.area * from + moment3(m) / 3);
      shell_volumes_[shell_[face]] += part;
    }
  }
  std::optional<Vec3> centroid;
  // Corners move by 2^-40 at most, and with them heights and areas along their rims. No side is longer than 3 units,
  // which nearly always is enough to know.
  const auto told = [&](double error) { return error * 0x1p-40 <= volume * 0x1p-10; };
  const auto error = [&] {
    double sum = 0;
    for (const Index h : half_faces) {
      const double along = geometry::dot(parts_.normals[parts_.arrangement.faces[h / 2].plane], apex_of(h) - apex);
      sum += std::abs(parts_.measures[h / 2].area) + perimeter(h) * std::abs(along);
    }
    return sum;
  };
  if (!told(1.001 * (size + 3 * static_cast<double>(half_edges_) * highest)) && !told(error())) {
    const FixedMeasure exactly = measure_exactly();
    volume = 3 * exactly.volume();
    centroid = exactly.centroid();
    if (!centroid) centroid = apex;
  }
  if (shell_count_ > 1) {
    const auto outer = static_cast<Index>(std::ranges::max_element(shell_volumes_) - shell_volumes_.begin());
    for (Index face = 0; face < faces; ++face) {
      Index& shell = faces_[face].shell;
      if (shell == outer) {
        shell = 0;
      } else if (shell == 0) {
        shell = outer;
      }
    }
  }
  volume /= 3;
  block.volume = cubic_metres(volume * parts_.scale * parts_.scale * parts_.scale);
  if (!centroid) centroid = apex + moment / volume;
  block.centroid = parts_.origin + parts_.scale * *centroid;
}

double BlockMaker::perimeter(Index half_face) const {
  return perimeter_of(parts_.arrangement, parts_.positions, half_face / 2);
}

/// Sets the volumes of the shells too.
FixedMeasure BlockMaker::measure_exactly() {
  ExactMeasures exactly{parts_.prepared, parts_.graph, parts_.arrangement};
  if (shell_count_ > 1) {
    const auto faces = static_cast<Index>(face_begin_.size() - 1);
    std::vector<std::vector<Index>> shells(shell_count_);
    for (Index face = 0; face < faces; ++face) {
      auto& own = shells[shell_[face]];
      own.insert(own.end(), members_.begin() + face_begin_[face], members_.begin() + face_begin_[face + 1]);
    }
    for (Index shell = 0; shell < shell_count_; ++shell) {
      shell_volumes_[shell] = exactly.measure(shells[shell]).volume();
    }
  }
  return exactly.measure(members_);
}

/// Smallest width across the largest faces (in units): a thin block is thin across a large face.
double BlockMaker::thickness() {
  constexpr Index most = 8;
  const auto faces = static_cast<Index>(face_begin_.size() - 1);
  by_area_.resize(faces);
  std::iota(by_area_.begin(), by_area_.end(), Index{0});
  const auto face = [&](Index k) -> const Face& { return faces_[k]; };
  if (faces > most) {
    std::ranges::nth_element(by_area_, by_area_.begin() + most, [&](Index a, Index b) {
      return face(a).area > face(b).area || (face(a).area == face(b).area && a < b);
    });
  }
  double least = std::numeric_limits<double>::infinity();
  for (Index k = 0; k < std::min(most, faces); ++k) {
    if (face(by_area_[k]).corner_count == 0) continue;
    const Vec3 n = face(by_area_[k]).outward;
    const Vec3 base = parts_.position(out_.corners[face(by_area_[k]).first_corner].value());
    double lo = std::numeric_limits<double>::infinity(), hi = -lo;
    for (const Index v : corners_) {
      const double h = geometry::dot(n, parts_.position(v) - base);
      lo = std::min(lo, h);
      hi = std::max(hi, h);
      if (hi - lo >= least) break;
    }
    least = std::min(least, hi - lo);
  }
  return least;
}

}  // namespace cleave::topology::detail
