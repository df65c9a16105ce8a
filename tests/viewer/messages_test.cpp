// What the page's calls and its guard refuse, in their own words.
#include <gtest/gtest.h>

#include <functional>

#include "retalho/core/error.h"
#include "support/errors.h"
#include "viewer/calls.h"
#include "viewer/curve_calls.h"
#include "viewer/guard.h"
#include "viewer/patch_calls.h"
#include "viewer/terrain_calls.h"
#include "viewer/tetraquad_calls.h"

namespace retalho::viewer {
namespace {

using test::holds;
using test::words_of;

CallTable all_calls() {
  CallTable table;
  add_curve_calls(table, {});
  add_patch_calls(table, {});
  add_terrain_calls(table, {});
  add_tetraquad_calls(table, {});
  return table;
}

TEST(ViewerMessages, InputsAreNamed) {
  const Json input = Json::parse(R"({"a": 1.5, "b": "x"})");
  const std::pair<const char*, std::function<void()>> rows[] = {
      {"the call lacks 'c'", [&] { number(input, "c", 0, 1); }},
      {"'a' must be true or false", [&] { flag_or(input, "a", false); }},
      {"'b' must be one of: y, z",
       [&] {
         word(input, "b", {"y", "z"});
       }},
      {"'b' must be a text of at most 0 bytes", [&] { text(input, "b", 0); }},
  };
  for (const auto& [words, call] : rows) EXPECT_TRUE(holds(words_of<BadInput>(call), words));
}

TEST(ViewerMessages, CallsSayWhatTheyLack) {
  const CallTable table = all_calls();
  std::string many = R"({"kind": "bezier", "points": [[0, 0], [1, 1]]})";
  for (int k = 0; k < 64; ++k) many += R"(, {"kind": "bezier", "points": [[0, 0], [1, 1]]})";
  std::string patches = R"({"sides": [0, 1, 2]})";
  for (int k = 0; k < 32; ++k) patches += R"(, {"sides": [0, 1, 2]})";
  const std::string sides =
      R"({"curves": [{"kind": "bezier", "points": [[0,0],[1,0]]}, {"kind": "bezier", "points": [[1,0],[0,1]]},
                     {"kind": "bezier", "points": [[0,1],[0,0]]}], "patches": [)";
  const std::string cubic = R"("document": {"curves": [{"kind": "bezier", "points": [[0,0],[1,2],[3,2],[4,0]]}]})";
  struct Row {
    const char *words, *path;
    std::string body;
  };
  const Row rows[] = {
      {"the call lacks 'document'", "/api/curves/compute", "{}"},
      {"the call lacks 'document'", "/api/patches/compute", R"({"colour": "none"})"},
      {"the page shows at most 64 curves of 4000 points together", "/api/curves/compute",
       R"({"document": {"curves": [)" + many + "]}}"},
      {"a formula has no control points: this works on curves with a parameter", "/api/curves/change",
       R"({"document": {"curves": [{"kind": "explicit", "f": "x", "from": 0, "to": 1}]}, "curve": 0, "what": "bezier"})"},
      {"'what' must be one of: split, elevate, bezier", "/api/curves/change",
       "{" + cubic + R"(, "curve": 0, "what": "melt"})"},
      {"the page shows at most 32 patches, the document has 33", "/api/patches/compute",
       R"({"colour": "none", "divisions": 4, "recovery": "spr", "document": )" + sides + patches + "]}}"},
      {"this model is no longer kept: fit it again", "/api/terrain/detail", R"({"model": "none"})"},
      {"'points' must be 2 to 200 places {x, y}", "/api/terrain/profile", R"({"model": "none", "points": []})"},
  };
  for (const Row& row : rows)
    EXPECT_TRUE(holds(words_of<BadInput>([&] { table.at(row.path).run(Json::parse(row.body), {}); }), row.words))
        << row.path;
}

TEST(ViewerMessages, TheGuardSaysWhy) {
  const Secrets secrets("right", "once");
  const Guard guard{8000, &secrets, [](const std::string& path) { return path == "/"; },
                    [](const std::string& path) { return path == "/api/x"; }};
  const std::pair<std::string, std::string> host{"host", "127.0.0.1:8000"}, session{"x-retalho-session", "right"};
  struct Row {
    const char *words, *method, *path;
    bool in_session;
  };
  const Row rows[] = {
      {"the page is read with GET", "POST", "/", false},
      {"there is no such address here", "POST", "/api/y", false},
      {"calls are made with POST", "GET", "/api/x", false},
      {"the session's secret is missing or wrong", "POST", "/api/x", false},
      {"calls send application/json", "POST", "/api/x", true},
  };
  for (const Row& row : rows) {
    Request request;
    request.method = row.method;
    request.path = row.path;
    request.headers.insert(host);
    if (row.in_session) request.headers.insert(session);
    const auto refusal = refuse(guard, request);
    ASSERT_TRUE(refusal) << row.words;
    EXPECT_TRUE(holds(*refusal->body, row.words));
  }
}

}  // namespace
}  // namespace retalho::viewer
