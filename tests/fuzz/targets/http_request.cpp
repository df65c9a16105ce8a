// Requests to the page's server, from their headers to the calls' own arguments: the guard refuses or the call answers,
// with words and a status, whatever the bytes. The first byte says whether the request has the right secret and host,
// so that half of them reach the calls. HTTP's own syntax is libmicrohttpd's.
#include <nlohmann/json.hpp>

#include "target.h"
#include "viewer/calls.h"
#include "viewer/curve_calls.h"
#include "viewer/guard.h"
#include "viewer/patch_calls.h"

namespace {

using namespace retalho;
using namespace retalho::viewer;

const CallTable& calls() {
  static const CallTable table = [] {
    CallTable made;
    add_curve_calls(made, {});
    add_patch_calls(made, {});
    return made;
  }();
  return table;
}

std::string_view take_line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

Request request_of(std::string_view text) {
  Request request;
  const std::string_view first = take_line(text);
  const std::size_t space = std::min(first.find(' '), first.size());
  request.method = first.substr(0, space);
  request.path = first.substr(std::min(space + 1, first.size()));
  for (std::string_view line = take_line(text); !line.empty(); line = take_line(text)) {
    const std::size_t colon = std::min(line.find(':'), line.size());
    request.headers[std::string(line.substr(0, colon))] = line.substr(std::min(colon + 1, line.size()));
  }
  request.body = text;
  return request;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0 || size > 8192) return 0;
  Request request = request_of(fuzz::text_of(data + 1, size - 1));
  const bool trusted = data[0] % 2 == 1;
  if (trusted) {
    request.method = "POST";
    request.headers = {
        {"host", "127.0.0.1:8000"}, {"x-retalho-session", "right"}, {"content-type", "application/json"}};
  }
  static const Secrets secrets("right", "once");
  const Guard guard{8000, &secrets, [](const std::string& path) { return path == "/"; },
                    [](const std::string& path) { return calls().count(path) > 0; }};
  const auto refusal = refuse(guard, request);
  if (refusal) {
    fuzz::require(refusal->status >= 400 && refusal->status < 500, "a refusal that is none");
    fuzz::require(nlohmann::json::accept(*refusal->body), "a refusal that is no JSON");
    fuzz::require(!trusted || calls().count(request.path) == 0, "a right request was refused");
    return 0;
  }
  if (request.path == "/") return 0;
  if (request.path == kExchangePath) {
    fuzz::require(request.headers[kTokenHeader] == "once", "an exchange without the token");
    return 0;
  }
  fuzz::require(request.headers["x-retalho-session"] == "right", "a call without the session's secret");
  return fuzz::refuse_or([&] {
    const Json input = Json::parse(request.body, nullptr, false);
    if (input.is_discarded() || !input.is_object()) return;
    for (const char* key : {"divisions", "samples", "width", "height"})  // for speed: small work shows as much
      if (input.contains(key) && input[key].is_number() && input[key] > 24) return;
    const Answer answer = calls().at(request.path).run(input, {});
    fuzz::require(pack(answer).size() % 8 == 0, "arrays out of step");
  });
}
