#include "boundary.hpp"

#include <set>
#include <stdexcept>

namespace cleave::oracle {

namespace {

struct Corner {
  std::size_t half, at;  ///< half-face and position in its loop; as an edge: from `at` to the next
};

class Walk final {
 public:
  Walk(const Arrangement& arrangement, const Neighbours& neighbours, const std::vector<HalfFace>& boundary,
       const std::vector<std::vector<std::int32_t>>& number)
      : arrangement_{arrangement}, neighbours_{neighbours}, boundary_{boundary}, number_{number} {
    for (std::size_t h = 0; h < boundary.size(); ++h) {
      offset_.push_back(partner_.size());
      for (std::size_t i = 0; i < loop(h).size(); ++i) partner_.push_back(across(h, i));
    }
    offset_.push_back(partner_.size());
  }

  [[nodiscard]] OracleBlock counted() const;

 private:
  [[nodiscard]] const CellFace& face(std::size_t h) const {
    return arrangement_.cells()[boundary_[h].cell][boundary_[h].face];
  }
  [[nodiscard]] const Loop& loop(std::size_t h) const { return face(h).loop; }
  [[nodiscard]] std::size_t id(Corner c) const { return offset_[c.half] + c.at; }
  [[nodiscard]] Corner partner(Corner c) const { return partner_[id(c)]; }
  [[nodiscard]] Corner next(Corner c) const { return {c.half, (c.at + 1) % loop(c.half).size()}; }
  [[nodiscard]] std::uint32_t vertex(Corner c) const { return loop(c.half)[c.at]; }

  // The half-face that shares edge i of h, turning through the inside of the block.
  [[nodiscard]] Corner across(std::size_t h, std::size_t i) const {
    std::uint32_t cell = boundary_[h].cell, f = boundary_[h].face;
    const std::uint32_t u = loop(h)[i], v = loop(h)[(i + 1) % loop(h).size()];
    for (;;) {
      const auto [g, at] = face_with_edge(cell, f, v, u);
      if (number_[cell][g] >= 0) return {static_cast<std::size_t>(number_[cell][g]), at};
      const Neighbour other = neighbours_[cell][g].value();
      cell = other.cell;
      f = other.face;
    }
  }
  [[nodiscard]] std::pair<std::uint32_t, std::size_t> face_with_edge(std::uint32_t cell, std::uint32_t except,
                                                                     std::uint32_t from, std::uint32_t to) const {
    const Cell& faces = arrangement_.cells()[cell];
    for (std::uint32_t g = 0; g < faces.size(); ++g) {
      if (g == except) continue;
      const Loop& l = faces[g].loop;
      for (std::size_t i = 0; i < l.size(); ++i) {
        if (l[i] == from && l[(i + 1) % l.size()] == to) return {g, i};
      }
    }
    throw std::logic_error("oracle: open cell");
  }

  // Same plane, same side, same label, next to each other.
  [[nodiscard]] bool merges(std::size_t a, std::size_t b) const {
    return face(a).plane == face(b).plane && face(a).side == face(b).side && boundary_[a].label == boundary_[b].label;
  }
  [[nodiscard]] bool sharp(Corner edge) const { return !merges(edge.half, partner(edge).half); }
  [[nodiscard]] bool collinear(std::uint32_t a, std::uint32_t b, std::uint32_t c) const;
  [[nodiscard]] Rational volume() const;

