#include "oracle.hpp"

#include <algorithm>
#include <sstream>
#include <stdexcept>

#include "boundary.hpp"
#include "membership.hpp"

namespace cleave::oracle {

using testing::IntegerPoint;
using testing::IntegerPolygon;
using testing::IntegerScene;
using testing::IntegerSolid;

namespace {

enum class Role : std::int64_t { joint, fixed, free };

/// With excavations the box is cut one larger on all sides: what lies behind a side of the domain may be air.
IntegerPoint around(const IntegerScene& scene, std::int32_t by) {
  const std::int32_t d = scene.excavations.empty() ? 0 : by;
  return (by < 0 ? scene.min : scene.max) + IntegerPoint{d, d, d};
}

/// One joint with its plane, ready to be asked.
struct Facet {
  const IntegerPolygon* polygon;
  PlaneEquation plane;
  std::vector<PlaneEquation> outline;
};

class Cutter final {
 public:
  Cutter(const IntegerScene& scene, const OracleOptions& options)
      : scene_{scene}, options_{options}, arrangement_{around(scene, -1), around(scene, 1)} {
    for (const IntegerPolygon& joint : scene.joints)
      facets_.push_back({&joint, plane_of(joint), outline_planes(joint)});
  }

  [[nodiscard]] std::vector<OracleBlock> run() {
    partition();
    pair_faces();
    classify();
    join();
    return blocks();
  }

 private:
  void partition();
  void pair_faces();
  void classify();
  void join();
  [[nodiscard]] bool covered(const CellFace& face);
  [[nodiscard]] std::int64_t first_joint(const CellFace& face) const;
  [[nodiscard]] std::vector<OracleBlock> blocks();

