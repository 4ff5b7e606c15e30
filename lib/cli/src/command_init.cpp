#include <fmt/ranges.h>

#include <algorithm>

#include "annotate.hpp"
#include "commands.hpp"
#include "init_texts.hpp"

namespace cleave::cli {

std::string init_kinds() {
  std::vector<std::string_view> kinds;
  for (const InitText& text : init_texts()) kinds.push_back(text.kind);
  return fmt::format("{}", fmt::join(kinds, ", "));
}

ExitCode init_scene(const std::string& kind) {
  const std::vector<InitText> texts = init_texts();
  const auto found = std::ranges::find(texts, kind, &InitText::kind);
  if (found == texts.end()) {
    print_error("cleave init: \"" + kind + "\" is not known; choose one of: " + init_kinds());
    return ExitCode::wrong_input;
  }
  print(found->keys != nullptr ? annotated(found->text, found->keys()) : std::string{found->text});
  return ExitCode::done;
}

}  // namespace cleave::cli
