#include "field_stress.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "cleave/core/assert.hpp"
#include "cleave/core/expected.hpp"
#include "cleave/core/parallel.hpp"
#include "cleave/core/special.hpp"
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

std::expected<TunnelField, bem::SolveError> TunnelField::make(const Scene& scene, const FieldStressSettings& settings,
                                                              unsigned threads) {
  const TunnelLine& line = *scene.excavations[settings.excavation].tunnel;
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
    for (bem::Side& side : opening) side.elements *= 4;
    CLEAVE_TRY(out.along_, bem::Antiplane::make({opening}, surface, {}, {out.far_[5], out.far_[4]}));
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

/// The joint faces of a block that are still in contact when it is judged, with what the field puts across them.
std::vector<std::pair<topology::FaceId, stability::ClampedContact>> contacts_of(
    const topology::BlockComplex& complex, const stability::Judgement& judged, const TunnelField& field,
    const std::vector<std::uint32_t>& leaves, const stability::StrengthTable& strengths) {
  std::vector<std::pair<topology::FaceId, stability::ClampedContact>> out;
  for (const topology::FaceId id : complex.blocks()[judged.block].faces) {
    const topology::Face& face = complex.faces()[id];
    if (face.role != topology::Role::joint) continue;
    stability::ClampedContact contact{.inward = -face.outward};
    for (const topology::Patch& patch : complex.patches(face)) {
      if (!patch.neighbour || leaves[patch.neighbour->index()] < judged.batch.value_or(never)) continue;
      contact.area += patch.area.si();
      contact.strengths.emplace_back(&strengths.of(patch.joint), patch.area.si());
    }
    if (!(contact.area > 0)) continue;
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

ClampedBlock clamp(const topology::BlockComplex& complex, const stability::Judgement& judged, const TunnelField& field,
                   const std::vector<std::uint32_t>& leaves, const stability::Settings& settings,
                   std::optional<double> stiffness_ratio) {
  ClampedBlock out{.block = judged.block};
  // Faces on one plane are reported as one.
  std::map<std::pair<topology::PlaneId, bool>, ClampedPlane> planes;
  std::vector<stability::ClampedContact> contacts;
  for (auto& [id, contact] : contacts_of(complex, judged, field, leaves, settings.strengths)) {
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
  out.factor_of_safety =
      stability::clamped_factor(contacts, applied_to(judged, complex), stiffness_ratio, settings.partial);
  return out;
}

}  // namespace

FieldStressResult clamp_blocks(const Scene& scene, const TunnelField& field, const topology::BlockComplex& complex,
                               const stability::Analysis& analysis, const stability::Settings& settings,
                               unsigned threads) {
  FieldStressResult result;
  const FieldStressSettings& wanted = *scene.field_stress;
  result.tunnel = scene.excavations[wanted.excavation].name;
  const bem::Refined& section = field.section();
  result.elements = section.solution.diagnostics().elements;
  result.error = section.error;
  result.reached = section.reached;
  result.condition = section.solution.diagnostics().condition;
  result.residual = section.solution.diagnostics().residual;

  std::vector<std::uint32_t> leaves(complex.blocks().size(), never);
  for (const topology::BlockId id : settings.left_out) leaves[id.index()] = 0;
  for (const stability::Judgement& j : analysis.judgements) {
    if (j.batch) leaves[j.block.index()] = *j.batch;
  }
  std::vector<const stability::Judgement*> judged;
  for (const stability::Judgement& j : analysis.judgements) {
    if (!stability::moves(j.mode)) continue;
    const bool at_tunnel = std::ranges::any_of(complex.blocks()[j.block].faces, [&](topology::FaceId id) {
      const topology::Face& face = complex.faces()[id];
      return face.role == topology::Role::free && face.excavation == wanted.excavation;
    });
    if (!at_tunnel && !(j.batch && *j.batch > 1)) continue;
    judged.push_back(&j);
    result.blocks.push_back({.block = j.block});
  }
  parallel_for(judged.size(), ThreadLimit{std::max(1U, threads)}, [&](std::size_t k) {
    result.blocks[k] = clamp(complex, *judged[k], field, leaves, settings, wanted.stiffness_ratio);
  });
  for (std::size_t k = 0; k < judged.size(); ++k) {
    if (judged[k]->key && result.blocks[k].factor_of_safety >= 1) ++result.held;
  }
  return result;
}

}  // namespace cleave::scene
