#include "elements.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace cleave::assembly {
namespace {

using geometry::Vec3;

/// Which of x, y, z, and turning about x, y, z count.
std::span<const Eigen::Index> rows_of(Freedom freedom) {
  static constexpr std::array<Eigen::Index, 6> all{0, 1, 2, 3, 4, 5};
  static constexpr std::array<Eigen::Index, 3> plane{0, 2, 4};
  switch (freedom) {
    case Freedom::translation: return std::span{all}.first(3);
    case Freedom::rigid: return all;
    case Freedom::section_translation: return std::span{plane}.first(2);
    case Freedom::section: return plane;
  }
  std::unreachable();
}

Eigen::Matrix<double, 6, 6> full_mass(const Body& body) {
  Eigen::Matrix<double, 6, 6> m = Eigen::Matrix<double, 6, 6>::Zero();
  m.diagonal().head<3>().setConstant(body.mass);
  const auto& [xx, yy, zz, xy, yz, zx] = body.inertia;
  m.bottomRightCorner<3, 3>() << xx, xy, zx, xy, yy, yz, zx, yz, zz;
  return m;
}

Eigen::Matrix<double, 6, 1> column(Vec3 force, Vec3 arm) {
  const Vec3 moment = cross(arm, force);
  return {force.x, force.y, force.z, moment.x, moment.y, moment.z};
}

}  // namespace

std::pair<Vec3, Vec3> tangents(Vec3 normal) {
  const Vec3 a{std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)};
  // In a section the first tangent lies in its plane.
  Vec3 first = a.y <= a.x && a.y <= a.z ? cross(normal, {0, 1, 0}) : cross(normal, {0, 0, 1});
  if (a.y > a.x && a.y > a.z) first = cross(normal, {1, 0, 0});
  first = normalized(first);
  return {first, cross(normal, first)};
}

Elements::Elements(const Assembly& assembly)
    : bodies_{assembly.bodies().size()}, freedom_{assembly.freedom()}, starts_{0} {
  const std::span<const Eigen::Index> rows = rows_of(freedom_);
  width_ = static_cast<Eigen::Index>(rows.size());
  load_ = Eigen::VectorXd::Zero(width_ * static_cast<Eigen::Index>(bodies_));
  for (std::size_t b = 0; b < bodies_; ++b) {
    const Body& body = assembly.bodies()[b];
    mass_l_.emplace_back(full_mass(body)(rows, rows).llt().matrixL());
    Eigen::Matrix<double, 6, 1> r;
    r << body.force.x, body.force.y, body.force.z, body.moment.x, body.moment.y, body.moment.z;
    Eigen::VectorXd own = r(rows);
    mass_l_.back().triangularView<Eigen::Lower>().solveInPlace(own);
    load_.segment(width_ * static_cast<Eigen::Index>(b), width_) = own;
    unit_ = b == 0 ? own.norm() : std::max(unit_, own.norm());
  }
  if (!(unit_ > 0)) unit_ = 1;
  load_ /= unit_;
  const auto scaled_rows = [&](std::uint32_t b, const std::array<Vec3, 3>& axes, Vec3 at, double sign) {
    const Vec3 arm = at - assembly.bodies()[b].centroid;
    Rows out(width_, 3);
    for (Eigen::Index k = 0; k < 3; ++k) out.col(k) = sign * column(axes[static_cast<std::size_t>(k)], arm)(rows);
    mass_l_[b].triangularView<Eigen::Lower>().solveInPlace(out);
    return out;
  };
  for (std::uint32_t c = 0; c < assembly.contacts().size(); ++c) {
    const Contact& contact = assembly.contacts()[c];
    const auto [t1, t2] = tangents(contact.normal);
    const std::array<Vec3, 3> axes{contact.normal, t1, t2};
    const auto add = [&](Vec3 at) -> Element& {
      Element e;
      e.contact = c;
      e.body = contact.body;
      e.other = contact.other;
      e.on_body = scaled_rows(contact.body, axes, at, 1);
      double size = e.on_body.squaredNorm();
      if (contact.other) {
        e.on_other = scaled_rows(*contact.other, axes, at, -1);
        size += e.on_other.squaredNorm();
      }
      e.scale = size > 0 ? 1 / std::sqrt(size) : 1;
      e.on_body *= e.scale;
      e.on_other *= e.scale;
      return elements_.emplace_back(std::move(e));
    };
    const std::size_t points =
        turns(freedom_) ? contact.points.size() : std::min<std::size_t>(contact.points.size(), 1);
    for (std::size_t p = 0; p < points; ++p) add(contact.points[p]).friction = contact.friction;
    for (const Bond& bond : contact.bonds) {
      if (!(bond.cohesion > 0) && !(bond.tension > 0)) continue;
      Element& e = add((bond.corners[0] + bond.corners[1] + bond.corners[2]) / 3);
      e.bond = true;
      e.cohesion = bond.cohesion / newtons(e);
      e.tension = bond.tension / newtons(e);
    }
    starts_.push_back(elements_.size());
  }
}

