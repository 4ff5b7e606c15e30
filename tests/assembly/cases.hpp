#pragma once

/// Pairs of blocks with closed or independent answers.

#include "builder.hpp"

namespace cleave::assembly::test {

/// A slab of 312 m3 on a plane of 35 degrees behind a toe of 18.86 m3 on a level base; between walls that do not touch
/// each other or that do.
inline Builder toe(bool sides, double phi = 30, double k = 0) {
  const double m35 = tan_deg(35), za = 40 - 30 * m35, zb = 40 - 31 * m35;
  const double slab = 312, small = 6 * ((za - 15.5) + (zb - 15.5)) / 2, m = tan_deg(phi);
  Builder b{Freedom::translation};
  b.block({k * slab, 0, -slab}, slab);
  b.block({k * small, 0, -small}, small);
  b.contact(0, rock, {sin_deg(35), 0, cos_deg(35)}, m);
  b.contact(1, rock, {0, 0, 1}, m);
  b.contact(0, 1, {-1, 0, 0}, m);
  b.contact(0, rock, {1, 0, 0}, m);
  b.contact(1, rock, {1, 0, 0}, m);
  for (std::uint32_t body = 0; body < 2 && sides; ++body) {
    b.contact(body, rock, {0, 1, 0}, m);
    b.contact(body, rock, {0, -1, 0}, m);
  }
  return b;
}

/// Its section: moments count.
inline Builder toe_section(double phi = 30) {
  const double m = tan_deg(phi), m35 = tan_deg(35);
  const auto z = [&](double x) { return 38 - x * m35; };
  Builder b{Freedom::section};
  const std::uint32_t slab = b.polygon({{4, z(4)}, {30, z(30)}, {30, z(30) + 2}, {4, z(4) + 2}}, 6);
  const std::uint32_t small = b.polygon({{30, 15.5}, {31, 15.5}, {31, 40 - 31 * m35}, {30, 40 - 30 * m35}}, 6);
  b.edge(slab, rock, {4, z(4)}, {30, z(30)}, m);
  b.edge(small, rock, {30, 15.5}, {31, 15.5}, m);
  b.edge(slab, small, {30, z(30)}, {30, z(30) + 2}, m);
  b.edge(small, rock, {30, z(30)}, {30, 15.5}, m);
  b.edge(slab, rock, {4, z(4) + 2}, {4, z(4)}, m);
  return b;
}

inline Builder active_passive() {
  Builder b{Freedom::translation};
  b.block({0, 0, -1000}, 1000);
  b.block({0, 0, -800}, 800);
  b.contact(0, rock, {sin_deg(50), 0, cos_deg(50)}, tan_deg(30));
  b.contact(1, rock, {sin_deg(15), 0, cos_deg(15)}, tan_deg(30));
  b.contact(0, 1, {-1, 0, 0}, tan_deg(25));
  return b;
}

inline Builder interlocked() {
  Builder b{Freedom::translation};
  b.block({0, 0, -1}, 1);
  b.block({0, 0, -1}, 1);
  const double wall = tan_deg(5), tongue = tan_deg(30);
  b.contact(0, rock, {cos_deg(10), 0, -sin_deg(10)}, wall);
  b.contact(1, rock, {-cos_deg(10), 0, -sin_deg(10)}, wall);
  b.contact(0, 1, {-1, 0, 0}, tongue);
  b.contact(0, 1, {0, 0, 1}, tongue);
  b.contact(0, 1, {0, 0, -1}, tongue);
  return b;
}

inline Builder drawer(bool held) {
  Builder b{Freedom::translation};
  b.block({0, 0, -1}, 1);
  b.block({0, 0, -1}, 1);
  const Vec3 n{sin_deg(20), 0, cos_deg(20)};
  b.contact(0, rock, n, tan_deg(15));
  b.contact(1, 0, n, tan_deg(15));
  if (held) b.contact(1, rock, {-cos_deg(20), 0, sin_deg(20)}, 0);
  return b;
}

inline Builder leaning(double weight) {
  Builder b{Freedom::translation};
  b.block({0, 0, -weight}, weight);
  b.block({0, 0, -1}, 1);
  b.contact(0, rock, {sin_deg(40), 0, cos_deg(40)}, tan_deg(20));
  b.contact(1, rock, {-sin_deg(40), 0, cos_deg(40)}, tan_deg(20));
  b.contact(0, 1, {-1, 0, 0}, 0);
  return b;
}

/// Ploughing slabs: an upper block on its base pushes a lower one out.
struct Plough {
  double dip, base, joint;
  P2 corner, front, back;
};
inline Builder ploughing(const Plough& p, Freedom freedom = Freedom::section) {
  const double c = cos_deg(p.dip), s = sin_deg(p.dip), height = 25;
  const auto onto = [&](P2 q, double depth) {
    const double off = s * q.x + c * q.z + depth;
    return P2{q.x - off * s, q.z - off * c};
  };
  const P2 b0 = onto(p.corner, 1.5), b1 = p.back, f1 = onto(p.front, 0);
  const P2 top_back{b0.x - (height - b0.z) / s * c, height}, top_front{-height * c / s, height};
  Builder b{freedom};
  const std::uint32_t upper = b.polygon({f1, top_front, top_back, b1}, 25);
  const std::uint32_t lower = b.polygon({{0, 0}, f1, b1, b0}, 25);
  const double mb = tan_deg(p.base), mr = tan_deg(p.joint);
  b.edge(upper, rock, top_back, b1, mb);
  b.edge(lower, rock, b1, b0, mb);
  b.edge(lower, rock, b0, {0, 0}, mr);
  b.edge(upper, lower, b1, f1, mr);
  return b;
}
inline const Plough e1{50, 30, 20, {-1.14907, -0.964181}, {-2.43625294577519, 2.90341192441329}, {-2.62114, 0.790165}};
inline const Plough e2{60, 30, 40, {-1.29904, -0.75}, {-2.57111, 4.45329}, {-2.79904, 1.84808}};
inline const Plough e3{55, 25, 20, {-1.22852, -0.860663}, {-2.22963, 3.18425}, {-2.42975, 0.854877}};
inline const Plough e4{60, 20, 30, {-1.29928, -0.749584}, {-2.86498, 4.96228}, {-3.09385, 2.35871}};

}  // namespace cleave::assembly::test
