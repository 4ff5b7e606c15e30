#include "unrolled.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "cleave/exchange/text.hpp"
#include "cleave/geometry/tunnel.hpp"
#include "cleave/realize/places.hpp"
#include "cleave/stochastic/record.hpp"
#include "drawings.hpp"
#include "svg.hpp"

namespace cleave::report {
namespace {

using detail::fixed, detail::tick_step;
using geometry::Vec3;

/// A place on the wall of a tunnel: along the axis, and around it from the crown, to the right looking along the axis.
struct Unrolled {
  double chainage = 0, around = 0;
};

/// The wall of a tunnel as a strip.
class Wall final {
 public:
  Wall(const scene::TunnelLine& line, geometry::North north)
      : line_{line},
        north_{north},
        frames_{geometry::section_frames(line.axis, line.up)},
        starts_(line.outline.size() + 1, 0.0) {
    const auto& outline = line.outline;
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const auto [du, dv] = side(i);
      starts_[i + 1] = starts_[i] + std::hypot(du, dv);
    }
    // The crown: the highest place straight above the middle.
    double top = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const auto [du, dv] = side(i);
      const double u = outline[i][0];
      if ((u > 0) == (u + du > 0) || du == 0) continue;
      const double share = -u / du, v = outline[i][1] + share * dv;
      if (v <= top) continue;
      top = v;
      crown_ = starts_[i] + share * (starts_[i + 1] - starts_[i]);
    }
  }
  [[nodiscard]] double perimeter() const { return starts_.back(); }
  /// Of the four sides, from the lowest over the left one.
  [[nodiscard]] std::array<std::string_view, 4> names() const {
    const geometry::SectionFrame& section = frames_.front();
    if (!scene::at_shaft(section)) return {"floor", "left wall", "crown", "right wall"};
    const auto name = [&](Vec3 away) { return scene::position_of(section, away, north_); };
    return {name(-section.up), name(-section.right), name(section.up), name(section.right)};
  }
  [[nodiscard]] Vec3 axis_at(double chainage) const { return part_at(chainage).frame.along; }
  /// The side of the outline nearest to a point, and how far off it is.
  [[nodiscard]] std::pair<std::size_t, double> nearest_side(Vec3 p) const {
    const auto [u, v] = across(p);
    std::pair<std::size_t, double> best{0, std::numeric_limits<double>::infinity()};
    for (std::size_t i = 0; i + 1 < starts_.size(); ++i) {
      const auto [du, dv] = side(i);
      const double square = du * du + dv * dv;
      if (!(square > 0)) continue;
      const double a = u - line_.outline[i][0], b = v - line_.outline[i][1];
      const double share = std::clamp((a * du + b * dv) / square, 0.0, 1.0);
      const double off = std::hypot(a - share * du, b - share * dv);
      if (off < best.second) best = {i, off};
    }
    return best;
  }
  /// Of a point at that side of the outline.
  [[nodiscard]] Unrolled unroll(Vec3 p, std::size_t i) const {
    const auto [u, v] = across(p);
    const auto [du, dv] = side(i);
    const double part = starts_[i + 1] - starts_[i];
    const double along = ((u - line_.outline[i][0]) * du + (v - line_.outline[i][1]) * dv) / part;
    double around = crown_ - (starts_[i] + std::clamp(along, 0.0, part));  // the outline runs counter-clockwise
    const double middle = crown_ - (starts_[i] + part / 2);
    if (middle > perimeter() / 2) around -= perimeter();
    if (middle < -perimeter() / 2) around += perimeter();
    return {stochastic::chainage_of(line_.axis, p), around};
  }

 private:
  [[nodiscard]] std::array<double, 2> side(std::size_t i) const {
    const auto& a = line_.outline[i];
    const auto& b = line_.outline[(i + 1) % line_.outline.size()];
    return {b[0] - a[0], b[1] - a[1]};
  }
  /// Where the axis is at a chainage, and how the section lies there.
  struct Part {
    Vec3 at;
    const geometry::SectionFrame& frame;
  };
  [[nodiscard]] Part part_at(double chainage) const {
    std::size_t i = 0;
    for (; i + 2 < line_.axis.size() && chainage > norm(line_.axis[i + 1] - line_.axis[i]); ++i) {
      chainage -= norm(line_.axis[i + 1] - line_.axis[i]);
    }
    return {line_.axis[i] + chainage * frames_[i].along, frames_[i]};
  }
  /// To the right and up from the axis.
  [[nodiscard]] std::array<double, 2> across(Vec3 p) const {
    const Part part = part_at(stochastic::chainage_of(line_.axis, p));
    const Vec3 d = p - part.at;
    return {dot(d, part.frame.right), dot(d, part.frame.up)};
  }

