#pragma once

#include <string>
#include <string_view>

#include "cleave/report/summary.hpp"

/// Pieces that all of cleave's pages share.
namespace cleave::report::detail {

/// Up to and with <main>: title, style, heading. `sub` is HTML.
[[nodiscard]] std::string page_begin(const std::string& title, const std::string& sub);
[[nodiscard]] std::string page_end();
[[nodiscard]] std::string key_figure(std::string_view label, const std::string& figure, const std::string& below,
                                     std::string_view kind = "");
[[nodiscard]] std::string plan_part(const Summary& summary);
[[nodiscard]] std::string cost_part(const CostTable& cost);

}  // namespace cleave::report::detail
