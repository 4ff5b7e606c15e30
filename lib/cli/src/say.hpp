#pragma once

#include <fmt/args.h>
#include <fmt/format.h>

#include <cmath>
#include <concepts>
#include <ranges>
#include <string>
#include <string_view>

#include "cleave/exchange/json_fields.hpp"

/// Lines for people as visitors over `fields`: what stands in braces is the name of a declared figure.
namespace cleave::cli {

/// A figure in a line; where the text gives no format it is written as its unit asks.
struct SaidFigure {
  double value;
  std::string_view name;
};
[[nodiscard]] std::string text_of(SaidFigure figure);

/// Collects the figures of a row by name. A list stands as its length.
class NamedFigures final {
 public:
  template <class T>
  void operator()(std::string_view name, const T& x, std::string_view /*help*/ = {}) {
    if constexpr (report::is_a<T, std::optional>) {
      if (x) (*this)(name, *x);
    } else if constexpr (report::is_a<T, When>) {
      if (x.present) (*this)(name, x.value);
    } else if constexpr (report::is_a<T, OrNull>) {
      if (x.value) (*this)(name, *x.value);
    } else if constexpr (report::is_a<T, Group>) {
      x.body(*this);
    } else if constexpr (std::floating_point<T>) {
      push(name, SaidFigure{x, name});
    } else if constexpr (report::HasUnit<T>) {
      push(name, SaidFigure{x.si(), name});
    } else if constexpr (std::integral<T>) {
      push(name, x);
    } else if constexpr (std::same_as<T, OneOf>) {
      push(name, std::string{x.value});
    } else if constexpr (report::TextLike<T>) {
      push(name, std::string{std::string_view{x}});
    } else if constexpr (std::ranges::sized_range<T>) {
      push(name, std::ranges::size(x));
    }
  }
  [[nodiscard]] std::string in(std::string_view text) const { return fmt::vformat(text, figures_); }

 private:
  void push(std::string_view name, const auto& value) {
    figures_.push_back(fmt::arg(std::string{name}.c_str(), value));
  }
  fmt::dynamic_format_arg_store<fmt::format_context> figures_;
};

/// `say("{count} in {batches} batches", row)`: `row` has `fields` or is a `Group`; a figure is named as in
/// summary.json.
template <class Row>
[[nodiscard]] std::string say(std::string_view text, const Row& row) {
  NamedFigures figures;
  if constexpr (requires { row.body(figures); }) {
    row.body(figures);
  } else {
    fields(figures, row);
  }
  return figures.in(text);
}

}  // namespace cleave::cli

template <>
struct fmt::formatter<cleave::cli::SaidFigure> : fmt::formatter<double> {
  constexpr auto parse(fmt::format_parse_context& context) {
    plain = context.begin() == context.end() || *context.begin() == '}';
    return fmt::formatter<double>::parse(context);
  }
  template <class Context>
  auto format(const cleave::cli::SaidFigure& figure, Context& context) const {
    return plain ? fmt::format_to(context.out(), "{}", text_of(figure))
                 : fmt::formatter<double>::format(figure.value, context);
  }
  bool plain = true;
};
