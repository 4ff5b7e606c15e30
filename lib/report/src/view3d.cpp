#include "view3d.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>

#include "cleave/exchange/exports.hpp"
#include "cleave/exchange/json.hpp"
#include "cleave/exchange/polygons.hpp"
#include "cleave/exchange/text.hpp"

namespace cleave::report {
namespace {

using geometry::Vec3;
using topology::BlockComplex;
using topology::BlockId;

static_assert(std::endian::native == std::endian::little);

template <class T>
void member_base64(JsonWriter& json, std::string_view name, const std::vector<T>& values) {
  json.key(name);
  json.base64(std::as_bytes(std::span{values}));
}

void member_vector(JsonWriter& json, std::string_view name, Vec3 v) {
  json.key(name);
  json.begin_array();
  for (const double c : {v.x, v.y, v.z}) json.value(c);
  json.end_array();
}

// Key blocks come first: the view must show them whatever the budget.
std::vector<BlockId> by_importance(const BlockComplex& complex, const stability::Analysis* analysis,
                                   const stability::KeyGroups* groups) {
  std::vector<std::uint8_t> rank(complex.blocks().size(), 4);
  for (const BlockId id : complex.blocks().ids()) {
    const topology::Block& block = complex.blocks()[id];
    if (block.fixed) rank[id.index()] = 3;
    if (block.free) rank[id.index()] = 2;
  }
  if (analysis != nullptr) {
    for (const stability::Judgement& j : analysis->judgements) rank[j.block.index()] = j.key ? 0 : 1;
  }
  if (groups != nullptr) {
    for (const stability::KeyGroup& group : groups->groups) {
      for (const BlockId id : group.blocks) rank[id.index()] = 0;
    }
  }
  std::vector<BlockId> order;
  for (const BlockId id : complex.blocks().ids()) order.push_back(id);
  std::ranges::stable_sort(order, {}, [&](BlockId id) { return rank[id.index()]; });
  return order;
}

struct BlockColumns {
  std::vector<std::uint32_t> id;
  std::vector<std::uint16_t> batch;  // 0: stays
  std::vector<std::uint8_t> mode;    // stability::Mode, or 255
  std::vector<float> factor;         // -1: none, 1e9: infinite
  std::vector<float> volume;
  std::vector<std::uint32_t> faces;

  void add(BlockId block, const topology::Block& facts, const stability::Judgement* judgement) {
    id.push_back(block.value());
    volume.push_back(static_cast<float>(facts.volume.si()));
    faces.push_back(static_cast<std::uint32_t>(facts.faces.size()));
    batch.push_back(judgement != nullptr && judgement->batch
                        ? static_cast<std::uint16_t>(std::min<std::uint32_t>(*judgement->batch, 65535U))
                        : std::uint16_t{0});
    mode.push_back(judgement != nullptr ? std::to_underlying(judgement->mode) : mode_not_judged);
    const double factor_of_safety = judgement != nullptr ? judgement->factor_of_safety : factor_when_unknown;
    factor.push_back(static_cast<float>(
        std::isfinite(factor_of_safety) ? std::min(factor_of_safety, factor_when_infinite) : factor_when_infinite));
  }
};

std::uint8_t role_code(const topology::Face& face) {
  switch (face.role) {
    case topology::Role::joint: return 0;
    case topology::Role::fixed:
    case topology::Role::window: return 1;
    case topology::Role::free: return face.excavation ? 3 : 2;
  }
  std::unreachable();
}

/// Set of a face without a joint.
constexpr std::uint16_t no_set = std::numeric_limits<std::uint16_t>::max();

struct FaceColumns {
  std::vector<std::uint32_t> block;  // index into the blocks shown
  std::vector<std::uint8_t> role;    // 0 joint, 1 fixed, 2 free domain side, 3 excavation
  std::vector<std::uint32_t> triangles;
  std::vector<std::uint16_t> set;  // no_set: no joint

