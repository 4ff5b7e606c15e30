#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <tuple>
#include <utility>

#include "cleave/core/overloaded.hpp"
#include "cleave/scene/table_reader.hpp"

namespace cleave::scene {
namespace {

constexpr std::size_t most_errors = 200;

/// A value that is read twice is told once. False when there are too many to add it.
bool add(std::vector<Problem>& list, Problem problem) {
  if (std::ranges::find(list, problem) != list.end()) return true;
  if (list.size() >= most_errors) return false;
  list.push_back(std::move(problem));
  return true;
}

}  // namespace

std::string_view kind_of(const TomlNode& node) noexcept {
  return std::visit(overloaded{[](bool) -> std::string_view { return "true or false"; },
                               [](std::int64_t) -> std::string_view { return "a whole number"; },
                               [](double) -> std::string_view { return "a number"; },
                               [](const std::string&) -> std::string_view { return "text"; },
                               [](const TomlDate&) -> std::string_view { return "a date or time"; },
                               [](const TomlArray&) -> std::string_view { return "an array"; },
                               [](const TomlTable&) -> std::string_view { return "a table"; }},
                    node.value);
}

void Problems::error(std::uint32_t line, std::string key, std::string what, std::string remedy) {
  error_in(file_, line, std::move(key), std::move(what), std::move(remedy));
}
void Problems::error_in(std::string file, std::uint32_t line, std::string key, std::string what, std::string remedy) {
  ++error_count_;
  if (!add(errors_, {std::move(file), line, std::move(key), std::move(what), std::move(remedy)})) ++not_shown_;
}
void Problems::note(std::uint32_t line, std::string key, std::string what, std::string remedy) {
  note_in(file_, line, std::move(key), std::move(what), std::move(remedy));
}
void Problems::note_in(std::string file, std::uint32_t line, std::string key, std::string what, std::string remedy) {
  (void)add(notes_, {std::move(file), line, std::move(key), std::move(what), std::move(remedy)});
}

bool Problems::is_unread(std::string_view name) const noexcept {
  return std::ranges::find(unread_, name) != unread_.end();
}

std::vector<Problem> Problems::take_errors() && {
  const auto place = [&](const Problem& problem) {
    return std::tuple{problem.file != file_, std::string_view{problem.file}, problem.line};
  };
  std::vector<std::size_t> order(errors_.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::sort(order, [&](std::size_t a, std::size_t b) {
    return std::pair{place(errors_[a]), a} < std::pair{place(errors_[b]), b};
  });
  std::vector<Problem> sorted;
  sorted.reserve(errors_.size() + 1);
  for (const std::size_t i : order) sorted.push_back(std::move(errors_[i]));
  errors_ = std::move(sorted);
  if (not_shown_ > 0) {
    errors_.push_back({file_, 1, "scene", fmt::format("{} more errors are not shown", not_shown_), "fix these first"});
  }
  return std::move(errors_);
}
std::vector<Problem> Problems::take_notes() && { return std::move(notes_); }

}  // namespace cleave::scene
