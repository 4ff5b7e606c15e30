#include "contact_bodies.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>

#include "cleave/bem/block.hpp"
#include "contact_parts.hpp"

namespace cleave::scene {
namespace {

using bem::Vec2;

/// A node of a boundary, as a part of a side of the outline.
struct SideNode {
  std::size_t side;
  double t;      ///< from its first corner to the next
  double share;  ///< of the way to the next node, see dbem::Body::shares
};

/// The operator of one shape in the axes of the body it was built for.
struct Shape {
  const ContactBody* body;
  bem::BlockOperator block;
  std::vector<SideNode> outline;
  std::vector<std::size_t> node;  ///< of the mesh, of each outline corner
  dbem::ModalBasis modes;
  PreparedBodies::StressOfModes stress;
};

double longest(const ContactBody& body) {
  double out = 0;
  for (const Vec2 p : body.corners) out = std::max(out, norm(p - body.corners.front()));
  return out;
}

/// The angle by which `b` is `a` turned; empty when it is not the same shape of the same material.
std::optional<double> turn_between(const ContactBody& a, const ContactBody& b) {
  if (a.corners.size() != b.corners.size() || a.young != b.young || a.poisson != b.poisson || a.density != b.density ||
      a.held != b.held || a.fixed != b.fixed) {
    return std::nullopt;
  }
  const Vec2 first = a.corners[1] - a.corners[0], second = b.corners[1] - b.corners[0];
  double angle = std::atan2(cross(first, second), dot(first, second));
  if (std::abs(angle) < 1e-12) angle = 0;  // rounding of coordinates
  const double tolerance = 1e-9 * longest(a);
  for (std::size_t k = 0; k < a.corners.size(); ++k) {
    const Vec2 off = rotated(a.corners[k] - a.corners[0], angle) - (b.corners[k] - b.corners[0]);
    if (norm(off) > tolerance) return std::nullopt;
  }
  return angle;
}

Problem refused(const ContactScene& scene, std::size_t body, const std::string& what) {
  return {scene.shown, scene.bodies[body].line, fmt::format("body \"{}\"", scene.bodies[body].name), what,
          "change its outline or contact.element, or write rigid = true"};
}

/// At the first node of every element and at its inner one, in the order of the outline: where two elements meet, the
/// mean of both.
std::vector<bem::Sym2> stress_of_modes(const bem::BlockOperator& block, const bem::Modes& modes, std::size_t count) {
  const bem::Mesh& mesh = block.mesh();
  const std::size_t nodes = mesh.per_element() - 1, elements = mesh.elements.size();
  std::vector<bem::Sym2> out(nodes * elements * count);
  std::vector<double> u(block.freedoms());
  for (std::size_t m = 0; m < count; ++m) {
    for (std::size_t i = 0; i < u.size(); ++i) u[i] = modes.shapes(i, m);
    const auto tractions = bem::tractions_of(block, u);
    const auto local = bem::local_nodes(mesh.order);
    for (std::size_t e = 0; e < elements; ++e) {
      const std::size_t before = e == 0 ? elements - 1 : e - 1;
      for (std::size_t a = 0; a < nodes; ++a) {
        bem::Sym2 s = bem::boundary_stress(block, {e, local[a]}, u, tractions);
        if (a == 0) s = 0.5 * (s + bem::boundary_stress(block, {before, 1}, u, tractions));
        out[(e * nodes + a) * count + m] = s;
      }
    }
  }
  return out;
}

/// Of each mode, see dbem::ModalBasis: the body grown evenly is a static extension of its boundary, so that the mass
/// matrix has the integral over the body.
std::vector<double> stretch_of(const bem::BlockOperator& block, const bem::Modes& modes, std::size_t count) {
  const bem::Mesh& mesh = block.mesh();
  std::vector<double> out(count, 0.0);
  for (std::size_t i = 0; i < block.freedoms(); ++i) {
    double pull = 0;
    for (std::size_t k = 0; k < mesh.nodes.size(); ++k) {
      const Vec2 x = mesh.nodes[k].x;
      pull += block.mass_matrix()(i, 2 * k) * x.x + block.mass_matrix()(i, 2 * k + 1) * x.y;
    }
    for (std::size_t m = 0; m < count; ++m) out[m] += modes.shapes(i, m) * pull;
  }
  return out;
}

std::expected<Shape, Problem> make_shape(const ContactScene& scene, std::size_t index, unsigned threads) {
  const ContactBody& body = scene.bodies[index];
  const ContactSettings& settings = scene.settings;
  const auto material =
      bem::Material::make(pascals(*body.young), *body.poisson, kilograms_per_cubic_metre(body.density), settings.plane);
  if (!material) return std::unexpected(refused(scene, index, describe(material.error())));
  bem::BlockOptions options;
  options.threads = threads;
  options.bubbles = 3;  // what weight and turning need; the contacts act on the boundary
  options.mesh.element = element_of(settings, body);
  auto made = bem::BlockOperator::make({bem::polygon(body.corners)}, *material, options);
  if (!made) return std::unexpected(refused(scene, index, describe(made.error())));
  Shape shape{&body, *std::move(made), {}, {}, {}, {}};
  const bem::Mesh& mesh = shape.block.mesh();
  for (const bem::Element& element : mesh.elements) {
    const std::size_t nodes = mesh.per_element() - 1;  // the last one belongs to the next element
    const Vec2 start = body.corners[element.side];
    const Vec2 along = body.corners[(element.side + 1) % body.corners.size()] - start;
    for (std::size_t a = 0; a < nodes; ++a) {
      const Vec2 x = shape.block.centroid() + mesh.nodes[element.node[a]].x;
      double t = dot(x - start, along) / dot(along, along);
      if (std::abs(t) < 1e-12) t = 0;
      // Simpson's weights, 1 4 1, of an element with a node in its middle.
      const double share = nodes == 1 ? 0.5 : a == 0 ? 1.0 / 3 : 2.0 / 3;
      shape.outline.push_back({element.side, t, share});
      shape.node.push_back(element.node[a]);
    }
  }
  std::vector<bem::HeldFreedom> held;
  if (body.clamped()) {
    std::vector<bool> done(mesh.nodes.size(), false);
    for (const bem::Element& element : mesh.elements) {
      if (!body.held[element.side]) continue;
      for (std::size_t a = 0; a < mesh.per_element(); ++a) {
        const std::size_t node = element.node[a];
        if (done[node]) continue;
        done[node] = true;
        held.push_back({node, {1, 0}});
        held.push_back({node, {0, 1}});
      }
    }
  }
  const bem::Modes modes =
      body.clamped() ? bem::supported_modes(shape.block, held) : bem::free_modes(shape.block, settings.modes);
  const std::size_t count = std::min(settings.modes.value_or(modes.eigenvalues.size()), modes.eigenvalues.size());
  shape.modes.damping = settings.damping;
  for (std::size_t m = 0; m < count; ++m) shape.modes.omega.push_back(std::sqrt(modes.eigenvalues[m]));
  shape.modes.shapes.resize(2 * shape.node.size() * count);
  for (std::size_t v = 0; v < shape.node.size(); ++v) {
    for (std::size_t c = 0; c < 2; ++c) {
      for (std::size_t m = 0; m < count; ++m) {
        shape.modes.shapes[(2 * v + c) * count + m] = modes.shapes(2 * shape.node[v] + c, m);
      }
    }
  }
  if (!body.clamped()) shape.modes.stretch = stretch_of(shape.block, modes, count);
  shape.stress.poisson = settings.plane == bem::PlaneState::strain ? *body.poisson : 0;
  shape.stress.values = stress_of_modes(shape.block, modes, count);
  return shape;
}

/// Modes of a shape in the axes of a body that is that shape turned by `angle`.
dbem::ModalBasis turned(const dbem::ModalBasis& modes, double angle) {
  if (angle == 0) return modes;
  dbem::ModalBasis out = modes;
  const std::size_t count = modes.omega.size();
  const double c = std::cos(angle), s = std::sin(angle);
  for (std::size_t v = 0; 2 * v * count < modes.shapes.size(); ++v) {
    for (std::size_t m = 0; m < count; ++m) {
      const double x = modes.shapes[2 * v * count + m], y = modes.shapes[(2 * v + 1) * count + m];
      out.shapes[2 * v * count + m] = c * x - s * y;
      out.shapes[(2 * v + 1) * count + m] = s * x + c * y;
    }
  }
  return out;
}

std::function<double(double, double)> mean_of(const TimeFunction& time) {
  return [time](double from, double to) { return time.mean(from, to); };
}

/// Nodal forces (in the shape's axes) as forces at the corners of the body.
void add_nodal(const Shape& shape, double angle, const std::vector<double>& forces, const TimeFunction& time,
               bool follows, dbem::Body& body) {
  for (std::size_t v = 0; v < shape.node.size(); ++v) {
    const Vec2 f{forces[2 * shape.node[v]], forces[2 * shape.node[v] + 1]};
    if (f == Vec2{}) continue;
    body.forces.push_back({body.outline[v], rotated(f, angle), time, follows, mean_of(time)});
  }
}

/// Stress that the rock had before at the height of the body's centroid.
bem::Sym2 locked_in(const ContactScene& scene, const ContactBody& spec) {
  if (!scene.settings.in_situ) return {};
  const bem::InSitu& rock = *scene.settings.in_situ;
  const double height = dbem::polygon_moments(spec.corners).centroid.y - rock.level;
  return rock.stress + height * rock.gradient;
}

/// What strains an elastic body that holds a stress: tractions against those it had on all its sides. They turn with
/// it.
void load_locked(const Shape& shape, double angle, bem::Sym2 stress, dbem::Body& body) {
  if (stress == bem::Sym2{}) return;
  const bem::Mesh& mesh = shape.block.mesh();
  const auto places = bem::local_nodes(mesh.order);
  std::vector<std::array<Vec2, 3>> tractions(mesh.elements.size());
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    for (std::size_t a = 0; a < places.size(); ++a) {
      tractions[e][a] = -rotated(stress * rotated(mesh.elements[e].normal(places[a]), angle), -angle);
    }
  }
  add_nodal(shape, angle, shape.block.forces_of(tractions), {}, true, body);
}

void load_elastic(const ContactBody& spec, const Shape& shape, double angle, Vec2 gravity, dbem::Body& body) {
  const bem::Mesh& mesh = shape.block.mesh();
  for (const ContactLoad& load : spec.loads) {
    if (!load.side) {
      // The place in the frame of the shape.
      const Vec2 local = rotated(load.at - spec.corners[0], -angle) + shape.body->corners[0] - shape.block.centroid();
      std::vector<double> forces(shape.block.freedoms(), 0.0);
      shape.block.add_point_force(shape.block.place(local), rotated(load.force, -angle), forces);
      add_nodal(shape, angle, forces, load.time, load.follows, body);
      continue;
    }
    std::vector<std::array<Vec2, 3>> tractions(mesh.elements.size());
    const auto places = bem::local_nodes(mesh.order);
    for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
      if (mesh.elements[e].side != *load.side) continue;
      for (std::size_t a = 0; a < places.size(); ++a) {
        tractions[e][a] = rotated(load.traction, -angle) - load.pressure * mesh.elements[e].normal(places[a]);
      }
    }
    add_nodal(shape, angle, shape.block.forces_of(tractions), load.time, load.follows, body);
  }
  if (spec.clamped() && !(gravity == Vec2{})) {
    // A free body's weight moves it as a whole only; a clamped one bends. Forces on inner shapes move no boundary
    // point.
    add_nodal(shape, angle, shape.block.forces_of_acceleration(rotated(gravity, -angle)), {}, false, body);
  }
}

