#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "cleave/realize/run_result.hpp"

/// Pieces that all of cleave's pages share. Text given is HTML.
namespace cleave::report::detail {

/// Up to and with <main>: title, style, heading, a line below it. `style` follows the style of all pages.
[[nodiscard]] std::string page_begin(const std::string& title, const std::string& sub,
                                     std::span<const std::string_view> style = {});
/// What [project] says, before the rest of the line below the heading.
[[nodiscard]] std::string project_line(const scene::Project& project);
/// From </main> to the foot; `more` stands in the footer.
[[nodiscard]] std::string page_foot(std::string_view more = {});
[[nodiscard]] std::string script(std::span<const std::string_view> pieces);
/// The data that a page's scripts read.
[[nodiscard]] std::string data_script(std::string_view json);
inline constexpr std::string_view page_end = "</body>\n</html>\n";

[[nodiscard]] std::string key_figure(std::string_view label, const std::string& figure, const std::string& below,
                                     std::string_view kind = "");
/// A table of facts from its rows, and one of them.
[[nodiscard]] std::string facts_table(std::string_view rows);
[[nodiscard]] std::string fact(std::string_view name, const std::string& value, std::string_view kind = "");
[[nodiscard]] std::string plan_section(const scene::Plan& plan);
[[nodiscard]] std::string cost_section(const scene::RunCost& cost);
/// Under the heading `id="notes"`.
[[nodiscard]] std::string notes_list(std::span<const std::string> notes);
/// How many notes there are, as a figure that leads to them; empty for none.
[[nodiscard]] std::string notes_figure(std::size_t count);

/// Rows of a table of facts: what a page comes from. `kind`: "Scene", "Survey".
[[nodiscard]] std::string input_rows(std::string_view kind, const std::string& file, const std::string& sha256,
                                     std::span<const scene::InputFile> files, std::optional<std::uint64_t> seed);
/// What the figures rest on and leave out.
[[nodiscard]] std::string limits_list(std::span<const std::string_view> limits);
/// Inputs and limits of a page that has nothing to add to them.
[[nodiscard]] std::string inputs_section(std::string_view rows, std::span<const std::string_view> limits);

}  // namespace cleave::report::detail