Elements Elements::part(std::span<const std::uint32_t> members, std::vector<std::uint32_t>& from) const {
  constexpr auto outside = static_cast<std::uint32_t>(-1);
  Elements out{*this, members.size()};
  from.clear();
  std::vector<std::uint32_t> number(bodies_, outside);
  out.load_.resize(width_ * static_cast<Eigen::Index>(members.size()));
  for (std::uint32_t k = 0; k < members.size(); ++k) {
    number[members[k]] = k;
    out.mass_l_.push_back(mass_l_[members[k]]);
    out.load_.segment(width_ * static_cast<Eigen::Index>(k), width_) =
        load_.segment(width_ * static_cast<Eigen::Index>(members[k]), width_);
  }
  for (std::size_t contact = 0; contact + 1 < starts_.size(); ++contact) {
    for (std::size_t k = starts_[contact]; k < starts_[contact + 1]; ++k) {
      const Element& e = elements_[k];
      const std::uint32_t body = number[e.body], other = e.other ? number[*e.other] : outside;
      if (body == outside && other == outside) break;
      Element& own = out.elements_.emplace_back(e);
      own.contact = static_cast<std::uint32_t>(out.starts_.size() - 1);
      own.body = body != outside ? body : other;
      own.other.reset();
      if (body == outside) own.on_body = e.on_other;
      if (body != outside && other != outside) own.other = other;
      from.push_back(static_cast<std::uint32_t>(k));
    }
    if (out.elements_.size() > out.starts_.back()) out.starts_.push_back(out.elements_.size());
  }
  return out;
}

Eigen::Vector3d Elements::relative(const Element& e, const Eigen::VectorXd& v) const {
  Eigen::Vector3d u = e.on_body.transpose() * v.segment(width_ * static_cast<Eigen::Index>(e.body), width_);
  if (e.other) u += e.on_other.transpose() * v.segment(width_ * static_cast<Eigen::Index>(*e.other), width_);
  return u;
}

void Elements::add_force(const Element& e, const Eigen::Vector3d& x, Eigen::VectorXd& y) const {
  y.segment(width_ * static_cast<Eigen::Index>(e.body), width_) += e.on_body * x;
  if (e.other) y.segment(width_ * static_cast<Eigen::Index>(*e.other), width_) += e.on_other * x;
}

Motion Elements::motion_of(const Eigen::VectorXd& v) const {
  const std::span<const Eigen::Index> rows = rows_of(freedom_);
  Motion out(bodies_);
  for (std::size_t b = 0; b < bodies_; ++b) {
    Eigen::VectorXd own = unit_ * v.segment(width_ * static_cast<Eigen::Index>(b), width_);
    mass_l_[b].triangularView<Eigen::Lower>().transpose().solveInPlace(own);
    Eigen::Matrix<double, 6, 1> six = Eigen::Matrix<double, 6, 1>::Zero();
    six(rows) = own;
    out[b] = {{six[0], six[1], six[2]}, {six[3], six[4], six[5]}};
  }
  return out;
}

Eigen::VectorXd Elements::scaled(const Motion& motion) const {
  const std::span<const Eigen::Index> rows = rows_of(freedom_);
  Eigen::VectorXd out(width_ * static_cast<Eigen::Index>(bodies_));
  for (std::size_t b = 0; b < bodies_; ++b) {
    const Rate& r = motion[b];
    Eigen::Matrix<double, 6, 1> six;
    six << r.velocity.x, r.velocity.y, r.velocity.z, r.spin.x, r.spin.y, r.spin.z;
    out.segment(width_ * static_cast<Eigen::Index>(b), width_) = mass_l_[b].transpose() * six(rows) / unit_;
  }
  return out;
}

}  // namespace cleave::assembly
