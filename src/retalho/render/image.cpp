#include "retalho/render/image.h"

#include <fmt/format.h>
#include <png.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"

namespace retalho {
namespace {

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

/// What libpng's error handler passes on: exceptions must not cross C code, so it jumps and this tells why.
[[noreturn]] void on_error(png_structp png, png_const_charp message) {
  *static_cast<std::string*>(png_get_error_ptr(png)) = message;
  png_longjmp(png, 1);
}
void on_warning(png_structp, png_const_charp) {}

/// No objects with destructors are made after the setjmp.
bool encode(std::FILE* file, const Image& image, const Context& context, std::string& problem) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &problem, on_error, on_warning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  if (!info) {
    png_destroy_write_struct(&png, nullptr);
    problem = "out of memory";
    return false;
  }
  if (setjmp(png_jmpbuf(png))) {
    png_destroy_write_struct(&png, &info);
    return false;
  }
  png_init_io(png, file);
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.width), static_cast<png_uint_32>(image.height), 8,
               PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  for (int y = 0; y < image.height; ++y) {
    if (context.cancel && context.cancel->load(std::memory_order_relaxed)) png_error(png, "stopped");
    png_write_row(png, reinterpret_cast<png_const_bytep>(
                           image.pixels.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width)));
  }
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return true;
}

}  // namespace

void write_png(const Image& image, const std::string& path, bool overwrite, const Context& context) {
  static_assert(sizeof(Rgb) == 3);
  AtomicFile output(path, overwrite);
  std::unique_ptr<std::FILE, CloseFile> file(std::fopen(output.temporary().c_str(), "wb"));
  std::string problem;
  if (!file) throw CannotWrite(fmt::format("cannot write '{}': {}", path, std::strerror(errno)), path);
  const bool encoded = encode(file.get(), image, context, problem);
  context.check();
  if (!encoded) throw CannotWrite(fmt::format("cannot write '{}': {}", path, problem), path);
  if (std::fclose(file.release()) != 0)
    throw CannotWrite(fmt::format("cannot write '{}': {}", path, std::strerror(errno)), path);
  output.commit();
}

}  // namespace retalho
