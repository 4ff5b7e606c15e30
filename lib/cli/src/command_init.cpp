#include "commands.hpp"
#include "init_texts.hpp"

namespace cleave::cli {

ExitCode init_scene(const std::string& kind) {
  if (const auto text = init_text(kind)) {
    say(std::string{*text});
    return ExitCode::done;
  }
  complain("cleave init: \"" + kind +
           "\" is not known; choose one of: tunnel, slope, wedge, network, monte-carlo, bodies, contact, support, "
           "survey, bench, csv, water, motion");
  return ExitCode::wrong_input;
}

}  // namespace cleave::cli
