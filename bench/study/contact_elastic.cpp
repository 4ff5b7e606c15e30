/// Study "contact_elastic": closed assemblies of elastic blocks (arches, walls and roofs between abutments) under their
/// own weight, at random moduli (1 to 100 GPa), frictions (10 to 60 degrees) and steps (1e-5 to 1e-2 s). Each assembly
/// is asked twice: the groups of contacts of its first step, cold, are judged by the suite's own residual (`error`),
/// and steps of the world by what a step must not do: bodies that share space, forces outside of their cones, slip
/// against nothing, energy from nowhere. A row ends `converged`, or `stopped` by a status. Ends with 1 when an answer
/// called converged is wrong. `condition` is the number of contacts.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "../contact_suite/suite.hpp"
#include "cleave/core/rng.hpp"
#include "contact_families.hpp"
#include "elastic_body.hpp"
#include "study.hpp"

namespace cleave {
namespace {

using bem::Vec2;
using dbem::Body;
using dbem::World;
using Ring = std::vector<Vec2>;
using std::numbers::pi;

constexpr double g = 9.81;
constexpr double degree = pi / 180;
constexpr std::size_t all_modes = 1000;

Body fixed(Ring outline) {
  Body body{.name = "", .outline = std::move(outline)};
  body.held = {true, true, true};
  return body;
}

Ring rectangle(double x, double y, double width, double height) {
  return {{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}};
}

struct Draw {
  std::string family;
  std::size_t blocks = 0;
  double young = 0, friction = 0, step = 0;  // Pa, degrees, s
  std::size_t modes = all_modes;
  std::size_t per_side = 1;  // elements
};

/// Makes elastic blocks; equal ones once.
class Blocks final {
 public:
  explicit Blocks(const Draw& draw) : draw_{draw} {}
  /// A block of these sides with its lower left corner there.
  Body brick(double x, double y, double width, double height) {
    auto& kept = made_[{width, height}];
    if (kept.outline.empty()) kept = make(rectangle(0, 0, width, height));
    Body out = kept;
    out.origin += {x, y};
    return out;
  }
  [[nodiscard]] Body make(const Ring& ring) const {
    return support::elastic_body(ring, {.young = draw_.young, .poisson = 0.2}, draw_.per_side, draw_.modes);
  }

 private:
  Draw draw_;
  std::map<std::pair<double, double>, Body> made_;
};

/// Voussoirs of half a circle on a floor, radius 5 m.
std::vector<Body> arch(const Draw& draw, Rng& rng) {
  Blocks blocks{draw};
  std::vector<Body> out{fixed(rectangle(-8, -1, 16, 1))};
  const double thick = 5 * (0.12 + 0.15 * rng.uniform());
  const auto at = [](double r, double angle) { return Vec2{r * std::cos(angle), r * std::sin(angle)}; };
  const auto count = static_cast<double>(draw.blocks);
  for (std::size_t k = 0; k < draw.blocks; ++k) {
    const double from = pi * static_cast<double>(k) / count, to = pi * static_cast<double>(k + 1) / count;
    out.push_back(
        blocks.make({at(5 - thick / 2, from), at(5 + thick / 2, from), at(5 + thick / 2, to), at(5 - thick / 2, to)}));
  }
  return out;
}

/// Rows of bricks in running bond between two abutments, all joints closed; `floor`: a wall, else a roof of layers that
/// only the abutments carry.
std::vector<Body> bond(const Draw& draw, Rng& rng, bool floor) {
  Blocks blocks{draw};
  const std::size_t rows = floor
                               ? static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(draw.blocks) / 2)))
                               : 5 + static_cast<std::size_t>(rng.between(0, 3));
  const std::size_t across = std::max<std::size_t>(2, draw.blocks / rows);
  const double width = 0.5, height = 0.25 * static_cast<double>(rng.between(1, 3));
  const double length = width * static_cast<double>(across), high = height * static_cast<double>(rows);
  std::vector<Body> out{fixed(rectangle(-2, -1, 2, high + 2)), fixed(rectangle(length, -1, 2, high + 2))};
  if (floor) out.push_back(fixed(rectangle(0, -1, length, 1)));
  // What rests on nothing is pressed by its abutments, as rock closes on an opening: without that it falls freely
  // first.
  if (!floor) out[1].velocity = {-0.02, 0};
  for (std::size_t r = 0; r < rows; ++r) {
    const double y = height * static_cast<double>(r);
    const bool shifted = r % 2 == 1;
    if (shifted) out.push_back(blocks.brick(0, y, width / 2, height));
    for (std::size_t k = 0; k + (shifted ? 1 : 0) < across; ++k) {
      out.push_back(blocks.brick(width * (static_cast<double>(k) + (shifted ? 0.5 : 0)), y, width, height));
    }
    if (shifted) out.push_back(blocks.brick(length - width / 2, y, width / 2, height));
  }
  return out;
}

