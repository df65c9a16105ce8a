// Outputs are complete or absent: written beside their final name, flushed to disk, renamed at the end.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace retalho {

/// A file in the making. Write to `temporary()` by any means, then `commit()`. Destroyed without commit, it leaves
/// nothing behind and the old file, if any, untouched.
///
/// Some formats are several files (.shp with .dbf and .prj; .tif.aux.xml). What a writer puts beside `temporary()`
/// under the same stem is a part of the output: it shares its fate, and takes the stem of the final name. While parts
/// are replaced the old file is away: whoever looks sees the old set, the new set, or no file of that name, never a
/// mixture.
///
/// A process that is killed leaves its temporaries. The next AtomicFile of the same name removes those of processes
/// that are gone (of this machine; of others when they are a day old), and puts back an old file that was away.
class AtomicFile {
 public:
  /// Reserves a name beside `path` that ends in the same extension (so that drivers which look at it still work).
  /// Throws CannotWrite when `path` exists and `overwrite` is false, or when its folder is missing or not writable.
  AtomicFile(std::string path, bool overwrite);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  const std::string& path() const { return path_; }
  const std::string& temporary() const { return temporary_; }

  /// A file beside `path()` with its stem, which belongs to the old output and must go when the new one comes.
  void supersede(const std::string& old_part);

  /// fsync and rename, the parts before the file itself, so that a file which is there is whole. Throws CannotWrite
  /// when any of it fails, and when the name of a part is taken and `overwrite` is false; then the old files are back
  /// at their places and nothing new is left.
  void commit();

 private:
  void remove_temporaries() const;
  void replace_set(const std::vector<std::string>& tails) const;

  std::vector<std::string> superseded_;  // what follows the stem

  std::string path_;
  std::string temporary_;
  bool overwrite_;
  bool committed_ = false;
};

/// Writes `bytes` to `path` atomically. Throws CannotWrite.
void write_file(const std::string& path, std::string_view bytes, bool overwrite);

/// The whole file as bytes. Throws CannotRead (missing, a folder, unreadable).
std::string read_file(const std::string& path);

}  // namespace retalho