  const Arrangement& arrangement_;
  const Neighbours& neighbours_;
  const std::vector<HalfFace>& boundary_;
  const std::vector<std::vector<std::int32_t>>& number_;
  std::vector<std::size_t> offset_;
  std::vector<Corner> partner_;
};

Rational coordinate(const HomogeneousPoint& p, std::size_t i) {
  return Rational{boost::multiprecision::cpp_int{p[i]}, boost::multiprecision::cpp_int{p[3]}};
}

bool Walk::collinear(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
  const HomogeneousPoint &p = arrangement_.vertex(a), &q = arrangement_.vertex(b), &r = arrangement_.vertex(c);
  const auto d = [](const HomogeneousPoint& s, const HomogeneousPoint& t, std::size_t i) -> Int {
    return t[i] * s[3] - s[i] * t[3];
  };
  return d(p, q, 1) * d(p, r, 2) == d(p, q, 2) * d(p, r, 1) && d(p, q, 2) * d(p, r, 0) == d(p, q, 0) * d(p, r, 2) &&
         d(p, q, 0) * d(p, r, 1) == d(p, q, 1) * d(p, r, 0);
}

Rational Walk::volume() const {
  Rational six = 0;
  for (std::size_t h = 0; h < boundary_.size(); ++h) {
    const Loop& l = loop(h);
    const auto at = [&](std::size_t i) {
      const HomogeneousPoint& p = arrangement_.vertex(l[i]);
      return std::array{coordinate(p, 0), coordinate(p, 1), coordinate(p, 2)};
    };
    const auto a = at(0);
    for (std::size_t i = 2; i < l.size(); ++i) {
      const auto b = at(i - 1), c = at(i);
      six +=
          a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
    }
  }
  return six / 6;
}

OracleBlock Walk::counted() const {
  const std::size_t halves = boundary_.size(), corners = partner_.size();
  UnionFind faces{halves}, shells{halves}, fans{corners};
  std::vector<Corner> all;
  for (std::size_t h = 0; h < halves; ++h) {
    for (std::size_t i = 0; i < loop(h).size(); ++i) all.push_back({h, i});
  }
  for (const Corner c : all) {
    const Corner p = partner(c);
    if (id(partner(p)) != id(c)) throw std::logic_error("oracle: shell not closed");
    shells.join(c.half, p.half);
    if (!sharp(c)) faces.join(c.half, p.half);
    fans.join(id(c), id(next(p)));  // around the edge's start
  }
  const auto roots = [](UnionFind& sets, std::size_t count) {
    std::set<std::size_t> out;
    for (std::size_t i = 0; i < count; ++i) out.insert(sets.find(i));
    return out.size();
  };

  // Ends of sharp edges at each fan. An edge is walked from both sides; its start on one side is its end on the other.
  std::vector<std::vector<std::uint32_t>> ends(corners);
  std::size_t half_edges = 0;
  for (const Corner c : all) {
    if (!sharp(c)) continue;
    ++half_edges;
    if (faces.find(c.half) == faces.find(partner(c).half)) throw std::logic_error("oracle: edge inside a face");
    ends[fans.find(id(c))].push_back(vertex(next(c)));
  }
  std::size_t vertices = 0, edges = half_edges / 2;
  for (const Corner c : all) {
    auto& e = ends[fans.find(id(c))];
    if (e.empty()) continue;
    if (e.size() == 2 && collinear(e[0], vertex(c), e[1])) {
      --edges;
    } else {
      ++vertices;
    }
    e.clear();
  }

  // Loops: from a sharp edge's end turn inside the face to the next sharp edge.
  std::vector<bool> seen(corners, false);
  std::size_t loops = 0;
  for (const Corner start : all) {
    if (!sharp(start) || seen[id(start)]) continue;
    ++loops;
    for (Corner c = start; !seen[id(c)];) {
      seen[id(c)] = true;
      c = next(c);
      while (!sharp(c)) c = next(partner(c));
    }
  }

  OracleBlock block;
  block.volume = volume();
  const std::size_t shell_count = roots(shells, halves), face_count = roots(faces, halves);
  // Genus from the cells' own surface, not from the merged counts.
  const auto chi = static_cast<std::int64_t>(roots(fans, corners)) - static_cast<std::int64_t>(corners / 2) +
                   static_cast<std::int64_t>(halves);
  const std::int64_t twice = 2 * static_cast<std::int64_t>(shell_count) - chi;
  if (twice < 0 || twice % 2 != 0) throw std::logic_error("oracle: genus is not a number >= 0");
  block.vertices = static_cast<std::uint32_t>(vertices);
  block.edges = static_cast<std::uint32_t>(edges);
  block.faces = static_cast<std::uint32_t>(face_count);
  block.loops = static_cast<std::uint32_t>(loops);
  block.shells = static_cast<std::uint32_t>(shell_count);
  block.genus = static_cast<std::uint32_t>(twice / 2);
  const auto number = [](std::size_t n) { return static_cast<std::int64_t>(n); };
  if (number(vertices) - number(edges) + 2 * number(face_count) - number(loops) - 2 * number(shell_count) + twice !=
      0) {
    throw std::logic_error("oracle: Euler-Poincare does not hold: " + describe(block));
  }
  return block;
}

}  // namespace

OracleBlock measure(const Arrangement& arrangement, const Neighbours& neighbours, const std::vector<HalfFace>& boundary,
                    const std::vector<std::vector<std::int32_t>>& number) {
  return Walk{arrangement, neighbours, boundary, number}.counted();
}

}  // namespace cleave::oracle