  const IntegerScene& scene_;
  OracleOptions options_;
  Arrangement arrangement_;
  std::vector<Facet> facets_;
  Neighbours neighbours_;
  std::vector<std::optional<Role>> outside_;  // role of the faces next to a cell that is not rock
  UnionFind same_{0};
};

void Cutter::partition() {
  for (const Facet& facet : facets_) arrangement_.insert(facet.plane);
  std::vector<const IntegerSolid*> solids;
  const IntegerSolid box = testing::integer_box(scene_.min, scene_.max);
  solids.push_back(&box);
  for (const IntegerSolid& solid : scene_.excavations) solids.push_back(&solid);
  if (scene_.domain) solids.push_back(&*scene_.domain);
  for (const IntegerSolid* solid : solids) {
    for (std::size_t f = 0; f < solid->faces.size(); ++f) arrangement_.insert(plane_of(face_polygon(*solid, f)));
  }
  for (const Facet& facet : facets_) {
    // By joint, faces end where a coplanar joint takes over: those outlines must be lines of the partition.
    const auto coplanar = std::ranges::count_if(facets_, [&](const Facet& o) { return o.plane == facet.plane; });
    if (!options_.outlines_cut_cells && (options_.rule == FaceRule::role || coplanar < 2)) continue;
    for (const PlaneEquation& plane : facet.outline) arrangement_.insert(plane);
  }
}

void Cutter::pair_faces() {
  std::map<Loop, Neighbour> open;
  const auto& cells = arrangement_.cells();
  neighbours_.resize(cells.size());
  for (std::uint32_t c = 0; c < cells.size(); ++c) {
    neighbours_[c].resize(cells[c].size());
    for (std::uint32_t f = 0; f < cells[c].size(); ++f) {
      Loop key = cells[c][f].loop;
      std::ranges::sort(key);
      const auto [it, fresh] = open.try_emplace(std::move(key), Neighbour{c, f});
      if (fresh) continue;
      neighbours_[c][f] = it->second;
      neighbours_[it->second.cell][it->second.face] = Neighbour{c, f};
      open.erase(it);
    }
  }
  for (const auto& entry : open) {
    const std::uint32_t plane = cells[entry.second.cell][entry.second.face].plane;
    if (plane >= 6) throw std::logic_error("oracle: a cell face inside the box has no neighbour");
  }
}

void Cutter::classify() {
  outside_.resize(arrangement_.cells().size());
  if (scene_.excavations.empty() && !scene_.domain) return;
  const IntegerSolid domain = scene_.domain ? *scene_.domain : testing::integer_box(scene_.min, scene_.max);
  for (std::size_t c = 0; c < outside_.size(); ++c) {
    const HomogeneousPoint point = arrangement_.inside(arrangement_.cells()[c]);
    // Air first: an excavation that ends on a side of the domain, or leaves it, frees what it touches.
    if (std::ranges::any_of(scene_.excavations, [&](const IntegerSolid& s) { return contains(s, point); })) {
      outside_[c] = Role::free;
    } else if (!contains(domain, point)) {
      outside_[c] = Role::fixed;
    }
  }
}

bool Cutter::covered(const CellFace& face) {
  std::vector<Loop> open{face.loop};
  for (const Facet& facet : facets_) {
    if (facet.plane != arrangement_.plane(face.plane)) continue;
    std::vector<Loop> pieces = std::move(open);
    open.clear();
    for (const PlaneEquation& line : facet.outline) {
      std::vector<Loop> finer;
      for (const Loop& piece : pieces) {
        auto [below, above] = arrangement_.split(piece, line);
        if (!below.empty()) finer.push_back(std::move(below));
        if (!above.empty()) finer.push_back(std::move(above));
      }
      pieces = std::move(finer);
    }
    for (Loop& piece : pieces) {
      if (!contains(*facet.polygon, facet.plane, arrangement_.inside(piece))) open.push_back(std::move(piece));
    }
    if (open.empty()) return true;
  }
  return open.empty();
}

void Cutter::join() {
  const auto& cells = arrangement_.cells();
  same_ = UnionFind{cells.size()};
  for (std::uint32_t c = 0; c < cells.size(); ++c) {
    if (outside_[c]) continue;
    for (std::uint32_t f = 0; f < cells[c].size(); ++f) {
      const auto other = neighbours_[c][f];
      if (!other || other->cell < c || outside_[other->cell]) continue;
      if (same_.find(c) != same_.find(other->cell) && !covered(cells[c][f])) same_.join(c, other->cell);
    }
  }
}

std::int64_t Cutter::first_joint(const CellFace& face) const {
  if (options_.rule == FaceRule::role) return 0;
  std::vector<std::size_t> coplanar;
  for (std::size_t j = 0; j < facets_.size(); ++j) {
    if (facets_[j].plane == arrangement_.plane(face.plane)) coplanar.push_back(j);
  }
  if (coplanar.size() == 1) return static_cast<std::int64_t>(coplanar.front());
  const HomogeneousPoint point = arrangement_.inside(face.loop);
  for (const std::size_t j : coplanar) {
    if (contains(*facets_[j].polygon, facets_[j].plane, point)) return static_cast<std::int64_t>(j);
  }
  throw std::logic_error("oracle: blocks parted by nothing");
}

std::vector<OracleBlock> Cutter::blocks() {
  const auto& cells = arrangement_.cells();
  std::map<std::size_t, std::vector<HalfFace>> boundaries;
  std::vector<std::vector<std::int32_t>> number(cells.size());
  for (std::uint32_t c = 0; c < cells.size(); ++c) {
    number[c].assign(cells[c].size(), -1);
    if (outside_[c]) continue;
    auto& boundary = boundaries[same_.find(c)];
    for (std::uint32_t f = 0; f < cells[c].size(); ++f) {
      const auto other = neighbours_[c][f];
      Role role = Role::joint;
      std::int64_t joint = 0;
      if (!other) {
        role = Role::fixed;
      } else if (outside_[other->cell]) {
        role = *outside_[other->cell];
      } else if (same_.find(other->cell) == same_.find(c)) {
        continue;
      } else {
        joint = first_joint(cells[c][f]);
      }
      number[c][f] = static_cast<std::int32_t>(boundary.size());
      boundary.push_back({c, f, static_cast<std::int64_t>(role) + 3 * joint});
    }
  }
  std::vector<OracleBlock> out;
  for (const auto& entry : boundaries) out.push_back(measure(arrangement_, neighbours_, entry.second, number));
  std::ranges::sort(out);
  return out;
}

}  // namespace

std::vector<OracleBlock> oracle_blocks(const IntegerScene& scene, const OracleOptions& options) {
  return Cutter{scene, options}.run();
}

std::string describe(const OracleBlock& b) {
  std::ostringstream out;
  out << b.volume << " (" << b.vertices << ' ' << b.edges << ' ' << b.faces << ' ' << b.loops << ' ' << b.shells << ' '
      << b.genus << ')';
  return out.str();
}

std::string describe(const std::vector<OracleBlock>& blocks) {
  std::string out;
  for (const OracleBlock& b : blocks) out += describe(b) + '\n';
  return out;
}

}  // namespace cleave::oracle
