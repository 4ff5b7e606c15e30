#pragma once

#include <expected>
#include <filesystem>
#include <string>
#include <vector>

#include "exit_code.hpp"

namespace cleave::cli {

struct OutError {
  ExitCode code;        ///< wrong_input or machine_failed
  std::string message;  ///< "what is wrong; what to do"
};

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
  [[nodiscard]] const std::filesystem::path& folder() const noexcept { return temporary_; }
  [[nodiscard]] const std::filesystem::path& final_name() const noexcept { return final_; }
  [[nodiscard]] std::expected<void, OutError> publish();
  void discard() noexcept;

 private:
  OutFolder(std::filesystem::path final_name, std::filesystem::path temporary, std::vector<std::filesystem::path> made)
      : final_{std::move(final_name)}, temporary_{std::move(temporary)}, made_{std::move(made)} {}
  [[nodiscard]] std::expected<void, OutError> publish_file_by_file();

  std::filesystem::path final_;
  std::filesystem::path temporary_;
  std::vector<std::filesystem::path> made_;  ///< folders above, made by us, outermost first
  bool open_ = true;
};

/// True for the names of files that cleave writes into a result.
[[nodiscard]] bool is_result_file(const std::string& name);
/// True for such a file, and for a folder realization_K that holds a result (of cleave replay).
[[nodiscard]] bool is_result_entry(const std::filesystem::directory_entry& entry);

}  // namespace cleave::cli
