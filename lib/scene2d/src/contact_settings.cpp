#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "body_keys.hpp"
#include "cleave/core/nearest.hpp"
#include "contact_parts.hpp"

namespace cleave::scene {
namespace {

using bem::Vec2;
using std::string_view;

/// What a scene may ask for.
constexpr std::array solvers{dbem::Method::cascade, dbem::Method::open_close, dbem::Method::newton,
                             dbem::Method::continuation, dbem::Method::lemke};
constexpr auto solver_names = [] {
  std::array<string_view, solvers.size()> names;
  for (std::size_t k = 0; k < names.size(); ++k) names[k] = dbem::name_of(solvers[k]);
  return names;
}();

constexpr NumberRule downwards_rule =
    rule::as_gravity({0, false, 1e3, false, " m/s2, downwards (a direction: [x, y])"});
constexpr std::array<string_view, 1> auto_word{"auto"};
/// Of a body's size: a point so near to it lies in an open joint, and moves with the body that it names.
constexpr double in_a_gap = 0.01;
/// Of the scene's extent, as a limit of the move in a step. Contacts are closed within 1e-9: less is no move.
constexpr NumberRule move_rule{1e-8, false, 1, false, ""};

constexpr NumberRule rock_strength_rule = NumberRule{0, false, 1e12, false, " Pa"}.usually(1e3, 1e9);

const KeyTable& rock_strength_keys() {
  static const KeyTable keys{.name = "contact.strength",
                             .keys = {{"cohesion", key::number(rock_strength_rule), required, "Pa"},
                                      {"friction", key::number({0, false, 89, false, " degrees"}), required, "degrees"},
                                      {"tension", key::number(rock_strength_rule), required, "Pa"}}};
  return keys;
}

const KeyTable& history_point_keys() {
  static const KeyTable keys{.name = "contact.points", .keys = history_keys()};
  return keys;
}

/// Extent of what moves (of everything when nothing does).
double size_of(const ContactScene& scene, bool height) {
  double low = 1e300, high = -1e300;
  for (const bool all : {false, true}) {
    for (const ContactBody& body : scene.bodies) {
      if (body.fixed && !all) continue;
      for (const Vec2 p : body.corners) {
        low = std::min(low, height ? p.y : p.x);
        high = std::max(high, height ? p.y : p.x);
      }
    }
    if (high > low) return high - low;
  }
  return 1;
}

/// The body that holds the point, or on whose outline it lies; one that moves goes before fixed ones.
std::optional<std::size_t> body_at(const std::vector<ContactBody>& bodies, Vec2 at) {
  std::optional<std::size_t> best;
  const auto take = [&](std::size_t b) {
    if (!best || (bodies[*best].fixed && !bodies[b].fixed)) best = b;
  };
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (holds(bodies[b], at) || lies_on(bodies[b], at)) take(b);
  }
  return best;
}

/// From a point to the outline of a body, m.
double distance_to(const ContactBody& body, Vec2 at) {
  double least = 1e300;
  for (std::size_t k = 0; k < body.corners.size(); ++k) {
    const Vec2 a = body.corners[k], d = body.corners[(k + 1) % body.corners.size()] - a;
    least = std::min(least, norm(at - a - std::clamp(dot(at - a, d) / dot(d, d), 0.0, 1.0) * d));
  }
  return least;
}

/// Of a point that lies in no body: which is nearest, but for `known`. Empty: there is none.
std::string nearest_body(const std::vector<ContactBody>& bodies, Vec2 at, const ContactBody* known = nullptr) {
  const ContactBody* best = nullptr;
  double least = 1e300;
  for (const ContactBody& body : bodies) {
    const double d = distance_to(body, at);
    if (d < least) {
      least = d;
      best = &body;
    }
  }
  if (best == nullptr || best == known) return "";
  return fmt::format("; the nearest is \"{}\", {:.3g} m away", best->name, least);
}

}  // namespace

