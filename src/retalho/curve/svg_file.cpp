// SVG files: the XML reader is GDAL's (cpl_minixml.h).
#include <cpl_error.h>
#include <cpl_minixml.h>
#include <fmt/format.h>

#include <cstring>
#include <memory>

#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"
#include "retalho/curve/plane_path.h"

namespace retalho {

namespace {

struct Reader {
  std::vector<Curve> curves;
  int transforms = 0, elements = 0;
  std::string file;

  static const char* attribute(const CPLXMLNode* node, const char* name) { return CPLGetXMLValue(node, name, nullptr); }

  void add(const CPLXMLNode* node, const std::string& d) {
    try {
      for (Curve& curve : parse_svg_path(d)) curves.push_back(std::move(curve));
    } catch (const BadInput& error) {
      const char* id = attribute(node, "id");
      const std::string where = id ? fmt::format("element \"{}\", {}", id, error.where())
                                   : fmt::format("<{}> number {}, {}", node->pszValue, elements, error.where());
      throw BadInput(fmt::format("{}: {}", where, error.what()), file, where);
    }
  }

  void visit(const CPLXMLNode* node, bool moved) {
    for (; node; node = node->psNext) {
      if (node->eType != CXT_Element) continue;
      const char* const kind = attribute(node, "class");
      if (kind && std::strstr(kind, "decoration")) continue;
      const std::string name = node->pszValue;
      if (name == "defs" || name == "clipPath" || name == "symbol") continue;
      // Our own drawings turn y up by a transform, so that the numbers of a path are the curve's own.
      const bool foreign = attribute(node, "transform") && !(kind && std::strstr(kind, "retalho"));
      const bool shifted = moved || foreign;
      const char* const d = name == "path" ? attribute(node, "d") : nullptr;
      const char* const points = name == "polyline" || name == "polygon" ? attribute(node, "points") : nullptr;
      if (d || points || name == "line") {
        ++elements;
        if (shifted) ++transforms;
        if (d) add(node, d);
        if (points) add(node, fmt::format("M{}{}", points, name == "polygon" ? "Z" : ""));
        if (name == "line")
          add(node, fmt::format("M{},{}L{},{}", CPLGetXMLValue(node, "x1", "0"), CPLGetXMLValue(node, "y1", "0"),
                                CPLGetXMLValue(node, "x2", "0"), CPLGetXMLValue(node, "y2", "0")));
      }
      visit(node->psChild, shifted);
    }
  }
};

}  // namespace

std::vector<Curve> read_svg(const std::string& file, int* transforms) {
  const std::string text = read_file(file);
  CPLPushErrorHandler(CPLQuietErrorHandler);
  const std::unique_ptr<CPLXMLNode, void (*)(CPLXMLNode*)> root(CPLParseXMLString(text.c_str()), [](CPLXMLNode* n) {
    if (n) CPLDestroyXMLNode(n);
  });
  const std::string trouble = CPLGetLastErrorMsg();
  CPLPopErrorHandler();
  if (!root) throw CannotRead(fmt::format("not an SVG file: {}", trouble), file);
  CPLStripXMLNamespace(root.get(), nullptr, TRUE);
  Reader reader;
  reader.file = file;
  reader.visit(root.get(), false);
  if (transforms) *transforms = reader.transforms;
  if (reader.curves.empty()) throw BadInput("no path, polyline, polygon or line in the SVG file", file);
  return reader.curves;
}

}  // namespace retalho
