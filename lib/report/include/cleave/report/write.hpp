#pragma once

#include <expected>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "cleave/realize/run_result.hpp"

namespace cleave::report {

struct CannotCreate {  ///< no permission, a missing folder, a folder in the way
  std::filesystem::path path;
  std::string reason;  ///< of the operating system
};
struct NoSpace {  ///< disk full, quota or file size limit reached
  std::filesystem::path path;
  std::string reason;
};
struct CannotWrite {  ///< any other failure after the file was begun
  std::filesystem::path path;
  std::string reason;
};
/// The machine failed, not the user and not cleave: the program ends with 3.
using WriteError = std::variant<CannotCreate, NoSpace, CannotWrite>;
/// "PATH: what is wrong; what to do".
[[nodiscard]] std::string describe(const WriteError& error);

/// Writes `content` beside `path` under a temporary name (PATH.part), flushes it to the disk and renames it. After an
/// error nothing new stands under either name; what stood under `path` before is untouched.
[[nodiscard]] std::expected<void, WriteError> write_file(const std::filesystem::path& path, std::string_view content);

/// NAME_0000.vtu and on, each `frame_vtu(frame)` at `time_of(frame)`, and NAME.pvd of them.
[[nodiscard]] std::expected<void, WriteError> write_frames(const std::filesystem::path& folder, const std::string& name,
                                                           std::size_t frames,
                                                           const std::function<double(std::size_t)>& time_of,
                                                           const std::function<std::string(std::size_t)>& frame_vtu);

/// The single writers, so that a program can time them; each writes one file into `folder`, which must exist. Files
/// that the scene does not ask for, or whose stage did not run, are skipped without an error.
[[nodiscard]] std::expected<void, WriteError> write_blocks_vtu(const scene::RunResult& result,
                                                               const std::filesystem::path& folder);
/// dangling.vtu and dangling.obj, where the scene keeps what dangles.
[[nodiscard]] std::expected<void, WriteError> write_dangling(const scene::RunResult& result,
                                                             const std::filesystem::path& folder);
/// motion.csv, motion_NNNN.vtu and motion.pvd, where blocks were in motion.
[[nodiscard]] std::expected<void, WriteError> write_motion(const scene::RunResult& result,
                                                           const std::filesystem::path& folder);
/// mapped_joints.csv, where the scene says what has been mapped.
[[nodiscard]] std::expected<void, WriteError> write_mapped(const scene::RunResult& result,
                                                           const std::filesystem::path& folder);
/// flow.vtu and flow_joints.csv, where the scene asks for flow.
[[nodiscard]] std::expected<void, WriteError> write_flow(const scene::RunResult& result,
                                                         const std::filesystem::path& folder);
/// One file for each format in [output] exports, named blocks with the format's ending; what the user should know about
/// them comes back.
[[nodiscard]] std::expected<std::vector<std::string>, WriteError> write_exports(const scene::RunResult& result,
                                                                                const std::filesystem::path& folder);
/// Sections of the block system as scenes of contact, as [output] section asks; what the user should know comes back.
[[nodiscard]] std::expected<std::vector<std::string>, WriteError> write_sections(const scene::RunResult& result,
                                                                                 const std::filesystem::path& folder);
[[nodiscard]] std::expected<void, WriteError> write_key_blocks_csv(const scene::RunResult& result,
                                                                   const std::filesystem::path& folder);
[[nodiscard]] std::expected<void, WriteError> write_report_html(const scene::RunResult& result,
                                                                const std::filesystem::path& folder);
[[nodiscard]] std::expected<void, WriteError> write_summary_json(const scene::RunResult& result,
                                                                 const std::filesystem::path& folder);

/// All of them, summary.json last, so that a folder with a summary is whole. Makes `folder` when it is missing.
[[nodiscard]] std::expected<void, WriteError> write_all(const scene::RunResult& result,
                                                        const std::filesystem::path& folder);

}  // namespace cleave::report
