// Each rule of the house can fail: made-up source folders, one breach each, and nothing else found in them.
#include "house/rules.h"

#include <gtest/gtest.h>

#include "support/support.h"

namespace retalho {
namespace {

const char* const kPage =
    "# Page\n\n```\nsrc/retalho/\n  core/   ground\n         more words\n  tin/    first floor\n  render/ roof\n```\n"
    "  notaroom/  after the list\n";

/// A house of three rooms that keeps every rule.
class MadeUpHouse : public testing::Test {
 protected:
  void SetUp() override {
    put("docs/architecture.md", kPage);
    put("src/retalho/core/vec.h", "#pragma once\n#include <vector>\n");
    put("src/retalho/core/vec.cpp", "#include \"retalho/core/vec.h\"\n#include <unistd.h>\n#include <fmt/format.h>\n");
    put("src/retalho/tin/tin.h", "#pragma once\n#include \"retalho/core/vec.h\"\n");
    put("src/retalho/tin/parts.h", "// Pieces.\n// Internal to tin/.\n#include <fmt/format.h>\n");
    put("src/retalho/tin/tin.cpp", "#include \"retalho/tin/tin.h\"\n\n#include \"retalho/tin/parts.h\"\n");
    put("src/retalho/render/image.cpp", "#include <png.h>\n#include \"retalho/tin/tin.h\"\n");
  }
  void put(const std::string& name, const std::string& text) { folder_.put(name, text); }
  const std::filesystem::path& root() const { return folder_.path(); }
  std::vector<std::string> rooms() const { return house::rooms_of(root() / "docs/architecture.md"); }

  static void expect_one(const house::Breaches& breaches, const std::string& start, const std::string& words) {
    ASSERT_EQ(breaches.size(), 1U);
    EXPECT_EQ(breaches[0].substr(0, start.size()), start);
    EXPECT_NE(breaches[0].find(words), std::string::npos) << breaches[0];
  }

 private:
  test::ScratchFolder folder_;
};

TEST_F(MadeUpHouse, KeepsTheRules) {
  EXPECT_EQ(rooms(), (std::vector<std::string>{"core", "tin", "render"}));
  EXPECT_EQ(house::room_breaches(root(), rooms()), house::Breaches{});
  EXPECT_EQ(house::library_breaches(root()), house::Breaches{});
  EXPECT_EQ(house::length_breaches(root()), house::Breaches{});
  EXPECT_EQ(house::machine_breaches(root()), house::Breaches{});
}

TEST_F(MadeUpHouse, ARoomThatUsesARoomBelowItIsFound) {
  put("src/retalho/core/vec.cpp", "// words\n#  include  \"retalho/tin/tin.h\"\n");
  expect_one(house::room_breaches(root(), rooms()), "src/retalho/core/vec.cpp:2", "core uses tin");
  put("src/retalho/core/vec.cpp", "#include <retalho/render/image.h>\n");
  expect_one(house::room_breaches(root(), rooms()), "src/retalho/core/vec.cpp:1", "core uses render");
}

TEST_F(MadeUpHouse, ARoomThatIsNotOnTheListIsFound) {
  put("src/retalho/attic/box.cpp", "\n");
  expect_one(house::room_breaches(root(), rooms()), "src/retalho/attic/box.cpp:1", "attic is not a room");
  put("src/retalho/attic/box.cpp", "");
  std::filesystem::remove_all(root() / "src/retalho/attic");
  put("src/retalho/tin/tin.cpp", "#include \"retalho/attic/box.h\"\n");
  expect_one(house::room_breaches(root(), rooms()), "src/retalho/tin/tin.cpp:1", "attic is not a room");
}

TEST_F(MadeUpHouse, ALibraryInAPublicHeaderIsFound) {
  put("src/retalho/tin/tin.h", "#include <fmt/format.h>\n");
  expect_one(house::library_breaches(root()), "src/retalho/tin/tin.h:1", "in a public header");
  put("src/retalho/tin/tin.h", "#include <sys/stat.h>\n");
  expect_one(house::library_breaches(root()), "src/retalho/tin/tin.h:1", "in a public header");
}

TEST_F(MadeUpHouse, ALibraryInAnotherRoomIsFound) {
  put("src/retalho/tin/tin.cpp", "\n#include <gdal_priv.h>\n");
  expect_one(house::library_breaches(root()), "src/retalho/tin/tin.cpp:2", "GDAL");
  put("src/retalho/tin/tin.cpp", "#include <CGAL/Delaunay_triangulation_2.h>\n");
  expect_one(house::library_breaches(root()), "src/retalho/tin/tin.cpp:1", "CGAL");
  put("src/retalho/tin/tin.cpp", "#include <tbb/parallel_for.h>\n");
  expect_one(house::library_breaches(root()), "src/retalho/tin/tin.cpp:1", "oneTBB");
  put("src/retalho/tin/tin.cpp", "#include \"retalho/model/model_file_generated.h\"\n");
  expect_one(house::library_breaches(root()), "src/retalho/tin/tin.cpp:1", "FlatBuffers");
}

TEST_F(MadeUpHouse, AnUnknownLibraryIsFound) {
  put("src/retalho/tin/tin.cpp", "#include <boost/any.hpp>\n");
  expect_one(house::library_breaches(root()), "src/retalho/tin/tin.cpp:1", "no library of the table");
}

TEST_F(MadeUpHouse, AnInternalOrMissingHeaderInAPublicOneIsFound) {
  put("src/retalho/tin/tin.h", "#include \"retalho/tin/parts.h\"\n");
  expect_one(house::library_breaches(root()), "src/retalho/tin/tin.h:1", "is internal");
  put("src/retalho/tin/tin.h", "#include \"retalho/tin/gone.h\"\n");
  expect_one(house::library_breaches(root()), "src/retalho/tin/tin.h:1", "does not exist");
}

TEST_F(MadeUpHouse, ALongFileIsFound) {
  std::string text;
  for (int i = 0; i < 500; ++i) text += "//\n";
  put("app/main.cpp", text);
  EXPECT_EQ(house::length_breaches(root()), house::Breaches{});
  put("app/main.cpp", text + "//\n");
  expect_one(house::length_breaches(root()), "app/main.cpp", "501 lines");
}

TEST_F(MadeUpHouse, AFolderOfOneMachineIsFound) {
  for (const std::string folder : {"home", "work", "root"}) {
    put("README.md", "see `/" + folder + "/data/dem`\n");
    expect_one(house::machine_breaches(root()), "README.md:1", "folder of one machine");
  }
  put("README.md", "a home/made house/work/shop and ${prefix}/root/x and /usr/bin/env\n");
  EXPECT_EQ(house::machine_breaches(root()), house::Breaches{});
}

TEST_F(MadeUpHouse, TheHostOfARegistryIsFound) {
  put("package-lock.json",
      "{\n\"resolved\": \"https:/"
      "/registry.example.org/x.tgz\"}\n");
  expect_one(house::machine_breaches(root()), "package-lock.json:2", "host of a registry");
  put("package-lock.json",
      "{\"homepage\": \"https:/"
      "/example.org/registry\"}\n");
  EXPECT_EQ(house::machine_breaches(root()), house::Breaches{});
}

}  // namespace
}  // namespace retalho
