#include "element_rows.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "gauss.hpp"

namespace cleave::bem {
namespace {

using Complex = std::complex<double>;

struct Poles {
  std::array<Complex, 2> z;
  std::size_t count;
};

/// Where x1(s) + i x2(s) meets the source: the singular points of every kernel (conjugates implied).
Poles poles_of(const Element& e, Vec2 source) {
  const Complex c0{e.c0.x - source.x, e.c0.y - source.y};
  const Complex c1{e.c1.x, e.c1.y};
  const Complex c2{e.c2.x, e.c2.y};
  if (std::norm(c2) < 1e-26 * std::norm(c1)) return {{-c0 / c1, {}}, 1};
  Complex q = std::sqrt(c1 * c1 - 4.0 * c2 * c0);
  q = -(c1 + ((std::conj(c1) * q).real() >= 0 ? q : -q)) / 2.0;
  return {{q / c2, q == Complex{} ? Complex{} : c0 / q}, 2};
}

double bernstein(Complex z) {
  const Complex q = std::sqrt(z * z - 1.0);
  return std::max(std::abs(z + q), std::abs(z - q));
}

double ellipse_on(const Poles& poles, double middle, double half) {
  double rho = 1e9;
  for (std::size_t k = 0; k < poles.count; ++k) rho = std::min(rho, bernstein((poles.z[k] - middle) / half));
  return rho;
}

/// Points more than the ellipse's radius alone asks for. The factor in front of the error is what the integrand grows
/// to on the ellipse: quadratic shape functions to rho^2 / 4 (which is one point), and close by the pole itself.
constexpr double near_margin = 3, far_margin = 1.1, far_from = 5;

constexpr int deepest = 48;

void split(const Poles& poles, double a, double b, int depth, double log_tolerance, double extra,
           std::vector<LocalPoint>& out) {
  const double middle = 0.5 * (a + b);
  const double half = 0.5 * (b - a);
  const double rho = ellipse_on(poles, middle, half);
  const double need = rho > 1.0001 ? std::ceil(log_tolerance / (2 * std::log(rho))) + 3 + extra : 999;
  if (need <= 20 || depth > deepest) {
    const GaussRule& rule = gauss(static_cast<std::size_t>(std::clamp(need, 4.0, 24.0)));
    for (std::size_t k = 0; k < rule.s.size(); ++k) out.push_back({middle + half * rule.s[k], half * rule.w[k]});
    return;
  }
  split(poles, a, middle, depth + 1, log_tolerance, extra, out);
  split(poles, middle, b, depth + 1, log_tolerance, extra, out);
}

Vec2 offset(const Element& e, double s0, double off) { return off * (e.c1 + (2 * s0 + off) * e.c2); }

}  // namespace

Integrator::Integrator(const Mesh& mesh, Medium medium, double tolerance)
    : mesh_{&mesh}, medium_{medium}, log_tolerance_{std::log(1 / tolerance)} {
  for (std::size_t k = 0; k < orders.size(); ++k) {
    const auto reach = [&](double margin) {
      const double n = static_cast<double>(orders[k]) - margin;
      if (n <= 0) return 1e300;
      const double rho = std::exp(log_tolerance_ / (2 * n));
      if (margin < near_margin && rho < far_from) return 1e300;
      const double z = 0.5 * (rho + 1 / rho);
      return z * z;
    };
    reach_straight_[k] = std::min(reach(near_margin), reach(far_margin));
    reach_curved_[k] = reach(near_margin + 4);
  }
  table_.reserve(mesh.elements.size() * table_size);
  // Order by order: far away all elements take the same one, and what is read then lies together.
  for (const std::size_t n : orders) {
    const GaussRule& rule = gauss(n);
    for (const Element& e : mesh.elements) {
      for (std::size_t k = 0; k < n; ++k) {
        const Vec2 t = e.derivative(rule.s[k]);
        table_.push_back({e.at(rule.s[k]), rule.w[k] * turned_right(t), rule.w[k] * norm(t)});
      }
    }
  }
  for (const std::size_t n : orders) {
    for (const double s : gauss(n).s) shapes_.push_back(shape(mesh.order, s));
  }
}

std::size_t Integrator::order_by_distance(const Element& e, double distance2) const {
  // A lower bound of |z| for the poles: |c2||z|^2 + |c1||z| >= |c0 - y|. For a given |z| the ellipse is smallest when z
  // is real.
  const double c1 = dot(e.c1, e.c1);
  double z2 = distance2 / c1;
  if (e.curved) {
    const double l1 = std::sqrt(c1), l2 = norm(e.c2);
    const double distance = std::sqrt(distance2);
    const double z = 2 * distance / (l1 + std::sqrt(c1 + 4 * l2 * distance));
    z2 = z * z;
  }
  const auto& reach = e.curved ? reach_curved_ : reach_straight_;
  std::size_t k = 0;
  while (k < orders.size() && z2 < reach[k]) ++k;
  return k;
}

std::size_t Integrator::order_at(const Element& e, Vec2 source) const {
  if (const std::size_t k = order_by_distance(e, dot(source - e.c0, source - e.c0)); k < orders.size()) return k;
  const double rho = ellipse_on(poles_of(e, source), 0, 1);
  if (rho <= 1.0001) return orders.size();
  const double need = std::ceil(log_tolerance_ / (2 * std::log(rho))) + near_margin + (e.curved ? 4 : 0);
  for (std::size_t k = 0; k < orders.size(); ++k) {
    if (static_cast<double>(orders[k]) >= need) return k;
  }
  return orders.size();
}

void Integrator::add_far(const Element& e, std::span<const TablePoint> points,
                         std::span<const std::array<double, 3>> shapes, Vec2 source, ElementIntegrals& out) const {
  const double nu = medium_.elastic.nu;
  const double a = 1 - 2 * nu;
  const double log_factor = -0.5 * (3 - 4 * nu);
  const std::size_t per = mesh_->per_element();
  for (auto& m : out.g) m = {};
  for (auto& m : out.h) m = {};
  for (std::size_t k = 0; k < points.size(); ++k) {
    const TablePoint& p = points[k];
    const Vec2 d = p.x - source;
    const double r2 = dot(d, d);
    const double inv = 1 / r2;
    const double log_term = log_factor * std::log(r2);
    const double gxx = d.x * d.x * inv;
    const double gxy = d.x * d.y * inv;
    const double gyy = d.y * d.y * inv;
    const double uxx = p.w * (log_term + gxx);
    const double uxy = p.w * gxy;
    const double uyy = p.w * (log_term + gyy);
    const double dn = dot(d, p.n) * inv;
    const double twist = a * inv * (d.x * p.n.y - d.y * p.n.x);
    const double txx = dn * (a + 2 * gxx);
    const double both = 2 * dn * gxy;
    const double tyy = dn * (a + 2 * gyy);
    for (std::size_t i = 0; i < per; ++i) {
      const double n = shapes[k][i];
      out.g[i].xx += n * uxx;
      out.g[i].xy += n * uxy;
      out.g[i].yy += n * uyy;
      out.h[i].xx += n * txx;
      out.h[i].xy += n * (both - twist);
      out.h[i].yx += n * (both + twist);
      out.h[i].yy += n * tyy;
    }
  }
  const double cu = 1 / (8 * std::numbers::pi * medium_.elastic.mu * (1 - nu));
  const double ct = -1 / (4 * std::numbers::pi * (1 - nu));
  for (std::size_t i = 0; i < per; ++i) {
    out.g[i].yx = out.g[i].xy;
    out.g[i] = cu * out.g[i];
    out.h[i] = ct * out.h[i];
  }
  static_cast<void>(e);
}

void Integrator::add_far(std::span<const TablePoint> points, std::span<const std::array<double, 3>> shapes,
                         const std::array<Vec2, lanes>& sources, std::array<ElementIntegrals, lanes>& out) const {
  using Lane = Eigen::Array<double, static_cast<int>(lanes), 1>;
  const double nu = medium_.elastic.nu;
  const double a = 1 - 2 * nu;
  const double log_factor = -0.5 * (3 - 4 * nu);
  const std::size_t per = mesh_->per_element();
  Lane sx, sy;
  for (std::size_t l = 0; l < lanes; ++l) {
    sx(static_cast<Eigen::Index>(l)) = sources[l].x;
    sy(static_cast<Eigen::Index>(l)) = sources[l].y;
  }
  std::array<std::array<Lane, 7>, 3> sum;
  for (auto& node : sum) {
    for (Lane& v : node) v.setZero();
  }
  for (std::size_t k = 0; k < points.size(); ++k) {
    const TablePoint& p = points[k];
    const Lane dx = p.x.x - sx, dy = p.x.y - sy;
    const Lane r2 = dx * dx + dy * dy;
    const Lane inv = r2.inverse();
    const Lane log_term = log_factor * r2.log();
    const Lane gxx = dx * dx * inv, gxy = dx * dy * inv, gyy = dy * dy * inv;
    const Lane uxx = p.w * (log_term + gxx), uxy = p.w * gxy, uyy = p.w * (log_term + gyy);
    const Lane dn = (dx * p.n.x + dy * p.n.y) * inv;
    const Lane twist = a * inv * (dx * p.n.y - dy * p.n.x);
    const Lane txx = dn * (a + 2 * gxx), both = 2 * dn * gxy, tyy = dn * (a + 2 * gyy);
    const Lane txy = both - twist, tyx = both + twist;
    for (std::size_t i = 0; i < per; ++i) {
      const double n = shapes[k][i];
      sum[i][0] += n * uxx;
      sum[i][1] += n * uxy;
      sum[i][2] += n * uyy;
      sum[i][3] += n * txx;
      sum[i][4] += n * txy;
      sum[i][5] += n * tyx;
      sum[i][6] += n * tyy;
    }
  }
  const double cu = 1 / (8 * std::numbers::pi * medium_.elastic.mu * (1 - nu));
  const double ct = -1 / (4 * std::numbers::pi * (1 - nu));
  for (std::size_t l = 0; l < lanes; ++l) {
    const auto at = static_cast<Eigen::Index>(l);
    for (std::size_t i = 0; i < per; ++i) {
      const auto& v = sum[i];
      out[l].g[i] = {cu * v[0](at), cu * v[1](at), cu * v[1](at), cu * v[2](at)};
      out[l].h[i] = {ct * v[3](at), ct * v[4](at), ct * v[5](at), ct * v[6](at)};
    }
  }
}

void Integrator::add_near(const Element& e, Vec2 source, ElementIntegrals& out) const {
  thread_local std::vector<LocalPoint> rule;
  thread_local std::vector<TablePoint> points;
  thread_local std::vector<std::array<double, 3>> shapes;
  rule.clear();
  points.clear();
  shapes.clear();
  split(poles_of(e, source), -1, 1, 0, log_tolerance_, e.curved ? 4 : 0, rule);
  for (const LocalPoint& p : rule) {
    const Vec2 t = e.derivative(p.s);
    points.push_back({e.at(p.s), p.w * turned_right(t), p.w * norm(t)});
    shapes.push_back(shape(mesh_->order, p.s));
  }
  add_far(e, points, shapes, source, out);
}

void Integrator::points_for(std::size_t element, Vec2 source, double sharper, std::vector<LocalPoint>& out) const {
  const Element& e = mesh_->elements[element];
  out.clear();
  split(poles_of(e, source), -1, 1, 0, log_tolerance_ - std::log(sharper), e.curved ? 4 : 0, out);
}

void Integrator::own_straight(const Element& e, double s0, ElementIntegrals& out) const {
  // N_a(s0 + v) = n0 + n1 v + n2 v^2 / 2: every integral in closed form.
  const double nu = medium_.elastic.nu;
  const double length = norm(e.c1);
  const Vec2 t = e.c1 / length;
  const auto n0 = shape(mesh_->order, s0);
  const auto n1 = shape_slope(mesh_->order, s0);
  const auto n2 = shape_curve(mesh_->order);
  const double ahead = 1 - s0;
  const double behind = 1 + s0;
  std::array<double, 3> power{};  // of v^k over [-1-s0, 1-s0]
  std::array<double, 3> logs{};   // of v^k ln|v|
  for (std::size_t k = 0; k < 3; ++k) {
    const double q = static_cast<double>(k + 1);
    const auto one = [&](double l, double sign) {
      if (l <= 0) return;
      const double lk = std::pow(l, q);
      power[k] += sign * lk / q;
      logs[k] += sign * lk * (std::log(l) / q - 1 / (q * q));
    };
    one(ahead, 1);
    one(behind, k % 2 == 0 ? 1 : -1);
  }
  const double cu = length / (8 * std::numbers::pi * medium_.elastic.mu * (1 - nu));
  const double ct = (1 - 2 * nu) / (4 * std::numbers::pi * (1 - nu));
  const Vec2 n = turned_right(t);
  for (std::size_t a = 0; a < mesh_->per_element(); ++a) {
    const double whole = n0[a] * power[0] + n1[a] * power[1] + 0.5 * n2[a] * power[2];
    const double with_log = n0[a] * logs[0] + n1[a] * logs[1] + 0.5 * n2[a] * logs[2] + std::log(length) * whole;
    const double l = -(3 - 4 * nu) * with_log;
    const double xy = cu * whole * t.x * t.y;
    out.g[a] = {cu * (l + whole * t.x * t.x), xy, xy, cu * (l + whole * t.y * t.y)};
    // T N over r: only the part along t x n is left, odd in v, and N - N(s0) takes its pole away.
    const double odd = ct * (n1[a] * power[0] + 0.5 * n2[a] * power[1]);
    const double twist = odd * (t.x * n.y - t.y * n.x);
    out.h[a] = {0, twist, -twist, 0};
  }
}

void Integrator::own_curved(const Element& e, double s0, ElementIntegrals& out) const {
  const Elastic elastic = medium_.elastic;
  const std::size_t per = mesh_->per_element();
  for (auto& m : out.g) m = {};
  for (auto& m : out.h) m = {};
  const auto n0 = shape(mesh_->order, s0);
  for (const double sign : {1.0, -1.0}) {
    const double length = 1 - sign * s0;
    if (length <= 1e-14) continue;
    const GaussRule& rule = log_rule();
    for (std::size_t k = 0; k < rule.s.size(); ++k) {
      const double off = sign * length * rule.s[k];
      const Mat2 u =
          length * rule.w[k] * norm(e.derivative(s0 + off)) * kelvin_displacement(offset(e, s0, off), elastic);
      const auto n = shape(mesh_->order, s0 + off);
      for (std::size_t a = 0; a < per; ++a) out.g[a] += n[a] * u;
    }
    const GaussRule& plain = gauss(20);
    for (std::size_t k = 0; k < plain.s.size(); ++k) {
      const double off = sign * length * 0.5 * (1 + plain.s[k]);
      const double w = 0.5 * length * plain.w[k];
      const Vec2 t = e.derivative(s0 + off);
      const Mat2 m = w * kelvin_traction(offset(e, s0, off), turned_right(t), elastic.nu);
      const auto n = shape(mesh_->order, s0 + off);
      for (std::size_t a = 0; a < per; ++a) out.h[a] += (n[a] - n0[a]) * m;
    }
  }
}

void Integrator::add_surface(const Element& e, Vec2 source, std::optional<double> own, ElementIntegrals& out) const {
  // The image lies beyond the surface: a rule for the image's distance is a rule for this part.
  const Vec2 image{source.x, 2 * medium_.surface->level - source.y};
  thread_local std::vector<LocalPoint> rule;
  rule.clear();
  split(poles_of(e, image), -1, 1, 0, log_tolerance_, 4, rule);
  const auto n0 = own ? shape(mesh_->order, *own) : std::array<double, 3>{};
  for (const LocalPoint& p : rule) {
    const Vec2 x = e.at(p.s);
    const Vec2 t = e.derivative(p.s);
    const Mat2 u = p.w * norm(t) * half_plane_displacement(x, source, medium_.elastic, *medium_.surface);
    const Mat2 tr = p.w * half_plane_traction(x, source, turned_right(t), medium_.elastic, *medium_.surface);
    const auto n = shape(mesh_->order, p.s);
    for (std::size_t a = 0; a < mesh_->per_element(); ++a) {
      out.g[a] += n[a] * u;
      out.h[a] += (n[a] - n0[a]) * tr;
    }
  }
}

void Integrator::integrate(std::size_t element, Vec2 source, std::optional<double> own, ElementIntegrals& out) const {
  const Element& e = mesh_->elements[element];
  if (own) {
    if (e.curved) {
      own_curved(e, *own, out);
    } else {
      own_straight(e, *own, out);
    }
  } else if (const std::size_t k = order_at(e, source); k < orders.size()) {
    std::size_t first = 0;
    for (std::size_t i = 0; i < k; ++i) first += orders[i];
    add_far(e, std::span{table_}.subspan(first * mesh_->elements.size() + element * orders[k], orders[k]),
            std::span{shapes_}.subspan(first, orders[k]), source, out);
  } else {
    add_near(e, source, out);
  }
  if (medium_.surface) add_surface(e, source, own, out);
}

void Integrator::integrate(std::size_t element, const std::array<Vec2, lanes>& sources,
                           const std::array<std::optional<double>, lanes>& own,
                           std::array<ElementIntegrals, lanes>& out) const {
  std::size_t k = orders.size();
  if (std::ranges::none_of(own, [](const auto& s) { return s.has_value(); })) {
    // The rule of the closest is good for all.
    const Element& e = mesh_->elements[element];
    double closest = 1e300;
    for (const Vec2 source : sources) closest = std::min(closest, dot(source - e.c0, source - e.c0));
    k = order_by_distance(e, closest);
    if (k == orders.size()) {
      k = 0;
      for (const Vec2 source : sources) k = std::max(k, order_at(e, source));
    }
  }
  if (k == orders.size()) {
    for (std::size_t l = 0; l < lanes; ++l) integrate(element, sources[l], own[l], out[l]);
    return;
  }
  std::size_t first = 0;
  for (std::size_t i = 0; i < k; ++i) first += orders[i];
  add_far(std::span{table_}.subspan(first * mesh_->elements.size() + element * orders[k], orders[k]),
          std::span{shapes_}.subspan(first, orders[k]), sources, out);
  if (!medium_.surface) return;
  for (std::size_t l = 0; l < lanes; ++l) add_surface(mesh_->elements[element], sources[l], own[l], out[l]);
}

void Integrator::log_slopes(std::size_t element, Vec2 source, std::optional<double> own,
                            std::array<Mat2, 3>& out) const {
  const Element& e = mesh_->elements[element];
  for (auto& m : out) m = {};
  const auto add = [&](double s, double w, Vec2 d) {
    const double r2 = dot(d, d);
    const double l = -0.5 * std::log(r2);
    const Mat2 m{w * (l + d.x * d.x / r2), w * d.x * d.y / r2, w * d.x * d.y / r2, w * (l + d.y * d.y / r2)};
    const auto n = shape_slope(mesh_->order, s);
    for (std::size_t a = 0; a < mesh_->per_element(); ++a) out[a] += n[a] * m;
  };
  if (own) {
    for (const double sign : {1.0, -1.0}) {
      const double length = 1 - sign * *own;
      if (length <= 1e-14) continue;
      const GaussRule& rule = log_rule();
      for (std::size_t k = 0; k < rule.s.size(); ++k) {
        const double off = sign * length * rule.s[k];
        add(*own + off, length * rule.w[k], offset(e, *own, off));
      }
    }
    return;
  }
  thread_local std::vector<LocalPoint> rule;
  points_for(element, source, 1, rule);
  for (const LocalPoint& p : rule) add(p.s, p.w, e.at(p.s) - source);
}

std::size_t Integrator::points_of(std::size_t element, Vec2 source) const {
  const Element& e = mesh_->elements[element];
  if (const std::size_t k = order_at(e, source); k < orders.size()) return orders[k];
  std::vector<LocalPoint> rule;
  split(poles_of(e, source), -1, 1, 0, log_tolerance_, e.curved ? 4 : 0, rule);
  return rule.size();
}

}  // namespace cleave::bem
