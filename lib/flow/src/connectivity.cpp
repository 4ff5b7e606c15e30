#include "cleave/flow/flow.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <set>
#include <utility>

#include "biconnected.hpp"
#include "cleave/core/assert.hpp"
#include "cleave/core/disjoint_sets.hpp"
#include "discretisation.hpp"

namespace cleave::flow {
namespace {

using topology::JointId;
using topology::JointNetwork;
using topology::JointPiece;

void keep_once(auto& values) {
  std::ranges::sort(values);
  const auto repeated = std::ranges::unique(values);
  values.erase(repeated.begin(), repeated.end());
}

bool share_a_joint(const JointPiece& a, const JointPiece& b) {
  return std::ranges::find_first_of(a.joints, b.joints) != a.joints.end();
}

class Connecting {
 public:
  Connecting(const topology::BlockComplex& complex, const JointSurfaces& surfaces)
      : network_{*complex.network()}, surfaces_{surfaces}, mesh_{mesh_as_cut(complex, surfaces)}, sides_{mesh_} {}

  Connectivity run() {
    find_parts();
    find_links();
    find_clusters();
    find_backbone();
    return std::move(out_);
  }

 private:
  /// The pieces at a side, each once.
  [[nodiscard]] std::vector<Index> pieces_at(Index side) const {
    std::vector<Index> pieces;
    for (const Index t : sides_.triangles(side)) pieces.push_back(mesh_.part[t]);
    keep_once(pieces);
    return pieces;
  }

  void find_parts() {
    DisjointSets<Index> together{network_.pieces.size()};
    for (Index s = 0; s < sides_.count(); ++s) {
      const auto pieces = pieces_at(s);
      for (std::size_t i = 0; i < pieces.size(); ++i) {
        for (std::size_t j = i + 1; j < pieces.size(); ++j) {
          if (share_a_joint(network_.pieces[pieces[i]], network_.pieces[pieces[j]]))
            together.join(pieces[i], pieces[j]);
        }
      }
    }
    out_.part_of.assign(network_.pieces.size(), 0);
    for (Index p = 0; p < network_.pieces.size(); ++p) {
      const JointPiece& piece = network_.pieces[p];
      const Index root = together.find(p);
      if (root == p) {
        out_.part_of[p] = static_cast<Index>(out_.parts.size());
        out_.parts.push_back({piece.joints.front(), {}, 0, false});
      } else {
        out_.part_of[p] = out_.part_of[root];
      }
      out_.parts[out_.part_of[p]].area += piece.area;
      out_.area += piece.area;
    }
  }

  /// Which parts share a line, and how long the lines are.
  void find_links() {
    std::set<std::pair<JointId, JointId>> meetings;
    for (Index s = 0; s < sides_.count(); ++s) {
      const auto pieces = pieces_at(s);
      if (pieces.size() < 2) continue;
      bool several = false;
      for (std::size_t i = 0; i < pieces.size(); ++i) {
        for (std::size_t j = i + 1; j < pieces.size(); ++j) {
          const JointPiece &a = network_.pieces[pieces[i]], &b = network_.pieces[pieces[j]];
          const Index one = out_.part_of[pieces[i]], other = out_.part_of[pieces[j]];
          if (one != other) links_.emplace_back(std::min(one, other), std::max(one, other));
          if (share_a_joint(a, b)) continue;
          several = true;
          meetings.insert(std::minmax(a.joints.front(), b.joints.front()));
        }
      }
      const auto [from, to] = sides_.ends(s);
      if (several) out_.meeting_length += metres(geometry::norm(mesh_.points[to] - mesh_.points[from]));
    }
    out_.meetings = meetings.size();
    keep_once(links_);
    for (const Border& border : mesh_.borders) {
      const auto side = sides_.find(border.ends[0], border.ends[1]);
      for (const Index piece : pieces_at(*side)) reached_.emplace_back(out_.part_of[piece], border.surface);
    }
    keep_once(reached_);
  }

  void find_clusters() {
    DisjointSets<Index> together{out_.parts.size()};
    for (const auto& [one, other] : links_) together.join(one, other);
    std::vector<Cluster> found;
    std::vector<Index> number(out_.parts.size(), 0);
    for (Index p = 0; p < out_.parts.size(); ++p) {
      const Index root = together.find(p);
      if (root == p) {
        number[p] = static_cast<Index>(found.size());
        found.emplace_back();
      } else {
        number[p] = number[root];
      }
      Cluster& cluster = found[number[p]];
      cluster.joints.push_back(out_.parts[p].joint);
      cluster.area += out_.parts[p].area;
    }
    // Of a joint that lies on others, too.
    for (Index p = 0; p < network_.pieces.size(); ++p) {
      auto& joints = found[number[out_.part_of[p]]].joints;
      if (network_.pieces[p].joints.size() > 1) {
        joints.insert(joints.end(), network_.pieces[p].joints.begin(), network_.pieces[p].joints.end());
      }
    }
    for (const auto& [part, surface] : reached_) found[number[part]].surfaces.push_back(surface);
    for (Cluster& cluster : found) {
      keep_once(cluster.joints);
      keep_once(cluster.surfaces);
    }
    std::vector<Index> order(found.size());
    std::iota(order.begin(), order.end(), Index{0});
    std::ranges::stable_sort(order, [&](Index a, Index b) { return found[a].area > found[b].area; });
    std::vector<Index> place(found.size());
    for (Index k = 0; k < order.size(); ++k) {
      place[order[k]] = k;
      out_.clusters.push_back(std::move(found[order[k]]));
    }
    for (Index p = 0; p < out_.parts.size(); ++p) out_.parts[p].cluster = place[number[p]];
    std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (const Cluster& cluster : out_.clusters) {
      for (const std::uint32_t a : cluster.surfaces) {
        for (const std::uint32_t b : cluster.surfaces) {
          if (a < b && !surfaces_.surfaces[b].excavation) pairs.emplace(a, b);
        }
      }
    }
    out_.percolates.assign(pairs.begin(), pairs.end());
  }

  /// With one node for the fixed sides and one for the openings, tied to each other: a path between the two is a ring.
  void find_backbone() {
    const auto fixed = static_cast<Index>(out_.parts.size()), openings = fixed + 1;
    std::vector<std::pair<Index, Index>> links = links_;
    for (const auto& [part, surface] : reached_) {
      switch (surfaces_.surfaces[surface].role) {
        case topology::Role::fixed: links.emplace_back(part, fixed); break;
        case topology::Role::free: links.emplace_back(part, openings); break;
        case topology::Role::window:
        case topology::Role::joint: break;
      }
    }
    links.emplace_back(fixed, openings);
    for (const Index node : together_with_link(openings + std::size_t{1}, links, links.size() - 1)) {
      if (node < fixed) out_.parts[node].backbone = true;
    }
  }

  const JointNetwork& network_;
  const JointSurfaces& surfaces_;
  Mesh mesh_;
  Sides sides_;
  Connectivity out_;
  std::vector<std::pair<Index, Index>> links_;    ///< of parts, ascending
  std::vector<std::pair<Index, Index>> reached_;  ///< part, surface
};

}  // namespace

Connectivity connectivity(const topology::BlockComplex& complex, const JointSurfaces& surfaces) {
  CLEAVE_ASSERT(complex.network().has_value());
  return Connecting{complex, surfaces}.run();
}

}  // namespace cleave::flow
