#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <ranges>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cleave/core/assert.hpp"
#include "cleave/exchange/json_fields.hpp"
#include "cleave/exchange/text.hpp"

/// Tables of pages as visitors over the `fields` of their rows. A table names the columns that it shows; heading, unit
/// and the words under the pointer come from the declaration of the figure.
namespace cleave::report {

/// Markup as a value of a row, for cells that join figures or draw.
struct Html {
  std::string text;
  std::optional<double> sort = {};  ///< what the column is sorted by
};

/// One shown figure.
struct Shown {
  std::string_view name;          ///< as declared: "net_force_n"
  std::string_view heading = {};  ///< empty: made from the name, "Net force (kN)"
  int digits = 4;
  bool optional = false;       ///< left out where the row does not have it
  std::string_view kind = {};  ///< class of its cells: "wide"
};

/// What surrounds a table: `scroll` moves long ones within the page.
enum class Frame : std::uint8_t { scroll, none };

/// A figure in the unit an engineer reads it in.
struct ShownUnit {
  std::string_view suffix;  ///< of names
  std::string_view unit;
  double scale;
};
/// The unit of a figure by its name; none: a bare number.
[[nodiscard]] const ShownUnit* unit_of(std::string_view name);
/// "Net force (kN)" of "net_force_n".
[[nodiscard]] std::string heading_of(std::string_view name);

/// The text of a value in a page, and what it is sorted by.
class HtmlValue final {
 public:
  HtmlValue(std::string_view name, int digits) : unit_{unit_of(name)}, digits_{digits} {}

  template <class T>
  Html operator()(const T& x) const {
    if constexpr (is_a<T, std::optional>) {
      return x ? (*this)(*x) : none();
    } else if constexpr (is_a<T, OrNull>) {
      return x.value ? (*this)(*x.value) : none();
    } else if constexpr (is_a<T, When>) {
      return x.present ? (*this)(x.value) : none();
    } else if constexpr (std::same_as<T, Html>) {
      return x;
    } else if constexpr (std::same_as<T, bool>) {
      return {x ? "yes" : "no"};
    } else if constexpr (std::integral<T>) {
      return {display_count(static_cast<std::uint64_t>(x)), static_cast<double>(x)};
    } else if constexpr (std::floating_point<T>) {
      return {display(x * (unit_ != nullptr ? unit_->scale : 1), digits_), x};
    } else if constexpr (HasUnit<T>) {
      return (*this)(x.si());
    } else if constexpr (Numbered<T>) {
      return {std::to_string(x.value()), x.value()};
    } else if constexpr (std::same_as<T, OneOf>) {
      return (*this)(x.value);
    } else if constexpr (TextLike<T>) {
      const std::string_view text{x};
      return text.empty() ? none() : Html{escape_xml(text)};
    } else if constexpr (Point3<T>) {
      return {"(" + display(x.x) + ", " + display(x.y) + ", " + display(x.z) + ")"};
    } else if constexpr (std::ranges::range<T>) {
      return list(x);
    } else {
      return none();  // a part with figures of its own
    }
  }

 private:
  static Html none() { return {"–"}; }
  template <class Range>
  Html list(const Range& items) const {
    constexpr std::size_t most = 12;
    std::string text;
    std::size_t shown = 0;
    const auto count = static_cast<std::size_t>(std::ranges::distance(items));
    for (const auto& item : items) {
      if (shown == most) break;
      text += (shown++ == 0 ? "" : ", ") + (*this)(item).text;
    }
    if (count > most) text += " and " + display_count(count - most) + " more";
    return text.empty() ? none() : Html{text};
  }

  const ShownUnit* unit_;
  int digits_;
};

/// Collects the chosen figures of one row, in the order of the choice.
class ChosenFigures final {
 public:
  struct Cell {
    Html value;
    std::string_view help;
    bool found = false;
  };
  explicit ChosenFigures(const std::vector<Shown>& chosen) : chosen_{&chosen}, cells_(chosen.size()) {}

