// docs/curve.schema.json against what the reader takes: every example is valid for both, and what the reader refuses
// for its form the schema refuses too.
#include <gtest/gtest.h>

#include <fmt/format.h>
#include <cstdlib>
#include <filesystem>

#include "retalho/core/error.h"
#include "retalho/curve/document.h"
#include "support/paths.h"
#include "support/support.h"

namespace retalho {
namespace {

/// 0: valid, 1: refused, other: the validator is not there (Debian's python3-jsonschema).
int validate(const std::string& file) {
  const std::string script =
      "import json,sys,jsonschema\n"
      "schema,value=(json.load(open(f)) for f in sys.argv[1:3])\n"
      "sys.exit(1 if list(jsonschema.Draft202012Validator(schema).iter_errors(value)) else 0)";
  const std::string schema = test::source_folder() + "/docs/curve.schema.json";
  return WEXITSTATUS(
      std::system(fmt::format("/usr/bin/python3 -c '{}' '{}' '{}' 2>/dev/null", script, schema, file).c_str()));
}

bool have_validator() {
  return std::system("/usr/bin/python3 -c 'import jsonschema' 2>/dev/null") == 0;
}

TEST(Schema, EveryExampleIsValid) {
  if (!have_validator()) GTEST_SKIP() << "python3-jsonschema is not installed";
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(test::source_folder() + "/examples/curves")) {
    EXPECT_EQ(validate(entry.path().string()), 0) << entry.path();
    ++files;
  }
  EXPECT_GE(files, 10U);
}

TEST(Schema, RefusesWhatTheReaderRefuses) {
  if (!have_validator()) GTEST_SKIP() << "python3-jsonschema is not installed";
  const test::ScratchFolder folder;
  const std::string good =
      folder.put("good.json", R"({"curves": [{"kind": "bezier", "points": [[0, 0], [1, 2], [3, 2], [4, 0]]}]})");
  EXPECT_EQ(validate(good), 0);
  EXPECT_NO_THROW(read_curves(good));
  for (const char* bad :
       {R"({"curves": [{"kind": "bezier", "points": [[0, 0], [1]]}]})",
        R"({"curves": [{"kind": "circle", "points": [[0, 0], [1, 1]]}]})", R"({"curves": [{"kind": "bezier"}]})",
        R"({"curves": {"kind": "bezier"}})", R"({"curves": [{"kind": "implicit", "f": "x"}]})",
        R"({"curves": [{"kind": "spline", "points": [[0, 0], [1, 1]], "ends": "loose"}]})"}) {
    const std::string file = folder.put("bad.json", bad);
    EXPECT_EQ(validate(file), 1) << bad;
    EXPECT_THROW(read_curves(file), Error) << bad;
  }
}

}  // namespace
}  // namespace retalho
