#pragma once

#include <nlohmann/json.hpp>

#include "program.hpp"

namespace cleave::cli::test {

/// `cleave survey` on a text, as a user would call it.
class SurveyProgramTest : public ProgramTest {
 protected:
  /// survey.json of what is done.
  [[nodiscard]] nlohmann::json survey(const std::string& text) const {
    write("d.toml", text);
    const Ended run = cleave("survey d.toml -o out");
    EXPECT_EQ(run.code, 0) << run.err;
    return run.code == 0 ? nlohmann::json::parse(read("out/survey.json")) : nlohmann::json{};
  }
  /// What is said of wrong data.
  [[nodiscard]] std::string refusal(const std::string& text) const {
    write("d.toml", text);
    fs::remove_all(path("out"));
    const Ended run = cleave("survey d.toml -o out");
    EXPECT_EQ(run.code, 2) << run.out;
    EXPECT_FALSE(exists("out"));
    return run.err;
  }
};

}  // namespace cleave::cli::test