void load_rigid(const ContactBody& spec, dbem::Body& body) {
  for (const ContactLoad& load : spec.loads) {
    if (!load.side) {
      body.forces.push_back({load.at - body.origin, load.force, load.time, load.follows, mean_of(load.time)});
      continue;
    }
    const Vec2 a = spec.corners[*load.side], b = spec.corners[(*load.side + 1) % spec.corners.size()];
    const Vec2 force = norm(b - a) * load.traction - load.pressure * turned_right(b - a);
    body.forces.push_back({(a + b) / 2 - body.origin, force, load.time, load.follows, mean_of(load.time)});
  }
}

}  // namespace

std::vector<std::size_t> shapes_of(const ContactScene& scene) {
  std::vector<std::size_t> out;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const ContactBody& body = scene.bodies[b];
    const auto alike = [&](std::size_t shape) { return turn_between(scene.bodies[shape], body).has_value(); };
    if (!body.fixed && std::ranges::none_of(out, alike)) out.push_back(b);
  }
  return out;
}

std::expected<PreparedBodies, std::vector<Problem>> prepare_bodies(const ContactScene& scene, bool elastic,
                                                                   unsigned threads) {
  PreparedBodies out;
  std::vector<Shape> shapes;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const ContactBody& spec = scene.bodies[b];
    out.locked.emplace_back();
    dbem::Body body;
    body.name = spec.name;
    body.density = spec.density;
    body.properties = spec.joint;
    body.velocity = spec.velocity;
    body.spin = spec.spin;
    if (spec.fixed || spec.clamped()) body.held = {true, true, true};
    if (spec.motion) body.moves = [motion = *spec.motion](double t) { return motion.velocity(Time::from_si(t)); };
    body.origin = spec.corners.front();
    if (!elastic || spec.fixed) {
      for (const Vec2 p : spec.corners) body.outline.push_back(p - body.origin);
      if (!spec.fixed) load_rigid(spec, body);
      out.bodies.push_back(std::move(body));
      out.elements.push_back(0);
      out.stress.emplace_back();
      continue;
    }
    std::optional<double> angle;
    std::size_t found = 0;
    for (; found < shapes.size() && !angle; ++found) angle = turn_between(*shapes[found].body, spec);
    if (angle) {
      --found;
    } else {
      auto shape = make_shape(scene, b, threads);
      if (!shape) return std::unexpected(std::vector{shape.error()});
      found = shapes.size();
      shapes.push_back(*std::move(shape));
      angle = 0;
    }
    const Shape& shape = shapes[found];
    body.properties.clear();
    for (const SideNode& node : shape.outline) {
      const Vec2 start = spec.corners[node.side];
      const Vec2 along = spec.corners[(node.side + 1) % spec.corners.size()] - start;
      body.outline.push_back(start - body.origin + node.t * along);
      body.properties.push_back(spec.joint[node.side]);
      body.shares.push_back(node.share);
    }
    body.modes = turned(shape.modes, *angle);
    load_elastic(spec, shape, *angle, scene.settings.gravity, body);
    out.locked.back() = locked_in(scene, spec);
    load_locked(shape, *angle, out.locked.back(), body);
    out.bodies.push_back(std::move(body));
    out.elements.push_back(shape.block.mesh().elements.size());
    out.stress.push_back(PreparedBodies::OwnStress{found, *angle});
  }
  out.operators = shapes.size();
  for (Shape& shape : shapes) out.shapes.push_back(std::move(shape.stress));
  return out;
}

