#include "viewer.h"

#include <fmt/format.h>

#include <chrono>
#include <thread>

#include "curve_calls.h"
#include "guard.h"
#include "page.h"
#include "patch_calls.h"
#include "retalho/core/error.h"
#include "terrain_calls.h"
#include "tetraquad_calls.h"
#include "work.h"

namespace retalho::viewer {
namespace {

const PageFile* find_page(const std::string& path) {
  const std::string_view wanted = path == "/" ? std::string_view("/index.html") : std::string_view(path);
  for (const PageFile& file : page_files())
    if (file.path == wanted) return &file;
  return nullptr;
}

Reply page_reply(const PageFile& file) {
  Reply reply;
  reply.type = std::string(file.type);
  reply.body = std::make_shared<const std::string>(file.gzip);
  reply.headers = {{"Content-Encoding", "gzip"}};
  return reply;
}

Reply exchange_token(Secrets& secrets, const Request& request) {
  const auto at = request.headers.find(kTokenHeader);
  const auto session = at == request.headers.end() ? std::nullopt : secrets.exchange(at->second);
  // Two who ask at the same moment may both have been admitted: one of them comes here first.
  if (!session) return error_reply(403, "refused", "this address has been used already");
  Reply reply;
  reply.type = "application/json";
  reply.body = std::make_shared<const std::string>(Json{{"session", *session}}.dump());
  return reply;
}

/// What every reply says to the browser: nothing from elsewhere, no frames around us, nothing kept.
const std::vector<std::pair<std::string, std::string>>& safe_headers() {
  static const std::vector<std::pair<std::string, std::string>> headers{
      {"Content-Security-Policy",
       "default-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'; object-src 'none'"},
      {"X-Content-Type-Options", "nosniff"},
      {"Referrer-Policy", "no-referrer"},
      {"Cross-Origin-Opener-Policy", "same-origin"},
      {"Cross-Origin-Resource-Policy", "same-origin"},
      {"Cache-Control", "no-store"}};
  return headers;
}

}  // namespace

bool has_page() {
  return find_page("/") != nullptr;
}

void serve(const InputFiles& inputs, int threads, const std::atomic<bool>& stop,
           const std::function<void(const std::string& address)>& ready) {
  if (!has_page())
    throw Error(Error::Kind::internal,
                "this program was built without the page: install nodejs and npm, run scripts/setup, and try again");
  CallTable table;
  add_terrain_calls(table, inputs);
  add_curve_calls(table, inputs);
  add_patch_calls(table, inputs);
  add_tetraquad_calls(table, inputs);
  Secrets secrets;
  // A further tab of the same user: the page asks for an address of its own.
  table["/api/session/token"] = {Call::Kind::quick, [&secrets](const Json&, const Context&) {
                                   return Answer{{{"token", secrets.token()}}};
                                 }};
  Workers workers(std::move(table), threads);
  Guard guard;
  guard.secrets = &secrets;
  guard.is_page = [](const std::string& path) { return find_page(path) != nullptr; };
  guard.is_call = [&workers](const std::string& path) { return workers.knows(path); };
  // The port is known when the server runs already: what comes before `open` is refused.
  std::atomic<bool> open{false};
  ServerHooks hooks;
  hooks.admit = [&](const Request& request) {
    return open ? refuse(guard, request) : std::optional<Reply>(error_reply(503, "busy", "not ready yet"));
  };
  hooks.handle = [&](std::shared_ptr<Exchange> exchange) {
    if (exchange->request().path == kExchangePath)
      exchange->reply(exchange_token(secrets, exchange->request()));
    else if (const PageFile* file = find_page(exchange->request().path))
      exchange->reply(page_reply(*file));
    else
      workers.submit(std::move(exchange));
  };
  hooks.headers = safe_headers();
  const HttpServer server(std::move(hooks), {});
  guard.port = server.port();
  open = true;
  ready(fmt::format("http://127.0.0.1:{}/#token={}", guard.port, secrets.token()));
  while (!stop) std::this_thread::sleep_for(std::chrono::milliseconds(50));
}

}  // namespace retalho::viewer
