// [field_stress]: the stress around a tunnel across the joints of key blocks, against Kirsch's closed form.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "cleave/core/cost.hpp"
#include "cleave/core/progress.hpp"
#include "cleave/realize/monte_carlo.hpp"
#include "cleave/realize/run.hpp"
#include "cleave/stochastic/ensemble.hpp"
#include "run_scene.hpp"

namespace cleave::scene::test {
namespace {

using std::numbers::pi;

constexpr double radius = 3, apex = 4.5, length = 4, density = 2700, gravity = 9.81, nu = 0.25;

/// A roof prism over a circular tunnel along y: two joints that dip at 60 degrees away from each other and meet
/// above the axis, two vertical ones across it. The whole scene turned by `azimuth` clockwise about z.
/// `skew`: degrees by which the vertical joints are off a right angle to the axis; `friction` of the two sloping
/// joints, `ends` of the vertical ones.
std::string roof(std::string_view stress, double azimuth = 0, std::string_view more = "", double depth = 0,
                 double skew = 0, double friction = 35, double ends = 35) {
  const double a = azimuth * pi / 180;
  const auto at = [&](double x, double y, double z) {
    return fmt::format("[{:.17g}, {:.17g}, {:.17g}]", x * std::cos(a) + y * std::sin(a),
                       y * std::cos(a) - x * std::sin(a), z + depth);
  };
  std::string text =
      fmt::format("[domain]\nbox = {{ min = [-30, -30, {}], max = [30, 30, {}] }}\n", depth - 15, depth + 15);
  for (const auto& [y, dip, direction] : {std::tuple{0.0, 60.0, 90.0}, {0.0, 60.0, 270.0}}) {
    text += fmt::format("[[joint]]\nplane = {{ through = {}, dip = {}, dip_direction = {} }}\n", at(0, y, apex), dip,
                        std::fmod(direction + azimuth, 360));
  }
  for (const double y : {-length / 2, length / 2}) {
    text += fmt::format("[[joint]]\nplane = {{ through = {}, dip = 90, dip_direction = {} }}\nfriction = {}\n",
                        at(0, y, 0), azimuth + skew, ends);
  }
  text += fmt::format(
      "[joints.default]\nfriction = {}\n[rock]\ndensity = {}\npoisson = {}\n[[excavation]]\nname = \"tunnel\"\n"
      "kind = \"tunnel\"\nsection = {{ shape = \"circle\", radius = {}, segments = 32 }}\naxis = [{}, {}]\n"
      "[field_stress]\nstress = {}\n{}",
      friction, density, nu, radius, at(0, -20, 0), at(0, 20, 0), stress, more);
  return text;
}

/// Kirsch (1898): remote stresses sx, sz (tension positive); normal stress on the plane with normal (nx, nz).
double kirsch(double sx, double sz, double x, double z, double nx, double nz) {
  const double r = std::hypot(x, z), t = std::atan2(z, x), q = radius * radius / (r * r);
  const double mean = (sx + sz) / 2, half = (sx - sz) / 2;
  const double rr = mean * (1 - q) + half * (1 - 4 * q + 3 * q * q) * std::cos(2 * t);
  const double tt = mean * (1 + q) - half * (1 + 3 * q * q) * std::cos(2 * t);
  const double rt = -half * (1 + 2 * q - 3 * q * q) * std::sin(2 * t);
  const double nr = nx * std::cos(t) + nz * std::sin(t), nt = nz * std::cos(t) - nx * std::sin(t);
  return nr * nr * rr + nt * nt * tt + 2 * nr * nt * rt;
}

/// Compression on one sloping face of the prism, N.
double on_face(double sx, double sz) {
  // From the apex down at 60 degrees until the circle.
  const double down = std::sin(pi / 3), out = std::cos(pi / 3);
  const double b = apex * down, end = b - std::sqrt(b * b - apex * apex + radius * radius);
  constexpr int n = 4000;
  double sum = 0;
  for (int k = 0; k < n; ++k) {
    const double s = end * (k + 0.5) / n;
    sum += kirsch(sx, sz, s * out, apex - s * down, down, out) * end / n;
  }
  return -sum * length;
}

/// The prism moved down by steps: the largest factor at which its faces, N falling and S rising until friction, carry
/// the weight somewhere on the way. `slope`: N and upward S of one sloping face, `end` N of one vertical one.
/// `end_stiffness`: shear stiffness of the vertical faces over that of the sloping ones.
double by_steps(double weight, double n, double s, double area, double end, double end_area, double friction,
                double end_friction, double ratio, double end_stiffness = 1) {
  const double c = std::cos(pi / 6), sine = std::sin(pi / 6);
  const auto carries = [&](double factor) {
    const double t = std::tan(friction * pi / 180) / factor, te = std::tan(end_friction * pi / 180) / factor;
    constexpr int steps = 40000;
    const double last = n / (ratio * area * sine) + s / area;
    for (int k = 0; k <= steps; ++k) {
      const double u = last * k / steps;
      const double normal = std::max(0.0, n - ratio * area * u * sine);
      const double shear = std::min(s + area * u * c, normal * t);
      if (2 * (shear * c - normal * sine) + 2 * std::min(end_stiffness * end_area * u, end * te) >= weight) return true;
    }
    return false;
  };
  double low = 0, high = 1e4;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (carries(middle) ? low : high) = middle;
  }
  return low;
}

const ClampedBlock& only_block(const RunResult& r) {
  EXPECT_TRUE(r.field_stress.has_value());
  EXPECT_EQ(r.field_stress->blocks.size(), 1U);
  return r.field_stress->blocks.at(0);
}

/// Compressions of the planes, largest first.
std::vector<double> sorted_forces(const ClampedBlock& block) {
  std::vector<double> out;
  for (const ClampedPlane& plane : block.planes) out.push_back(plane.normal_force.si());
  std::ranges::sort(out, std::greater{});
  return out;
}

TEST(FieldStressScene, ForcesOnTheFacesOfARoofBlockAreKirschs) {
  // Horizontal stress three times the vertical one: the roof is clamped.
  const RunResult r = run_of(roof("[-6e6, -5e6, -2e6, 0, 0, 0]"));
  const ClampedBlock& block = only_block(r);
  ASSERT_EQ(block.planes.size(), 4U);
  const double exact = on_face(-6e6, -2e6);
  int sloping = 0;
  const auto& judged = *std::ranges::find(r.analysis->judgements, block.block, &stability::Judgement::block);
  EXPECT_EQ(judged.mode, stability::Mode::falling);
  EXPECT_TRUE(judged.key);
  EXPECT_EQ(judged.factor_of_safety, 0);  // without clamping nothing holds it
  const ClampedPlane* slope = nullptr;
  const ClampedPlane* end = nullptr;
  geometry::Vec3 sum;
  for (const ClampedPlane& plane : block.planes) {
    const geometry::Vec3 n = r.complex->complex().faces()[plane.face].outward;
    sum += plane.shear_force - plane.normal_force.si() * n;
    (std::abs(n.y) > 0.5 ? end : slope) = &plane;
    if (std::abs(n.y) > 0.5) continue;
    ++sloping;
    EXPECT_NEAR(plane.normal_force.si() / exact, 1, 5e-3);  // 64 chords in place of the circle
  }
  EXPECT_EQ(sloping, 2);
  // The field has no weight of its own and the roof is free: its forces balance, shear and all.
  EXPECT_LT(geometry::norm(sum), 5e-3 * exact);
  const double up = slope->shear_force.z / std::cos(pi / 6);
  double least = 1e9;
  for (const double ratio : {1.0, 10.0, 100.0, 1000.0}) {
    least = std::min(least, by_steps(judged.weight.si(), slope->normal_force.si(), up, slope->area.si(),
                                     end->normal_force.si(), end->area.si(), 35, 35, ratio));
  }
  EXPECT_NEAR(block.factor_of_safety / least, 1, 5e-3);
  EXPECT_GT(block.factor_of_safety, 1);
  EXPECT_EQ(r.field_stress->held, 1U);
  EXPECT_TRUE(
      std::ranges::any_of(r.notes, [](const std::string& n) { return n.starts_with("field stress: 1 unstable"); }));
  EXPECT_TRUE(r.plan.runs(Step::elastic));
}

// Semi-apex angle 30 degrees: with less friction than that the stress squeezes the prism out (Crawford and Bray 1983),
// however large it is.
TEST(FieldStressScene, APrismWiderThanItsFrictionIsSqueezedOut) {
  for (const auto& [friction, held] : {std::pair{25.0, false}, {29.0, false}, {35.0, true}}) {
    for (const std::string_view more : {"", "stiffness_ratio = 1\n", "stiffness_ratio = 50\n"}) {
      const RunResult r = run_of(roof("[-6e6, -5e6, -2e6, 0, 0, 0]", 0, more, 0, 0, friction, 0));
      EXPECT_EQ(only_block(r).factor_of_safety >= 1, held) << friction << " " << more;
      EXPECT_EQ(r.field_stress->held, held ? 1U : 0U);
      EXPECT_LT(only_block(r).factor_of_safety, std::tan(friction * pi / 180) / std::tan(pi / 6));
    }
  }
}

TEST(FieldStressScene, StressAlongTheAxisFollowsInPlaneStrain) {
  // Equal stress across: the in-plane sum stays as it was, so the axial stress does too, all over the end faces.
  const RunResult r = run_of(roof("[-4e6, -1e6, -4e6, 0, 0, 0]"));
  const ClampedBlock& block = only_block(r);
  for (const ClampedPlane& plane : block.planes) {
    if (std::abs(r.complex->complex().faces()[plane.face].outward.y) < 0.5) continue;
    EXPECT_NEAR(plane.normal_force.si() / (1e6 * plane.area.si()), 1, 5e-3);
  }
  EXPECT_NEAR(sorted_forces(block)[0] / on_face(-4e6, -4e6), 1, 5e-3);
}

TEST(FieldStressScene, VerticalStressAlonePullsTheRoofApart) {
  const RunResult r = run_of(roof("[0, 0, -3e6, 0, 0, 0]"));
  const ClampedBlock& block = only_block(r);
  const double exact = on_face(0, -3e6);
  EXPECT_LT(exact, 0);
  for (const ClampedPlane& plane : block.planes) {
    if (std::abs(r.complex->complex().faces()[plane.face].outward.y) < 0.5) {
      EXPECT_NEAR(plane.normal_force.si() / exact, 1, 2e-2);
    }
    EXPECT_LT(plane.normal_force, Force{});
  }
  EXPECT_EQ(block.factor_of_safety, 0);
  EXPECT_EQ(block.compression, Force{});
}

TEST(FieldStressScene, ATurnedSceneHasTheSameForces) {
  // Stress at an angle to the tunnel: shear along the axis, which the plane problem does not hold.
  const double a = 30 * pi / 180, c = std::cos(a), s = std::sin(a);
  const auto straight = sorted_forces(only_block(run_of(roof("[-6e6, -3e6, -2e6, 1.5e6, 0.5e6, 0]"))));
  // Rotated clockwise by `a`: x' = (c, -s), y' = (s, c).
  const double xx = -6e6, yy = -3e6, xy = 1.5e6, yz = 0.5e6;
  const auto turned = sorted_forces(only_block(run_of(roof(
      fmt::format("[{}, {}, -2e6, {}, {}, {}]", c * c * xx + 2 * c * s * xy + s * s * yy,
                  s * s * xx - 2 * c * s * xy + c * c * yy, (yy - xx) * c * s + xy * (c * c - s * s), c * yz, s * yz),
      30))));
  ASSERT_EQ(straight.size(), turned.size());
  for (std::size_t k = 0; k < straight.size(); ++k)
    EXPECT_NEAR(turned[k] / straight[0], straight[k] / straight[0], 2e-3);
}

TEST(FieldStressScene, ShearAlongTheAxisPressesOnObliqueFaces) {
  // Undisturbed shear xy along a tunnel in y: around the hole xy is tau (1 - a^2 (x^2 - z^2) / r^4).
  const double skew = 30, angle = skew * pi / 180, tau = 2e6;
  const auto on_skewed = [&](double shear) {
    const RunResult r = run_of(roof(fmt::format("[-6e6, -5e6, -2e6, {}, 0, 0]", shear), 0, "", 0, skew));
    std::vector<double> out;
    for (const ClampedPlane& plane : only_block(r).planes) {
      if (std::abs(r.complex->complex().faces()[plane.face].outward.z) < 1e-6) out.push_back(plane.normal_force.si());
    }
    return out;
  };
  const auto with = on_skewed(tau), without = on_skewed(0);
  ASSERT_EQ(with.size(), 2U);
  // The face seen along the axis: above the circle, below the two sloping joints.
  double area = 0, sum = 0;
  constexpr int n = 1500;
  const double step = apex / n;
  for (int i = -n; i < n; ++i) {
    for (int k = 0; k < n; ++k) {
      const double x = (i + 0.5) * step, z = (k + 0.5) * step, r2 = x * x + z * z;
      if (r2 < radius * radius || z > apex - std::abs(x) * std::tan(pi / 3)) continue;
      area += step * step;
      sum += step * step * (1 - radius * radius * (x * x - z * z) / (r2 * r2));
    }
  }
  EXPECT_GT(sum, 1.3 * area);
  const double exact = -2 * std::sin(angle) * std::cos(angle) * tau * sum / std::cos(angle);
  for (const std::size_t k : {0U, 1U}) EXPECT_NEAR((with[k] - without[k]) / exact, 1, 2e-2);
}

TEST(FieldStressScene, DeepBelowTheGroundTheHalfPlaneIsThePlane) {
  // 300 m deep: the surface is a hundred radii away.
  const double weight = density * gravity, down = -300 * weight;
  const auto forces = [&](std::string_view more, double level) {
    return sorted_forces(only_block(run_of(roof(fmt::format("[{0}, {0}, {0}, 0, 0, 0]", level), 0, more, -300))));
  };
  const auto plane = forces("", down);
  const auto half = forces(fmt::format("gradient = [{0}, {0}, {0}, 0, 0, 0]\nsurface = 0\n", weight), 0);
  for (std::size_t k = 0; k < plane.size(); ++k) EXPECT_NEAR(half[k] / plane[k], 1, 0.03);
}

/// A second tunnel across the first, `y` m from the prism's middle.
std::string across(double y, std::string_view more = "") {
  return fmt::format(
      "[[excavation]]\nname = \"across\"\nkind = \"tunnel\"\nsection = {{ shape = \"circle\", radius = {}, segments = "
      "32 "
      "}}\naxis = [[-30, {}, 0], [30, {}, 0]]\n{}",
      radius, y, y, more);
}

// The section of one tunnel knows nothing of a second one: nearer than two widths of it (12 m) no factor is given.
TEST(FieldStressScene, NothingIsSaidNearAnotherOpening) {
  const std::string stress = "[-6e6, -5e6, -2e6, 0, 0, 0]";
  const RunResult alone = run_of(roof(stress));
  const RunResult near = run_of(roof(stress, 0, across(14)));
  ASSERT_TRUE(near.field_stress.has_value());
  EXPECT_EQ(near.field_stress->tunnels, (std::vector<std::string>{"tunnel", "across"}));
  EXPECT_TRUE(near.field_stress->blocks.empty());
  EXPECT_EQ(near.field_stress->undecided, 1U);
  EXPECT_EQ(near.field_stress->held, 0U);
  EXPECT_TRUE(std::ranges::any_of(near.notes, [](const std::string& n) {
    return n.starts_with("field stress: 1 block that would move is nearer");
  }));
  const RunResult far = run_of(roof(stress, 0, across(18)));
  EXPECT_EQ(far.field_stress->undecided, 0U);
  EXPECT_EQ(only_block(far).factor_of_safety, only_block(alone).factor_of_safety);
  // A heading and the ground are no part of the section either.
  std::string heading = roof(stress);
  heading.replace(heading.find("[0, 20, 0]]"), 11, "[0, 13, 0]]");
  EXPECT_EQ(run_of(heading).field_stress->undecided, 1U);
  EXPECT_EQ(run_of(roof(stress, 0, "[stability]\nfree = [\"top\"]\n")).field_stress->undecided, 1U);
}

TEST(FieldStressScene, StiffnessesOfTheSetsTakeThePlaceOfTheirRatio) {
  const auto with_sets = [](double normal, double shear, double end_normal, double end_shear) {
    // So little stress that the block has to come out a little until its joints carry it.
    std::string text = roof("[-5e4, -5e4, -2e4, 0, 0, 0]");
    std::size_t joint = 0;
    for (std::size_t at = text.find("[[joint]]\n"); at != std::string::npos; at = text.find("[[joint]]\n", at + 1)) {
      text.insert(at + 10, joint++ < 2 ? "set = \"slope\"\n" : "set = \"end\"\n");
    }
    return text + fmt::format(
                      "[joints.slope]\nnormal_stiffness = {}\nshear_stiffness = {}\n[joints.end]\n"
                      "normal_stiffness = {}\nshear_stiffness = {}\n",
                      normal, shear, end_normal, end_shear);
  };
  const auto ratio = run_of(roof("[-5e4, -5e4, -2e4, 0, 0, 0]", 0, "stiffness_ratio = 8\n"));
  const auto same = run_of(with_sets(8e9, 1e9, 8e9, 1e9));
  EXPECT_NEAR(only_block(same).factor_of_safety / only_block(ratio).factor_of_safety, 1, 1e-9);
  // Of unequal stiffness: the steps of an oracle.
  const auto unequal = run_of(with_sets(8e9, 1e9, 1e9, 1e5));
  const ClampedBlock& block = only_block(unequal);
  const ClampedPlane* slope = nullptr;
  const ClampedPlane* end = nullptr;
  for (const ClampedPlane& plane : block.planes) {
    (std::abs(unequal.complex->complex().faces()[plane.face].outward.y) > 0.5 ? end : slope) = &plane;
  }
  const auto& judged = *std::ranges::find(unequal.analysis->judgements, block.block, &stability::Judgement::block);
  const double exact = by_steps(judged.weight.si(), slope->normal_force.si(), slope->shear_force.z / std::cos(pi / 6),
                                slope->area.si(), end->normal_force.si(), end->area.si(), 35, 35, 8, 1e-4);
  EXPECT_NEAR(block.factor_of_safety / exact, 1, 5e-3);
  EXPECT_GT(std::abs(block.factor_of_safety / only_block(same).factor_of_safety - 1), 0.01);
  std::string one = with_sets(8e9, 1e9, 8e9, 1e9);
  one.erase(one.rfind("normal_stiffness"));
  EXPECT_NE(error_of(one).find("joints.end.normal_stiffness: is missing, and other sets have it"), std::string::npos);
}

// Semi-apex angle 30 degrees: with the friction drawn the prism is held above it and squeezed out below.
TEST(FieldStressScene, AnEnsembleCountsWhatTheStressHolds) {
  std::string text = roof("[-6e6, -5e6, -2e6, 0, 0, 0]", 0, "[monte_carlo]\nrealizations = 12\n", 0, 0, 35, 0);
  const std::size_t at = text.find("friction = 35\n");
  text.replace(at, 14, "friction = { distribution = \"uniform\", min = 20, max = 40 }\n");
  const Scene scene = scene_of(text);
  const Shared shared = shared_by_realizations(scene);
  std::uint64_t held = 0;
  for (std::uint64_t k = 0; k < 12; ++k) {
    const stochastic::Record record = make_record(scene, shared, k);
    ASSERT_TRUE(record.clamped.has_value());
    EXPECT_EQ(record.all.count, 1U);
    StageTimer timer;
    Progress progress{ProgressStyle::quiet};
    const auto single = run(scene, {.realization = k}, timer, progress);
    ASSERT_TRUE(single && single->field_stress);
    EXPECT_EQ(record.clamped->held, single->field_stress->held);
    EXPECT_EQ(record.clamped->held_volume, single->field_stress->held_volume);
    EXPECT_EQ(record, make_record(scene, {.questions = shared.questions}, k));
    held += record.clamped->held;
    EXPECT_EQ(stochastic::quantity_named("clamped_key_block_count")->of(record),
              static_cast<double>(1 - record.clamped->held));
    EXPECT_EQ(stochastic::quantity_named("clamped_probability_of_failure")->of(record),
              static_cast<double>(1 - record.clamped->held));
    EXPECT_EQ(stochastic::quantity_named("clamped_key_block_volume")->of(record),
              record.clamped->held == 1 ? 0 : record.all.volume_m3);
  }
  EXPECT_GT(held, 2U);
  EXPECT_LT(held, 10U);
}

// Which way a section stands is that of its frame: an `up` that leans along the axis only is upright in it.
TEST(FieldStressScene, ADirectionUpThatLeansAlongTheAxisStandsUpright) {
  const auto with_up = [](std::string_view up) {
    std::string text = roof("[0, 0, 0, 0, 0, 0]", 0, "gradient = [1e3, 1e3, 1e3, 0, 0, 0]\n");
    return text.insert(text.find("[field_stress]"), fmt::format("up = {}\n", up));
  };
  EXPECT_TRUE(scene_of(with_up("[0, 0.5, 1]")).field_stress.has_value());
  EXPECT_NE(error_of(with_up("[0.5, 0, 1]")).find("needs a level tunnel with a vertical section"), std::string::npos);
}

TEST(FieldStressScene, MistakesAreNamed) {
  const auto wrong = [](std::string_view stress, std::string_view more) { return error_of(roof(stress, 0, more)); };
  EXPECT_NE(wrong("[1, 2]", "").find("field_stress.stress: must be 6 numbers"), std::string::npos);
  EXPECT_NE(wrong("[0, 0, 0, 0, 0, 0]", "tunnel = \"tunel\"\n").find("did you mean \"tunnel\"?"), std::string::npos);
  EXPECT_NE(wrong("[0, 0, -1e6, 0, 0, 0]", "surface = 100\n").find("carries a traction"), std::string::npos);
  EXPECT_NE(wrong("[-1e6, 0, 0, 0, 0, 0]", "surface = 2\n").find("is not above the tunnel"), std::string::npos);
  EXPECT_NE(wrong("[0, 0, 0, 0, 0, 0]", "gradient = [0, 0, 0, 1, 0, 0]\n").find("shear stress along the tunnel"),
            std::string::npos);
  EXPECT_NE(wrong("[0, 0, 0, 0, 0, 0]", "sress = 1\n").find("stress"), std::string::npos);
  EXPECT_NE(wrong("[0, 0, 0, 0, 0, 0]", "tunnel = [\"tunnel\", \"tunnel\"]\n").find("twice"), std::string::npos);
  EXPECT_NE(wrong("[0, 0, 0, 0, 0, 0]", "tunnel = []\n").find("names no tunnel"), std::string::npos);
  EXPECT_NE(wrong("[0, 0, 0, 0, 0, 0]", "[joints.x]\nnormal_stiffness = 1e9\n").find("shear_stiffness"),
            std::string::npos);
  std::string no_poisson = roof("[0, 0, 0, 0, 0, 0]");
  no_poisson.erase(no_poisson.find("poisson"), std::string_view{"poisson = 0.25\n"}.size());
  EXPECT_NE(error_of(no_poisson).find("rock.poisson: is missing"), std::string::npos);
}

}  // namespace
}  // namespace cleave::scene::test