  void add(std::uint32_t of_block, const topology::Face& face, const ViewSets* sets) {
    block.push_back(of_block);
    role.push_back(role_code(face));
    triangles.push_back(0);
    if (sets == nullptr) return;
    set.push_back(face.joint && face.joint->index() < sets->of.size() ? sets->of[face.joint->index()] : no_set);
  }
};

/// Blocks of all groups one after the other, with the number of each group's, and of each block centroid (from the
/// middle of the view), velocity and spin: nine numbers. Groups in doubt move nowhere.
void add_groups(JsonWriter& json, const BlockComplex& complex, const stability::KeyGroups& groups, Vec3 middle) {
  std::vector<std::uint32_t> sizes, blocks;
  std::vector<float> motions;
  for (const stability::KeyGroup& group : groups.groups) {
    sizes.push_back(static_cast<std::uint32_t>(group.blocks.size()));
    for (std::size_t k = 0; k < group.blocks.size(); ++k) {
      blocks.push_back(group.blocks[k].value());
      const Vec3 at = complex.blocks()[group.blocks[k]].centroid - middle;
      const assembly::Rate rate = k < group.rates.size() ? group.rates[k] : assembly::Rate{};
      for (const Vec3& v : {at, rate.velocity, rate.spin}) {
        for (const double c : {v.x, v.y, v.z}) motions.push_back(static_cast<float>(c));
      }
    }
  }
  member_base64(json, "groupSizes", sizes);
  member_base64(json, "groupBlocks", blocks);
  member_base64(json, "groupMotions", motions);
}

/// A vertex that is not shown; a bolt that serves no block.
constexpr std::uint32_t unused = std::numeric_limits<std::uint32_t>::max();

void add_bolts(JsonWriter& json, const std::vector<stability::BoltResult>& bolts, Vec3 middle) {
  std::vector<float> ends;
  std::vector<std::uint8_t> status;
  std::vector<std::uint32_t> serves;
  for (const stability::BoltResult& bolt : bolts) {
    const Vec3 head = bolt.bolt.collar - middle;
    const Vec3 tip = head + bolt.bolt.length.si() * bolt.bolt.direction;
    for (const double c : {head.x, head.y, head.z, tip.x, tip.y, tip.z}) ends.push_back(static_cast<float>(c));
    status.push_back(std::to_underlying(bolt.status));
    serves.push_back(bolt.serves ? bolt.serves->value() : unused);
  }
  member_base64(json, "bolts", ends);
  member_base64(json, "boltStatus", status);
  member_base64(json, "boltServes", serves);
}

/// x, y, z of each point in steps of a 65,535th of the box's sides.
std::vector<std::uint16_t> quantised(const std::vector<Vec3>& points, Vec3 low, Vec3 size) {
  std::vector<std::uint16_t> positions;
  positions.reserve(3 * points.size());
  const auto quantise = [](double value, double from, double extent) {
    return static_cast<std::uint16_t>(extent > 0 ? std::lround((value - from) / extent * 65535) : 0);
  };
  for (const Vec3& p : points) {
    positions.push_back(quantise(p.x, low.x, size.x));
    positions.push_back(quantise(p.y, low.y, size.y));
    positions.push_back(quantise(p.z, low.z, size.z));
  }
  return positions;
}

}  // namespace

std::size_t view_bytes(const BlockComplex& complex, BlockId block) {
  std::size_t corners = 0, faces = 0, loops = 0;
  for (const topology::FaceId id : complex.blocks()[block].faces) {
    const topology::Face& face = complex.faces()[id];
    ++faces;
    loops += complex.loops(face).size();
    corners += face.corner_count;
  }
  const std::size_t triangles =
      corners + 2 * loops - 4 * faces;  // corners + 2 holes - 2 of each face, holes = loops - 1
  // Points are shared by about three faces of a block; base64 makes four bytes of three.
  return (12 * triangles + 2 * corners + 11 * faces + 19 + 11) * 4 / 3;
}

View3d pack_view(const BlockComplex& complex, const stability::Analysis* analysis, std::size_t budget,
                 const stability::SupportResult* support, const stability::KeyGroups* groups, const ViewSets* sets) {
  View3d view{.json = {}, .total = complex.blocks().size()};
  BlockColumns blocks;
  FaceColumns faces;
  std::vector<std::uint32_t> triangles;
  std::vector<std::uint32_t> number(complex.vertices().size(), unused);
  std::vector<Vec3> points;
  std::vector<Triangle> of_face;
  FaceLoops loops;
  std::size_t bytes = 0;
  for (const BlockId id : by_importance(complex, analysis, groups)) {
    bytes += view_bytes(complex, id);
    if (bytes > budget && view.shown > 0) break;
    const stability::Judgement* judgement = nullptr;
    if (analysis != nullptr) {
      const auto found = std::ranges::lower_bound(analysis->judgements, id, {}, &stability::Judgement::block);
      if (found != analysis->judgements.end() && found->block == id) judgement = std::to_address(found);
    }
    const topology::Block& block = complex.blocks()[id];
    blocks.add(id, block, judgement);
    const std::size_t first_face = faces.block.size();
    for (const topology::FaceId face : block.faces) {
      faces.add(static_cast<std::uint32_t>(view.shown), complex.faces()[face], sets);
    }
    for (std::size_t f = 0; f < block.faces.size(); ++f) {
      of_face.clear();
      detail::append_triangles(complex, complex.faces()[block.faces[f]], complex.vertices().items(), loops, of_face);
      faces.triangles[first_face + f] = static_cast<std::uint32_t>(of_face.size());
      for (const Triangle& triangle : of_face) {
        for (const std::uint32_t vertex : triangle) {
          if (number[vertex] == unused) {
            number[vertex] = static_cast<std::uint32_t>(points.size());
            points.push_back(complex.position(topology::VertexId{vertex}));
          }
          triangles.push_back(number[vertex]);
        }
      }
    }
    ++view.shown;
  }

  const auto [low, high] = points.empty() ? geometry::Box{{}, {}} : geometry::box_of(points);
  const Vec3 size = high - low;
  JsonWriter json;
  json.reserve(std::min(bytes, budget) + 1'500'000);  // and the page around it
  json.begin_object();
  json.member("total", std::uint64_t{view.total});
  member_vector(json, "low", low);
  member_vector(json, "size", size);
  member_base64(json, "positions", quantised(points, low, size));
  member_base64(json, "triangles", triangles);
  member_base64(json, "faceBlock", faces.block);
  member_base64(json, "faceRole", faces.role);
  member_base64(json, "faceTriangles", faces.triangles);
  if (sets != nullptr) {
    member_base64(json, "faceSet", faces.set);
    json.key("setNames");
    json.begin_array();
    for (const std::string& name : sets->names) json.value(name);
    json.end_array();
  }
  member_base64(json, "id", blocks.id);
  member_base64(json, "batch", blocks.batch);
  member_base64(json, "mode", blocks.mode);
  member_base64(json, "factor", blocks.factor);
  member_base64(json, "volume", blocks.volume);
  member_base64(json, "faces", blocks.faces);
  // Relative to the view's middle, as the page has it.
  const Vec3 middle = 0.5 * (low + high);
  if (groups != nullptr && !groups->groups.empty()) add_groups(json, complex, *groups, middle);
  if (support != nullptr && !support->bolts.empty()) add_bolts(json, support->bolts, middle);
  json.end_object();
  view.json = std::move(json).finish();
  return view;
}

}  // namespace cleave::report
