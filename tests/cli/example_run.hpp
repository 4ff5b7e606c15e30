#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "program.hpp"

namespace cleave::cli::test {

/// Every null of a result has its reason beside it: `NAME_reason` (without the unit), or `reason` of the object.
inline void expect_reasons(const nlohmann::json& value, const std::string& where) {
  if (value.is_array()) {
    for (const auto& element : value) expect_reasons(element, where + "[]");
  }
  if (!value.is_object()) return;
  for (const auto& [name, member] : value.items()) {
    if (!member.is_null()) {
      expect_reasons(member, where + "." + name);
      continue;
    }
    const std::string plain = name.substr(0, name.find_last_of('_'));
    EXPECT_TRUE(value.contains("reason") || value.contains(name + "_reason") || value.contains(plain + "_reason"))
        << where << "." << name;
  }
}

/// Runs scenes of examples/ and looks at what holds for every result.
class ExampleRun : public ProgramTest {
 protected:
  [[nodiscard]] static std::string file(const std::string& name, const std::string& of) {
    return std::string{CLEAVE_SOURCE_DIR} + "/examples/" + name + "/" + of;
  }
  /// summary.json of NAME/NAME.toml, run into NAME.
  [[nodiscard]] nlohmann::json result_of(const std::string& name) const {
    const Ended run = cleave("run '" + file(name, name + ".toml") + "' --quiet -o " + name);
    EXPECT_EQ(run.code, 0) << run.err;
    const auto result = nlohmann::json::parse(read(name + "/summary.json"));
    EXPECT_TRUE(result["blocks"]["certificate"]["passed"]);
    EXPECT_LE(result["blocks"]["volume_relative_error"].get<double>(), 1e-12);
    expect_reasons(result, name);
    return result;
  }
};

}  // namespace cleave::cli::test
