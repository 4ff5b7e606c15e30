/// Siconos (Acary et al.; python3-siconos), in a process of its own: its contacts are found by Bullet in single
/// precision, whose names are those of Bullet in double precision. See engine_siconos.py.

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "engines.hpp"

namespace cleave::study::engines {
namespace {

using Json = nlohmann::json;

Json to_json(Vec3 v) { return {v.x, v.y, v.z}; }
Json to_json(Turn t) { return {t.w, t.x, t.y, t.z}; }

/// Exit code of the script with the scene (none: whether Siconos is there); its answer goes to a file.
int call(std::string scene, const std::string& answer) {
  std::string script = CLEAVE_SOURCE_DIR "/bench/study/engine_siconos.py", python = "/usr/bin/python3";
  std::string name = "timeout", most = "200";
  std::vector<char*> arguments{name.data(), most.data(), python.data(), script.data()};
  if (!scene.empty()) arguments.push_back(scene.data());
  arguments.push_back(nullptr);
  setenv("OMP_NUM_THREADS", "1", 1);  // NOLINT(concurrency-mt-unsafe)
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, answer.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int failed = posix_spawnp(&child, "timeout", &files, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  int status = 0;
  if (failed != 0 || waitpid(child, &status, 0) != child || !WIFEXITED(status)) return 1;
  return WEXITSTATUS(status);
}

/// `wide`: contacts count from 0.4 m, at a scale of 20, else from its 2 cm. `afresh`: pairs are looked for anew in
/// every step. `thin`: edges are rounded by a hundredth of a body, else by a tenth. `implicit`: theta 1, else a half.
Json described(const Scene& scene, const Setting& setting, const std::vector<double>& times) {
  Json out{{"step", setting.step},
           {"times", times},
           {"gravity", to_json(scene.gravity)},
           {"restitution", scene.restitution},
           {"theta", setting.way.contains("implicit") ? 1.0 : 0.5},
           {"iterations", setting.iterations > 0 ? setting.iterations : 1000},
           {"breaking", setting.way.contains("wide") ? 0.4 : 0.02},
           {"scale", setting.way.contains("wide") ? 20.0 : 1.0},
           {"afresh", setting.way.contains("afresh")},
           {"bodies", Json::array()},
           {"floors", Json::array()}};
  // Of its own 10 cm, which do not fit thin bodies, or a tenth of that.
  const double margin = setting.way.contains("thin") ? 0.01 : 0.1;
  for (const Body& b : scene.bodies) {
    const MassOf m = mass_of(b);
    const motion::Symmetric& j = m.inertia;
    Json vertices = Json::array();
    for (const Vec3 v : b.shape.vertices) vertices.push_back(to_json(v));
    const Vec3 spin = b.turn.back(b.spin), s = b.sides.value_or(Vec3{1, 1, 1});
    out["bodies"].push_back({{"sides", b.sides ? to_json(*b.sides) : Json{}},
                             {"vertices", vertices},
                             {"margin", margin * std::min({1.0, s.x, s.y, s.z})},
                             {"at", to_json(b.at)},
                             {"turn", to_json(b.turn)},
                             {"velocity", to_json(b.velocity)},
                             {"spin", to_json(spin)},
                             {"mass", m.mass},
                             {"inertia", {{j.xx, j.xy, j.zx}, {j.xy, j.yy, j.yz}, {j.zx, j.yz, j.zz}}},
                             {"friction", b.friction}});
  }
  for (const Floor& f : scene.floors) {
    out["floors"].push_back(
        {{"at", to_json(f.turn * Vec3{0, 0, -0.5})}, {"turn", to_json(f.turn)}, {"friction", f.friction}});
  }
  return out;
}

Outcome understood(const Json& answer) {
  Outcome out;
  for (const Json& frame : answer.at("frames")) {
    std::vector<Pose>& poses = out.frames.emplace_back();
    for (const Json& body : frame) {
      std::vector<double> q;
      for (const Json& x : body) q.push_back(x.is_number() ? x.get<double>() : std::nan(""));
      const Turn turn{.w = q.at(3), .x = q.at(4), .y = q.at(5), .z = q.at(6)};
      poses.push_back({.at = {q[0], q[1], q[2]},
                       .turn = turn,
                       .velocity = {q.at(7), q.at(8), q.at(9)},
                       .spin = turn * Vec3{q.at(10), q.at(11), q.at(12)}});
    }
  }
  out.wall_s = answer.at("wall").get<double>();
  out.cpu_s = answer.at("cpu").get<double>();
  return out;
}

class Siconos final : public Engine {
 public:
  [[nodiscard]] std::string name() const override { return "siconos"; }
  [[nodiscard]] bool present() const override {
    static const bool there = call("", "/dev/null") == 0;
    return there;
  }
  [[nodiscard]] Outcome run(const Scene& scene, const Setting& setting, const std::vector<double>& times) override {
    const std::string stem =
        (std::filesystem::temp_directory_path() / ("cleave-engines-" + std::to_string(getpid()))).string();
    const std::string asked = stem + ".json", answer = stem + "-answer.json";
    std::ofstream{asked} << described(scene, setting, times);
    const int code = call(asked, answer);
    std::ifstream file{answer};
    const Json json = code == 0 ? Json::parse(file, nullptr, false) : Json{};
    std::filesystem::remove(asked);
    std::filesystem::remove(answer);
    if (code == 124) return {.frames = {}, .stopped = "took more than 200 s"};
    if (!json.is_object()) return {.frames = {}, .stopped = "gave up"};
    return understood(json);
  }
};

}  // namespace

Engine& siconos_engine() {
  static Siconos engine;
  return engine;
}

}  // namespace cleave::study::engines
