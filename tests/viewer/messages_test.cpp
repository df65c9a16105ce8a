// What the page's calls and its guard refuse, in their own words.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <functional>
#include <memory>

#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"
#include "retalho/model/model.h"
#include "support/errors.h"
#include "support/sample_patches.h"
#include "support/sample_terrain.h"
#include "support/sample_tetraquad.h"
#include "support/support.h"
#include "viewer/calls.h"
#include "viewer/curve_calls.h"
#include "viewer/guard.h"
#include "viewer/http_server.h"
#include "viewer/input_files.h"
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

TEST(ViewerMessages, CallsSayWhatTheirFilesLack) {
  InputFiles inputs;
  inputs.terrains.push_back({"m.retalho", "", nullptr,
                             std::make_shared<const Terrain>(
                                 test::sample_terrain({.kind = SurfaceKind::linear, .columns = 70, .rows = 70}))});
  inputs.patches.push_back({"curves.json", "", Json::object(), nullptr});
  inputs.tetraquads.push_back({"ball", "", std::make_shared<const TetraQuad>(test::sample_tetraquad())});
  inputs.tetraquads.push_back(
      {"many", "", std::make_shared<const TetraQuad>(test::sample_tetraquad(TetSplit::kuhn, 21))});  // 6 x 42^3
  CallTable table;
  add_curve_calls(table, inputs);
  add_patch_calls(table, inputs);
  add_terrain_calls(table, inputs);
  add_tetraquad_calls(table, inputs);
  table.at("/api/terrain/fit").run(Json::parse(R"({"file": 0, "triangles": 1000})"), {});  // loads it, as model "0"
  struct Row {
    const char *words, *path, *body;
  };
  const Row rows[] = {
      {"this file holds curves and no model", "/api/patches/compute", R"({"colour": "none", "model": 0})"},
      {"'eye' must be three numbers", "/api/terrain/detail", R"({"model": "0", "triangles": 1000, "eye": [1, 2]})"},
      {"'forward' must be three numbers", "/api/terrain/detail",
       R"({"model": "0", "triangles": 1000, "eye": [1, 2, 3], "forward": 4})"},
      {"a model file has no grid beside it: open the DEM to see errors", "/api/terrain/errors",
       R"({"model": "0", "size": 16})"},
      {"these contours have too many points to draw: choose a larger interval", "/api/terrain/contours",
       R"({"model": "0", "interval": 3})"},
      {"'origin' must be three numbers", "/api/tetraquads/ray", R"({"file": 0, "origin": [1, 2]})"},
      {"444528 tetrahedra are more than the page draws (400000)", "/api/tetraquads/load", R"({"file": 1})"},
      {"there is a join at this parameter already", "/api/curves/change",
       R"({"document": {"curves": [{"kind": "polyline", "points": [[0,0],[1,2],[2,0]]}]}, "curve": 0, "what": "split",
           "t": 0.5})"},
  };
  for (const Row& row : rows)
    EXPECT_TRUE(holds(words_of<BadInput>([&] { table.at(row.path).run(Json::parse(row.body), {}); }), row.words))
        << row.path;
}

TEST(ViewerMessages, FilesThatThePageCannotDrawAreNamed) {
  const test::ScratchFolder scratch;
  const auto file = [&](const char* name) { return (scratch.path() / name).string(); };
  write_file(file("two.asc"), "ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2\n", false);
  save_model(test::sample_tetraquad(TetSplit::kuhn, 21), file("many.retalho"), false);  // 6 x 42^3
  PatchSet fine = test::sample_patches(90);
  while (fine.patches.size() < 50) fine.patches.push_back(fine.patches[0]);
  save_model(fine, file("fine.retalho"), false);
  test::expect_refused<BadInput>({
      {"two.asc' has fewer than three heights: there is no surface", [&] { read_inputs({file("two.asc")}, {}); }},
      {"many.retalho' has 444528 tetrahedra, more than the page draws (400000): draw it with `retalho render`",
       [&] { read_inputs({file("many.retalho")}, {}); }},
      {"triangles, more than the page draws (400000): draw it with `retalho render`",
       [&] { read_inputs({file("fine.retalho")}, {}); }},
  });
}

TEST(ViewerMessages, TheGuardSaysWhy) {
  const Secrets secrets("right", "once");
  const Guard guard{8000, &secrets, [](const std::string& path) { return path == "/"; },
                    [](const std::string& path) { return path == "/api/x"; }};
  const std::pair<std::string, std::string> host{"host", "127.0.0.1:8000"}, session{"x-retalho-session", "right"};
  Request astray;
  astray.headers.insert({"host", "elsewhere.example:8000"});
  const auto no = refuse(guard, astray);
  ASSERT_TRUE(no);
  EXPECT_TRUE(holds(*no->body, "the Host header names another machine: this server answers to 127.0.0.1 only"));
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

TEST(ViewerMessages, AServerWithoutAPortSaysSo) {
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit none{0, before.rlim_max};  // no file, no socket can be opened
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &none), 0);
  const std::string words = words_of<Error>([] { HttpServer({}, {}); });
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &before), 0);
  EXPECT_TRUE(holds(words, "cannot listen on 127.0.0.1: the system gives no port to this program"));
}

}  // namespace
}  // namespace retalho::viewer
