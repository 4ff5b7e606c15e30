/// Any bytes as a VTU file: polyhedra whose indices exist, or an error; never a crash.

#include <span>
#include <string>

#include "cleave/core/assert.hpp"
#include "cleave/io/mesh.hpp"
#include "fuzz_target.hpp"

CLEAVE_FUZZ_TARGET(bytes) {
  using namespace cleave;
  const std::string text(bytes.begin(), bytes.end());
  const auto cells = io::parse_vtu(text, "fuzz");
  if (!cells) {
    CLEAVE_ASSERT(!cells.error().what.empty() && !cells.error().remedy.empty());
    return;
  }
  CLEAVE_ASSERT(cells->size() > 0 && cells->block.size() == cells->size());
  CLEAVE_ASSERT(cells->face_ends.back() == static_cast<std::int64_t>(cells->face_stream.size()));
  for (const geometry::Vec3& p : cells->points) CLEAVE_ASSERT(geometry::is_finite(p));
  std::size_t at = 0;
  for (std::size_t c = 0; c < cells->size(); ++c) {
    const std::int64_t faces = cells->face_stream[at++];
    CLEAVE_ASSERT(faces >= 4);
    for (std::int64_t f = 0; f < faces; ++f) {
      const auto count = static_cast<std::size_t>(cells->face_stream[at++]);
      CLEAVE_ASSERT(count >= 3);
      for (const std::int64_t p : std::span{cells->face_stream}.subspan(at, count)) {
        CLEAVE_ASSERT(p >= 0 && static_cast<std::size_t>(p) < cells->points.size());
      }
      at += count;
    }
    CLEAVE_ASSERT(at == static_cast<std::size_t>(cells->face_ends[c]));
  }
  const auto again = io::parse_vtu(text, "fuzz");
  CLEAVE_ASSERT(again && *again == *cells);
}