  const scene::TunnelLine& line_;
  geometry::North north_;
  std::vector<geometry::SectionFrame> frames_;
  std::vector<double> starts_;
  double crown_ = 0;
};

struct Shape {
  std::vector<std::vector<Unrolled>> loops;
  std::vector<std::array<Unrolled, 2>> traces;  ///< its edges but those where one block's faces bend with the outline
  std::uint32_t batch = 0;
  bool key = false;
  std::uint32_t block = 0;
  double area = 0;
};

/// Block and ends of every directed edge of the faces at one opening: the reverse is there too where two faces of one
/// block meet.
using DirectedEdges = std::set<std::array<std::uint32_t, 3>>;
DirectedEdges edges_at(const topology::BlockComplex& complex, std::uint32_t excavation) {
  DirectedEdges edges;
  for (const topology::Face& face : complex.faces()) {
    if (face.role != topology::Role::free || face.excavation != excavation) continue;
    for (const auto& loop : complex.loops(face)) {
      for (std::size_t i = 0; i < loop.size(); ++i) {
        edges.insert({face.block.value(), loop[i].value(), loop[(i + 1) % loop.size()].value()});
      }
    }
  }
  return edges;
}

/// Faces of the rock at one opening, but for its headings.
std::vector<Shape> shapes_at(const Page& page, std::uint32_t excavation, const Wall& wall) {
  const topology::BlockComplex& complex = *page.complex;
  std::vector<std::uint32_t> batches(complex.blocks().size(), 0);
  std::vector<bool> key(complex.blocks().size(), false);
  if (page.result.analysis) {
    for (const stability::Judgement& j : page.result.analysis->judgements) {
      batches[j.block.index()] = j.batch.value_or(0);
      key[j.block.index()] = j.key;
    }
  }
  const DirectedEdges bends = edges_at(complex, excavation);
  std::vector<Shape> shapes;
  for (const topology::FaceId id : complex.faces().ids()) {
    const topology::Face& face = complex.faces()[id];
    if (face.role != topology::Role::free || face.excavation != excavation) continue;
    const double chainage = wall.unroll(face.centroid, 0).chainage;
    if (std::abs(dot(face.outward, wall.axis_at(chainage))) > 0.7) continue;
    const std::size_t side = wall.nearest_side(face.centroid).first;
    Shape shape{.loops = {},
                .traces = {},
                .batch = batches[face.block.index()],
                .key = key[face.block.index()],
                .block = face.block.value(),
                .area = face.area.si()};
    for (const auto& loop : complex.loops(face)) {
      auto& corners = shape.loops.emplace_back();
      for (const topology::VertexId v : loop) corners.push_back(wall.unroll(complex.position(v), side));
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const std::size_t next = (i + 1) % loop.size();
        if (!bends.contains({face.block.value(), loop[next].value(), loop[i].value()})) {
          shape.traces.push_back({corners[i], corners[next]});
        }
      }
    }
    shapes.push_back(std::move(shape));
  }
  return shapes;
}

class Map final {
 public:
  Map(const Wall& wall, const std::vector<Shape>& shapes, std::size_t number) : wall_{wall}, number_{number} {
    for (const Shape& shape : shapes) {
      for (const Unrolled& p : shape.loops.front()) {
        from_ = std::min(from_, p.chainage);
        to_ = std::max(to_, p.chainage);
      }
    }
    if (!any()) return;
    const double wanted = std::ceil((to_ - from_) / (3 * wall.perimeter()));
    strips_ = static_cast<std::size_t>(std::clamp(wanted, 1.0, 8.0));
    strip_length_ = (to_ - from_) / static_cast<double>(strips_);
    scale_ = (width - left - 26) / strip_length_;
    strip_height_ = wall.perimeter() * scale_ + 44;
  }

