#include "field_stress.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "cleave/core/assert.hpp"
#include "cleave/core/expected.hpp"
#include "cleave/core/parallel.hpp"
#include "cleave/core/special.hpp"
#include "cleave/geometry/box_tree.hpp"
#include "cleave/stability/strength.hpp"

namespace cleave::scene {
namespace {

using bem::Vec2;
using geometry::Vec3;

/// Components xx, yy, zz, xy, yz, zx in other axes (unit, at right angles).
std::array<double, 6> turned(const std::array<double, 6>& s, Vec3 right, Vec3 up, Vec3 axis) {
  const auto times = [&](Vec3 v) {
    return Vec3{s[0] * v.x + s[3] * v.y + s[5] * v.z, s[3] * v.x + s[1] * v.y + s[4] * v.z,
                s[5] * v.x + s[4] * v.y + s[2] * v.z};
  };
  return {dot(right, times(right)), dot(up, times(up)),   dot(axis, times(axis)),
          dot(right, times(up)),    dot(up, times(axis)), dot(axis, times(right))};
}

}  // namespace

std::expected<TunnelField, bem::SolveError> TunnelField::make(const TunnelLine& line,
                                                              const FieldStressSettings& settings, unsigned threads) {
  TunnelField out;
  out.axis_ = normalized(line.axis[1] - line.axis[0]);
  out.right_ = normalized(cross(out.axis_, line.up));
  out.up_ = cross(out.right_, out.axis_);
  out.origin_ = 0.5 * (line.axis[0] + line.axis[1]);
  out.poisson_ = settings.poisson;
  std::array<double, 6> here{};
  for (std::size_t i = 0; i < 6; ++i)
    here[i] = settings.stress[i] + (out.origin_.z - settings.level) * settings.gradient[i];
  out.far_ = turned(here, out.right_, out.up_, out.axis_);
  out.slope_ = turned(settings.gradient, out.right_, out.up_, out.axis_);

  std::vector<Vec2> corners;
  for (const auto& [u, v] : line.outline) corners.push_back({u, v});
  std::ranges::reverse(corners);  // rock on the left
  bem::Problem problem;
  // Stresses of a traction problem do not depend on the modulus; the weight is the one that the gradient carries.
  auto material = bem::Material::make(pascals(1e9), settings.poisson, kilograms_per_cubic_metre(1));
  CLEAVE_ASSERT(material.has_value());
  bem::Loop opening = bem::polygon(corners);
  const bool rough = corners.size() <= 12;  // real corners: stress is singular there
  for (bem::Side& side : opening) {
    side.elements = rough ? 6 : 2;
    if (rough) side.grade_start = side.grade_end = 2;
  }
  problem.regions = {
      {.name = "section", .material = *material, .loops = {opening}, .conditions = {bem::free_surface()}}};
  problem.extent = settings.surface ? bem::Extent::half_plane : bem::Extent::plane;
  problem.in_situ.stress = {out.far_[0], out.far_[3], out.far_[1]};
  problem.in_situ.gradient = {out.slope_[0], out.slope_[3], out.slope_[1]};
  problem.load.gravity = {-out.slope_[3], -out.slope_[1]};
  std::optional<double> surface;
  if (settings.surface) surface = problem.surface = *settings.surface - out.origin_.z;
  bem::Options options;
  options.threads = threads;
  CLEAVE_TRY(out.section_, bem::solve_to(problem, options, settings.tolerance, 4));
  const double size = std::abs(out.far_[0]) + std::abs(out.far_[1]) + std::abs(out.far_[2]);
  if (std::abs(out.far_[4]) + std::abs(out.far_[5]) > 1e-12 * size) {
    for (bem::Side& side : opening) side.elements = 4 * side.elements.value_or(1);
    CLEAVE_TRY(out.along_, bem::Antiplane::make({opening}, surface, {}, {out.far_[5], out.far_[4]}));
  }
  return out;
}

std::expected<TunnelFields, bem::SolveError> TunnelFields::make(const Scene& scene, unsigned threads) {
  TunnelFields out;
  for (const std::uint32_t tunnel : scene.field_stress->tunnels) {
    CLEAVE_TRY(TunnelField field, TunnelField::make(*scene.excavations[tunnel].tunnel, *scene.field_stress, threads));
    out.fields_.push_back(std::move(field));
  }
  return out;
}

Vec3 TunnelField::traction(Vec3 at, Vec3 normal) const {
  const Vec2 x{dot(at - origin_, right_), dot(at - origin_, up_)};
  const bem::Solution& solution = section_->solution;
  const std::optional<bem::Sym2> found = solution.stress(0, x);
  if (!found) return {};
  const bem::Sym2 in_plane = *found;
  const auto far = [&](std::size_t i) { return far_[i] + x.y * slope_[i]; };
  // Plane strain: what is added along the axis follows from what is added across it.
  const double axial = far(2) + poisson_ * (in_plane.xx + in_plane.yy - far(0) - far(1));
  const Vec2 shear = along_ ? along_->shear(x) : Vec2{};
  const double u = dot(normal, right_), v = dot(normal, up_), w = dot(normal, axis_);
  return (u * in_plane.xx + v * in_plane.xy + w * shear.x) * right_ +
         (u * in_plane.xy + v * in_plane.yy + w * shear.y) * up_ + (u * shear.x + v * shear.y + w * axial) * axis_;
}

Vec3 force_on(const topology::BlockComplex& complex, const topology::Face& face, const TunnelField& field) {
  // Coordinates in the face's plane.
  const Vec3 n = face.outward;
  const Vec3 helper = std::abs(n.z) < 0.7 ? Vec3{0, 0, 1} : Vec3{1, 0, 0};
  const Vec3 a = normalized(cross(helper, n));
  const Vec3 b = cross(n, a);
  struct Edge {
    Vec2 low, high;
  };
  std::vector<Edge> edges;
  std::vector<double> levels;
  for (const auto& loop : complex.loops(face)) {
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const auto flat = [&](topology::VertexId id) {
        const Vec3 r = complex.position(id) - face.centroid;
        return Vec2{dot(r, a), dot(r, b)};
      };
      Vec2 p = flat(loop[k]), q = flat(loop[(k + 1) % loop.size()]);
      levels.push_back(p.y);
      if (p.y > q.y) std::swap(p, q);
      if (p.y < q.y) edges.push_back({p, q});
    }
  }
  std::ranges::sort(levels);
  // Slabs between corners: their parts inside the face are trapezoids, however many loops it has.
  const auto integral = [&](std::size_t points) {
    const special::GaussRule& rule = special::gauss_rule(points);
    Vec3 sum;
    double magnitude = 0;
    for (std::size_t l = 0; l + 1 < levels.size(); ++l) {
      const double low = levels[l], high = levels[l + 1];
      if (!(high - low > 1e-12 * (levels.back() - levels.front()))) continue;
      std::vector<std::pair<double, const Edge*>> crossing;
      const auto on = [](const Edge& e, double y) {
        return e.low.x + (e.high.x - e.low.x) * (y - e.low.y) / (e.high.y - e.low.y);
      };
      for (const Edge& e : edges) {
        if (e.low.y <= low && e.high.y >= high) crossing.emplace_back(on(e, 0.5 * (low + high)), &e);
      }
      std::ranges::sort(crossing);
      for (std::size_t c = 0; c + 1 < crossing.size(); c += 2) {
        for (std::size_t i = 0; i < points; ++i) {
          const double y = 0.5 * (low + high) + 0.5 * (high - low) * rule.s[i];
          const double left = on(*crossing[c].second, y), right = on(*crossing[c + 1].second, y);
          for (std::size_t j = 0; j < points; ++j) {
            const double x = 0.5 * (left + right) + 0.5 * (right - left) * rule.s[j];
            const double w = 0.25 * (high - low) * (right - left) * rule.w[i] * rule.w[j];
            const Vec3 f = w * field.traction(face.centroid + x * a + y * b, n);
            sum += f;
            magnitude += norm(f);
          }
        }
      }
    }
    return std::pair{sum, magnitude};
  };
  auto [value, size] = integral(2);
  for (const std::size_t points : {4U, 6U, 9U}) {
    const auto [finer, finer_size] = integral(points);
    const bool settled = norm(finer - value) <= 1e-3 * finer_size;
    value = finer;
    if (settled) break;
  }
  return value;
}

