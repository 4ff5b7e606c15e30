#pragma once

#include <optional>
#include <string_view>

namespace cleave::io {

/// One tag of an XML text: <name ...>, </name> or <name .../>; comments and declarations are passed over.
struct XmlTag {
  std::string_view name;        ///< with its slash when it closes: "/Points"
  std::string_view attributes;  ///< what follows the name
  bool empty = false;           ///< ends with />
  std::string_view text;        ///< from its end to the next <

  /// The value of an attribute, without its quotes; empty optional when there is none.
  [[nodiscard]] std::optional<std::string_view> find(std::string_view key) const noexcept;
};

/// Takes the next tag off `rest`; nothing at the end of the text or where a tag does not end.
[[nodiscard]] std::optional<XmlTag> take_tag(std::string_view& rest) noexcept;

}  // namespace cleave::io
