/// Study "bem_peers": the same plane-strain problems by cleave's boundary elements and by CalculiX (Dhondt and Wittig,
/// Debian's calculix-ccx), quadratic finite elements CPE8 on structured meshes with mid-side nodes on the arcs. Error
/// is the largest error of displacement at the nodes over the largest displacement. Kirsch's infinite plane ends for
/// the finite elements at four radii, where they are given the exact displacement; so the peer has the easier problem.
/// Times of the peer hold its start and its files; without the program its rows say `refused`.

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "bem_problems.hpp"
#include "study.hpp"

extern char** environ;

namespace cleave {
namespace {

using namespace bem;

using study::nu;
constexpr double young = 2 * (1 + nu);  // shear modulus 1

enum class Edge : std::uint8_t { traction, displacement, symmetry_x, symmetry_y };

/// A problem on a map of the unit square: sides t = 0, s = 1, t = 1, s = 0 of it in this order.
struct PeerProblem {
  std::string name;
  std::function<Vec2(double s, double t)> map;
  std::array<Edge, 4> edges;
  std::function<Vec2(Vec2 x)> displacement;
  std::function<Vec2(Vec2 x, Vec2 n)> traction;
  std::size_t aspect;  ///< elements along s for one along t
  Problem problem;     ///< for the boundary elements, elements for the coarsest mesh
};

Vec2 polar(double r, double t) { return {r * std::cos(t), r * std::sin(t)}; }

PeerProblem lame() {
  const study::Exact exact = study::lame();
  return {exact.name,
          [](double s, double t) { return polar(1 + t, (1 - s) * std::numbers::pi / 2); },
          {Edge::traction, Edge::symmetry_y, Edge::displacement, Edge::symmetry_x},
          exact.displacement,
          exact.traction,
          1,
          exact.problem};
}

PeerProblem kirsch() {
  const study::Exact exact = study::kirsch();
  return {exact.name,
          [](double s, double t) { return polar(std::pow(4.0, t), (1 - s) * std::numbers::pi / 2); },
          {Edge::traction, Edge::symmetry_y, Edge::displacement, Edge::symmetry_x},
          exact.displacement,
          exact.traction,
          1,
          exact.problem};
}

PeerProblem cantilever() {
  const study::Exact exact = study::cantilever();
  return {exact.name,
          [](double s, double t) { return Vec2{4 * s, 0.5 * (2 * t - 1)}; },
          {Edge::traction, Edge::traction, Edge::traction, Edge::displacement},
          exact.displacement,
          exact.traction,
          4,
          exact.problem};
}

/// Nodes of 8-node quadrilaterals on a grid of 2 nx by 2 ny half steps; numbers from 1, centres of elements left out.
struct Grid {
  std::size_t nx, ny;
  std::vector<std::size_t> number;  ///< by half step; 0: none
  std::vector<Vec2> nodes;