namespace {

constexpr std::uint32_t never = UINT32_MAX;

/// What every block is judged with.
struct Clamping {
  const Scene* scene;
  const Realization* made;
  const stability::Settings* settings;
  std::vector<std::uint32_t> leaves;  ///< batch in which each block leaves

  [[nodiscard]] const topology::BlockComplex& complex() const { return made->complex->complex(); }
  [[nodiscard]] std::optional<stability::JointStiffness> stiffness_of(std::optional<topology::JointId> joint) const {
    if (!joint) return std::nullopt;
    return scene->sets[made->joints[*joint].set].properties.stiffness;
  }
};

/// The joint faces of a block that are still in contact when it is judged, with what the field puts across them.
std::vector<std::pair<topology::FaceId, stability::ClampedContact>> contacts_of(const Clamping& with,
                                                                                const stability::Judgement& judged,
                                                                                const TunnelField& field) {
  const topology::BlockComplex& complex = with.complex();
  std::vector<std::pair<topology::FaceId, stability::ClampedContact>> out;
  for (const topology::FaceId id : complex.blocks()[judged.block].faces) {
    const topology::Face& face = complex.faces()[id];
    if (face.role != topology::Role::joint) continue;
    stability::ClampedContact contact{.inward = -face.outward};
    double normal = 0, shear = 0;  // stiffness times area, of patches side by side
    for (const topology::Patch& patch : complex.patches(face)) {
      if (!patch.neighbour || with.leaves[patch.neighbour->index()] < judged.batch.value_or(never)) continue;
      const double area = patch.area.si();
      contact.area += area;
      contact.strengths.emplace_back(&with.settings->strengths.of(patch.joint), area);
      if (const auto stiffness = with.stiffness_of(patch.joint)) {
        normal += stiffness->normal.si() * area;
        shear += stiffness->shear.si() * area;
      }
    }
    if (!(contact.area > 0)) continue;
    if (normal > 0)
      contact.stiffness = {pascals_per_metre(normal / contact.area), pascals_per_metre(shear / contact.area)};
    const Vec3 force = std::min(1.0, contact.area / face.area.si()) * force_on(complex, face, field);
    contact.normal = dot(force, contact.inward);
    contact.shear = force - contact.normal * contact.inward;
    out.emplace_back(id, std::move(contact));
  }
  return out;
}

/// What acts on a block that would move, without its joints: what is left to drive it and what its planes take up.
Vec3 applied_to(const stability::Judgement& judged, const topology::BlockComplex& complex) {
  Vec3 sum = judged.driving.si() * judged.direction;
  for (const stability::Pressing& p : judged.pressing) sum += p.reaction.si() * complex.faces()[p.face].outward;
  return sum;
}

ClampedBlock clamp(const Clamping& with, const stability::Judgement& judged, const TunnelField& field) {
  const topology::BlockComplex& complex = with.complex();
  ClampedBlock out{.block = judged.block};
  // Faces on one plane are reported as one.
  std::map<std::pair<topology::PlaneId, bool>, ClampedPlane> planes;
  std::vector<stability::ClampedContact> contacts;
  for (auto& [id, contact] : contacts_of(with, judged, field)) {
    const topology::Face& face = complex.faces()[id];
    ClampedPlane& plane =
        planes.try_emplace({face.plane, face.block_on_positive_side}, ClampedPlane{.face = id}).first->second;
    plane.area += square_metres(contact.area);
    plane.normal_force += newtons(contact.normal);
    plane.shear_force += contact.shear;
    contacts.push_back(std::move(contact));
  }
  for (const auto& [key, plane] : planes) {
    out.planes.push_back(plane);
    out.compression += std::max(Force{}, plane.normal_force);
    out.tension += std::max(Force{}, -plane.normal_force);
  }
  out.factor_of_safety = stability::clamped_factor(contacts, applied_to(judged, complex),
                                                   with.scene->field_stress->stiffness_ratio, with.settings->partial);
  return out;
}

// ---- How far a section says what the stress is ----------------------------------------------------------------------

void add(geometry::Extents& box, const topology::BlockComplex& complex, const topology::Face& face) {
  for (const auto& loop : complex.loops(face)) {
    for (const topology::VertexId id : loop) box.add(complex.position(id));
  }
}

/// Between two boxes; 0 where they meet.
double distance(const geometry::Extents& a, const geometry::Extents& b) {
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double gap = std::max({0.0, b.lo[k] - a.hi[k], a.lo[k] - b.hi[k]});
    sum += gap * gap;
  }
  return std::sqrt(sum);
}

