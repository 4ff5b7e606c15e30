#pragma once

#include <cmath>
#include <numbers>
#include <optional>
#include <string_view>

#include "cleave/exchange/csv.hpp"
#include "cleave/scene2d/bodies.hpp"
#include "cleave/scene2d/contact.hpp"

/// Rows of the tables of two-dimensional scenes, each column once.
namespace cleave::report {

struct PointRow {
  double time = 0;
  std::string_view name = {};
  bem::Vec2 at, displacement;
};
template <class V>
void fields(V& v, const PointRow& x) {
  v("time_s", x.time);
  v("point", x.name);
  v("x_m", x.at.x, "where the point is at the start");
  v("y_m", x.at.y);
  v("displacement_x_m", x.displacement.x);
  v("displacement_y_m", x.displacement.y);
}

struct StressPointRow {
  PointRow point;
  std::optional<bem::Sym2> stress;
};
template <class V>
void fields(V& v, const StressPointRow& x) {
  const bem::Sym2 s = x.stress.value_or(bem::Sym2{});
  fields(v, x.point);
  v("stress_xx_pa", when(x.stress.has_value(), s.xx), "where it was asked for");
  v("stress_yy_pa", when(x.stress.has_value(), s.yy));
  v("stress_xy_pa", when(x.stress.has_value(), s.xy));
}

/// Stress at a node of a body that deforms.
struct NodeStressRow {
  std::string_view body = {};
  std::uint64_t node = 0;
  bem::Vec2 at = {};
  scene::NodeStress stress = {};
};
template <class V>
void fields(V& v, const NodeStressRow& x) {
  const bem::Sym2 s = x.stress.stress;
  const double mean = 0.5 * (s.xx + s.yy), radius = std::hypot(0.5 * (s.xx - s.yy), s.xy);
  v("body", x.body);
  v("node", x.node, "from 1, along the outline");
  v("x_m", x.at.x, "at the end");
  v("y_m", x.at.y);
  v("stress_xx_pa", s.xx, "tension positive");
  v("stress_yy_pa", s.yy);
  v("stress_xy_pa", s.xy);
  v("stress_zz_pa", x.stress.out_of_plane);
  v("principal_1_pa", mean + radius, "in the plane");
  v("principal_2_pa", mean - radius);
  v("direction_1_degrees", 0.5 * std::atan2(2 * s.xy, s.xx - s.yy) * 180 / std::numbers::pi, "from the x axis");
  v("von_mises_pa", x.stress.von_mises);
  v("safety", x.stress.safety, "where a strength is stated");
}

}  // namespace cleave::report

namespace cleave::scene {

template <class V>
void fields(V& v, const ContactHistory& x) {
  v("time_s", x.time);
  v("step_s", x.step);
  v("kinetic_j", x.kinetic);
  v("elastic_j", x.elastic);
  v("gravity_j", x.gravity);
  v("work_j", x.work, "of loads, since the start");
  v("friction_j", x.friction, "dissipated by slip");
  v("lost_j", x.lost, "by impacts, damping and the time scheme");
  v("contacts", x.contacts);
  v("sticking", x.sticking);
  v("slipping", x.slipping);
  v("iterations", x.iterations);
  v("residual", x.residual);
  v("bolts_j", x.bolts, "dissipated by bolts that yield and break");
}

template <class V>
void fields(V& v, const ContactBodyResult& x) {
  v("body", x.name);
  v("fixed", x.fixed);
  v("elastic", x.elastic);
  v("centroid_x_m", x.centroid.x, "at the end");
  v("centroid_y_m", x.centroid.y);
  v("displacement_x_m", x.centroid.x - x.start.x);
  v("displacement_y_m", x.centroid.y - x.start.y);
  v("rotation_degrees", x.rotation * 180 / std::numbers::pi, "counter-clockwise, whole turns counted");
  v("max_displacement_m", x.largest, "of its corners");
  v("contact_force_x_n_per_m", x.force.x, "sum of the contact forces on it at the end");
  v("contact_force_y_n_per_m", x.force.y);
}

}  // namespace cleave::scene
