#include "monte_carlo_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>
#include <utility>

#include "cleave/core/sha256.hpp"
#include "cleave/load/load.hpp"
#include "cleave/report/write.hpp"
#include "cleave/scene3d/scene.hpp"

namespace cleave::cli {
namespace {

namespace fs = std::filesystem;

OutError wrong(const fs::path& out, std::string_view what, std::string_view remedy) {
  return {ExitCode::wrong_input, fmt::format("{}:1: -o: {}; {}", out.generic_string(), what, remedy)};
}
OutError failed(const fs::path& out, std::string_view what, const std::error_code& reason, std::string_view remedy) {
  return {ExitCode::machine_failed,
          fmt::format("{}:1: -o: {} ({}); {}", out.generic_string(), what, reason.message(), remedy)};
}

std::string first_line(const fs::path& path) {
  std::ifstream file{path, std::ios::binary};
  std::string line;
  std::getline(file, line);
  return line;
}

std::string copy_name(std::size_t number) { return fmt::format("scene_file_{}", number + 1); }

/// Name of the scene file that a result comes from.
std::optional<std::string> scene_name_of(const fs::path& result) {
  const auto text = scene::read_file(result / "summary.json");
  if (!text) return std::nullopt;
  const auto summary = nlohmann::json::parse(*text, nullptr, false);
  if (!summary.is_object()) return std::nullopt;
  const auto name = summary.find("scene_file");
  if (name == summary.end() || !name->is_string()) return std::nullopt;
  return name->get<std::string>();
}

}  // namespace

std::expected<MonteCarloFolder, OutError> MonteCarloFolder::prepare(const fs::path& out, const std::string& header) {
  std::error_code reason;
  if (out.empty()) return std::unexpected(wrong("-o", "the name is empty", "name a folder"));
  if (!fs::exists(fs::symlink_status(out, reason))) {
    fs::create_directories(out, reason);
    if (reason) {
      return std::unexpected(failed(out, "the folder cannot be made", reason, "check the path and its permissions"));
    }
    return MonteCarloFolder{out, false};
  }
  if (!fs::is_directory(out, reason)) {
    return std::unexpected(wrong(out, "is not a folder", "name a new folder with -o"));
  }
  remove_abandoned(out, "");
  fs::directory_iterator entries{out, reason};
  if (reason) return std::unexpected(failed(out, "the folder cannot be read", reason, "check its permissions"));
  bool any = false;
  for (const auto& entry : entries) {
    if (is_result_entry(entry)) {
      any = true;
      continue;
    }
    return std::unexpected(
        wrong(out, fmt::format("the folder holds \"{}\", which is not from cleave", entry.path().filename().string()),
              "name a new or an empty folder with -o"));
  }
  if (!any) return MonteCarloFolder{out, false};
  const bool finished = fs::exists(out / "summary.json", reason);
  if (!finished && !fs::exists(out / unfinished_name, reason) && fs::exists(out / records_name, reason)) {
    // Ended while the files got their final names: all realizations are there.
    if (first_line(out / records_name) == header) fs::rename(out / records_name, out / unfinished_name, reason);
  }
  if (!fs::exists(out / unfinished_name, reason)) {
    if (finished) return MonteCarloFolder{out, false};
    return std::unexpected(
        wrong(out, "the folder holds files but no finished result of cleave", "name a new or an empty folder with -o"));
  }
  const std::string found = first_line(out / unfinished_name);
  // A run that was killed at once may have left a piece of its first line.
  if (found == header) return MonteCarloFolder{out, true};
  if (header.starts_with(found)) return MonteCarloFolder{out, false};
  if (finished) {
    fs::remove(out / unfinished_name, reason);
    return MonteCarloFolder{out, false};
  }
  return std::unexpected(wrong(out, "the folder holds an unfinished Monte Carlo run of another scene, seed or shard",
                               "name another folder with -o, or remove this one"));
}

bool MonteCarloFolder::publish_in_one_step(const std::vector<File>& files) const {
  std::error_code reason;
  const fs::path whole = fs::canonical(folder_, reason);
  if (reason || whole == fs::current_path(reason)) return false;  // the shell stands in it: it must stay the same
  fs::directory_iterator entries{whole, reason};
  if (reason || !std::ranges::all_of(entries, is_result_entry)) return false;
  const auto fresh = TemporaryFolder::make(whole);
  if (!fresh) return false;
  for (const File& file : files) {
    if (!report::write_file(fresh->path() / file.name, file.content)) return false;
  }
  fs::create_hard_link(unfinished(), fresh->path() / records_name, reason);
  // After the exchange the temporary name is that of the old folder, which goes with it.
  return !reason && exchange_folders(fresh->path(), whole);
}

std::expected<void, OutError> MonteCarloFolder::publish(const std::vector<File>& files) {
  if (publish_in_one_step(files)) return {};
  std::error_code reason;
  // The summary says that a result is whole: the old one goes first, the new one comes last.
  fs::remove(folder_ / "summary.json", reason);
  std::vector<fs::path> old;
  for (const auto& entry : fs::directory_iterator{folder_, reason}) {
    if (entry.path().filename() != unfinished_name && is_result_entry(entry)) old.push_back(entry.path());
  }
  for (const fs::path& path : old) fs::remove_all(path, reason);
  for (const File& file : files) {
    if (file.name == "summary.json") {
      fs::rename(unfinished(), folder_ / records_name, reason);
      if (reason) {
        return std::unexpected(failed(folder_, "the records cannot be put there", reason, "check its permissions"));
      }
    }
    if (auto written = report::write_file(folder_ / file.name, file.content); !written) {
      return std::unexpected(OutError{ExitCode::machine_failed, describe(written.error())});
    }
  }
  return {};
}

std::expected<std::vector<MonteCarloFolder::File>, OutError> scene_copies(const scene::Scene& scene,
                                                                          const std::string& path) {
  std::vector<MonteCarloFolder::File> copies;
  const fs::path beside = fs::path{path}.parent_path();
  const auto add = [&](const fs::path& from, std::string name, const std::string& sha256) -> std::string {
    auto bytes = scene::read_file(from);
    if (!bytes) return fmt::format("{}: {}", from.generic_string(), bytes.error().what);
    if (sha256_hex(*bytes) != sha256) return from.generic_string() + " has changed since the run began";
    copies.push_back({std::move(name), *std::move(bytes)});
    return {};
  };
  std::string problem = add(path, "scene.toml", scene.sha256);
  for (std::size_t i = 0; i < scene.files.size() && problem.empty(); ++i) {
    const fs::path named{scene.files[i].name};
    problem = add(named.is_absolute() ? named : beside / named, copy_name(i), scene.files[i].sha256);
  }
  if (!problem.empty()) {
    return std::unexpected(
        OutError{ExitCode::wrong_input, fmt::format("{}:1: scene: {}; restore it, or begin again", path, problem)});
  }
  return copies;
}

std::expected<scene::Scene, std::vector<scene::Problem>> load_copied_scene(const fs::path& result) {
  const std::string shown = (result / "scene.toml").generic_string();
  auto text = scene::read_file(result / "scene.toml");
  if (!text) {
    return std::unexpected(std::vector{
        scene::Problem{result.generic_string(), 1, "OUT", "is no Monte Carlo result: it holds no scene.toml",
                       "name the folder of a finished run of a scene with [monte_carlo]"}});
  }
  // Files are asked for in the order in which the scene names them first: that of their copies.
  std::vector<std::string> names;
  auto scene =
      scene::parse(*text, shown, [&](const std::string& name) -> std::expected<scene::LoadedFile, scene::FileRefusal> {
        const auto known = std::ranges::find(names, name);
        const auto number = static_cast<std::size_t>(known - names.begin());
        if (known == names.end()) names.push_back(name);
        auto bytes = scene::read_file(result / copy_name(number));
        if (!bytes)
          return std::unexpected(
              scene::FileRefusal{bytes.error().what, "the result is not whole: run the scene again"});
        return scene::LoadedFile{*std::move(bytes), name};
      });
  // The copy has another name than the scene had, which is its title where it states none.
  if (const auto name = scene_name_of(result); scene && name) {
    if (scene->title == scene->file_name) scene->title = *name;
    scene->file_name = *name;
  }
  return scene;
}

}  // namespace cleave::cli
