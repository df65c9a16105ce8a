// The rules of the house (docs/architecture.md) as functions of a source folder: each returns one sentence for each
// breach, none when the rule is kept. rules_test.cpp shows on made-up folders that each can fail; house_test.cpp asks
// them of this repository.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace retalho::house {

using Path = std::filesystem::path;
using Breaches = std::vector<std::string>;

/// The rooms in the order of the list in docs/architecture.md: its lines "  name/   words" under "src/retalho/".
std::vector<std::string> rooms_of(const Path& architecture_page);

/// Every folder of src/retalho is a room of the list; no file of a room includes a file of a room below it.
Breaches room_breaches(const Path& source_folder, const std::vector<std::string>& rooms);

/// Is it a header of a room's own, which is not installed? Its comment says "Internal to".
bool is_internal(const Path& header);

/// Libraries from outside stand in the rooms that may use them, in .cpp files and internal headers only; a library that
/// is not in the table is a breach. Public headers include nothing but the standard library and public headers.
Breaches library_breaches(const Path& source_folder);

/// No file of code has more than `most` lines.
Breaches length_breaches(const Path& source_folder, std::size_t most = 500);

/// No file names a folder of somebody's machine or the host of a package registry.
Breaches machine_breaches(const Path& source_folder);

}  // namespace retalho::house
