#pragma once

#include <string>
#include <string_view>

/// What is made from the declarations of keys (keys.hpp): nothing of it is written by hand.
namespace cleave::scene {

/// docs/scene.schema.json.
[[nodiscard]] std::string schema_text();
/// The page with the rows of its tables between `<!-- keys NAME -->` and `<!-- end of keys -->` made anew.
[[nodiscard]] std::string with_key_tables(std::string_view page);
/// fuzz/cleave.dict with its units and tables made anew.
[[nodiscard]] std::string with_units(std::string_view dictionary);

}  // namespace cleave::scene
