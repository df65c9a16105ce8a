#include "guard.h"

#include <fmt/format.h>
#include <sys/random.h>

#include <array>
#include <nlohmann/json.hpp>

#include "retalho/core/error.h"

namespace retalho::viewer {
namespace {

std::string header(const Request& request, const char* name) {
  const auto at = request.headers.find(name);
  return at == request.headers.end() ? std::string() : at->second;
}

bool is_ours(const Guard& guard, const std::string& host) {
  return host == fmt::format("127.0.0.1:{}", guard.port) || host == fmt::format("localhost:{}", guard.port);
}

}  // namespace

std::string make_token() {
  static constexpr char kLetters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
  std::array<unsigned char, 32> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw Error(Error::Kind::internal, "the system gives no random numbers for the page's token");
  std::string token;
  for (const unsigned char byte : bytes) token += kLetters[byte % 64];
  return token;
}

std::string Secrets::token() {
  const std::lock_guard lock(mutex_);
  tokens_.push_back(make_token());
  if (tokens_.size() > kMostTokens) tokens_.pop_front();
  return tokens_.back();
}

bool Secrets::has_token(const std::string& token) const {
  const std::lock_guard lock(mutex_);
  bool found = false;
  for (const std::string& one : tokens_) found |= same_secret(one, token);
  return found;
}

std::optional<std::string> Secrets::exchange(const std::string& token) {
  const std::lock_guard lock(mutex_);
  if (std::erase_if(tokens_, [&](const std::string& one) { return same_secret(one, token); }) == 0) return std::nullopt;
  return session_;
}

bool same_secret(const std::string& a, const std::string& b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    difference |= static_cast<unsigned>(static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]));
  return difference == 0;
}

Reply error_reply(int status, const std::string& kind, const std::string& message) {
  const nlohmann::ordered_json json = {{"error", {{"kind", kind}, {"message", message}}}};
  Reply reply;
  reply.status = status;
  reply.type = "application/json";
  reply.body =
      std::make_shared<const std::string>(json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  return reply;
}

std::optional<Reply> refuse(const Guard& guard, const Request& request) {
  const auto no = [](int status, const std::string& words) { return error_reply(status, "refused", words); };
  if (!is_ours(guard, header(request, "host")))
    return no(421, "the Host header names another machine: this server answers to 127.0.0.1 only");
  const std::string origin = header(request, "origin");
  if (!origin.empty() && (origin.rfind("http://", 0) != 0 || !is_ours(guard, origin.substr(7))))
    return no(403, "the request comes from another site");
  if (guard.is_page(request.path)) {
    if (request.method != "GET" && request.method != "HEAD") return no(405, "the page is read with GET");
    return std::nullopt;
  }
  const bool exchange = request.path == kExchangePath;
  if (!exchange && !guard.is_call(request.path)) return no(404, "there is no such address here");
  if (request.method != "POST") return no(405, "calls are made with POST");
  const std::string site = header(request, "sec-fetch-site");
  if (!site.empty() && site != "same-origin") return no(403, "the request comes from another site");
  if (exchange && !guard.secrets->has_token(header(request, kTokenHeader)))
    return no(403, "this address has been used already, or is not the one that `retalho view` printed");
  if (!exchange && !guard.secrets->is_session(header(request, "x-retalho-session")))
    return no(403, "the session's secret is missing or wrong: use the address that `retalho view` printed");
  if (header(request, "content-type") != "application/json") return no(415, "calls send application/json");
  return std::nullopt;
}

}  // namespace retalho::viewer