/// The largest distance between two corners of a tunnel's section.
double width_of(const TunnelLine& line) {
  double most = 0;
  for (const auto& [u, v] : line.outline) {
    for (const auto& [p, q] : line.outline) most = std::max(most, std::hypot(u - p, v - q));
  }
  return most;
}

/// Free faces that the section of a tunnel knows nothing of, with how far they are felt: twice the width of an opening.
/// What a round hole of that width adds to the stress there is a twenty-fifth of it, 4 %.
class Surroundings final {
 public:
  Surroundings(const Scene& scene, const topology::BlockComplex& complex) : scene_{&scene}, complex_{&complex} {
    std::map<std::uint32_t, geometry::Extents> boxes;
    for (const topology::FaceId id : complex.faces().ids()) {
      const topology::Face& face = complex.faces()[id];
      if (face.role != topology::Role::free) continue;
      Free one{.face = id};
      add(one.box, complex, face);
      free_.push_back(one);
      if (face.excavation) add(boxes[*face.excavation], complex, face);
    }
    for (const auto& [excavation, box] : boxes) {
      const auto& line = scene.excavations[excavation].tunnel;
      std::array<double, 3> sides{};
      for (std::size_t k = 0; k < 3; ++k) sides[k] = box.hi[k] - box.lo[k];
      std::ranges::sort(sides);
      reach_[excavation] = 2 * (line ? width_of(*line) : sides[1]);
    }
  }

