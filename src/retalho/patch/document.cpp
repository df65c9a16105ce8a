#include "retalho/patch/document.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"
#include "retalho/curve/document.h"

namespace retalho {
namespace {

using Json = nlohmann::ordered_json;

[[noreturn]] void fail(const std::string& where, const std::string& what) {
  throw BadInput(fmt::format("{}: {}", where, what), {}, where);
}

struct Named {
  std::string name;
  Curve curve;
};

/// A curve written out at `where`: the room of curves reads it as a document of one.
Named read_curve(const Json& value, const std::string& where) {
  const Json document = {{"curves", Json::array({value})}};
  try {
    const CurveDocument one = parse_curves(document.dump());
    return {one.curves[0].name, to_curve(one.curves[0], "curves[0]")};
  } catch (const Error& error) {
    std::string words = error.what(), place = error.where();
    for (std::string* text : {&words, &place})
      if (const std::size_t at = text->find("curves[0]"); at != std::string::npos) text->replace(at, 9, where);
    throw BadInput(words, {}, place.empty() ? where : place);
  }
}

SideCurve read_side(const Json& value, const std::string& where, const std::vector<Named>& curves,
                    SidePlacement placement) {
  const auto listed = [&](const Json& name, const std::string& at) -> const Curve& {
    if (name.is_number_unsigned() && name.get<std::size_t>() < curves.size())
      return curves[name.get<std::size_t>()].curve;
    if (name.is_number())
      fail(at, fmt::format("there is no curve {}; \"curves\" has {}, counted from 0", name.dump(), curves.size()));
    if (!name.is_string()) fail(at, fmt::format("expected a curve's number or name, got {}", name.type_name()));
    for (const Named& curve : curves)
      if (curve.name == name.get<std::string>()) return curve.curve;
    fail(at, fmt::format("there is no curve of the name {} in \"curves\"", name.dump()));
  };
  if (!value.is_object()) return SideCurve(listed(value, where), false, placement);
  bool reversed = false;
  Json rest = value;
  if (value.contains("reversed")) {
    if (!value["reversed"].is_boolean())
      fail(where + ".reversed", fmt::format("expected true or false, got {}", value["reversed"].type_name()));
    reversed = value["reversed"].get<bool>();
    rest.erase("reversed");
  }
  if (!rest.contains("curve")) return SideCurve(read_curve(rest, where).curve, reversed, placement);
  for (const auto& [key, ignored] : rest.items())
    if (key != "curve") fail(where + "." + key, "a side that names a curve has the keys \"curve\" and \"reversed\"");
  return SideCurve(listed(rest["curve"], where + ".curve"), reversed, placement);
}

std::array<std::size_t, 3> read_divisions(const Json& value, const std::string& where) {
  const auto count = [&](const Json& n) {
    if (!n.is_number_unsigned() || n.get<std::size_t>() < 1 || n.get<std::size_t>() > 10000)
      fail(where, fmt::format("expected a whole number from 1 to 10000, or three, got {}", n.dump()));
    return n.get<std::size_t>();
  };
  if (!value.is_array()) return {count(value), count(value), count(value)};
  if (value.size() != 3) fail(where, fmt::format("expected one number or three, got {}", value.size()));
  return {count(value[0]), count(value[1]), count(value[2])};
}

PatchSpec read_patch(const Json& value, const std::string& where, const std::vector<Named>& curves,
                     SidePlacement placement) {
  if (!value.is_object()) fail(where, fmt::format("expected an object, got {}", value.type_name()));
  PatchSpec spec;
  spec.where = where;
  for (const auto& [key, entry] : value.items()) {
    const std::string at = where + "." + key;
    if (key == "name") {
      if (!entry.is_string()) fail(at, fmt::format("expected a text, got {}", entry.type_name()));
      spec.name = entry.get<std::string>();
    } else if (key == "divisions") {
      spec.divisions = read_divisions(entry, at);
    } else if (key != "sides") {
      fail(at, "a patch has no such key; it has sides, divisions, name");
    }
  }
  if (!value.contains("sides")) fail(where, "\"sides\" is missing");
  const Json& sides = value["sides"];
  if (!sides.is_array() || sides.size() != 3)
    fail(where + ".sides", fmt::format("expected an array of three curves, got {}",
                                       sides.is_array() ? std::to_string(sides.size()) : sides.type_name()));
  for (std::size_t i = 0; i < 3; ++i)
    spec.sides[i] = read_side(sides[i], fmt::format("{}.sides[{}]", where, i), curves, placement);
  return spec;
}

std::vector<PatchSpec> read_document(const Json& document, SidePlacement placement) {
  if (!document.is_object() || (!document.contains("patches") && !document.contains("curves")))
    fail("document", "expected an object with the key \"patches\" (or three \"curves\": one patch)");
  std::vector<Named> curves;
  if (document.contains("curves")) {
    const Json& list = document["curves"];
    if (!list.is_array()) fail("curves", fmt::format("expected an array, got {}", list.type_name()));
    for (std::size_t i = 0; i < list.size(); ++i) curves.push_back(read_curve(list[i], fmt::format("curves[{}]", i)));
  }
  std::vector<PatchSpec> patches;
  if (!document.contains("patches")) {
    if (curves.size() != 3)
      fail("curves",
           fmt::format("a document without \"patches\" is one patch of three curves, and has {}", curves.size()));
    PatchSpec spec;
    spec.where = "patches[0]";
    for (std::size_t i = 0; i < 3; ++i) spec.sides[i] = SideCurve(curves[i].curve, false, placement);
    patches.push_back(std::move(spec));
    return patches;
  }
  const Json& list = document["patches"];
  if (!list.is_array() || list.empty()) fail("patches", "expected an array of at least one patch");
  for (std::size_t i = 0; i < list.size(); ++i)
    patches.push_back(read_patch(list[i], fmt::format("patches[{}]", i), curves, placement));
  return patches;
}

}  // namespace

std::vector<PatchSpec> parse_patches(std::string_view json, const std::string& file, SidePlacement placement) {
  try {
    return read_document(Json::parse(json.begin(), json.end()), placement);
  } catch (const Json::parse_error& error) {
    const std::size_t at = std::min(json.size(), error.byte > 0 ? error.byte - 1 : 0);
    const std::string_view before = json.substr(0, at);
    const auto line = 1 + std::count(before.begin(), before.end(), '\n');
    const std::size_t start = before.rfind('\n');
    const std::string where =
        fmt::format("line {}, column {}", line, start == std::string_view::npos ? at + 1 : at - start);
    throw BadInput(fmt::format("not JSON ({})", where), file, where);
  } catch (const Json::exception& error) {
    throw BadInput(fmt::format("not usable JSON: {}", error.what()), file);
  } catch (const BadInput& error) {
    throw BadInput(error.what(), file, error.where());
  }
}

std::vector<PatchSpec> read_patches(const std::string& path, SidePlacement placement) {
  return parse_patches(read_file(path), path, placement);
}

}  // namespace retalho
