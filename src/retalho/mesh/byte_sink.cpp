#include <fmt/format.h>

#include <bit>
#include <cerrno>
#include <charconv>
#include <cstring>

#include "retalho/core/error.h"
#include "retalho/mesh/formats.h"

namespace retalho {

static_assert(std::endian::native == std::endian::little, "the binary formats are written in the machine's byte order");

ByteSink::ByteSink(const std::string& path, std::string name)
    : name_(std::move(name)), file_(std::fopen(path.c_str(), "wb")), block_(nullptr) {
  if (!file_) fail();
  std::setvbuf(file_, nullptr, _IONBF, 0);
  block_ = new char[kBlock];
}

ByteSink::ByteSink(std::string& into) : into_(&into), block_(new char[kBlock]) {}

ByteSink::~ByteSink() {
  if (file_) std::fclose(file_);
  delete[] block_;
}

void ByteSink::fail() {
  throw CannotWrite(fmt::format("cannot write '{}': {}", name_, std::strerror(errno)), name_);
}

void ByteSink::flush() {
  if (into_)
    into_->append(block_, used_);
  else if (used_ != 0 && std::fwrite(block_, 1, used_, file_) != used_)
    fail();
  used_ = 0;
}

void ByteSink::text(std::string_view words) {
  while (!words.empty()) {
    if (used_ == kBlock) flush();
    const std::size_t n = std::min(words.size(), kBlock - used_);
    std::memcpy(block_ + used_, words.data(), n);
    used_ += n;
    words.remove_prefix(n);
  }
}

void ByteSink::number(double value) {
  if (used_ + 32 > kBlock) flush();
  used_ = static_cast<std::size_t>(std::to_chars(block_ + used_, block_ + kBlock, value).ptr - block_);
}

void ByteSink::number(std::uint64_t value) {
  if (used_ + 32 > kBlock) flush();
  used_ = static_cast<std::size_t>(std::to_chars(block_ + used_, block_ + kBlock, value).ptr - block_);
}

void ByteSink::close() {
  flush();
  if (into_) return;
  std::FILE* const file = file_;
  file_ = nullptr;
  if (std::fclose(file) != 0) fail();
}

}  // namespace retalho
