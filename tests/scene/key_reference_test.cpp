// docs/scene.schema.json, the tables of keys in docs and the units of fuzz/cleave.dict are made from the declarations
// of keys: run this test with CLEAVE_GOLDEN=1 in the environment to write them anew.
#include "key_reference.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

namespace cleave::scene {
namespace {

std::string file_of(const std::string& name) {
  std::ifstream file{std::string{CLEAVE_SOURCE_DIR} + "/" + name, std::ios::binary};
  return {std::istreambuf_iterator<char>{file}, std::istreambuf_iterator<char>{}};
}

void compare(const std::string& name, const std::string& made) {
  if (std::getenv("CLEAVE_GOLDEN") != nullptr) {
    std::ofstream{std::string{CLEAVE_SOURCE_DIR} + "/" + name, std::ios::binary} << made;
  }
  EXPECT_TRUE(file_of(name) == made) << name << " is not what the keys make: run this test with CLEAVE_GOLDEN=1";
}

TEST(KeyReference, SchemaIsMadeFromTheKeys) {
  const std::string made = schema_text();
  EXPECT_EQ(made.find("two tables are called"), std::string::npos) << made.substr(made.find("two tables"), 80);
  compare("docs/scene.schema.json", made);
}

TEST(KeyReference, TablesOfDocsAreMadeFromTheKeys) {
  for (const std::string page : {"docs/scene.md", "docs/survey.md"}) {
    const std::string made = with_key_tables(file_of(page));
    EXPECT_EQ(made.find("there is no table"), std::string::npos) << made.substr(made.find("there is no table"), 80);
    compare(page, made);
  }
}

// Keys and words they take from the schema (fuzz/words.py).
TEST(KeyReference, FuzzersKnowAllUnitsAndTables) {
  compare("fuzz/cleave.dict", with_units(file_of("fuzz/cleave.dict")));
}

}  // namespace
}  // namespace cleave::scene
