// The program `retalho`: the one place where errors become messages and exit codes.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>

#include "command_line.h"
#include "inputs.h"
#include "program.h"
#include "progress.h"
#include "retalho/core/error.h"
#include "signals.h"
#include "work_limits.h"

namespace retalho::app {
namespace {

int fail(bool json, int code, const char* kind, const std::string& message, const std::string& file = {},
         const std::string& where = {}) {
  end_progress();
  fmt::print(stderr, "retalho: {}\n", message);
  if (!json) return code;
  nlohmann::ordered_json error = {{"code", code}, {"kind", kind}, {"message", message}};
  if (!file.empty()) error["file"] = file;
  if (!where.empty()) error["where"] = where;
  try {
    Program{}.print(nlohmann::ordered_json{{"error", error}});
  } catch (const std::exception&) {  // standard output is gone: the message and the code have to do
  }
  return code;
}

/// Errors about inputs name the file, whichever step found them.
int fail(bool json, const Error& error) {
  std::string message = error.what(), file = error.file();
  const bool about_input = error.kind() == Error::Kind::bad_input || error.kind() == Error::Kind::cannot_read;
  if (about_input && file.empty()) file = noted_input();
  if (about_input && !file.empty() && message.find(file) == std::string::npos)
    message = fmt::format("'{}': {}", file, message);
  return fail(json, error.exit_code(), kind_name(error.kind()), message, file, error.where());
}

int fail_stopped(bool json) {
  if (const std::optional<Stop> stop = stopped_by_limit())
    return fail(json, stop->code, stop->kind, stop->message, noted_input(), stop->where);
  return fail(json, Interrupted());
}

int run(int argc, char** argv) {
  catch_signals();
  // GDAL would keep blocks in a twentieth of the machine's memory: a few rows of blocks are all that we come back to.
  setenv("GDAL_CACHEMAX", "64", 0);
  const struct Limits {
    ~Limits() { stop_limits(); }
  } limits;
  const bool json = std::any_of(argv + 1, argv + argc, [](const char* a) { return std::strcmp(a, "--json") == 0; });
  const auto internal = [&](const std::string& words) {
    return fail(json, static_cast<int>(Error::Kind::internal), kind_name(Error::Kind::internal), words);
  };
  try {
    Program program;
    program.say_stopped = [json] { return fail_stopped(json); };
    const auto root = make_commands(program);
    if (const auto text = parse_words(*root, argc, argv)) program.print(*text);
    end_progress();
    return 0;
  } catch (const Error& error) {
    return stopped_by_limit() ? fail_stopped(json) : fail(json, error);  // whatever the stopped step says of itself
  } catch (const std::bad_alloc&) {
    return internal("out of memory: the work does not fit; try a smaller input or a larger tolerance");
  } catch (const std::exception& error) {
    return internal(fmt::format("failed inside: {}. Please report it with the command line.", error.what()));
  }
}

}  // namespace
}  // namespace retalho::app

int main(int argc, char** argv) {
  return retalho::app::run(argc, argv);
}
