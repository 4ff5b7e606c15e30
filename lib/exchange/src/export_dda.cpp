#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "cell_faces.hpp"
#include "cleave/exchange/text.hpp"
#include "export_writers.hpp"

namespace cleave::report::detail {
namespace {

using geometry::Vec3;

/// In the section: x to the right, z up; the block lies on the left of the way from `from` to `to`.
struct Segment {
  double from_x, from_z, to_x, to_z;
};

/// A straight line of the section and what lies on it, as places along its direction.
struct Line {
  double x, z;    ///< a point
  double dx, dz;  ///< unit direction, dx > 0 or (dx = 0 and dz > 0)
  struct Span {
    double low, high;
    bool left;  ///< the block lies on the left of the direction
  };
  std::vector<Span> spans;

  [[nodiscard]] double along(double px, double pz) const { return (px - x) * dx + (pz - z) * dz; }
  [[nodiscard]] double off(double px, double pz) const { return (pz - z) * dx - (px - x) * dz; }
};

/// The middle of the model, moved off its points: a section through a corner is no section of the blocks.
double section_place(const Cells& cells, const geometry::Box& extent) {
  const double width = extent.max.y - extent.min.y;
  std::vector<double> ys;
  for (const std::int64_t point : cells.connectivity) ys.push_back(cells.points[static_cast<std::size_t>(point)].y);
  std::ranges::sort(ys);
  const double middle = extent.min.y + width / 2;
  for (int step = 0; step < 100; ++step) {
    const double y = middle + width * 1e-3 * (step + 0.37) * (step % 2 == 0 ? 1 : -1);
    const auto above = std::ranges::lower_bound(ys, y);
    const bool clear = (above == ys.end() || *above - y > 1e-7 * width) &&
                       (above == ys.begin() || y - *std::prev(above) > 1e-7 * width);
    if (clear) return y;
  }
  return middle;
}

std::vector<Segment> segments_at(const Cells& cells, double y) {
  std::vector<Segment> segments;
  for (std::size_t cell = 0; cell < cells.size(); ++cell) {
    for (const CellFace& face : convex_faces_of_cell(cells, cell)) {
      std::array<std::array<double, 2>, 2> ends{};  // where the face's edge goes through the section: north, south
      int crossings = 0;
      for (std::size_t i = 0; i < face.size(); ++i) {
        const Vec3 a = cells.points[face[i]];
        const Vec3 b = cells.points[face[(i + 1) % face.size()]];
        if ((a.y < y) == (b.y < y)) continue;
        const double t = (y - a.y) / (b.y - a.y);
        ends[a.y < y ? 0 : 1] = {a.x + t * (b.x - a.x), a.z + t * (b.z - a.z)};
        ++crossings;
      }
      // Seen from the south with the block's face counter-clockwise from outside, the block lies left of the way from
      // the southward crossing to the northward one.
      if (crossings == 2) segments.push_back({ends[0][0], ends[0][1], ends[1][0], ends[1][1]});
    }
  }
  return segments;
}

class Lines final {
 public:
  explicit Lines(double size) : tolerance_{1e-9 * size} {}

  void add(const Segment& s) {
    double dx = s.to_x - s.from_x;
    double dz = s.to_z - s.from_z;
    const double length = std::hypot(dx, dz);
    if (!(length > tolerance_)) return;
    dx /= length;
    dz /= length;
    const bool forward = dx > 1e-12 || (std::abs(dx) <= 1e-12 && dz > 0);
    if (!forward) {
      dx = -dx;
      dz = -dz;
    }
    Line& line = line_of(s, dx, dz);
    const double a = line.along(s.from_x, s.from_z);
    const double b = line.along(s.to_x, s.to_z);
    line.spans.push_back({std::min(a, b), std::max(a, b), forward});
  }

  struct Piece {
    std::array<double, 4> ends;
    bool boundary;
  };
  /// The pieces that one block, or two, lie on; neighbours of one kind joined.
  [[nodiscard]] std::vector<Piece> pieces() const {
    std::vector<Piece> result;
    for (const auto& [key, lines] : buckets_) {
      for (const Line& line : lines) add_pieces(line, result);
    }
    return result;
  }

