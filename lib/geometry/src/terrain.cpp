#include "cleave/geometry/terrain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "cleave/core/overloaded.hpp"
#include "cleave/geometry/predicates.hpp"

namespace cleave::geometry {
namespace {

enum Tag : std::uint32_t { west, east, south, north, bottom, top };

using Edge = std::pair<std::uint32_t, std::uint32_t>;

double plan_area(const Ground& ground, const std::array<std::uint32_t, 3>& t) {
  const Vec3 a = ground.vertices[t[0]], b = ground.vertices[t[1]] - a, c = ground.vertices[t[2]] - a;
  return b.x * c.y - b.y * c.x;
}

/// Gives all triangles of a connected piece one sense, the one whose areas look up on the whole. False when that cannot
/// be.
bool turn_upwards(Ground& ground) {
  struct Use {
    std::uint32_t triangle;
    bool forward;
  };
  std::map<Edge, std::vector<Use>> uses;
  for (std::uint32_t t = 0; t < ground.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = ground.triangles[t][k], b = ground.triangles[t][(k + 1) % 3];
      uses[{std::min(a, b), std::max(a, b)}].push_back({t, a < b});
    }
  }
  std::vector<std::vector<std::pair<std::uint32_t, bool>>> neighbours(ground.triangles.size());  // second: same sense
  for (const auto& [edge, list] : uses) {
    if (list.size() > 2) return false;
    if (list.size() < 2) continue;
    const bool same = list[0].forward != list[1].forward;
    neighbours[list[0].triangle].emplace_back(list[1].triangle, same);
    neighbours[list[1].triangle].emplace_back(list[0].triangle, same);
  }
  std::vector<int> sense(ground.triangles.size(), 0);
  for (std::uint32_t first = 0; first < sense.size(); ++first) {
    if (sense[first] != 0) continue;
    std::vector<std::uint32_t> piece{first};
    sense[first] = 1;
    double area = 0;
    for (std::size_t at = 0; at < piece.size(); ++at) {
      area += sense[piece[at]] * plan_area(ground, ground.triangles[piece[at]]);
      for (const auto& [next, same] : neighbours[piece[at]]) {
        const int wanted = same ? sense[piece[at]] : -sense[piece[at]];
        if (sense[next] == 0) {
          sense[next] = wanted;
          piece.push_back(next);
        } else if (sense[next] != wanted) {
          return false;
        }
      }
    }
    for (const std::uint32_t t : piece) {
      if ((sense[t] > 0) != (area >= 0)) std::swap(ground.triangles[t][1], ground.triangles[t][2]);
    }
  }
  return true;
}

/// Loops of the surface's border, the surface on the left; empty when a vertex has two ways on.
std::optional<std::vector<std::vector<std::uint32_t>>> border_of(const Ground& ground) {
  std::map<Edge, int> count;
  for (const auto& t : ground.triangles) {
    for (std::size_t k = 0; k < 3; ++k) ++count[{t[k], t[(k + 1) % 3]}];
  }
  std::map<std::uint32_t, std::uint32_t> after;
  for (const auto& [edge, uses] : count) {
    if (count.contains({edge.second, edge.first})) continue;
    if (!after.try_emplace(edge.first, edge.second).second) return std::nullopt;
  }
  std::vector<std::vector<std::uint32_t>> loops;
  while (!after.empty()) {
    std::vector<std::uint32_t> loop;
    for (auto at = after.begin(); at != after.end(); at = after.find(loop.back())) {
      loop.push_back(at->second);
      after.erase(at);
    }
    std::ranges::rotate(loop, std::ranges::min_element(loop));
    loops.push_back(std::move(loop));
  }
  return loops;
}

Tag side_of(Vec3 along) {  // the body lies on the left
  if (std::abs(along.x) > std::abs(along.y)) return along.x < 0 ? north : south;
  return along.y > 0 ? east : west;
}

}  // namespace

Ground ground_of(const Heights& heights) {
  Ground ground;
  std::vector<std::uint32_t> number(heights.values.size(), UINT32_MAX);
  const auto at = [&](std::uint32_t column, std::uint32_t row) { return std::size_t{row} * heights.columns + column; };
  const auto vertex = [&](std::uint32_t column, std::uint32_t row) {
    std::uint32_t& n = number[at(column, row)];
    if (n == UINT32_MAX) {
      n = static_cast<std::uint32_t>(ground.vertices.size());
      ground.vertices.push_back({heights.x + column * heights.step_x,
                                 heights.y + (heights.rows - 1 - row) * heights.step_y,
                                 heights.values[at(column, row)]});
    }
    return n;
  };
  for (std::uint32_t row = 0; row + 1 < heights.rows; ++row) {
    for (std::uint32_t column = 0; column + 1 < heights.columns; ++column) {
      bool whole = true;
      for (const std::uint32_t r : {row, row + 1}) {
        for (const std::uint32_t c : {column, column + 1}) whole = whole && !std::isnan(heights.values[at(c, r)]);
      }
      if (!whole) continue;
      const std::uint32_t nw = vertex(column, row), ne = vertex(column + 1, row), sw = vertex(column, row + 1),
                          se = vertex(column + 1, row + 1);
      ground.triangles.push_back({sw, se, ne});
      ground.triangles.push_back({sw, ne, nw});
    }
  }
  return ground;
}