  /// Whether the section of this tunnel is all that a block feels.
  [[nodiscard]] bool alone(topology::BlockId block, std::uint32_t tunnel) const {
    geometry::Extents box;
    for (const topology::FaceId id : complex_->blocks()[block].faces) add(box, *complex_, complex_->faces()[id]);
    const TunnelLine& line = *scene_->excavations[tunnel].tunnel;
    const Vec3 axis = normalized(line.axis[1] - line.axis[0]);
    const double own = 2 * width_of(line);
    return std::ranges::none_of(free_, [&](const Free& one) {
      const topology::Face& face = complex_->faces()[one.face];
      double reach = own;
      if (face.excavation == tunnel) {
        if (std::abs(dot(face.outward, axis)) < 0.99) return false;  // a wall; a heading is none
      } else if (face.excavation) {
        reach = reach_.at(*face.excavation);
      } else if (scene_->field_stress->surface && face.outward.z > 0.99) {
        return false;  // the ground of the half plane
      }
      return distance(box, one.box) < reach;
    });
  }

 private:
  struct Free {
    topology::FaceId face;
    geometry::Extents box = {};
  };
  const Scene* scene_;
  const topology::BlockComplex* complex_;
  std::vector<Free> free_;
  std::map<std::uint32_t, double> reach_;
};

