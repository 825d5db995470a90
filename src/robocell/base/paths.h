// Paths from files and users that must stay inside a folder.
//
//   const fs::path mesh = ConfinedPath(root, "assets/link 1.stl");  // root / "assets/link 1.stl"
//   ConfinedPath(root, "../../etc/passwd");                         // ArgumentError naming both
#pragma once

#include <filesystem>
#include <string_view>

namespace robocell {

// root / relative, refused (ArgumentError that names both) when `relative` is empty, absolute,
// contains ".." or a NUL byte, is longer than a path can be, or when a symbolic link on the way,
// dangling ones included, leads outside `root`. Any other name is fine: spaces, quotes, $(),
// Unicode. The path need not exist, and neither need the root. It is a check against mistakes and
// hostile names, not against someone who swaps links while we run.
std::filesystem::path ConfinedPath(const std::filesystem::path& root, std::string_view relative);

// ArgumentError when `path` contains a NUL byte: the system would open the file whose name ends
// there, which is another one. `what` is the thing that is named, such as "model".
void RequireNoNul(std::string_view what, std::string_view path);

// Whether `name` can be the name of one file on the systems we know: not empty, "." or "..",
// without '/', NUL and control characters, at most 255 bytes.
bool ValidFileName(std::string_view name);

// An ArgumentError that says what is wrong with it unless ValidFileName(name); `what` is the thing
// that has this name, such as "camera".
void RequireFileName(std::string_view what, std::string_view name);

}  // namespace robocell
