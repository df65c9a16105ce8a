// Who may ask what (viewer/guard.h).
#include "viewer/guard.h"

#include <gtest/gtest.h>

#include <set>

namespace retalho::viewer {
namespace {

Guard sample_guard() {
  static const Secrets secrets("secret", "token");
  return {4321, &secrets, [](const std::string& p) { return p == "/"; },
          [](const std::string& p) { return p == "/api/x"; }};
}

Request good_call() {
  return {"POST",
          "/api/x",
          {{"host", "127.0.0.1:4321"},
           {"origin", "http://127.0.0.1:4321"},
           {"x-retalho-session", "secret"},
           {"content-type", "application/json"}},
          "{}"};
}

int status_of(const Request& request) {
  const std::optional<Reply> refusal = refuse(sample_guard(), request);
  return refusal ? refusal->status : 200;
}

int with(const std::string& name, const std::string& value) {
  Request request = good_call();
  if (value.empty())
    request.headers.erase(name);
  else
    request.headers[name] = value;
  return status_of(request);
}

TEST(Guard, LetsThePageCall) {
  EXPECT_EQ(status_of(good_call()), 200);
  EXPECT_EQ(with("host", "localhost:4321"), 200);
  EXPECT_EQ(with("origin", "http://localhost:4321"), 200);
  EXPECT_EQ(with("sec-fetch-site", "same-origin"), 200);
}

TEST(Guard, RefusesEachHeaderThatIsWrong) {
  for (const char* host : {"", "evil.example:4321", "127.0.0.1", "127.0.0.1:4322", "127.0.0.1:43210",
                           "127.0.0.1:4321, evil.example", "localhost.evil.example:4321"})
    EXPECT_EQ(with("host", host), 421) << host;
  for (const char* origin : {"null", "https://127.0.0.1:4321", "http://127.0.0.1:4322", "http://evil.example",
                             "http://127.0.0.1:4321.evil.example"})
    EXPECT_EQ(with("origin", origin), 403) << origin;
  for (const char* site : {"cross-site", "same-site", "none"}) EXPECT_EQ(with("sec-fetch-site", site), 403) << site;
  for (const char* secret : {"", "Secret", "secre", "secret1", "token"})
    EXPECT_EQ(with("x-retalho-session", secret), 403) << secret;
  for (const char* type : {"", "text/plain", "multipart/form-data"}) EXPECT_EQ(with("content-type", type), 415) << type;
}

TEST(Guard, KnowsItsAddressesAlone) {
  Request request = good_call();
  for (const char* path : {"/api/y", "/api/x/", "/api/../api/x", "/index.html", ""}) {
    request.path = path;
    EXPECT_EQ(status_of(request), 404) << path;
  }
  request.path = "/api/x";
  request.method = "GET";
  EXPECT_EQ(status_of(request), 405);
  request = {"GET", "/", {{"host", "127.0.0.1:4321"}}, ""};
  EXPECT_EQ(status_of(request), 200);  // the page has no secret: none is asked for
  request.method = "POST";
  EXPECT_EQ(status_of(request), 405);
}

TEST(Guard, TheExchangeNeedsATokenAndNoSession) {
  Request request = good_call();
  request.path = kExchangePath;
  request.headers.erase("x-retalho-session");
  EXPECT_EQ(status_of(request), 403);
  request.headers[kTokenHeader] = "token";
  EXPECT_EQ(status_of(request), 200);
  for (const char* token : {"", "Token", "toke", "token1", "secret"}) {
    request.headers[kTokenHeader] = token;
    EXPECT_EQ(status_of(request), 403) << token;
  }
  request.headers[kTokenHeader] = "token";
  request.headers["origin"] = "http://evil.example";
  EXPECT_EQ(status_of(request), 403);
  request.headers.erase("origin");
  request.method = "GET";
  EXPECT_EQ(status_of(request), 405);
}

TEST(Guard, ATokenIsGoodOnce) {
  Secrets secrets("secret", "first");
  EXPECT_FALSE(secrets.exchange("other"));
  EXPECT_TRUE(secrets.has_token("first"));
  EXPECT_EQ(secrets.exchange("first"), "secret");
  EXPECT_FALSE(secrets.has_token("first"));
  EXPECT_FALSE(secrets.exchange("first"));
  const std::string second = secrets.token();
  EXPECT_TRUE(secrets.has_token(second));
  for (std::size_t k = 0; k < Secrets::kMostTokens; ++k) secrets.token();
  EXPECT_FALSE(secrets.has_token(second)) << "the oldest is dropped";
  EXPECT_FALSE(secrets.is_session("first"));
  EXPECT_TRUE(secrets.is_session("secret"));
}

TEST(Guard, TokensAreLongAndNeverTheSame) {
  std::set<std::string> seen;
  for (int k = 0; k < 200; ++k) {
    const std::string token = make_token();
    EXPECT_EQ(token.size(), 32U);
    EXPECT_EQ(token.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_"),
              std::string::npos);
    EXPECT_TRUE(seen.insert(token).second);
  }
}

}  // namespace
}  // namespace retalho::viewer