namespace {

const KeyTable& ground_record_keys() {
  static const KeyTable keys{.name = "contact.ground.record",
                             .keys = record_keys({{"x", "m/s2 to the right, the first at 0 s; 0 after the last"},
                                                  {"y", "m/s2 upwards, likewise"}})};
  return keys;
}

const KeyTable& ground_keys() {
  static const KeyTable keys{
      .name = "contact.ground",
      .keys = {{"acceleration", key::pair(ground_rule), "", "`[x, y]` in m/s2, times `time`"},
               {"time", key::table(&time_function_keys), "constant",
                "as of a load: `step`, `ramp`, `pulse` or `harmonic`"},
               {"record", key::table(&ground_record_keys), "", "`{ step, x, y, scale }`: an accelerogram"}},
      .one_of = {{"acceleration", "record"}}};
  return keys;
}

void parse_ground(const TableReader& contact, ContactScene& scene) {
  const auto found = contact.sub("ground");
  if (!found) return;
  const TableReader& table = *found;
  if (table.one_of() == nullptr) return;
  if (scene.settings.to_rest) {
    contact.error("ground", "moves, but static = true knows no time", "remove ground, or static = true");
  }
  if (std::ranges::any_of(scene.bodies, &ContactBody::clamped)) {
    contact.error("ground", "moves, but a body with `support` vibrates about a ground at rest",
                  "make that body fixed, or let it rest on a fixed one");
  }
  scene.settings.ground = parse_course(table, pair(table, "acceleration").value_or(Vec2{}));
}

}  // namespace

const KeyTable& support_motion_keys() {
  static const KeyTable keys{
      .name = "body.motion",
      .keys = {{"velocity", key::pair(speed_rule), "", "`[x, y]` in m/s, times `time`"},
               {"acceleration", key::pair(rule::acceleration), "", "`[x, y]` in m/s2, times `time`; from rest"},
               {"time", key::table(&time_function_keys), "constant",
                "as of a load: `step`, `ramp`, `pulse` or `harmonic`"},
               {"record", key::table(&ground_record_keys), "", "`{ step, x, y, scale }`: an accelerogram, from rest"}},
      .one_of = {{"velocity", "acceleration", "record"}}};
  return keys;
}

void parse_support_motion(const TableReader& body, ContactBody& spec) {
  const auto found = body.sub("motion");
  if (!found) return;
  const TableReader& table = *found;
  const TomlEntry* kind = table.one_of();
  if (kind == nullptr) return;
  SupportMotion motion{.course = {}, .is_velocity = kind->key == "velocity"};
  motion.course = parse_course(table, kind->key == "record" ? Vec2{} : pair(table, kind->key).value_or(Vec2{}));
  if (!spec.fixed)
    body.error("motion", "is that of a fixed body", "write fixed = true, or give it a velocity or a load");
  spec.motion = std::move(motion);
}

