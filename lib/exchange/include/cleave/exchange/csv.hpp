#pragma once

#include <concepts>
#include <ranges>
#include <string>
#include <string_view>

#include "cleave/core/text.hpp"
#include "cleave/exchange/json_fields.hpp"
#include "cleave/exchange/text.hpp"

/// Tables of comma-separated values as visitors over the `fields` of a row: the header is the names, a flag is 1 or 0,
/// a value that is not there an empty field, several are joined by `;`, and a point is three columns or two.
namespace cleave::report {

/// Writes the names of a row's columns.
class CsvHeader final {
 public:
  template <class T>
  void operator()(std::string_view name, const T& /*value*/, std::string_view /*help*/ = {}) {
    if (!text_.empty()) text_ += ',';
    text_ += name;
  }
  [[nodiscard]] const std::string& text() const noexcept { return text_; }

 private:
  std::string text_;
};

/// Writes the values of one row.
class CsvRow final {
 public:
  explicit CsvRow(std::string& out) noexcept : out_{&out} {}

  template <class T>
  void operator()(std::string_view /*name*/, const T& x, std::string_view /*help*/ = {}) {
    if (!first_) *out_ += ',';
    first_ = false;
    put(x);
  }

 private:
  template <class T>
  void put(const T& x) {
    if constexpr (is_a<T, std::optional>) {
      if (x) put(*x);
    } else if constexpr (is_a<T, When>) {
      if (x.present) put(x.value);
    } else if constexpr (std::same_as<T, bool>) {
      *out_ += x ? '1' : '0';
    } else if constexpr (std::floating_point<T>) {
      append_number(*out_, x);
    } else if constexpr (std::integral<T>) {
      *out_ += std::to_string(x);
    } else if constexpr (TextLike<T>) {
      *out_ += csv_field(x);
    } else if constexpr (HasUnit<T>) {
      append_number(*out_, x.si());
    } else if constexpr (Numbered<T>) {
      *out_ += std::to_string(x.value());
    } else {
      bool first = true;
      for (const auto& item : x) {
        if (!std::exchange(first, false)) *out_ += ';';
        put(item);
      }
    }
  }

  std::string* out_;
  bool first_ = true;
};

/// A table; its header comes from a row that need hold nothing.
class CsvTable final {
 public:
  template <class Row>
  explicit CsvTable(const Row& sample) {
    CsvHeader header;
    fields(header, sample);
    text_ = header.text() + '\n';
  }
  template <class Row>
  void add(const Row& row) {
    CsvRow values{text_};
    fields(values, row);
    text_ += '\n';
  }
  [[nodiscard]] std::string text() && { return std::move(text_); }

 private:
  std::string text_;
};

/// A table of all rows of a range.
template <class Row, std::ranges::range Rows>
[[nodiscard]] std::string csv_table(const Row& sample, const Rows& rows) {
  CsvTable table{sample};
  for (const auto& row : rows) table.add(row);
  return std::move(table).text();
}

}  // namespace cleave::report
