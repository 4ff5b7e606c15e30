#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "cleave/exchange/polygons.hpp"
#include "drawings.hpp"
#include "svg.hpp"

namespace cleave::report {
namespace {

using detail::fixed;
using geometry::Vec3;
using topology::BlockComplex;

// Camera: to the right, up and towards the reader.
struct Camera {
  Vec3 right, up, towards;
};

Camera camera(Vec3 from) {
  const Vec3 towards = normalized(from);
  const Vec3 along = cross(Vec3{0, 0, 1}, towards);
  const Vec3 right = norm(along) > 1e-6 ? normalized(along) : Vec3{1, 0, 0};
  return {right, cross(towards, right), towards};
}
constexpr Vec3 south_east_above{0.62, -1.0, 0.55};

struct Patch {
  topology::FaceId face;
  double depth;
  double area;
  std::uint32_t batch;  // 0: wall of an excavation, or side of the system
  bool seen_through;    // a wall whose rock stands between it and the reader
};

std::vector<std::uint32_t> batches_of(const BlockComplex& complex, const stability::Analysis* analysis) {
  std::vector<std::uint32_t> batches(complex.blocks().size(), 0);
  if (analysis == nullptr) return batches;
  for (const stability::Judgement& j : analysis->judgements) {
    if (j.batch) batches[j.block.index()] = *j.batch;
  }
  return batches;
}

std::vector<Patch> visible(const BlockComplex& complex, const stability::Analysis* analysis, const Camera& eye,
                           std::size_t max_polygons) {
  const auto batches = batches_of(complex, analysis);
  const bool any_excavation =
      std::ranges::any_of(complex.faces(), [](const topology::Face& f) { return f.excavation.has_value(); });
  std::vector<Patch> patches;
  for (const topology::FaceId id : complex.faces().ids()) {
    const topology::Face& face = complex.faces()[id];
    const std::uint32_t batch = batches[face.block.index()];
    const double facing = dot(face.outward, eye.towards);
    const bool wall = any_excavation ? face.excavation.has_value() : face.role != topology::Role::joint;
    const bool show = batch > 0 ? facing > 0 : wall && (any_excavation || facing > 0);
    if (show) {
      patches.push_back({.face = id,
                         .depth = dot(face.centroid, eye.towards),
                         .area = face.area.si(),
                         .batch = batch,
                         .seen_through = batch == 0 && facing <= 0});
    }
  }
  if (patches.size() > max_polygons) {
    std::ranges::stable_sort(patches, std::ranges::greater{},
                             [](const Patch& p) { return std::pair{p.batch > 0, p.area}; });
    patches.erase(patches.begin() + static_cast<std::ptrdiff_t>(max_polygons), patches.end());
    std::ranges::sort(patches, {}, &Patch::face);
  }
  // Painter's order, from far to near; walls that the reader looks through are glass.
  std::ranges::stable_sort(patches, {}, &Patch::depth);
  return patches;
}

// Light from the upper left; percent of the batch's colour.
int shade(Vec3 outward) {
  const double light = dot(outward, normalized(Vec3{-0.3, -0.5, 0.9}));
  return static_cast<int>(std::lround(78 + 22 * light));
}

}  // namespace

std::string batch_colour(std::uint32_t batch) {
  constexpr std::array<std::string_view, 8> colours{"#D55E00", "#E69F00", "#0072B2", "#56B4E9",
                                                    "#009E73", "#CC79A7", "#B8A800", "#7A5195"};
  if (batch == 0 || batch > colours.size()) return "#7d8590";
  return std::string{colours[batch - 1]};
}

std::string still_picture(const BlockComplex& complex, const stability::Analysis* analysis, std::size_t max_polygons) {
  const Camera eye = camera(south_east_above);
  const auto patches = visible(complex, analysis, eye, max_polygons);
  double left = 1e300, right = -1e300, top = 1e300, bottom = -1e300;
  const auto at = [&](topology::VertexId v) {
    const Vec3 p = complex.vertices()[v];
    return std::pair{dot(p, eye.right), -dot(p, eye.up)};
  };
  for (const Patch& patch : patches) {
    for (const topology::VertexId v : complex.loops(complex.faces()[patch.face]).front()) {
      const auto [x, y] = at(v);
      left = std::min(left, x);
      right = std::max(right, x);
      top = std::min(top, y);
      bottom = std::max(bottom, y);
    }
  }
  if (patches.empty()) return {};
  const double scale = 940 / std::max({right - left, (bottom - top) * 1.5, 1e-300});
  const double height = (bottom - top) * scale + 60;
  std::string out =
      "<svg viewBox=\"0 0 1000 " + fixed(height) +
      "\" role=\"img\" aria-label=\"Key blocks and excavation, parallel view from the south-east and above\">";
  const double shift = (1000 - (right - left) * scale) / 2;
  for (const Patch& patch : patches) {
    const topology::Face& face = complex.faces()[patch.face];
    out += "<path class=\"";
    out += patch.batch > 0 ? "pic-key" : (patch.seen_through ? "pic-near" : "pic-wall");
    out += "\" d=\"";
    for (const auto& loop : complex.loops(face)) {
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const auto [x, y] = at(loop[i]);
        out += (i == 0 ? 'M' : 'L') + fixed((x - left) * scale + shift) + ',' + fixed((y - top) * scale + 30);
      }
      out += 'z';
    }
    out += "\"";
    if (patch.batch > 0) {
      out += " style=\"fill:color-mix(in srgb," + batch_colour(patch.batch) + ' ' +
             std::to_string(shade(face.outward)) + "%,#000)\" fill=\"" + batch_colour(patch.batch) + "\"";
    }
    out += "/>";
  }
  return out + "</svg>";
}

