#include "dxf_pairs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "cleave/core/expected.hpp"

namespace cleave::io {

const DxfPair* DxfRecord::find(int code) const {
  const auto found = std::ranges::find(pairs, code, &DxfPair::code);
  return found == pairs.end() ? nullptr : &*found;
}

ReadError DxfRecords::error(std::optional<std::uint32_t> line, ReadFault fault, std::string what,
                            std::string remedy) const {
  return {fault, std::string{lines_.file()}, line, {}, std::move(what), std::move(remedy)};
}

std::expected<bool, ReadError> DxfRecords::read_pair() {
  std::string_view line;
  do {
    if (!lines_.next(line)) return false;
    const std::string_view text = trimmed(line);
    if (text.empty() && trimmed(lines_.rest()).empty()) return false;  // blank lines at the end
    const auto code = number_of(text);
    if (!code || *code != std::floor(*code) || std::abs(*code) > 1071) {
      return std::unexpected(lines_.error(ReadFault::syntax,
                                          fmt::format("{} stands where a group code should", shown(text)),
                                          "check that this is a DXF file saved as text, and that no line is missing"));
    }
    pair_.code = static_cast<int>(*code);
    if (!lines_.next(line)) {
      return std::unexpected(lines_.error(ReadFault::truncated, "ends after a group code", "get the whole file again"));
    }
    pair_.value = trimmed(line);
    pair_.line = lines_.number();
  } while (pair_.code == 999);  // comments
  return true;
}

std::expected<bool, ReadError> DxfRecords::next(DxfRecord& record) {
  if (!begun_) {
    CLEAVE_TRY(const bool any, read_pair());
    if (!any || pair_.code != 0 || pair_.value != "SECTION") {
      return std::unexpected(error(any ? std::optional{pair_.line} : std::nullopt, ReadFault::unknown_format,
                                   "does not begin with 0 SECTION", "check that this is a DXF file saved as text"));
    }
    begun_ = true;
  }
  if (pair_.value == "EOF") return false;
  record.type = pair_.value;
  record.line = pair_.line;
  record.pairs.clear();
  while (true) {
    CLEAVE_TRY(const bool any, read_pair());
    if (!any) {
      return std::unexpected(
          lines_.error(ReadFault::truncated, "ends without 0 EOF", "get or save the whole file again"));
    }
    if (pair_.code == 0) return true;
    record.pairs.push_back(pair_);
  }
}

std::expected<double, ReadError> DxfRecords::number(const DxfPair& pair) const {
  auto value = number_of(pair.value);
  if (!value) {
    return std::unexpected(error(pair.line, ReadFault::bad_number,
                                 fmt::format("group code {}: {}", pair.code, value.error()), "correct the number"));
  }
  return *value;
}

std::expected<double, ReadError> DxfRecords::number(const DxfRecord& record, int code, double otherwise) const {
  const DxfPair* pair = record.find(code);
  return pair == nullptr ? otherwise : number(*pair);
}

std::expected<std::int64_t, ReadError> DxfRecords::integer(const DxfRecord& record, int code,
                                                           std::int64_t otherwise) const {
  const DxfPair* pair = record.find(code);
  if (pair == nullptr) return otherwise;
  CLEAVE_TRY(const double value, number(*pair));
  if (value != std::floor(value) || std::abs(value) > 4294967294.0) {
    return std::unexpected(error(
        pair->line, ReadFault::out_of_range,
        fmt::format("group code {}: {} is not a whole number that can stand here", code, value), "correct the number"));
  }
  return static_cast<std::int64_t>(value);
}

}  // namespace cleave::io