const KeyTable& contact_keys() {
  static const KeyTable keys{
      .name = "contact",
      .keys = {
          {"duration", key::number(time_rule), "", "s; with `static` the longest relaxation"},
          {"step", key::number(time_rule), "from size, speed and how fast loads change",
           "s, the first step; it is cut where contacts do not converge or bodies move too far"},
          {"max_step", key::number(time_rule), "`step`", "s; when larger, steps grow while little moves"},
          {"static", key::flag(), "false",
           "true: relax to rest (implicit steps, each from rest, so without `velocity` and loads in time); no rest "
           "found: exit code 4"},
          {"gravity", key::either({key::number(downwards_rule), key::pair(rule::acceleration)}), "9.81",
           "m/s2 downwards (not negative), or `[x, y]`"},
          {"ground", key::table(&ground_keys), "at rest",
           "its motion: bodies feel the opposite acceleration, and all results are relative to the ground (what is "
           "`fixed`); not with `static`"},
          {"rigid", key::either({key::flag(), key::word(auto_word)}), "\"auto\"",
           "`true`: three freedoms a body; `false`: elastic; `\"auto\"`: elastic where a body is clamped or strains "
           "may "
           "reach 1e-4; `cleave plan` says which and why"},
          {"solver", key::word(solver_names), "\"cascade\"",
           "`open_close` (that of Fu 2014), `newton`, `continuation`, `lemke`, or all of them, cheapest first"},
          {"restitution", key::number({0, false, 1, false, ""}), "0",
           "of the normal velocity at impacts of rigid bodies"},
          {"max_displacement", key::number(move_rule), "0.05",
           "of the scene's extent: no corner moves further in one step", "largest_move"},
          {"points", key::tables(&history_point_keys), "[]",
           "`[{ name, at = [x, y], body }]`: histories in points.csv, summary.json and the report"},
          {"frames", key::whole(1, 5000), "120", "pictures kept for the animation and the VTU series"},
          {"plane", key::word<bem::PlaneState>(), "\"strain\"", "of elastic bodies: plane strain or plane stress"},
          {"element", key::number(rule::length), "a quarter of the body",
           "m, longest element of elastic bodies; a body has at most 500"},
          {"modes", key::whole(0, 10'000), "0", "of an elastic body; 0: all, which keeps static compliance exact"},
          {"estimate", key::flag(), "false",
           "true: an estimate of the error of the steps, by three more runs with steps up to 6.5 times as long"},
          {"strength", key::table(&rock_strength_keys), "",
           "`{ cohesion, friction, tension }` of the rock of elastic bodies (Pa, degrees, Pa): `safety` of their "
           "stress"},
          {"in_situ", key::table(&in_situ_keys), "",
           "`{ stress, level, gradient }`: stress of the rock at the start, locked in elastic bodies (in each that at "
           "its centroid)"},
          {"work", key::number({0, true, 1e9, false, ""}), "none",
           "10^9 operations the run may take, counted, not timed (some 0.4 s each): beyond it the run stops with exit "
           "code 4 and keeps what is done"},
          {"damping", key::number({0, false, 10, false, ""}), "0", "share of critical damping of elastic vibrations"},
          {"mass_damping", key::number({0, false, 1e6, false, " 1/s"}), "0",
           "1/s, of all motion: each body is slowed by this times its mass and velocity; not with `static`"}}};
  return keys;
}

void parse_settings(const TableReader& table, ContactScene& scene) {
  ContactSettings& s = scene.settings;
  if (const TomlEntry* g = table.find("gravity")) {
    if (std::holds_alternative<TomlArray>(g->node.value)) {
      s.gravity = pair(table, "gravity").value_or(Vec2{});
      if (s.gravity.y > 0) {
        table.note("gravity", "points upwards, as y does: bodies would fall upwards",
                   "write gravity = 9.81, or [0, -9.81]");
      }
    } else {
      s.gravity = {0, -table.number("gravity").value_or(0)};
    }
  }
  s.to_rest = table.flag("static");
  parse_ground(table, scene);
  double smallest = 1e300, fastest = 0, load_time = s.ground ? s.ground->fastest().si() : 1e300;
  for (const ContactBody& body : scene.bodies) {
    if (body.motion) load_time = std::min(load_time, body.motion->course.fastest().si());
    if (body.fixed || body.corners.size() < 3) continue;
    Box2 box;
    for (const Vec2 p : body.corners) box.add(p);
    const double size = norm(box.high - box.low);
    for (const ContactLoad& load : body.loads) load_time = std::min(load_time, load.time.fastest().si());
    smallest = std::min(smallest, size);
    fastest = std::max(fastest, norm(body.velocity) + std::abs(body.spin) * size / 2);
  }
  if (smallest == 1e300) smallest = 1;
  const double g = norm(s.gravity);
  // A body falls a few thousandths of its own size from rest, or flies a hundredth of it, in the first step.
  double step = 1e-2;
  if (g > 0) step = 0.05 * std::sqrt(smallest / g);
  if (fastest > 0) step = std::min(step, 0.01 * smallest / fastest);
  step = std::min(step, load_time / 20);
  s.step = table.number("step").value_or(step);
  s.max_step = table.number("max_step").value_or(s.step);
  if (!s.to_rest && std::max(s.step, s.max_step) > load_time / 5) {
    table.note(
        table.has("max_step") ? "max_step" : "step",
        fmt::format("is long for a load that changes within {:.3g} s: only its mean over each step acts", load_time),
        fmt::format("use steps of {:.2g} s", load_time / 20));
  }
  if (s.max_step < s.step) table.error("max_step", "is shorter than step", "make it as long, or longer");
  if (s.to_rest) {
    const double natural = g > 0 ? std::sqrt(size_of(scene, true) / g) : 1;
    s.duration = table.number("duration").value_or(1000 * natural);
  } else {
    if (!table.has("duration"))
      table.missing("duration", "write how long to follow the bodies, in s, or static = true");
    s.duration = table.number("duration").value_or(1);
  }
  if (s.duration / s.step > 5e7) {
    table.error(table.has("step") ? "step" : "duration", "makes more than fifty million steps",
                "use a longer step or a shorter time");
  }
  if (table.has("step") && s.step > s.duration) {
    table.error("step", "is longer than the whole time", "use a shorter step");
  }
  s.solver = solvers[table.choice("solver").value_or(0)];
  s.restitution = table.value("restitution");
  if (const TomlEntry* rigid = table.find("rigid")) {
    const auto* word = std::get_if<std::string>(&rigid->node.value);
    const auto* flag = std::get_if<bool>(&rigid->node.value);
    if (flag != nullptr) {
      s.rigidity = *flag ? Rigidity::rigid : Rigidity::elastic;
    } else if (word == nullptr || *word != "auto") {
      table.error("rigid", "must be true, false or \"auto\"", "write rigid = \"auto\"");
    }
  }
  s.plane = table.word<bem::PlaneState>("plane");
  s.element = table.number("element");
  if (const auto modes = table.count("modes"); modes > 0) s.modes = static_cast<std::size_t>(modes);
  s.damping = table.value("damping");
  s.mass_damping = Rate::from_si(table.value("mass_damping"));
  if (s.to_rest && table.has("mass_damping")) {
    table.error("mass_damping", "slows what moves, but static = true knows no time",
                "remove mass_damping, or static = true");
  }
  s.largest_move = table.value("max_displacement");
  s.frames = static_cast<std::size_t>(table.count("frames"));
  s.estimate = table.flag("estimate");
  if (const auto most = table.number("work")) s.work = 1e9 * *most;
  if (const auto in_situ = table.sub("in_situ")) s.in_situ = parse_in_situ(*in_situ);
  if (const auto strength = table.sub("strength")) {
    s.strength = RockStrength{.cohesion = strength->need_number("cohesion").value_or(0),
                              .friction = strength->need_number("friction").value_or(0),
                              .tension = strength->need_number("tension").value_or(0)};
  }
}

void parse_points(const TableReader& table, ContactScene& scene) {
  std::size_t number = 0;
  for (const TableReader& point : table.each("points")) {
    ++number;
    if (!point.has("at")) point.missing("at", "write at = [x, y]");
    const auto at = pair(point, "at");
    if (!at) continue;
    PointSpec spec{.name = point.text("name").value_or(fmt::format("point {}", number)), .at = *at, .body = 0};
    if (spec.name.empty()) point.error("name", "is empty", "give a name, or remove the key");
    if (std::ranges::find(scene.points, spec.name, &PointSpec::name) != scene.points.end()) {
      point.error("name", fmt::format("\"{}\" is the name of another point, too", spec.name),
                  "give each point a name of its own");
      continue;
    }
    if (const auto wanted = point.text("body")) {
      const auto body = std::ranges::find(scene.bodies, *wanted, &ContactBody::name);
      if (body == scene.bodies.end()) {
        std::vector<string_view> known;
        for (const ContactBody& b : scene.bodies) known.emplace_back(b.name);
        const auto guess = nearest(*wanted, known);
        point.error("body", fmt::format("there is no body \"{}\"", wanted->substr(0, 60)),
                    guess ? fmt::format("did you mean \"{}\"?", *guess) : "name one there is");
        continue;
      }
      spec.body = static_cast<std::size_t>(body - scene.bodies.begin());
      const bool beside = !holds(*body, *at) && !lies_on(*body, *at);
      const double away = beside ? distance_to(*body, *at) : 0;
      if (beside && away <= in_a_gap * size_of(body->corners).si()) {
        point.note("at", fmt::format("lies outside \"{}\": it moves as if it were a part of it", body->name),
                   "write the place at the start of the run");
      } else if (beside) {
        const auto other = body_at(scene.bodies, *at);
        point.error("at",
                    fmt::format("({:.6g}, {:.6g}) lies outside \"{}\", {:.3g} m away{}", at->x, at->y, body->name, away,
                                other ? fmt::format(", in \"{}\"", scene.bodies[*other].name)
                                      : nearest_body(scene.bodies, *at, &*body)),
                    "write a place on that body at the start of the run, or name another body");
        continue;
      }
    } else if (const auto body = body_at(scene.bodies, *at)) {
      spec.body = *body;
    } else {
      point.error("at",
                  fmt::format("({:.6g}, {:.6g}) lies in no body{}", at->x, at->y, nearest_body(scene.bodies, *at)),
                  "write a place on a body at the start of the run");
      continue;
    }
    scene.points.push_back(std::move(spec));
  }
}

}  // namespace cleave::scene