std::string block_picture(const BlockComplex& complex, const stability::Judgement& judgement) {
  const topology::Block& block = complex.blocks()[judgement.block];
  Vec3 open{0, 0, 0};
  for (const topology::FaceId id : block.faces) {
    const topology::Face& face = complex.faces()[id];
    if (face.role == topology::Role::free) open += face.area.si() * face.outward;
  }
  const Vec3 aside = 0.55 * normalized(south_east_above);
  const Camera eye = camera(norm(open) > 0 ? normalized(open) + aside : aside);
  constexpr double side = 240, margin = 26;
  double reach = 0;
  for (const topology::FaceId id : block.faces) {
    for (const topology::VertexId v : complex.loops(complex.faces()[id]).front()) {
      const Vec3 p = complex.position(v) - block.centroid;
      reach = std::max({reach, std::abs(dot(p, eye.right)), std::abs(dot(p, eye.up))});
    }
  }
  if (!(reach > 0)) return {};
  const double scale = (side / 2 - margin) / reach;
  const auto at = [&](Vec3 p) {
    const Vec3 d = p - block.centroid;
    return fixed(side / 2 + scale * dot(d, eye.right)) + ',' + fixed(side / 2 - scale * dot(d, eye.up));
  };
  // Faces turned away first, as dashed edges; then those that are seen, from far to near.
  std::vector<topology::FaceId> faces{block.faces.begin(), block.faces.end()};
  const auto seen = [&](topology::FaceId id) { return dot(complex.faces()[id].outward, eye.towards) > 0; };
  std::ranges::stable_sort(faces, {}, [&](topology::FaceId id) {
    return std::pair{seen(id), dot(complex.faces()[id].centroid, eye.towards)};
  });
  const std::string colour = batch_colour(judgement.batch.value_or(0));
  std::string front, back;
  for (const topology::FaceId id : faces) {
    const topology::Face& face = complex.faces()[id];
    std::string d;
    for (const auto& loop : complex.loops(face)) {
      for (std::size_t i = 0; i < loop.size(); ++i) d += (i == 0 ? 'M' : 'L') + at(complex.position(loop[i]));
      d += 'z';
    }
    if (!seen(id)) {
      back += "<path class=\"pic-hidden\" d=\"" + d + "\"/>";
    } else if (face.role == topology::Role::joint) {
      front += "<path class=\"pic-key\" d=\"" + d + "\" fill-opacity=\".82\" style=\"fill:color-mix(in srgb," + colour +
               ' ' + std::to_string(shade(face.outward)) + "%,#000)\" fill=\"" + colour + "\"/>";
    } else {
      front += "<path class=\"pic-wall\" fill-opacity=\".82\" d=\"" + d + "\"/>";
    }
  }
  std::string out =
      "<svg viewBox=\"0 0 240 240\" role=\"img\" aria-label=\"The block from the side of its free faces\">" + front +
      back;
  const double x = dot(judgement.direction, eye.right), y = -dot(judgement.direction, eye.up);
  if (const double length = std::hypot(x, y); length > 0.05) {
    const double ux = x / length, uy = y / length, tip = side / 2 - 6;
    const double tx = side / 2 + tip * ux, ty = side / 2 + tip * uy;
    out += "<path d=\"M120,120L" + fixed(tx) + ',' + fixed(ty) +
           "\" stroke=\"#009E73\" stroke-width=\"3\"/><path d=\"M" + fixed(tx) + ',' + fixed(ty) + 'l' +
           fixed(-9 * ux - 4 * uy) + ',' + fixed(-9 * uy + 4 * ux) + 'l' + fixed(8 * uy) + ',' + fixed(-8 * ux) +
           "z\" fill=\"#009E73\"/>";
  }
  return out + "</svg>";
}

}  // namespace cleave::report