dbem::Laws laws_of(const ContactScene& scene) {
  const auto law = [&](const ContactJoint& joint) {
    dbem::JointLaw out;
    out.friction = std::tan(joint.friction * std::numbers::pi / 180);
    out.cohesion = joint.cohesion;
    out.tension = joint.tension;
    out.residual_cohesion = joint.residual_cohesion.si();
    if (joint.residual_friction) {
      out.residual_friction = std::tan(*joint.residual_friction * std::numbers::pi / 180);
    }
    out.restitution = scene.settings.restitution;
    out.water_pressure = joint.water_pressure;
    out.water_table = joint.water_table;
    out.dilation = std::tan(joint.dilation * std::numbers::pi / 180);
    out.dilation_slip = joint.dilation_slip;
    if (joint.normal_stiffness) out.normal_stiffness = joint.normal_stiffness->si();
    if (joint.shear_stiffness) out.shear_stiffness = joint.shear_stiffness->si();
    return out;
  };
  const auto softer = [](std::optional<JointStiffness> a, std::optional<JointStiffness> b) {
    return a && b ? std::min(a, b) : std::max(a, b);  // what is rigid, none, is below all
  };
  dbem::Laws laws;
  laws.otherwise = law(scene.joints[0]);
  for (std::size_t a = 0; a < scene.joints.size(); ++a) {
    for (std::size_t b = std::max<std::size_t>(a, 1); b < scene.joints.size(); ++b) {
      const ContactJoint& first = scene.joints[a];
      const ContactJoint& second = scene.joints[b];
      ContactJoint joint = second;
      if (a > 0) {
        joint.friction = std::min(first.friction, second.friction);
        if (first.residual_friction || second.residual_friction) {
          joint.residual_friction = std::min(first.residual_friction.value_or(first.friction),
                                             second.residual_friction.value_or(second.friction));
        }
        joint.cohesion = std::min(first.cohesion, second.cohesion);
        joint.residual_cohesion = std::min(first.residual_cohesion, second.residual_cohesion);
        joint.tension = std::min(first.tension, second.tension);
        // Of two waters the higher one is there.
        joint.water_pressure = std::max(first.water_pressure, second.water_pressure);
        if (first.water_table && second.water_table) {
          joint.water_table = std::max(*first.water_table, *second.water_table);
        } else if (first.water_table) {
          joint.water_table = first.water_table;
        }
        joint.dilation = std::min(first.dilation, second.dilation);
        joint.dilation_slip = std::min(first.dilation_slip, second.dilation_slip);
        joint.normal_stiffness = softer(first.normal_stiffness, second.normal_stiffness);
        joint.shear_stiffness = softer(first.shear_stiffness, second.shear_stiffness);
      }
      laws.pairs.push_back({a, b, law(joint)});
    }
  }
  return laws;
}

}  // namespace cleave::scene