  /// `row` has `fields`, or is a `Group`.
  template <class Row>
  void read(const Row& row) {
    if constexpr (requires { row.body(*this); }) {
      row.body(*this);
    } else {
      fields(*this, row);
    }
  }
  template <class T>
  void operator()(std::string_view name, const T& x, std::string_view help = {}) {
    for (std::size_t i = 0; i < chosen_->size(); ++i) {
      if ((*chosen_)[i].name == name) cells_[i] = {HtmlValue{name, (*chosen_)[i].digits}(x), help, true};
    }
  }
  [[nodiscard]] const std::vector<Cell>& cells() const {
    for (std::size_t i = 0; i < cells_.size(); ++i) CLEAVE_ASSERT(cells_[i].found || (*chosen_)[i].optional);
    return cells_;
  }

 private:
  const std::vector<Shown>* chosen_;
  std::vector<Cell> cells_;
};

/// A table with a row for each thing.
class HtmlTable final {
 public:
  /// `sample`: a row that need hold nothing, which has the columns. `attributes` of the table: `class="sortable"`.
  template <class Row>
  HtmlTable(std::vector<Shown> columns, const Row& sample, std::string_view attributes = {},
            Frame frame = Frame::scroll)
      : columns_{std::move(columns)}, sortable_{attributes.contains("sortable")}, frame_{frame} {
    ChosenFigures figures{columns_};
    figures.read(sample);
    head(figures.cells(), attributes);
  }
  /// `attributes` of the row: `data-block="3"`.
  template <class Row>
  void add(const Row& row, std::string_view attributes = {}) {
    ChosenFigures figures{columns_};
    figures.read(row);
    add_cells(figures.cells(), attributes);
  }
  [[nodiscard]] std::string html() &&;

 private:
  void head(const std::vector<ChosenFigures::Cell>& cells, std::string_view attributes);
  void add_cells(const std::vector<ChosenFigures::Cell>& cells, std::string_view attributes);

  std::vector<Shown> columns_;
  bool sortable_;
  Frame frame_;
  std::string text_;
};

/// What tables of points of two-dimensional scenes show.
[[nodiscard]] inline std::vector<Shown> point_columns() {
  return {{"point"},
          {"x_m", "x (m)"},
          {"y_m", "y (m)"},
          {"displacement_x_m", "u<sub>x</sub> (m)", 6},
          {"displacement_y_m", "u<sub>y</sub> (m)", 6}};
}

/// A table with a row for each element of a range, whose figures `body(visitor, element)` names, with or without the
/// index; it is called with an element that holds nothing as well.
template <class Range, class Body>
[[nodiscard]] std::string html_table(std::vector<Shown> columns, const Each<Range, Body>& rows,
                                     std::string_view attributes = {}, Frame frame = Frame::scroll) {
  const auto row = [&](const auto& item, std::size_t index) {
    return group([&, index](auto& v) { call_body(rows.body, v, item, index); });
  };
  const auto none = Sample<std::ranges::range_value_t<Range>>::make();
  HtmlTable table{std::move(columns), row(none, 0), attributes, frame};
  for (std::size_t i = 0; const auto& item : rows.range) table.add(row(item, i++));
  return std::move(table).html();
}
/// A table of all rows of a range.
template <std::ranges::range Rows, class Row>
[[nodiscard]] std::string html_table(std::vector<Shown> columns, const Row& sample, const Rows& rows,
                                     std::string_view attributes = {}) {
  HtmlTable table{std::move(columns), sample, attributes};
  for (const auto& row : rows) table.add(row);
  return std::move(table).html();
}

/// Rows of a table of facts, one a figure; those that are not there are left out. `row` has `fields`.
[[nodiscard]] std::string fact_rows(const std::vector<Shown>& chosen, const std::vector<ChosenFigures::Cell>& cells,
                                    std::string_view kind);
template <class Row>
[[nodiscard]] std::string facts(const std::vector<Shown>& chosen, const Row& row, std::string_view kind = {}) {
  ChosenFigures figures{chosen};
  figures.read(row);
  return fact_rows(chosen, figures.cells(), kind);
}

}  // namespace cleave::report