  /// False where nothing of the wall has a length along the axis.
  [[nodiscard]] bool any() const { return to_ > from_; }

  [[nodiscard]] std::string svg(const std::vector<Shape>& shapes, const std::vector<Unrolled>& bolts) const {
    std::string out = "<svg viewBox=\"0 0 1000 " + fixed(static_cast<double>(strips_) * strip_height_) +
                      "\" role=\"img\" aria-label=\"Unrolled wall of the tunnel\">";
    for (std::size_t strip = 0; strip < strips_; ++strip) draw_strip(out, strip, shapes, bolts);
    return out + "</svg>";
  }

 private:
  static constexpr double width = 1000, left = 78;

  void draw_strip(std::string& out, std::size_t strip, const std::vector<Shape>& shapes,
                  const std::vector<Unrolled>& bolts) const {
    const double begin = from_ + static_cast<double>(strip) * strip_length_, end = begin + strip_length_;
    const double top = static_cast<double>(strip) * strip_height_ + 10, height = wall_.perimeter() * scale_;
    const auto x = [&](double chainage) { return left + (chainage - begin) * scale_; };
    const auto y = [&](double around) { return top + height / 2 + around * scale_; };
    const std::string name = "strip-" + std::to_string(number_) + "-" + std::to_string(strip);
    out += "<clipPath id=\"" + name + "\"><rect x=\"" + fixed(left) + "\" y=\"" + fixed(top) + "\" width=\"" +
           fixed(strip_length_ * scale_) + "\" height=\"" + fixed(height) + "\"/></clipPath><g clip-path=\"url(#" +
           name + ")\">";
    std::string lines, labels;
    for (const Shape& shape : shapes) draw_shape(out, lines, labels, shape, begin, end, x, y);
    out += lines;
    for (const Unrolled& b : bolts) {
      if (b.chainage < begin || b.chainage > end) continue;
      out += "<circle r=\"2.5\" class=\"pic-bolt\" cx=\"" + fixed(x(b.chainage)) + "\" cy=\"" + fixed(y(b.around)) +
             "\"/>";
    }
    out += labels + "</g>";
    frame(out, begin, end, top, height, x);
  }

  void draw_shape(std::string& out, std::string& lines, std::string& labels, const Shape& shape, double begin,
                  double end, const auto& x, const auto& y) const {
    double low = std::numeric_limits<double>::infinity(), high = -low, lowest = low, highest = -low;
    for (const Unrolled& p : shape.loops.front()) {
      low = std::min(low, p.chainage);
      high = std::max(high, p.chainage);
      lowest = std::min(lowest, p.around);
      highest = std::max(highest, p.around);
    }
    if (high < begin || low > end) return;
    // What crosses the seam in the floor is drawn on both sides of the strip.
    for (const double turn : {-wall_.perimeter(), 0.0, wall_.perimeter()}) {
      if (lowest + turn > wall_.perimeter() / 2 || highest + turn < -wall_.perimeter() / 2) continue;
      out += "<path ";
      out += shape.key ? "stroke-width=\".6\" stroke=\"" + batch_colour(shape.batch) + "\" fill=\"" +
                             batch_colour(shape.batch)
                       : std::string{"class=\"pic-rock"};
      out += "\" d=\"";
      for (const auto& loop : shape.loops) {
        for (std::size_t i = 0; i < loop.size(); ++i) {
          out += (i == 0 ? 'M' : 'L') + fixed(x(loop[i].chainage)) + ',' + fixed(y(loop[i].around + turn));
        }
        out += 'z';
      }
      out += "\"/>";
      if (shape.traces.empty()) continue;
      lines += "<path class=\"pic-trace\" d=\"";
      for (const auto& [a, b] : shape.traces) {
        lines += 'M' + fixed(x(a.chainage)) + ',' + fixed(y(a.around + turn)) + 'L' + fixed(x(b.chainage)) + ',' +
                 fixed(y(b.around + turn));
      }
      lines += "\"/>";
    }
    if (shape.key && (high - low) * scale_ > 24 && (highest - lowest) * scale_ > 14) {
      labels += "<text text-anchor=\"middle\" x=\"" + fixed(x((low + high) / 2)) + "\" y=\"" +
                fixed(y((lowest + highest) / 2) + 4) + "\">" + std::to_string(shape.block) + "</text>";
    }
  }

