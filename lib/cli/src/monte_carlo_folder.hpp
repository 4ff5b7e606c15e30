#pragma once

#include <expected>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cleave/scene3d/scene.hpp"
#include "out_folder.hpp"

namespace cleave::cli {

/// The names of a Monte Carlo result beside those of every result.
inline constexpr const char* records_name = "realizations.csv";
inline constexpr const char* unfinished_name = "realizations.csv.part";  ///< the checkpoint

/// The folder of a Monte Carlo run. Unlike a single result it is written to while it grows, so that a run that was
/// ended in any way goes on from where it was: `unfinished()` holds the records so far. A finished result that stands
/// there stays whole until `publish`.
class MonteCarloFolder final {
 public:
  /// `header`: first line of the records of this run. Refuses folders that hold anything but an unfinished run with
  /// this header, a finished result, or nothing.
  [[nodiscard]] static std::expected<MonteCarloFolder, OutError> prepare(const std::filesystem::path& out,
                                                                         const std::string& header);
  [[nodiscard]] const std::filesystem::path& folder() const noexcept { return folder_; }
  [[nodiscard]] std::filesystem::path unfinished() const { return folder_ / unfinished_name; }
  /// Whether an earlier call's records were found.
  [[nodiscard]] bool resumed() const noexcept { return resumed_; }

  struct File {
    std::string name, content;
  };
  /// Puts the files and the records under their final names; what an older result left is taken away: in one step where
  /// the file system can, else file by file, for which summary.json must be the last one.
  [[nodiscard]] std::expected<void, OutError> publish(const std::vector<File>& files);

 private:
  /// Makes the whole result beside the folder and swaps the two; false, with nothing changed, where that cannot be.
  [[nodiscard]] bool publish_in_one_step(const std::vector<File>& files) const;
  MonteCarloFolder(std::filesystem::path folder, bool resumed) : folder_{std::move(folder)}, resumed_{resumed} {}
  std::filesystem::path folder_;
  bool resumed_;
};

/// The scene and the files it names, as files of a result: scene.toml, scene_file_1, ... Fails when a file is not any
/// more what was read.
[[nodiscard]] std::expected<std::vector<MonteCarloFolder::File>, OutError> scene_copies(const scene::Scene& scene,
                                                                                        const std::string& path);

/// The scene that a Monte Carlo result was made of, from its copies.
[[nodiscard]] std::expected<scene::Scene, std::vector<scene::Problem>> load_copied_scene(
    const std::filesystem::path& result);

}  // namespace cleave::cli
