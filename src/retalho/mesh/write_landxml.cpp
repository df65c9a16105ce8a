// LandXML 1.2: a TIN surface as surveyors' programs take it (LandXML-1.2.xsd: Units, CoordinateSystem, Surfaces /
// Surface / Definition surfType="TIN" with Pnts / P and Faces / F). A point is "northing easting elevation", in that
// order.
#include <fmt/format.h>

#include <string>

#include "retalho/core/error.h"
#include "retalho/mesh/formats.h"
#include "retalho/raster/crs_code.h"

namespace retalho {
namespace {

std::string escaped(std::string_view words) {
  std::string text;
  for (const char c : words) switch (c) {
      case '&':
        text += "&amp;";
        break;
      case '<':
        text += "&lt;";
        break;
      case '>':
        text += "&gt;";
        break;
      case '"':
        text += "&quot;";
        break;
      default:
        text += c;
    }
  return text;
}

/// The schema asks for all five; angles and the rest of its units do not occur in a surface.
std::string units_of(const std::string& unit) {
  const auto imperial = [](const char* length) {
    return fmt::format(
        R"(<Imperial areaUnit="squareFoot" linearUnit="{}" volumeUnit="cubicFeet" temperatureUnit="fahrenheit" pressureUnit="inHG"/>)",
        length);
  };
  if (unit == "US survey foot") return imperial("USSurveyFoot");
  if (unit == "foot") return imperial("foot");
  return R"(<Metric areaUnit="squareMeter" linearUnit="meter" volumeUnit="cubicMeter" temperatureUnit="celsius" pressureUnit="milliBars"/>)";
}

}  // namespace

void write_landxml(const MeshStream& mesh, ByteSink& out) {
  if (mesh.triangles == 0) throw CannotWrite("a LandXML surface cannot be without triangles");
  const bool known = mesh.unit == "metre" || mesh.unit == "foot" || mesh.unit == "US survey foot";
  if (!known && !mesh.unit.empty() && mesh.unit != "unit")
    throw CannotWrite(
        fmt::format("LandXML has metres and feet, and this mesh is in '{}': convert it first", mesh.unit));
  // date and time are required; a constant, so that the same surface is the same file.
  out.text(R"(<?xml version="1.0" encoding="UTF-8"?>
<LandXML xmlns="http://www.landxml.org/schema/LandXML-1.2" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xsi:schemaLocation="http://www.landxml.org/schema/LandXML-1.2 http://www.landxml.org/schema/LandXML-1.2/LandXML-1.2.xsd" version="1.2" date="1970-01-01" time="00:00:00">
)");
  out.text("<Units>" + units_of(mesh.unit) + "</Units>\n");
  if (!mesh.crs_wkt.empty()) {
    const int code = epsg_named_by(mesh.crs_wkt);
    out.text("<CoordinateSystem");
    if (code != 0) out.text(fmt::format(R"( epsgCode="{}")", code));
    out.text(fmt::format(R"( ogcWktCode="{}"/>)", escaped(mesh.crs_wkt)) + "\n");
  }
  out.text("<Application name=\"retalho\"/>\n<Surfaces>\n<Surface name=\"surface\"");
  if (!known) out.text(" desc=\"the unit of the coordinates is not known: metres are assumed\"");
  out.text(">\n<Definition surfType=\"TIN\">\n<Pnts>\n");
  std::uint64_t number = 0;
  mesh.each_vertex([&](const VertexBlock& block) {
    for (const Vec3& local : block.positions) {
      const Vec3 p = local + mesh.offset;
      out.text("<P id=\""), out.number(++number), out.text("\">");
      out.number(p.y), out.text(" "), out.number(p.x), out.text(" "), out.number(p.z), out.text("</P>\n");
    }
  });
  out.text("</Pnts>\n<Faces>\n");
  mesh.each_triangle([&](TriangleBlock block) {
    for (const auto& t : block) {
      out.text("<F>");
      for (std::size_t k = 0; k < 3; ++k) {
        if (k > 0) out.text(" ");
        out.number(std::uint64_t{t[k]} + 1);
      }
      out.text("</F>\n");
    }
  });
  out.text("</Faces>\n</Definition>\n</Surface>\n</Surfaces>\n</LandXML>\n");
}

}  // namespace retalho