  void frame(std::string& out, double begin, double end, double top, double height, const auto& x) const {
    out += "<rect fill=\"none\" class=\"grid\" x=\"" + fixed(left) + "\" y=\"" + fixed(top) + "\" width=\"" +
           fixed(strip_length_ * scale_) + "\" height=\"" + fixed(height) + "\"/>";
    const auto names = wall_.names();
    for (std::size_t quarter = 0; quarter <= 4; ++quarter) {
      const double place = 0.25 * static_cast<double>(quarter);
      out += detail::text(left - 6, top + height * place + 5, "end", names[quarter % 4]);
      if (quarter == 2) {
        out += "<path class=\"grid\" d=\"M" + fixed(left) + ',' + fixed(top + height / 2) + 'h' +
               fixed(strip_length_ * scale_) + "\" stroke-dasharray=\"6 4\"/>";
      }
    }
    const double step = tick_step(strip_length_, 8);
    for (double at = std::ceil(begin / step) * step; at <= end + 1e-9 * step; at += step) {
      out += "<path class=\"net-tick\" d=\"M" + fixed(x(at)) + ',' + fixed(top + height) + "v5\"/>" +
             detail::text(x(at), top + height + 20, "middle", display(std::abs(at) < 1e-9 * step ? 0 : at, 6) + " m");
    }
  }

  const Wall& wall_;
  std::size_t number_;
  double from_ = std::numeric_limits<double>::infinity(), to_ = -std::numeric_limits<double>::infinity();
  std::size_t strips_ = 1;
  double strip_length_ = 1, strip_height_ = 1, scale_ = 1;
};

/// Bolts whose collars lie on the wall.
std::vector<Unrolled> bolts_at(const Page& page, const Wall& wall) {
  std::vector<Unrolled> bolts;
  if (!page.result.support) return bolts;
  for (const stability::BoltResult& b : page.result.support->bolts) {
    const auto [side, off] = wall.nearest_side(b.bolt.collar);
    if (off < 1e-3 * wall.perimeter()) bolts.push_back(wall.unroll(b.bolt.collar, side));
  }
  return bolts;
}

constexpr std::size_t most_shapes = 20'000;

}  // namespace

std::string unrolled_section(const Page& page) {
  if (page.complex == nullptr) return {};
  std::string out;
  for (std::size_t i = 0; i < page.result.excavations.size(); ++i) {
    const scene::ExcavationInfo& excavation = page.result.excavations[i];
    if (!excavation.tunnel || excavation.tunnel->axis.size() < 2 || excavation.tunnel->outline.size() < 3) continue;
    const Wall wall{*excavation.tunnel, geometry::North::degrees(page.result.north)};
    std::vector<Shape> shapes = shapes_at(page, static_cast<std::uint32_t>(i), wall);
    if (shapes.empty() || !(wall.perimeter() > 0)) continue;
    const std::size_t all = shapes.size();
    if (all > most_shapes) {
      std::ranges::stable_sort(shapes, std::ranges::greater{}, [](const Shape& s) { return std::pair{s.key, s.area}; });
      shapes.resize(most_shapes);
    }
    std::ranges::stable_sort(shapes, {}, &Shape::key);  // key blocks' edges on top
    const Map map{wall, shapes, i};
    if (!map.any()) continue;
    out += "<figure class=\"unrolled\">" + map.svg(shapes, bolts_at(page, wall)) + "<figcaption>" +
           escape_xml(excavation.name) + ", perimeter " + display(wall.perimeter(), 4) + " m" +
           (all > most_shapes ? ", the " + display_count(most_shapes) + " largest of " + display_count(all) + " faces"
                              : "") +
           "</figcaption></figure>\n";
  }
  if (out.empty()) return {};
  return "<section id=\"unrolled\"><h2>Walls of the tunnels, unrolled</h2>\n<p class=\"small\">Chainage to the right, "
         "around the tunnel downwards from the floor over the left wall, the crown and the right wall to the floor, "
         "left and right looking along the axis: as seen through the rock from above; shafts by the compass. Lines are "
         "traces of joints; "
         "filled "
         "are the faces of key blocks, by batch, with their numbers; dots are collars of bolts.</p>\n" +
         out + "</section>\n";
}

}  // namespace cleave::report