std::expected<Solid, TerrainError> close_ground(const Ground& input, double level) {
  if (input.triangles.empty()) return std::unexpected(EmptyGround{});
  for (std::size_t t = 0; t < input.triangles.size(); ++t) {
    const auto& [a, b, c] = input.triangles[t];
    const std::size_t count = input.vertices.size();
    if (a >= count || b >= count || c >= count || a == b || b == c || c == a) return std::unexpected(BadTriangle{t});
  }
  Ground ground = input;
  double lowest = ground.vertices[ground.triangles[0][0]].z, highest = lowest;
  for (const auto& t : ground.triangles) {
    for (const std::uint32_t v : t) {
      lowest = std::min(lowest, ground.vertices[v].z);
      highest = std::max(highest, ground.vertices[v].z);
    }
  }
  const bool below = level < lowest;
  if (!below && !(level > highest)) {
    return std::unexpected(LevelWithin{metres(level), metres(lowest), metres(highest)});
  }
  if (!turn_upwards(ground)) return std::unexpected(TwistedGround{});
  const auto border = border_of(ground);
  if (!border) return std::unexpected(TwistedGround{});

  std::vector<Vec3> vertices = ground.vertices;
  std::vector<SolidFace> faces;
  for (const auto& t : ground.triangles) faces.push_back({{t[0], t[1], t[2]}, top});
  std::vector<std::uint32_t> foot(ground.vertices.size(), UINT32_MAX);
  const auto foot_of = [&](std::uint32_t v) {
    if (foot[v] == UINT32_MAX) {
      foot[v] = static_cast<std::uint32_t>(vertices.size());
      vertices.push_back({ground.vertices[v].x, ground.vertices[v].y, level});
    }
    return foot[v];
  };
  // With one border the base is one polygon, and sides that go straight on are one face; else the base repeats the
  // triangles of the ground.
  const bool one = border->size() == 1;
  const auto straight = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const auto plan = [&](std::uint32_t v) { return drop(flushed(ground.vertices[v]), 2); };
    const Vec3 in = ground.vertices[b] - ground.vertices[a], out = ground.vertices[c] - ground.vertices[b];
    return one && orient2d(plan(a), plan(b), plan(c)) == exact::Sign::zero && in.x * out.x + in.y * out.y > 0;
  };
  for (const auto& loop : *border) {
    const std::size_t count = loop.size();
    std::vector<std::size_t> turns;
    for (std::size_t i = 0; i < count; ++i) {
      if (!straight(loop[(i + count - 1) % count], loop[i], loop[(i + 1) % count])) turns.push_back(i);
    }
    SolidFace base{{}, bottom};
    for (std::size_t k = 0; k < turns.size(); ++k) {
      const std::size_t from = turns[k];
      const std::size_t steps = (turns[(k + 1) % turns.size()] + count - from - 1) % count + 1;
      const std::uint32_t a = loop[from], b = loop[(from + steps) % count];
      SolidFace side{{}, side_of(ground.vertices[b] - ground.vertices[a])};
      for (std::size_t i = steps + 1; i-- > 0;) side.corners.push_back(loop[(from + i) % count]);
      side.corners.push_back(foot_of(a));
      side.corners.push_back(foot_of(b));
      faces.push_back(std::move(side));
      base.corners.push_back(foot_of(a));
    }
    if (one) {
      std::ranges::reverse(base.corners);
      faces.push_back(std::move(base));
    }
  }
  if (!one) {
    for (const auto& t : ground.triangles) faces.push_back({{foot_of(t[0]), foot_of(t[2]), foot_of(t[1])}, bottom});
  }
  if (!below) {
    for (SolidFace& face : faces) {
      std::ranges::reverse(face.corners);
      face.tag = face.tag == top ? bottom : face.tag == bottom ? top : face.tag;
    }
  }
  auto solid = Solid::make(std::move(vertices), std::move(faces), {"west", "east", "south", "north", "bottom", "top"});
  if (!solid) return std::unexpected(std::move(solid).error());
  return std::move(*solid);
}

std::string describe(const TerrainError& error) {
  return std::visit(
      overloaded{
          [](const EmptyGround&) {
            return std::string{"the ground has no triangle; give a grid of two by two heights or more"};
          },
          [](const BadTriangle& e) {
            return fmt::format("triangle {} of the ground names a vertex twice or one that is not there; leave it out",
                               e.triangle);
          },
          [](const LevelWithin& e) {
            return fmt::format(
                "the level {} m that closes the body lies within the ground, which reaches from {} to {} m; give one "
                "below or above all of it",
                e.level.si(), e.lowest.si(), e.highest.si());
          },
          [](const TwistedGround&) {
            return std::string{
                "the triangles are no single sheet: three or more share an edge, the surface is twisted, or parts "
                "touch in a vertex only; fix the surface"};
          },
          [](const SolidError& e) { return describe(e); },
      },
      error);
}

}  // namespace cleave::geometry
