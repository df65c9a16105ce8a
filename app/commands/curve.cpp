// retalho curve: joins and their continuity, measures, conversion and drawing of curves.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "curve_work.h"
#include "retalho/core/error.h"

namespace retalho::app {
namespace {

struct Flags {
  std::string file;
  std::vector<std::string> outputs;
  bool report = false;
  std::string view = "iso", convert, size = "640x480";
  CurveWork work;
};

void run(const Flags& flags, const Program& program) {
  CurveWork work = flags.work;
  work.view = static_cast<CurveView>(choose("--view", flags.view, {"iso", "top", "front", "side"}));
  if (!flags.convert.empty()) work.convert = flags.convert;
  int width = 0, height = 0;
  char tail = 0;
  if (std::sscanf(flags.size.c_str(), "%dx%d%c", &width, &height, &tail) != 2 || width < 50 || height < 50 ||
      width > 10000 || height > 10000)
    throw UsageError(
        fmt::format("--size {}: expected WIDTHxHEIGHT in pixels, 50 to 10000 each, as in 640x480", flags.size), {},
        "--size");
  work.width = width;
  work.height = height;
  for (const std::string& out : flags.outputs)
    check_output(program, out, {".svg", ".pdf", ".png", ".json", ".gpkg", ".geojson", ".shp", ".dxf"}, {flags.file});

  const Stopwatch clock;
  const Context context = program.context();
  const std::vector<NamedCurve> curves = load_curves(flags.file, work, program);
  program.detail(fmt::format("{} curves from '{}'", curves.size(), flags.file));
  for (const std::string& out : flags.outputs) {
    write_curves(curves, out, work, program.overwrite, context);
    program.say(fmt::format("wrote '{}'", out));
  }
  const bool wanted = flags.report || flags.outputs.empty();
  if (!program.json && !wanted) return;
  const nlohmann::ordered_json result = report_curves(curves, work, context);
  if (program.json)
    program.print(result);
  else
    program.print(report_text(result));
  program.detail(fmt::format("{:.3f} s", clock.seconds()));
}

}  // namespace

void add_curve(CLI::App& root, Program& program) {
  CLI::App* command = add_command(root, program, "curve", "Joins, measures, conversion and drawing of curves",
                                  "retalho curve curves.json\n"
                                  "retalho curve curves.json -o picture.svg --control --comb\n"
                                  "retalho curve curves.json -o exact.json --convert bspline\n"
                                  "retalho curve drawing.svg -o lines.gpkg --flatten 0.1\n"
                                  "retalho curve curves.json --json --closest 1,2");
  auto flags = std::make_shared<Flags>();
  command->add_option("file", flags->file, "Curves: .json (docs/curves.md), .svg, or a vector file of lines")
      ->required()
      ->type_name("FILE");
  command
      ->add_option("-o,--output", flags->outputs,
                   "A picture (.svg .pdf .png), curves (.json), or lines (.gpkg .geojson .shp .dxf); may be repeated")
      ->type_name("FILE")
      ->take_all()
      ->expected(1);
  command->add_flag("--report", flags->report, "Print the report as well when there is an output");
  command->add_option("--flatten", flags->work.flatten, "Replace curves by lines nowhere farther away than T (proved)")
      ->type_name("T");
  command->add_option("--convert", flags->convert, "Form in .json: bezier, bspline, hermite, power")->type_name("KIND");
  command
      ->add_option("--degree", flags->work.degree, "Elevate (exact) or reduce (the error is reported) to this degree")
      ->type_name("N");
  command->add_flag("--reverse", flags->work.reverse, "Run backwards");
  command->add_option("--cut", flags->work.cut, "Only the part between two parameters")
      ->type_name("U0,U1")
      ->delimiter(',')
      ->expected(2);
  command->add_option("--closest", flags->work.closest, "Report the local minima of the distance from this point")
      ->type_name("X,Y[,Z]")
      ->delimiter(',')
      ->expected(2, 3);
  command->add_option("--at", flags->work.at, "Report point, derivatives and curvature at these parameters")
      ->type_name("U,...")
      ->delimiter(',');
  command->add_flag("--crossings", flags->work.crossings, "Report self-intersections and intersections of all curves");
  command->add_flag("--control", flags->work.control, "Draw control polygons");
  command->add_flag("--tangents", flags->work.tangents, "Draw the tangents Q' at joins and ends");
  command->add_flag("--comb", flags->work.comb, "Draw curvature combs");
  command
      ->add_option("--comb-scale", flags->work.comb_scale,
                   "Length of a comb's tooth at curvature 1 (default: a fifth of the size at the largest)")
      ->type_name("S");
  command->add_option("--casteljau", flags->work.casteljau, "Draw de Casteljau's construction at parameter U")
      ->type_name("U");
  command->add_flag("--hodograph", flags->work.hodograph, "Draw the hodograph beside each curve");
  command->add_flag("--joins", flags->work.joins, "Draw joins and ends as dots");
  command->add_flag("--points", flags->work.points, "Draw the points that were given");
  command->add_flag("--axes", flags->work.axes, "Draw a frame with numbers");
  command->add_flag("--stretch", flags->work.stretch, "Scales of their own for x and y");
  command->add_option("--window", flags->work.window, "What the picture shows")
      ->type_name("XMIN,YMIN,XMAX,YMAX")
      ->delimiter(',')
      ->expected(4);
  command->add_option("--title", flags->work.title, "Title of the picture")->type_name("TEXT");
  command->add_option("--view", flags->view, "How curves in space are seen: iso, top, front, side")
      ->type_name("VIEW")
      ->capture_default_str();
  command->add_option("--size", flags->size, "Pixels of a panel")->type_name("WxH")->capture_default_str();
  command->add_option("--depth", flags->work.depth, "Implicit curves: 2^N cells a side")
      ->type_name("N")
      ->capture_default_str();
  command->callback([flags, &program] { run(*flags, program); });
}

}  // namespace retalho::app
