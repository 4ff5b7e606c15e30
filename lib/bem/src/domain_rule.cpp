#include "domain_rule.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "gauss.hpp"

namespace cleave::bem {
namespace {

/// A piece of boundary on which y rises or falls all the way: x(s) of an element's polynomial, or a straight side.
struct Piece {
  Element element;
  double from, to;  // y(from) < y(to)
  double low, high;
};

double across(const Piece& p, double y) {
  const Element& e = p.element;
  if (!e.curved) return p.element.at(p.from + (y - p.low) / (p.high - p.low) * (p.to - p.from)).x;
  double a = p.from;
  double b = p.to;
  for (int k = 0; k < 60; ++k) {
    const double m = 0.5 * (a + b);
    (e.at(m).y < y ? a : b) = m;
  }
  return e.at(0.5 * (a + b)).x;
}

/// Straight elements of one side as one.
std::vector<Element> merged(const Mesh& mesh) {
  std::vector<Element> out;
  for (const Element& e : mesh.elements) {
    if (!e.curved && !out.empty() && !out.back().curved && out.back().loop == e.loop && out.back().side == e.side) {
      const Vec2 start = out.back().at(-1);
      out.back().c0 = 0.5 * (start + e.at(1));
      out.back().c1 = 0.5 * (e.at(1) - start);
    } else {
      out.push_back(e);
    }
  }
  return out;
}

}  // namespace

AreaMoments area_moments(const Mesh& mesh) {
  AreaMoments out;
  const Vec2 origin = mesh.elements.front().at(-1);
  double mx = 0, my = 0, polar = 0;
  const GaussRule& rule = gauss(6);
  for (const Element& e : mesh.elements) {
    for (std::size_t g = 0; g < rule.s.size(); ++g) {
      const Vec2 x = e.at(rule.s[g]) - origin;
      const double c = rule.w[g] * cross(x, e.derivative(rule.s[g]));
      out.area += c / 2;
      mx += c * x.x / 3;
      my += c * x.y / 3;
      polar += c * dot(x, x) / 4;
    }
  }
  const Vec2 c{mx / out.area, my / out.area};
  out.centroid = origin + c;
  out.polar = polar - out.area * dot(c, c);
  return out;
}

std::vector<DomainPoint> domain_rule(const Mesh& mesh, std::size_t n, double spacing) {
  std::vector<Piece> pieces;
  std::vector<double> levels;
  for (const Element& e : merged(mesh)) {
    std::vector<double> cuts{-1, 1};
    if (e.curved && e.c2.y != 0) {
      if (const double s = -e.c1.y / (2 * e.c2.y); s > -1 + 1e-9 && s < 1 - 1e-9) cuts = {-1, s, 1};
    }
    for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
      const double ya = e.at(cuts[k]).y;
      const double yb = e.at(cuts[k + 1]).y;
      levels.push_back(ya);
      levels.push_back(yb);
      if (ya < yb) pieces.push_back({e, cuts[k], cuts[k + 1], ya, yb});
      if (yb < ya) pieces.push_back({e, cuts[k + 1], cuts[k], yb, ya});
    }
  }
  std::ranges::sort(levels);
  const double span = levels.back() - levels.front();
  std::vector<DomainPoint> out;
  const GaussRule& rule = gauss(n);
  // Point k of parts that are even in the angle of the cosine map.
  const auto angle = [&](std::size_t k, std::size_t parts) {
    const auto part = static_cast<double>(k / n);
    return std::numbers::pi * (part + 0.5 * (1 + rule.s[k % n])) / static_cast<double>(parts);
  };
  const auto share = [&](std::size_t k, std::size_t parts) { return 0.5 * (1 - std::cos(angle(k, parts))); };
  const auto weight = [&](std::size_t k, std::size_t parts) {
    return 0.25 * rule.w[k % n] * std::numbers::pi / static_cast<double>(parts) * std::sin(angle(k, parts));
  };
  const auto parts_of = [&](double length) {
    if (!(spacing > 0)) return std::size_t{1};
    const double wanted = 0.5 * std::numbers::pi * length / (static_cast<double>(n) * spacing);
    return static_cast<std::size_t>(std::clamp(std::ceil(wanted), 1.0, 50.0));
  };
  double low = levels.front();
  for (std::size_t k = 1; k < levels.size(); ++k) {
    const double high = levels[k];
    if (high - low <= 1e-11 * span) continue;
    std::vector<const Piece*> crossed;
    const double middle = 0.5 * (low + high);
    for (const Piece& p : pieces) {
      if (p.low < middle && p.high > middle) crossed.push_back(&p);
    }
    std::ranges::sort(crossed, {}, [&](const Piece* p) { return across(*p, middle); });
    // A cosine map both ways: arcs leave their highest point like a square root, and the fields have logarithms at
    // corners.
    const std::size_t up = parts_of(high - low);
    for (std::size_t i = 0; i < up * n; ++i) {
      const double y = low + (high - low) * share(i, up);
      for (std::size_t s = 0; s + 1 < crossed.size(); s += 2) {
        const double left = across(*crossed[s], y);
        const double width = across(*crossed[s + 1], y) - left;
        const std::size_t over = parts_of(width);
        for (std::size_t j = 0; j < over * n; ++j) {
          out.push_back({{left + share(j, over) * width, y}, (high - low) * weight(i, up) * weight(j, over) * width});
        }
      }
    }
    low = high;
  }
  return out;
}

}  // namespace cleave::bem