std::vector<Body> assembly(const Draw& draw, Rng& rng) {
  if (draw.family == "arch") return arch(draw, rng);
  return bond(draw, rng, draw.family == "wall");
}

/// Triangles from the centroid to the sides, now.
std::vector<Ring> fan(const World& world, std::size_t body) {
  const Ring outline = world.outline(body);
  std::vector<Ring> out;
  if (outline.size() == 4) return {outline};
  const Vec2 middle = dbem::polygon_moments(outline).centroid;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    out.push_back({middle, outline[k], outline[k + 1 == outline.size() ? 0 : k + 1]});
  }
  return out;
}

/// Largest width of what two bodies share over the size of the smaller one.
double shared(const World& world) {
  std::vector<std::vector<Ring>> now;
  std::vector<std::pair<Vec2, Vec2>> box;
  for (std::size_t b = 0; b < world.size(); ++b) {
    now.push_back(fan(world, b));
    auto& [low, high] = box.emplace_back(Vec2{1e300, 1e300}, Vec2{-1e300, -1e300});
    for (const Vec2 p : world.outline(b)) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
  }
  double worst = 0;
  for (std::size_t a = 0; a < now.size(); ++a) {
    for (std::size_t b = a + 1; b < now.size(); ++b) {
      if (world.body(a).held.all() && world.body(b).held.all()) continue;
      if (box[a].second.x <= box[b].first.x || box[b].second.x <= box[a].first.x || box[a].second.y <= box[b].first.y ||
          box[b].second.y <= box[a].first.y) {
        continue;
      }
      const double size = std::sqrt(std::min(dbem::polygon_moments(world.body(a).outline).area,
                                             dbem::polygon_moments(world.body(b).outline).area));
      worst = std::max(worst, testing::widest_common_part(now[a], now[b]) / size);
    }
  }
  return worst;
}

/// Without what loads, moving supports and the parting of bodies brought in: it may only fall.
double own_energy(const World& world) {
  const dbem::Energy& energy = world.energy();
  return energy.total() - energy.work - energy.projected;
}

/// What is wrong with a step that was called right; empty: nothing was found.
std::string wrong_with(const World& world, const dbem::StepReport& report, double friction, double before,
                       double scale) {
  if (!(report.residual <= 1e-8)) return fmt::format("residual {:.2g}", report.residual);
  if (const double overlap = shared(world); !(overlap <= 1e-6)) return fmt::format("overlap {:.2g}", overlap);
  const double gain = (own_energy(world) - before) / scale;
  if (!(gain <= 1e-7)) return fmt::format("energy gained {:.2g}", gain);
  double most = 0;
  for (const dbem::Contact& c : world.contacts()) most = std::max(most, std::abs(c.normal_force));
  for (const dbem::Contact& c : world.contacts()) {
    const double bound = friction * c.normal_force, side = std::abs(c.tangential_force);
    if (c.normal_force < -1e-7 * most) return fmt::format("a contact pulls with {:.2g}", -c.normal_force / most);
    if (side > bound + 1e-7 * most) return fmt::format("outside of the cone by {:.2g}", (side - bound) / most);
    if (side < bound - 1e-6 * most && std::abs(c.slip_velocity) > 1e-6 * (1 + report.max_speed)) {
      return fmt::format("slips at {:.2g} m/s inside the cone", c.slip_velocity);
    }
    if (std::min(side, std::abs(c.slip_velocity)) > 0 && side > 1e-6 * most &&
        c.tangential_force * c.slip_velocity > 1e-7 * most * (1 + report.max_speed)) {
      return "friction pushes on";
    }
  }
  return {};
}

struct Verdict {
  bool converged = false;
  double residual = 0;  // judged
  std::size_t contacts = 0;
  std::string wrong = {}, why = {};
};

/// The groups of the first step from a cold start, judged apart.
Verdict cold(const World& world, double step) {
  Verdict out{.converged = true};
  for (const dbem::ContactProblem& group : world.problems(step)) {
    const dbem::ContactSolution found = dbem::solve(group, {.max_linear_solves = 300});
    out.contacts += group.contacts();
    const double judged = contact_suite::judge(group, found.impulse);
    if (found.report.status == dbem::ContactReport::Status::not_converged) {
      out.converged = false;
      out.why = "the contact law was not met";
      continue;
    }
    out.residual = std::max(out.residual, judged);
    if (!(judged <= 1e-7)) out.wrong = fmt::format("judged residual {:.2g}", judged);
  }
  return out;
}

