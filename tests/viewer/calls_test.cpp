// Answers in binary and inputs that are checked (viewer/calls.h), and what is embedded (viewer/page.h).
#include "viewer/calls.h"

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <iterator>

#include "retalho/core/error.h"
#include "support/paths.h"
#include "support/support.h"
#include "viewer/page.h"

namespace retalho::viewer {
namespace {

TEST(Calls, AnswersArePackedAsTheHeaderSays) {
  for (const std::size_t length : {0, 1, 7, 8, 9, 100}) {  // the header's own length changes what is padded
    const std::vector<float> a{1.5F, -2, 3};
    const std::vector<double> b{0.1};
    const std::vector<std::uint8_t> c{7, 8, 9};
    const std::string packed =
        pack({{{"text", std::string(length, 'x')}}, {make_array("a", a), make_array("b", b), make_array("c", c)}});
    ASSERT_EQ(packed.substr(0, 4), "RTL1");
    std::uint32_t header_size = 0;
    std::memcpy(&header_size, packed.data() + 4, 4);
    const Json header = Json::parse(packed.substr(8, header_size));
    EXPECT_EQ(header.at("words").at("text").get<std::string>().size(), length);
    const std::size_t start = (8 + header_size + 7) / 8 * 8;
    const auto at = [&](int k) {
      return packed.data() + start + header.at("arrays").at(k).at("offset").get<std::size_t>();
    };
    for (const Json& array : header.at("arrays")) EXPECT_EQ(array.at("offset").get<std::size_t>() % 8, 0U);
    EXPECT_EQ(header.at("arrays").at(0).at("count"), 3);
    EXPECT_EQ(std::memcmp(at(0), a.data(), 12), 0);
    EXPECT_EQ(header.at("arrays").at(1).at("type"), "f64");
    EXPECT_EQ(std::memcmp(at(1), b.data(), 8), 0);
    EXPECT_EQ(std::memcmp(at(2), c.data(), 3), 0);
    EXPECT_EQ(packed.size() % 8, 0U);
  }
}

TEST(Calls, WrongInputsAreNamed) {
  const Json input = Json::parse(R"({"a": 1.5, "b": "x", "c": true, "d": null, "e": 1e300})");
  const auto place = [](auto&& call) {
    try {
      call();
    } catch (const BadInput& error) {
      return error.where();
    }
    return std::string();
  };
  EXPECT_EQ(number(input, "a", 0, 2), 1.5);
  EXPECT_EQ(place([&] { number(input, "a", 2, 3); }), "a");
  EXPECT_EQ(place([&] { number(input, "b", 2, 3); }), "b");
  EXPECT_EQ(place([&] { number(input, "d", 2, 3); }), "d");
  EXPECT_EQ(place([&] { number(input, "missing", 2, 3); }), "missing");
  EXPECT_EQ(place([&] { whole(input, "a", 0, 9); }), "a");
  EXPECT_EQ(place([&] { whole(input, "e", 0, 9); }), "e");
  EXPECT_EQ(place([&] { flag_or(input, "a", false); }), "a");
  EXPECT_TRUE(flag_or(input, "c", false));
  EXPECT_EQ(place([&] { word(input, "b", {"y", "z"}); }), "b");
  EXPECT_EQ(word(input, "b", {"x"}), "x");
  EXPECT_EQ(place([&] { text(input, "b", 0); }), "b");
  EXPECT_EQ(place([&] { text(input, "a", 9); }), "a");
}

TEST(Page, IsUnderOneMegabyteCompressed) {
  if (page_files().empty()) GTEST_SKIP() << "the program was built without the page (scripts/page)";
  std::size_t bytes = 0;
  for (const PageFile& file : page_files()) {
    bytes += file.gzip.size();
    EXPECT_EQ(file.gzip.substr(0, 2), "\x1f\x8b") << file.path;
  }
  EXPECT_LE(bytes, 1'000'000U);
  EXPECT_GT(bytes, 50'000U);
}

TEST(Page, LockFileHoldsNoDownloadAddress) {
  std::ifstream in(test::source_folder() + "/viewer/web/package-lock.json");
  const std::string lock{std::istreambuf_iterator<char>(in), {}};
  ASSERT_NE(lock.find("node_modules/three"), std::string::npos);
  EXPECT_NE(lock.find("\"integrity\""), std::string::npos);
  EXPECT_EQ(lock.find("\"resolved\""), std::string::npos);
  EXPECT_EQ(lock.find(".tgz"), std::string::npos);
}

}  // namespace
}  // namespace retalho::viewer