 private:
  Line& line_of(const Segment& s, double dx, double dz) {
    const double angle = std::atan2(dz, dx);
    const auto key = static_cast<std::int64_t>(std::llround(angle * 1e6));
    for (std::int64_t k = key - 1; k <= key + 1; ++k) {
      const auto found = buckets_.find(k);
      if (found == buckets_.end()) continue;
      for (Line& line : found->second) {
        if (std::abs(line.off(s.from_x, s.from_z)) <= 100 * tolerance_ &&
            std::abs(line.off(s.to_x, s.to_z)) <= 100 * tolerance_) {
          return line;
        }
      }
    }
    return buckets_[key].emplace_back(Line{s.from_x, s.from_z, dx, dz, {}});
  }

  void add_pieces(const Line& line, std::vector<Piece>& result) const {
    std::vector<double> places;
    for (const Line::Span& span : line.spans) {
      places.push_back(span.low);
      places.push_back(span.high);
    }
    std::ranges::sort(places);
    double begin = 0;
    bool open = false;
    bool boundary = false;
    const auto close = [&](double end) {
      if (open && end - begin > tolerance_) {
        result.push_back(
            {{line.x + begin * line.dx, line.z + begin * line.dz, line.x + end * line.dx, line.z + end * line.dz},
             boundary});
      }
      open = false;
    };
    for (std::size_t i = 0; i + 1 < places.size(); ++i) {
      if (places[i + 1] - places[i] <= tolerance_) continue;
      const double middle = (places[i] + places[i + 1]) / 2;
      bool left = false;
      bool right = false;
      for (const Line::Span& span : line.spans) {
        if (span.low < middle && middle < span.high) (span.left ? left : right) = true;
      }
      if (!left && !right) {
        close(places[i]);
        continue;
      }
      const bool is_boundary = left != right;
      if (open && is_boundary != boundary) close(places[i]);
      if (!open) {
        begin = places[i];
        open = true;
        boundary = is_boundary;
      }
    }
    if (!places.empty()) close(places.back());
  }

  double tolerance_;
  std::map<std::int64_t, std::vector<Line>> buckets_;
};

}  // namespace

Exported section_dda(const Cells& cells, std::string_view) {
  Exported result;
  if (cells.size() == 0) return result;
  const geometry::Box extent = extent_of(cells);
  const double y = section_place(cells, extent);
  const double size = norm(extent.size());
  Lines lines{size};
  for (const Segment& segment : segments_at(cells, y)) lines.add(segment);
  std::vector<Lines::Piece> pieces = lines.pieces();
  std::ranges::stable_partition(pieces, [](const Lines::Piece& piece) { return piece.boundary; });
  const auto boundaries = std::ranges::count_if(pieces, [](const Lines::Piece& piece) { return piece.boundary; });
  std::string& out = result.bytes;
  append_number(out, 1e-4 * size);  // smallest distance between a node and an edge
  out += '\n' + std::to_string(pieces.size()) + '\n' + std::to_string(boundaries) + '\n';
  for (int i = 0; i < 7; ++i) out += "0\n";  // tunnel and material lines, bolts, fixed, load, measured, hole points
  for (const Lines::Piece& piece : pieces) {
    // The program finds blocks from lines that cross: each reaches out by a thousandth of its length.
    const double dx = 1e-3 * (piece.ends[2] - piece.ends[0]);
    const double dz = 1e-3 * (piece.ends[3] - piece.ends[1]);
    for (const double value : {piece.ends[0] - dx, piece.ends[1] - dz, piece.ends[2] + dx, piece.ends[3] + dz}) {
      append_number(out, value);
      out += ' ';
    }
    out += "1\n";
  }
  result.notes.push_back("the vertical section at y = " + number(y) +
                         " m, x to the right, z up; fixed points are yours to add");
  return result;
}

}  // namespace cleave::report::detail
