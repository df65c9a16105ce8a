#include "house/rules.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>
#include <string_view>

namespace retalho::house {
namespace {

namespace fs = std::filesystem;

std::string read(const Path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::vector<std::string> lines_of(const Path& file) {
  std::vector<std::string> lines;
  std::istringstream in(read(file));
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

/// All files that belong to the repository: what is built, installed or written by runs is left out.
std::vector<Path> files_of(const Path& folder) {
  static const std::set<std::string> not_ours = {".git",         "build",       "demo-out", "fuzz-out",
                                                 "node_modules", "__pycache__", "dist",     "test-results"};
  std::vector<Path> files;
  if (!fs::exists(folder)) return files;
  for (auto it = fs::recursive_directory_iterator(folder); it != fs::recursive_directory_iterator(); ++it) {
    if (not_ours.contains(it->path().filename().string())) {
      it.disable_recursion_pending();
    } else if (it->is_regular_file()) {
      files.push_back(it->path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

bool has_extension(const Path& file, std::initializer_list<std::string_view> extensions) {
  return std::find(extensions.begin(), extensions.end(), file.extension().string()) != extensions.end();
}

struct Include {
  std::size_t line;
  std::string name;
  bool quoted;
};

std::vector<Include> includes_of(const Path& file) {
  static const std::regex pattern(R"re(^\s*#\s*include\s*([<"])([^>"]+)[>"])re");
  std::vector<Include> includes;
  const auto lines = lines_of(file);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    std::smatch match;
    if (std::regex_search(lines[i], match, pattern)) includes.push_back({i + 1, match[2], match[1] == "\""});
  }
  return includes;
}

std::string where(const Path& file, const Path& root, std::size_t line) {
  return fmt::format("{}:{}", file.lexically_relative(root).generic_string(), line);
}

/// "retalho/tin/tin.h" to "tin"; "" for anything else.
std::string room_of(const std::string& include) {
  static const std::regex pattern(R"(^retalho/([^/]+)/.*$)");
  std::smatch match;
  return std::regex_match(include, match, pattern) ? match[1].str() : std::string();
}

struct Library {
  std::string name;
  std::regex include;
  std::set<std::string> places;  ///< rooms, or files as "room/name.cpp"; empty: every room
};

/// Where each library from outside may stand. A new one gets its row here, and its reason in docs/architecture.md.
const std::vector<Library>& libraries() {
  static const std::vector<Library> table = {
      {"CGAL", std::regex("^CGAL/.*"), {"tin/predicates.cpp"}},
      {"GDAL",
       std::regex("^(gdal|ogr|ogrsf|cpl|vrt)[a-z_]*\\.h$"),
       {"raster", "cloud", "level", "curve", "visibility"}},
      {"FlatBuffers", std::regex("^flatbuffers/.*|.*_generated\\.h$"), {"model"}},
      {"oneTBB", std::regex("^(tbb|oneapi)/.*"), {"core/arena.h", "core/in_order.cpp", "core/parallel.cpp"}},
      {"Eigen", std::regex("^Eigen/.*"), {}},
      {"SuiteSparse", std::regex("^(suitesparse/)?(cholmod|umfpack|SuiteSparseQR)[a-zA-Z_]*\\.(h|hpp)$"), {}},
      {"fmt", std::regex("^fmt/.*"), {}},
      {"nlohmann-json", std::regex("^nlohmann/.*"), {}},
      {"nanoflann", std::regex("^nanoflann\\.hpp$"), {"cloud", "patch", "tetraquad"}},
      {"zstd", std::regex("^zstd\\.h$"), {"model"}},
      {"xxHash", std::regex("^xxhash\\.h$"), {"model"}},
      {"libpng", std::regex("^png\\.h$"), {"render"}},
      {"zlib", std::regex("^zlib\\.h$"), {"render", "raster", "mesh"}},
      {"FreeType", std::regex("^ft2build\\.h$|^freetype/.*"), {"render"}},
      {"Cairo", std::regex("^cairo[a-z-]*\\.h$"), {"render", "level"}},
      {"muParserX", std::regex("^muparserx/.*"), {"curve"}},
      {"the compiler's intrinsics", std::regex("^immintrin\\.h$"), {"tetraquad"}},
  };
  return table;
}

/// Of the system's headers, those of POSIX that .cpp files and internal headers may use.
bool is_standard(const std::string& include) {
  return include.find_first_of("./") == std::string::npos;
}
bool is_posix(const std::string& include) {
  return std::regex_match(include, std::regex("^(sys/[a-z]+|unistd|fcntl|signal|pthread|dlfcn|termios)\\.h$"));
}

const Library* library_of(const std::string& include) {
  for (const Library& library : libraries())
    if (std::regex_match(include, library.include)) return &library;
  return nullptr;
}

bool may_stand(const Library& library, const std::string& room, const std::string& file) {
  return library.places.empty() || library.places.contains(room) || library.places.contains(room + "/" + file);
}

}  // namespace

std::vector<std::string> rooms_of(const Path& architecture_page) {
  static const std::regex pattern(R"(^  ([a-z]+)/\s+.*)");
  std::vector<std::string> rooms;
  bool inside = false;
  for (const std::string& line : lines_of(architecture_page)) {
    std::smatch match;
    if (line == "src/retalho/")
      inside = true;
    else if (inside && std::regex_match(line, match, pattern))
      rooms.push_back(match[1]);
    else if (inside && !line.starts_with("  "))
      break;
  }
  return rooms;
}

Breaches room_breaches(const Path& source_folder, const std::vector<std::string>& rooms) {
  Breaches breaches;
  const Path src = source_folder / "src" / "retalho";
  const auto floor_of = [&](const std::string& room) { return std::find(rooms.begin(), rooms.end(), room); };
  for (const Path& file : files_of(src)) {
    const std::string room = file.lexically_relative(src).begin()->string();
    if (floor_of(room) == rooms.end()) {
      breaches.push_back(
          fmt::format("{}: {} is not a room of docs/architecture.md", where(file, source_folder, 1), room));
      continue;
    }
    for (const Include& include : includes_of(file)) {
      const std::string used = room_of(include.name);
      if (used.empty()) continue;
      if (floor_of(used) == rooms.end())
        breaches.push_back(fmt::format("{}: {} is not a room of docs/architecture.md",
                                       where(file, source_folder, include.line), used));
      else if (floor_of(used) > floor_of(room))
        breaches.push_back(fmt::format("{}: {} uses {}, which is below it in docs/architecture.md",
                                       where(file, source_folder, include.line), room, used));
    }
  }
  return breaches;
}

bool is_internal(const Path& header) {
  const auto lines = lines_of(header);
  return std::any_of(lines.begin(), lines.end(), [](const std::string& line) {
    return line.starts_with("// ") && line.find("Internal to ") != std::string::npos;
  });
}

Breaches library_breaches(const Path& source_folder) {
  Breaches breaches;
  const Path src = source_folder / "src";
  for (const Path& file : files_of(src)) {
    if (!has_extension(file, {".h", ".cpp"})) continue;
    const std::string room = file.parent_path().filename().string();
    const bool is_public = file.extension() == ".h" && !is_internal(file);
    for (const Include& include : includes_of(file)) {
      const auto breach = [&](const std::string& words) {
        breaches.push_back(fmt::format("{}: {} {}", where(file, source_folder, include.line), include.name, words));
      };
      if (include.name.starts_with("retalho/") && !library_of(include.name)) {
        const Path header = src / include.name;
        if (!fs::exists(header))
          breach("does not exist");
        else if (is_public && is_internal(header))
          breach("is internal, in a public header");
      } else if (is_standard(include.name)) {
        continue;
      } else if (is_posix(include.name)) {
        if (is_public) breach("is not of the standard library, in a public header");
      } else if (const Library* library = library_of(include.name); library == nullptr) {
        breach("belongs to no library of the table in tests/house/rules.cpp");
      } else if (is_public) {
        breach(fmt::format("({}) in a public header", library->name));
      } else if (!may_stand(*library, room, file.filename().string())) {
        breach(fmt::format("({}) outside of the places that may use it", library->name));
      }
    }
  }
  return breaches;
}

Breaches length_breaches(const Path& source_folder, std::size_t most) {
  Breaches breaches;
  for (const Path& file : files_of(source_folder)) {
    if (!has_extension(file, {".h", ".cpp", ".ts", ".css", ".py", ".pyi", ".cmake"})) continue;
    if (const std::size_t count = lines_of(file).size(); count > most)
      breaches.push_back(fmt::format("{}: {} lines, more than {}",
                                     file.lexically_relative(source_folder).generic_string(), count, most));
  }
  return breaches;
}

Breaches machine_breaches(const Path& source_folder) {
  static const std::regex folder(R"((^|[^A-Za-z0-9_.}/])/(home|root|work|Users)/[A-Za-z0-9])");
  static const std::regex host(R"(://[a-z0-9.-]*(registry|artifact|mirror|pypi|crates)[a-z0-9.-]*)");
  Breaches breaches;
  for (const Path& file : files_of(source_folder)) {
    const std::string bytes = read(file);
    if (bytes.find('\0') != std::string::npos) continue;  // a picture or another binary file
    std::istringstream in(bytes);
    std::string line;
    for (std::size_t number = 1; std::getline(in, line); ++number) {
      if (line.size() > 4000) line.resize(4000);  // std::regex recurses by the length
      if (std::regex_search(line, folder))
        breaches.push_back(where(file, source_folder, number) + ": names a folder of one machine: " + line);
      if (std::regex_search(line, host))
        breaches.push_back(where(file, source_folder, number) + ": names the host of a registry: " + line);
    }
  }
  return breaches;
}

}  // namespace retalho::house
