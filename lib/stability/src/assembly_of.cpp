#include "assembly_of.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

#include "cleave/assembly/groups.hpp"
#include "cleave/core/assert.hpp"
#include "cleave/stability/analyse.hpp"
#include "flat.hpp"

namespace cleave::stability {
namespace {

using geometry::cross;
using geometry::dot;
using geometry::norm;
using geometry::Vec3;
using topology::BlockComplex;
using topology::BlockId;
using topology::Face;

/// Second moments about the centroid, of a block of density 1.
std::array<double, 6> inertia_of(const BlockComplex& complex, BlockId id) {
  const topology::Block& block = complex.blocks()[id];
  double xx = 0, yy = 0, zz = 0, xy = 0, yz = 0, zx = 0;
  for (const topology::FaceId face : block.faces) {
    for (const SignedTriangle& t : fan(complex, complex.faces()[face])) {
      const Vec3 a = t.corners[0] - block.centroid, b = t.corners[1] - block.centroid,
                 c = t.corners[2] - block.centroid;
      const double volume = t.sign * dot(a, cross(b, c)) / 120;
      const Vec3 s = a + b + c;
      const auto second = [&](auto p, auto q) {
        return volume * (a.*p * a.*q + b.*p * b.*q + c.*p * c.*q + s.*p * s.*q);
      };
      xx += second(&Vec3::x, &Vec3::x);
      yy += second(&Vec3::y, &Vec3::y);
      zz += second(&Vec3::z, &Vec3::z);
      xy += second(&Vec3::x, &Vec3::y);
      yz += second(&Vec3::y, &Vec3::z);
      zx += second(&Vec3::z, &Vec3::x);
    }
  }
  // Needles and plates are as stiff in every sense as rounding can tell.
  const double least = 1e-9 * std::max({xx, yy, zz, 1e-300});
  return {yy + zz + least, zz + xx + least, xx + yy + least, -xy, -yz, -zx};
}

/// Corners of the convex hull of points of a plane, counter-clockwise about its normal.
std::vector<Vec3> hull(const std::vector<Vec3>& points, Vec3 normal) {
  const Vec3 u = normalized(std::abs(normal.z) < 0.9 ? cross(normal, {0, 0, 1}) : cross(normal, {1, 0, 0}));
  const Vec3 w = cross(normal, u);
  struct Flat {
    double x, y;
    std::size_t from;
  };
  std::vector<Flat> flat;
  double size = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Vec3 p = points[k] - points[0];
    flat.push_back({dot(p, u), dot(p, w), k});
    size = std::max(size, norm(p));
  }
  std::ranges::sort(flat, [](const Flat& a, const Flat& b) { return std::pair{a.x, a.y} < std::pair{b.x, b.y}; });
  std::vector<Flat> out;
  const auto chain = [&](auto&& range) {
    const std::size_t base = out.size();
    for (const Flat& p : range) {
      while (out.size() >= base + 2) {
        const Flat &a = out[out.size() - 2], &b = out.back();
        if ((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x) > 1e-12 * size * size) break;
        out.pop_back();
      }
      out.push_back(p);
    }
    out.pop_back();
  };
  chain(flat);
  std::ranges::reverse(flat);
  chain(flat);
  std::vector<Vec3> corners;
  for (const Flat& p : out) corners.push_back(points[p.from]);
  if (corners.empty()) corners.push_back(points[0]);
  // Bonds fan out from the first, whichever block the patch is seen from.
  std::ranges::rotate(corners, std::ranges::min_element(corners, {}, geometry::along_generic));
  return corners;
}

/// What a face shares with one neighbour: all patches of both.
struct Shared {
  BlockId neighbour;
  double area = 0, tan_sum = 0, tan_least = std::numeric_limits<double>::infinity(), cohesion = 0, tension = 0;
  Vec3 centroid;
};

std::vector<Shared> shares_of(const Model& model, const Face& face, std::uint32_t batch) {
  const Settings& settings = model.settings();
  std::vector<Shared> out;
  for (const topology::Patch& patch : model.complex().patches(face)) {
    const double area = patch.area.si();
    if (!patch.neighbour || !model.present(*patch.neighbour, batch) || !(area > 0)) continue;
    auto it = std::ranges::find(out, *patch.neighbour, &Shared::neighbour);
    if (it == out.end()) it = out.insert(out.end(), Shared{.neighbour = *patch.neighbour, .centroid = {}});
    const JointStrength& strength = settings.strengths.of(patch.joint);
    it->area += area;
    it->centroid += area * patch.centroid;
    it->tan_sum += strength.tan_friction() * area;
    it->tan_least = std::min(it->tan_least, strength.tan_friction());
    const double counts = model.bond_share(face.block, *patch.neighbour, face.plane) / settings.partial.cohesion();
    it->cohesion += strength.cohesion().si() * area * counts;
    it->tension += strength.tension().si() * area * counts;
  }
  return out;
}

assembly::Contact contact_of(Model& model, const Face& face, const Shared& with) {
  const BlockComplex& complex = model.complex();
  assembly::Contact contact;
  contact.normal = model.inward(face).unit();
  std::vector<Vec3> corners;
  if (complex.patches(face).size() == 1) {
    for (const auto& loop : complex.loops(face)) {
      for (const topology::VertexId v : loop) corners.push_back(complex.position(v));
    }
  } else {
    corners = shared_corners(complex, face, with.neighbour);
  }
  if (corners.empty()) corners.push_back(with.centroid / with.area);
  contact.points = hull(corners, face.outward);
  const bool least = model.settings().group_friction == GroupFriction::smallest;
  contact.friction = (least ? with.tan_least : with.tan_sum / with.area) / model.settings().partial.friction();
  contact.most = most_pressure * with.area;
  if (!(with.cohesion > 0) && !(with.tension > 0)) return contact;
  const std::vector<Vec3>& p = contact.points;
  double whole = 0;
  for (std::size_t k = 1; k + 1 < p.size(); ++k) whole += norm(cross(p[k] - p[0], p[k + 1] - p[0]));
  for (std::size_t k = 1; k + 1 < p.size(); ++k) {
    const double part = norm(cross(p[k] - p[0], p[k + 1] - p[0])) / whole;
    contact.bonds.push_back(
        {.corners = {p[0], p[k], p[k + 1]}, .cohesion = part * with.cohesion, .tension = part * with.tension});
  }
  if (p.size() < 3) {
    contact.bonds.push_back({.corners = {p[0], p[0], p[0]}, .cohesion = with.cohesion, .tension = with.tension});
  }
  return contact;
}

assembly::Contact smooth_side(Model& model, const Face& face) {
  const BlockComplex& complex = model.complex();
  assembly::Contact contact;
  contact.normal = model.inward(face).unit();
  std::vector<Vec3> corners;
  for (const auto& loop : complex.loops(face)) {
    for (const topology::VertexId v : loop) corners.push_back(complex.position(v));
  }
  contact.points = hull(corners, face.outward);
  contact.most = most_pressure * face.area.si();
  return contact;
}

/// Two blocks and their plane, of each contact; none of a side of the domain.
using ContactKeys = std::vector<std::optional<BondShares::key_type>>;

assembly::Assembly assembly_with_keys(Model& model, std::span<const BlockId> blocks, std::uint32_t batch,
                                      ContactKeys& keys) {
  const BlockComplex& complex = model.complex();
  assembly::AssemblySpec spec{.freedom = assembly::Freedom::rigid};
  const double density = model.settings().rock.density().si();
  for (const BlockId id : blocks) {
    const topology::Block& block = complex.blocks()[id];
    assembly::Body body{.centroid = block.centroid,
                        .force = model.applied_forces(id, batch).newtons(),
                        .moment = model.other_forces(id, batch).moment,
                        .mass = density * block.volume.si()};
    body.inertia = inertia_of(complex, id);
    for (double& i : body.inertia) i *= density;
    spec.bodies.push_back(body);
  }
  const auto number = [&](BlockId id) -> std::optional<std::uint32_t> {
    const auto it = std::ranges::lower_bound(blocks, id);
    if (it == blocks.end() || *it != id) return std::nullopt;
    return static_cast<std::uint32_t>(it - blocks.begin());
  };
  for (std::uint32_t b = 0; b < blocks.size(); ++b) {
    for (const topology::FaceId face_id : complex.blocks()[blocks[b]].faces) {
      const Face& face = complex.faces()[face_id];
      if (face.role == topology::Role::fixed) {
        assembly::Contact contact = smooth_side(model, face);
        contact.body = b;
        spec.contacts.push_back(std::move(contact));
        keys.emplace_back();
      }
      if (face.role != topology::Role::joint) continue;
      for (const Shared& with : shares_of(model, face, batch)) {
        const auto other = number(with.neighbour);
        if (other && *other < b) continue;  // seen from there
        assembly::Contact contact = contact_of(model, face, with);
        contact.body = b;
        contact.other = other;
        spec.contacts.push_back(std::move(contact));
        keys.emplace_back(
            std::tuple{std::min(blocks[b], with.neighbour), std::max(blocks[b], with.neighbour), face.plane});
      }
    }
  }
  auto made = assembly::Assembly::make(std::move(spec));
  CLEAVE_ASSERT(made.has_value());
  return *std::move(made);
}

}  // namespace

assembly::Assembly assembly_of(Model& model, std::span<const BlockId> blocks, std::uint32_t batch) {
  ContactKeys keys;
  return assembly_with_keys(model, blocks, batch, keys);
}

BondShares bonds_that_count(Model& model, std::span<const BlockId> blocks, std::uint32_t batch) {
  ContactKeys keys;
  const assembly::Assembly group = assembly_with_keys(model, blocks, batch, keys);
  BondShares out;
  if (std::ranges::all_of(group.contacts(), [](const assembly::Contact& c) { return c.bonds.empty(); })) return out;
  const assembly::Start start = start_from_rest(group, 1);
  if (start.found != assembly::FromRest::moves) return out;
  for (std::size_t c = 0; c < keys.size(); ++c) {
    const assembly::Contact& contact = group.contacts()[c];
    if (!keys[c] || contact.bonds.empty()) continue;
    const double counts = pressed_cohesion(group, contact, start.forces.at_points[c]);
    // Faces of two blocks on one plane are one joint.
    const auto [at, fresh] = out.try_emplace(*keys[c], counts);
    if (!fresh) at->second = std::max(at->second, counts);
  }
  return out;
}

}  // namespace cleave::stability
