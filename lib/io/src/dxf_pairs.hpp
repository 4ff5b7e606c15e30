#pragma once

#include <cstdint>
#include <expected>
#include <optional>
#include <string_view>
#include <vector>

#include "cleave/io/file.hpp"
#include "text.hpp"

namespace cleave::io {

/// One group code of a DXF file and its value.
struct DxfPair {
  int code = 0;
  std::string_view value;  ///< without blanks around it
  std::uint32_t line = 0;  ///< of the value, from 1
};

/// All pairs from one code 0 to the next: an entity, or a marker such as SECTION with what follows it.
struct DxfRecord {
  std::string_view type;
  std::uint32_t line = 0;
  std::vector<DxfPair> pairs;

  [[nodiscard]] const DxfPair* find(int code) const;
};

/// Takes a DXF text apart into records.
class DxfRecords final {
 public:
  DxfRecords(std::string_view bytes, std::string_view file) : lines_{bytes, file} {}

  /// Reads the next record; false behind EOF. A file that ends without 0 EOF is truncated.
  [[nodiscard]] std::expected<bool, ReadError> next(DxfRecord& record);

  [[nodiscard]] ReadError error(std::optional<std::uint32_t> line, ReadFault fault, std::string what,
                                std::string remedy) const;
  [[nodiscard]] std::expected<double, ReadError> number(const DxfPair& pair) const;
  /// The number of the first pair with that code, or `otherwise` when there is none.
  [[nodiscard]] std::expected<double, ReadError> number(const DxfRecord& record, int code, double otherwise) const;
  [[nodiscard]] std::expected<std::int64_t, ReadError> integer(const DxfRecord& record, int code,
                                                               std::int64_t otherwise) const;

 private:
  /// False at the end of the bytes.
  [[nodiscard]] std::expected<bool, ReadError> read_pair();

  LineReader lines_;
  DxfPair pair_;
  bool begun_ = false;  ///< pair_ holds the code 0 of the next record
};

}  // namespace cleave::io
