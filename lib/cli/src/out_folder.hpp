#pragma once

#include <expected>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "exit_code.hpp"

namespace cleave::cli {

struct OutError {
  ExitCode code;        ///< wrong_input or machine_failed
  std::string message;  ///< "what is wrong; what to do"
};

/// A folder for work under way, with a name that no other run has. While its owner lives it is locked, so that the next
/// run can tell what a killed one left behind from what somebody still writes to. Removed with its owner.
class TemporaryFolder final {
 public:
  /// Makes `base`.cleave-PROCESS-NUMBER, and takes away folders of that name whose owners are gone.
  [[nodiscard]] static std::expected<TemporaryFolder, std::error_code> make(const std::filesystem::path& base);

  TemporaryFolder(TemporaryFolder&& other) noexcept;
  TemporaryFolder& operator=(TemporaryFolder&&) = delete;
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder();

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }
  /// It has been renamed or is gone: nothing is left to remove.
  void release() noexcept { path_.clear(); }
  /// May be called from another thread, and twice.
  void remove() noexcept;

 private:
  TemporaryFolder(std::filesystem::path path, int lock);
  std::filesystem::path path_;
  std::filesystem::path dead_;  ///< its name on the way out, made while there is memory
  int lock_;
};

/// Takes away the temporary folders in `parent` whose names begin with `name` and whose owners are gone.
void remove_abandoned(const std::filesystem::path& parent, const std::string& name);

/// Swaps two folders in one step, where the file system can.
[[nodiscard]] bool exchange_folders(const std::filesystem::path& a, const std::filesystem::path& b) noexcept;

/// A result on its way: files go into a temporary folder, and `publish` gives that its final name in one step.
///
/// Invariant: until `publish` succeeds nothing of ours stands under the final name, and what stood there is untouched.
/// `discard` (also by the destructor) removes the temporary folder and folders made above it. Both may be called from
/// another thread (an interrupt).
class OutFolder final {
 public:
  /// Looks at what stands at `out` (the policy of the contract) and makes the temporary folder: beside it, or inside it
  /// where the folder above cannot be written or is another file system.
  [[nodiscard]] static std::expected<OutFolder, OutError> prepare(const std::filesystem::path& out);

  OutFolder(OutFolder&& other) noexcept;
  OutFolder& operator=(OutFolder&&) = delete;
  OutFolder(const OutFolder&) = delete;
  OutFolder& operator=(const OutFolder&) = delete;
  ~OutFolder();

  /// Where to write; exists and is empty at first.
  [[nodiscard]] const std::filesystem::path& folder() const noexcept { return temporary_.path(); }
  [[nodiscard]] const std::filesystem::path& final_name() const noexcept { return final_; }
  /// A message with the name that a file will have in the place of where it is written now.
  [[nodiscard]] std::string by_final_name(std::string message) const;
  [[nodiscard]] std::expected<void, OutError> publish();
  void discard() noexcept;

 private:
  OutFolder(std::filesystem::path final_name, TemporaryFolder temporary, std::vector<std::filesystem::path> made)
      : final_{std::move(final_name)}, temporary_{std::move(temporary)}, made_{std::move(made)} {}
  [[nodiscard]] std::expected<void, OutError> publish_file_by_file(const std::filesystem::path& from);

  std::filesystem::path final_;
  TemporaryFolder temporary_;
  std::vector<std::filesystem::path> made_;  ///< folders above, made by us, outermost first
  bool open_ = true;
};

/// True for the names of files that cleave writes into a result.
[[nodiscard]] bool is_result_file(const std::string& name);
/// True for such a file, and for a folder realization_K that holds a result (of cleave replay) and nothing else.
[[nodiscard]] bool is_result_entry(const std::filesystem::directory_entry& entry);

}  // namespace cleave::cli
