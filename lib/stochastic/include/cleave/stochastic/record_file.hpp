#pragma once

#include <cstdint>
#include <expected>
#include <filesystem>
#include <functional>
#include <string>
#include <variant>

#include "cleave/core/version.hpp"
#include "cleave/stochastic/record.hpp"

namespace cleave::stochastic {

/// Part `number` of `of`: the realizations k with (k / group) mod of == number - 1. `group` realizations in a row
/// belong together (nested design); the scene says how many, so files do not.
struct Shard {
  std::uint64_t number = 1, of = 1;
  std::uint64_t group = 1;
  friend bool operator==(const Shard&, const Shard&) = default;
};

/// What the records of a file belong to; its first line.
struct RunIdentity {
  std::string version{cleave::version};  ///< of the program
  std::string scene_sha256;              ///< of the scene and the files it names
  std::uint64_t seed = 1;
  Shard shard;
  friend bool operator==(const RunIdentity&, const RunIdentity&) = default;
};
[[nodiscard]] std::string header_of(const RunIdentity& identity);

struct OtherRun {  ///< the file's first line is not that of this run
  std::string found, wanted;
};
struct InUse {};  ///< another process writes to the file
struct Unreadable {
  std::uint64_t line;  ///< where the file stops making sense, from 1
};
struct SystemFailure {  ///< the machine failed
  std::string reason;
};
using RecordFileError = std::variant<OtherRun, InUse, Unreadable, SystemFailure>;
[[nodiscard]] std::string describe(const RecordFileError& error);

/// The records of a run on disk, in the order of their realizations: the checkpoint. Each append is one write; a line
/// that was cut off (kill -9, power) is noticed by its checksum and taken away when the file is opened again.
///
/// Invariant: the file holds the header and whole records of the shard's realizations in their order.
class RecordFile final {
 public:
  /// Opens or makes the file and locks it against other processes.
  [[nodiscard]] static std::expected<RecordFile, RecordFileError> open(const std::filesystem::path& path,
                                                                       const RunIdentity& identity);
  RecordFile(RecordFile&& other) noexcept;
  RecordFile& operator=(RecordFile&&) = delete;
  ~RecordFile();

  [[nodiscard]] std::uint64_t records() const noexcept { return records_; }
  [[nodiscard]] std::uint64_t next_realization() const noexcept {
    return (shard_.number - 1 + records_ / shard_.group * shard_.of) * shard_.group + records_ % shard_.group;
  }
  [[nodiscard]] std::expected<void, RecordFileError> append(const Record& record);
  [[nodiscard]] std::expected<void, RecordFileError> flush_to_disk() const;

 private:
  RecordFile(int descriptor, Shard shard) : descriptor_{descriptor}, shard_{shard} {}
  int descriptor_;
  Shard shard_;
  std::uint64_t records_ = 0;
};

/// Reads a whole file of records one by one, without keeping them. `use` returns false to stop.
[[nodiscard]] std::expected<RunIdentity, RecordFileError> read_records(
    const std::filesystem::path& path, const std::function<bool(const Record&, std::string_view line)>& use);

}  // namespace cleave::stochastic