/// The tunnel of [field_stress] that a block has a free face of; of a block behind others the one whose axis is
/// nearest. Its place in FieldStressSettings::tunnels; empty: none.
std::optional<std::size_t> tunnel_of(const Scene& scene, const topology::BlockComplex& complex,
                                     const stability::Judgement& judged) {
  const std::vector<std::uint32_t>& tunnels = scene.field_stress->tunnels;
  const topology::Block& block = complex.blocks()[judged.block];
  for (const topology::FaceId id : block.faces) {
    const topology::Face& face = complex.faces()[id];
    if (face.role != topology::Role::free || !face.excavation) continue;
    const auto found = std::ranges::find(tunnels, *face.excavation);
    if (found != tunnels.end()) return found - tunnels.begin();
  }
  if (!judged.batch || *judged.batch < 2 || tunnels.empty()) return std::nullopt;
  const auto from_axis = [&](std::uint32_t tunnel) {
    const std::vector<Vec3>& axis = scene.excavations[tunnel].tunnel->axis;
    return norm(cross(block.centroid - axis[0], normalized(axis[1] - axis[0])));
  };
  return std::ranges::min_element(tunnels, {}, from_axis) - tunnels.begin();
}

}  // namespace

FieldStressResult clamp_blocks(const Scene& scene, const TunnelFields& fields, const Realization& made,
                               const stability::Settings& settings, unsigned threads) {
  FieldStressResult result;
  const std::vector<std::uint32_t>& tunnels = scene.field_stress->tunnels;
  for (std::size_t k = 0; k < tunnels.size(); ++k) {
    const bem::Refined& section = fields.of_tunnels()[k].section();
    const bem::Diagnostics& solved = section.solution.diagnostics();
    result.tunnels.push_back(scene.excavations[tunnels[k]].name);
    result.elements += solved.elements;
    result.error = std::max(result.error, section.error);
    result.reached = result.reached && section.reached;
    result.condition = std::max(result.condition, solved.condition);
    result.residual = std::max(result.residual, solved.residual);
  }
  const topology::BlockComplex& complex = made.complex->complex();
  const stability::Analysis& analysis = *made.analysis;
  Clamping with{&scene, &made, &settings, std::vector<std::uint32_t>(complex.blocks().size(), never)};
  for (const topology::BlockId id : settings.left_out) with.leaves[id.index()] = 0;
  for (const stability::Judgement& j : analysis.judgements) {
    if (j.batch) with.leaves[j.block.index()] = *j.batch;
  }
  const Surroundings surroundings{scene, complex};
  std::vector<std::pair<const stability::Judgement*, std::size_t>> judged;
  for (const stability::Judgement& j : analysis.judgements) {
    if (!stability::moves(j.mode)) continue;
    const auto tunnel = tunnel_of(scene, complex, j);
    if (!tunnel) continue;
    if (!surroundings.alone(j.block, tunnels[*tunnel])) {
      ++result.undecided;
      continue;
    }
    judged.emplace_back(&j, *tunnel);
    result.blocks.push_back({.block = j.block});
  }
  parallel_for(judged.size(), ThreadLimit{std::max(1U, threads)}, [&](std::size_t k) {
    const auto [judgement, tunnel] = judged[k];
    result.blocks[k] = clamp(with, *judgement, fields.of_tunnels()[tunnel]);
  });
  for (std::size_t k = 0; k < judged.size(); ++k) {
    if (judged[k].first->key && result.blocks[k].factor_of_safety >= 1) {
      ++result.held;
      result.held_volume += complex.blocks()[judged[k].first->block].volume;
    }
  }
  return result;
}

}  // namespace cleave::scene
