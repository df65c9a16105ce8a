// This repository keeps the rules of docs/architecture.md.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "house/rules.h"
#include "support/paths.h"

namespace retalho {
namespace {

const house::Path kSource = test::source_folder();

void expect_none(const house::Breaches& breaches) {
  EXPECT_TRUE(breaches.empty()) << fmt::format("{}", fmt::join(breaches, "\n"));
}

TEST(House, TheListOfRoomsIsTheArchitectures) {
  const auto rooms = house::rooms_of(kSource / "docs" / "architecture.md");
  EXPECT_EQ(fmt::format("{}", fmt::join(rooms, " ")),
            "core bernstein raster cloud curve tin terrain level visibility patch tetraquad mesh model tiles render");
}

TEST(House, NoRoomUsesARoomBelowIt) {
  expect_none(house::room_breaches(kSource, house::rooms_of(kSource / "docs" / "architecture.md")));
}

TEST(House, LibrariesStandWhereTheyMayAndNeverInPublicHeaders) {
  expect_none(house::library_breaches(kSource));
}

TEST(House, NoFileIsTooLong) {
  expect_none(house::length_breaches(kSource));
}

TEST(House, NothingNamesOneMachine) {
  expect_none(house::machine_breaches(kSource));
}

}  // namespace
}  // namespace retalho
