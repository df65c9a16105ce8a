// A file without a name, for what a mesh in the making does not hold in memory: nothing is left of it whatever happens.
// Internal to the room.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace retalho {

class MeshFile {
 public:
  /// Made beside `path`, which must be free; errors speak of `name`. Throws CannotWrite, here and below.
  MeshFile(const std::string& path, std::string name);
  ~MeshFile();
  MeshFile(const MeshFile&) = delete;
  MeshFile& operator=(const MeshFile&) = delete;

  void put(const void* bytes, std::size_t size, std::uint64_t at) const;
  void get(void* bytes, std::size_t size, std::uint64_t at) const;

 private:
  std::string name_;
  int number_;
};

}  // namespace retalho
