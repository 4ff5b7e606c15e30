#include "xml_tags.hpp"

#include "text.hpp"

namespace cleave::io {
namespace {

constexpr std::size_t npos = std::string_view::npos;

bool is_space(char c) { return is_blank(c) || c == '\n'; }

std::string_view after(std::string_view text, std::string_view mark) {
  const std::size_t at = text.find(mark);
  return at == npos ? std::string_view{} : text.substr(at + mark.size());
}

}  // namespace

std::optional<std::string_view> XmlTag::find(std::string_view key) const noexcept {
  std::string_view rest = attributes;
  while (true) {
    while (!rest.empty() && is_space(rest.front())) rest.remove_prefix(1);
    const std::size_t equals = rest.find('=');
    if (equals == npos) return std::nullopt;
    std::string_view found = rest.substr(0, equals);
    while (!found.empty() && is_space(found.back())) found.remove_suffix(1);
    rest.remove_prefix(equals + 1);
    while (!rest.empty() && is_space(rest.front())) rest.remove_prefix(1);
    if (rest.empty() || (rest.front() != '"' && rest.front() != '\'')) return std::nullopt;
    const std::size_t end = rest.find(rest.front(), 1);
    if (end == npos) return std::nullopt;
    if (found == key) return rest.substr(1, end - 1);
    rest.remove_prefix(end + 1);
  }
}

std::optional<XmlTag> take_tag(std::string_view& rest) noexcept {
  while (true) {
    const std::size_t begin = rest.find('<');
    if (begin == npos) return std::nullopt;
    rest.remove_prefix(begin + 1);
    if (rest.starts_with("!--")) {
      rest = after(rest, "-->");
    } else if (rest.starts_with('?') || rest.starts_with('!')) {
      rest = after(rest, ">");
    } else {
      break;
    }
  }
  const std::size_t end = rest.find('>');
  if (end == npos) return std::nullopt;
  XmlTag tag;
  std::string_view inside = rest.substr(0, end);
  rest.remove_prefix(end + 1);
  if (inside.ends_with('/')) {
    tag.empty = true;
    inside.remove_suffix(1);
  }
  std::size_t name_end = 0;
  while (name_end < inside.size() && !is_space(inside[name_end])) ++name_end;
  tag.name = inside.substr(0, name_end);
  tag.attributes = inside.substr(name_end);
  tag.text = rest.substr(0, rest.find('<'));
  return tag;
}

}  // namespace cleave::io