Verdict stepped(World& world, const Draw& draw, std::size_t steps) {
  Verdict out{.converged = true};
  double weight = 0;
  for (std::size_t b = 0; b < world.size(); ++b) weight += world.body(b).held.all() ? 0 : world.mass(b) * g;
  for (std::size_t k = 0; k < steps; ++k) {
    const double before = own_energy(world);
    const auto report = world.step();
    if (!report) {
      out.converged = false;
      out.why = describe(report.error());
      return out;
    }
    out.residual = std::max(out.residual, report->residual);
    out.contacts = std::max(out.contacts, report->contacts);
    out.wrong = wrong_with(world, *report, std::tan(draw.friction * degree), before, weight * 0.5);
    if (!out.wrong.empty()) return out;
  }
  return out;
}

struct Share {
  int all = 0, solved = 0, stopped = 0, wrong = 0;
  double slowest = 0;  // s of processor time for each 100 blocks and step
};

void study_elastic(study::Study& study) {
  const std::vector<std::size_t> sizes =
      study.quick() ? std::vector<std::size_t>{60} : std::vector<std::size_t>{60, 120, 250, 500};
  const int draws = study.quick() ? 1 : 5;
  const std::size_t steps = study.quick() ? 2 : 10;
  std::map<std::string, Share> shares;
  std::uint64_t seed = 18000;
  for (const std::string family : {"arch", "wall", "roof"}) {
    for (const std::size_t blocks : sizes) {
      for (int k = 0; k < draws; ++k) {
        for (const std::size_t modes : {all_modes, std::size_t{12}}) {
          if (modes == 12 && (study.quick() || blocks > 120)) continue;  // seconds a step
          Rng rng{seed + static_cast<std::uint64_t>(k)};
          const Draw draw{.family = family,
                          .blocks = blocks,
                          .young = std::pow(10.0, 9 + 2 * rng.uniform()),
                          .friction = 10 + 50 * rng.uniform(),
                          .step = std::pow(10.0, -5 + 3 * rng.uniform()),
                          .modes = modes,
                          .per_side = modes == all_modes ? 1U : 3U};
          dbem::Laws laws;
          laws.otherwise.friction = std::tan(draw.friction * degree);
          auto world = World::make(assembly(draw, rng), laws, {.gravity = {0, -g}, .step = draw.step});
          if (!world) {
            study.broken("an assembly was refused: " + describe(world.error()));
            continue;
          }
          for (const bool once : {true, false}) {
            Verdict verdict;
            study::Row row{
                .problem = fmt::format("{}/{}/{}", family, blocks, k),
                .method = once ? "cold" : "steps",
                .setting = fmt::format("modes={} E={:.2e} friction={:.1f} dt={:.2e}", modes == all_modes ? "all" : "12",
                                       draw.young, draw.friction, draw.step),
                .error = std::nullopt,
                .cost = study.measure([&] { verdict = once ? cold(*world, draw.step) : stepped(*world, draw, steps); },
                                      0, 1),
                .condition = static_cast<double>(verdict.contacts),
                .status = study::Status::stopped};
            row.condition = static_cast<double>(verdict.contacts);
            if (verdict.converged) {
              row.status = study::Status::converged;
              row.error = verdict.residual;
            }
            Share& share = shares[fmt::format("{:5} {:5} modes {}", family, once ? "cold" : "steps",
                                              modes == all_modes ? "all" : "12")];
            ++share.all;
            share.solved += verdict.converged ? 1 : 0;
            share.stopped += verdict.converged ? 0 : 1;
            share.slowest = std::max(share.slowest, row.cost.cpu_s / (once ? 1.0 : static_cast<double>(steps)) * 100 /
                                                        static_cast<double>(blocks));
            if (!verdict.wrong.empty()) {
              ++share.wrong;
              study.broken(fmt::format("{} {} {}: {}", row.problem, row.method, row.setting, verdict.wrong));
            }
            if (!verdict.why.empty()) fmt::print("# {} {}: {}\n", row.problem, row.method, verdict.why);
            study.add(std::move(row));
          }
        }
      }
      seed += 100;
    }
  }
  std::string table =
      "| family | asked | solved | ended with a status | wrong | s for 100 blocks and step, at most "
      "|\n|---|---|---|---|---|---|\n";
  for (const auto& [name, s] : shares) {
    table += fmt::format("| {} | {} | {} | {} | {} | {:.2g} |\n", name, s.all, s.solved, s.stopped, s.wrong, s.slowest);
  }
  fmt::print("\n{}", table);
  study.text("shares.md", table);
}

}  // namespace
}  // namespace cleave

int main(int argc, char** argv) { return cleave::study::run("contact_elastic", argc, argv, cleave::study_elastic); }