  Grid(const PeerProblem& p, std::size_t across) : nx{across * p.aspect}, ny{across} {
    number.assign((2 * nx + 1) * (2 * ny + 1), 0);
    for (std::size_t j = 0; j <= 2 * ny; ++j) {
      for (std::size_t i = 0; i <= 2 * nx; ++i) {
        if (i % 2 == 1 && j % 2 == 1) continue;
        nodes.push_back(p.map(static_cast<double>(i) / static_cast<double>(2 * nx),
                              static_cast<double>(j) / static_cast<double>(2 * ny)));
        number[at(i, j)] = nodes.size();
      }
    }
  }
  [[nodiscard]] std::size_t at(std::size_t i, std::size_t j) const { return j * (2 * nx + 1) + i; }
  [[nodiscard]] std::size_t of(std::size_t i, std::size_t j) const { return number[at(i, j)]; }
  /// Node numbers along a side, in the sense that has the body on the left.
  [[nodiscard]] std::vector<std::size_t> side(std::size_t which) const {
    std::vector<std::size_t> out;
    for (std::size_t k = 0; k <= 2 * (which % 2 == 0 ? nx : ny); ++k) {
      out.push_back(which == 0   ? of(k, 0)
                    : which == 1 ? of(2 * nx, k)
                    : which == 2 ? of(2 * nx - k, 2 * ny)
                                 : of(0, 2 * ny - k));
    }
    return out;
  }
};

/// Input of CalculiX, whose fields hold 20 characters. Tractions become the nodal forces of the edges' quadratic shape
/// functions, by 5 Gauss points.
std::string deck(const PeerProblem& p, const Grid& grid) {
  std::string out = "*NODE, NSET=ALL\n";
  for (std::size_t n = 0; n < grid.nodes.size(); ++n) {
    out += fmt::format("{}, {:.11g}, {:.11g}, 0\n", n + 1, grid.nodes[n].x, grid.nodes[n].y);
  }
  out += "*ELEMENT, TYPE=CPE8, ELSET=E\n";
  // The maps of the rings turn the other way: corners must run counter-clockwise.
  const Vec2 a = p.map(0, 0), b = p.map(0.01, 0), c = p.map(0, 0.01);
  const bool mirrored = cross(b - a, c - a) < 0;
  std::size_t element = 0;
  for (std::size_t j = 0; j < 2 * grid.ny; j += 2) {
    for (std::size_t i = 0; i < 2 * grid.nx; i += 2) {
      std::array<std::size_t, 8> n{grid.of(i, j),     grid.of(i + 2, j),     grid.of(i + 2, j + 2), grid.of(i, j + 2),
                                   grid.of(i + 1, j), grid.of(i + 2, j + 1), grid.of(i + 1, j + 2), grid.of(i, j + 1)};
      if (mirrored) n = {n[0], n[3], n[2], n[1], n[7], n[6], n[5], n[4]};
      out += fmt::format("{}, {}\n", ++element, fmt::join(n, ", "));
    }
  }
  out += fmt::format("*MATERIAL, NAME=M\n*ELASTIC\n{:.11g}, {}\n*SOLID SECTION, ELSET=E, MATERIAL=M\n1.\n", young, nu);
  std::vector<Vec2> force(grid.nodes.size());
  std::string held;
  constexpr std::array<double, 5> gs{-0.906179845938664, -0.538469310105683, 0, 0.538469310105683, 0.906179845938664};
  constexpr std::array<double, 5> gw{0.236926885056189, 0.478628670499366, 0.568888888888889, 0.478628670499366,
                                     0.236926885056189};
  for (std::size_t which = 0; which < 4; ++which) {
    const auto side = grid.side(which);
    if (p.edges[which] == Edge::traction) {
      for (std::size_t k = 0; k + 2 < side.size(); k += 2) {
        const std::array<Vec2, 3> x{grid.nodes[side[k] - 1], grid.nodes[side[k + 1] - 1], grid.nodes[side[k + 2] - 1]};
        for (std::size_t g = 0; g < gs.size(); ++g) {
          const double s = gs[g];
          const std::array<double, 3> n{s * (s - 1) / 2, 1 - s * s, s * (s + 1) / 2};
          const std::array<double, 3> d{s - 0.5, -2 * s, s + 0.5};
          Vec2 at, slope;
          for (std::size_t m = 0; m < 3; ++m) {
            at += n[m] * x[m];
            slope += d[m] * x[m];
          }
          const Vec2 normal = (mirrored ? -1.0 : 1.0) / norm(slope) * turned_right(slope);
          for (std::size_t m = 0; m < 3; ++m) {
            force[side[k + m] - 1] += (gw[g] * norm(slope) * n[m]) * p.traction(at, normal);
          }
        }
      }
      continue;
    }
    for (const std::size_t n : side) {
      const Vec2 u = p.displacement(grid.nodes[n - 1]);
      if (p.edges[which] != Edge::symmetry_y) held += fmt::format("{}, 1, 1, {:.11g}\n", n, u.x);
      if (p.edges[which] != Edge::symmetry_x) held += fmt::format("{}, 2, 2, {:.11g}\n", n, u.y);
    }
  }
  out += "*STEP\n*STATIC\n*BOUNDARY\n" + held + "*CLOAD\n";
  for (std::size_t n = 0; n < force.size(); ++n) {
    if (force[n].x != 0) out += fmt::format("{}, 1, {:.11g}\n", n + 1, force[n].x);
    if (force[n].y != 0) out += fmt::format("{}, 2, {:.11g}\n", n + 1, force[n].y);
  }
  return out + "*NODE PRINT, NSET=ALL\nU\n*END STEP\n";
}

bool run_program(const std::filesystem::path& folder) {
  std::string job = (folder / "job").string(), name = "ccx", option = "-i";
  std::array<char*, 4> arguments{name.data(), option.data(), job.data(), nullptr};
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  // It leaves a file of its own where it runs.
  posix_spawn_file_actions_addchdir_np(&files, folder.c_str());
  pid_t child = 0;
  const int failed = posix_spawnp(&child, "ccx", &files, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (failed != 0) return false;
  int status = 0;
  return waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

double of_children() {
  rusage used{};
  getrusage(RUSAGE_CHILDREN, &used);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

/// Largest error at the nodes over the largest displacement; empty when the program is not there or did not finish.
std::optional<double> by_calculix(const PeerProblem& p, std::size_t across, const std::filesystem::path& folder) {
  const Grid grid{p, across};
  std::ofstream{folder / "job.inp"} << deck(p, grid);
  std::filesystem::remove(folder / "job.dat");
  if (!run_program(folder)) return std::nullopt;
  std::ifstream file{folder / "job.dat"};
  std::string line;
  double worst = 0, size = 0;
  std::size_t seen = 0;
  while (std::getline(file, line)) {
    std::istringstream words{line};
    words.imbue(std::locale::classic());
    std::size_t n = 0;
    Vec2 u;
    if (!(words >> n >> u.x >> u.y) || n == 0 || n > grid.nodes.size()) continue;
    const Vec2 exact = p.displacement(grid.nodes[n - 1]);
    worst = std::max(worst, norm(u - exact));
    size = std::max(size, norm(exact));
    ++seen;
  }
  if (seen != grid.nodes.size()) return std::nullopt;
  return worst / size;
}

void study_peers(study::Study& study) {
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("cleave-bem-peers-{}", getpid());
  std::filesystem::create_directories(folder);
  for (const PeerProblem& p : {kirsch(), lame(), cantilever()}) {
    study::Plot plot{.title = p.name + ": error against run time",
                     .x_label = "processor time (s)",
                     .y_label = "relative error of displacement",
                     .series = {}};
    study::Series own{.name = "cleave, quadratic", .points = {}, .line = true, .fit = true};
    study::Series peer{.name = "CalculiX CPE8", .points = {}, .line = true, .fit = true};
    for (std::size_t k = 0; k < (study.quick() ? 2U : 5U); ++k) {
      Options options;
      options.mesh.subdivide = std::size_t{1} << k;
      std::optional<Solution> s;
      const auto cost = study.measure([&] { s = solve(p.problem, options).value(); }, 0.05);
      double worst = 0, size = 0;
      const auto& part = s->regions().front();
      for (std::size_t n = 0; n < part.mesh.nodes.size(); ++n) {
        const Vec2 u = p.displacement(s->node(0, n));
        size = std::max(size, norm(u));
        worst = std::max(worst, norm(part.displacement[n] - u));
      }
      study.add({.problem = p.name,
                 .method = "cleave",
                 .setting = fmt::format("elements={}", part.mesh.elements.size()),
                 .error = worst / size,
                 .cost = cost,
                 .condition = s->diagnostics().condition,
                 .status = study::Status::converged});
      own.points.emplace_back(cost.cpu_s, worst / size);
    }
    for (const std::size_t across :
         study.quick() ? std::vector<std::size_t>{2} : std::vector<std::size_t>{2, 4, 8, 16, 32}) {
      std::optional<double> error;
      double spent = 0;
      int runs = 0;
      auto cost = study.measure(
          [&] {
            const double before = of_children();
            error = by_calculix(p, across, folder);
            spent += of_children() - before;
            ++runs;
          },
          0.2, 3);
      cost.cpu_s += spent / std::max(1, runs);
      study.add({.problem = p.name,
                 .method = "calculix",
                 .setting = fmt::format("cpe8 {}x{}", across * p.aspect, across),
                 .error = error,
                 .cost = cost,
                 .condition = std::nullopt,
                 .status = error ? study::Status::converged : study::Status::refused});
      if (error) peer.points.emplace_back(cost.cpu_s, *error);
      if (!error) break;  // the program is not there
    }
    plot.series.push_back(std::move(own));
    if (!peer.points.empty()) plot.series.push_back(std::move(peer));
    study.plot(p.name, plot);
  }
  std::error_code ignored;
  std::filesystem::remove_all(folder, ignored);
}

}  // namespace
}  // namespace cleave

int main(int argc, char** argv) { return cleave::study::run("bem_peers", argc, argv, cleave::study_peers); }
