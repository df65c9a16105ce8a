// OBJ as points: whose normals are whose, and what is refused with its line.
#include <gtest/gtest.h>

#include "retalho/cloud/cloud.h"
#include "retalho/cloud/formats.h"
#include "retalho/core/error.h"
#include "support/errors.h"
#include "support/support.h"

namespace retalho {
namespace {

PointCloud parse(const std::string& text, PointNotes& notes) {
  PointCloud cloud;
  parse_obj_points(text, "x.obj", cloud, notes);
  return cloud;
}

TEST(Obj, FacesSayWhoseNormalsTheyAre) {
  PointNotes notes;
  const PointCloud cloud = parse(
      "# a comment\nv 0 0 1\r\nv 1 0 1 0.5 0.5 0.5\nv 0 1 1e0\nvn 0 0 1\nvn 1 0 0\nvt 0 0\n"
      "f 1//1 2//1 3/1/2\nf -3//-2 2//1 3//1\n",
      notes);
  ASSERT_EQ(cloud.positions.size(), 3U);
  EXPECT_EQ(cloud.positions[1].x, 1);
  ASSERT_EQ(cloud.normals.size(), 3U);
  EXPECT_EQ(cloud.normals[0].z, 2);  // twice the first: their length does not count
  EXPECT_EQ(cloud.normals[2].x, 1);
  EXPECT_EQ(cloud.normals[2].z, 1);
}

TEST(Obj, AnEqualNumberOfNormalsStandsForItself) {
  PointNotes notes;
  EXPECT_EQ(parse("v 0 0 0\nvn 0 0 1\nv 1 2 3\nvn 0 1 0\n", notes).normals[1].y, 1);
  EXPECT_TRUE(notes.remarks.empty());
  EXPECT_TRUE(parse("v 0 0 0\nvn 0 0 1\nv 1 2 3\n", notes).normals.empty());
  ASSERT_EQ(notes.remarks.size(), 1U);
  EXPECT_TRUE(test::holds(notes.remarks[0], "1 normals for 2 vertices"));
  EXPECT_TRUE(parse("v 0 0 0\nv 1 2 3\nf 1 2 2\n", notes).normals.empty());
}

TEST(Obj, SaysWhatIsWrongAndWhere) {
  const auto message = [](const std::string& text) {
    PointNotes notes;
    return test::words_of<CannotRead>([&] { parse(text, notes); });
  };
  EXPECT_TRUE(test::holds(message("v 0 0 0\nv 1 2\n"), "line 2"));
  EXPECT_TRUE(test::holds(message("v 0 0,5 0\n"), "'0,5' is none"));
  EXPECT_TRUE(test::holds(message("v 0 0 0\nf 1 2 1\n"), "'2' is no vertex (there are 1 so far)"));
  EXPECT_TRUE(test::holds(message("v 0 0 0\nf 1//1 1//1 1//1\n"), "'1' is no normal"));
  EXPECT_TRUE(test::holds(message("v 0 0 0\nf 0 1 1\n"), "'0' is no vertex"));
  PointNotes notes;
  EXPECT_EQ(parse("v nan 0 0\nv 1 1 1\nv 1e999 0 0\n", notes).positions.size(), 1U);
  EXPECT_EQ(notes.skipped, 2U);
  const test::ScratchFolder folder;
  EXPECT_EQ(read_points(folder.put("a.obj", "v 0 0 0\nv 1 2 3\n")).positions.size(), 2U);
  EXPECT_THROW(read_points(folder.put("b.obj", "o nothing\n")), BadInput);
}

}  // namespace
}  // namespace retalho
