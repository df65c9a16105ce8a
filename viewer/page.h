// The page's files, embedded into the program as gzip bytes when it was built (embed_page.cmake).
#pragma once

#include <span>
#include <string_view>

namespace retalho::viewer {

struct PageFile {
  std::string_view path;  ///< "/index.html"
  std::string_view type;  ///< "text/html; charset=utf-8"
  std::string_view gzip;
};

/// Empty when the program was built without the page (no nodejs, or scripts/setup did not run).
std::span<const PageFile> page_files();

}  // namespace retalho::viewer
