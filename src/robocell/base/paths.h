// Paths from files and users that must stay inside a folder.
//
//   const fs::path mesh = ConfinedPath(root, "assets/link 1.stl");  // root / "assets/link 1.stl"
//   ConfinedPath(root, "../../etc/passwd");                         // ArgumentError naming both
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace robocell::internal {

// root / relative, refused (ArgumentError that names both) when `relative` is empty, absolute,
// contains ".." or a NUL byte, is longer than a path can be, or when a symbolic link on the way,
// dangling ones included, leads outside `root`. Any other name is fine: spaces, quotes, $(),
// Unicode. The path need not exist, and neither need the root. It is a check against mistakes and
// hostile names, not against someone who swaps links while we run.
std::filesystem::path ConfinedPath(const std::filesystem::path& root, std::string_view relative);

// Raises ArgumentError if `path` contains a NUL byte: the system would open another file, whose
// name ends there. `what` says what the path belongs to, such as "model".
void RequireNoNul(std::string_view what, std::string_view path);

// Whether `name` can be the name of one file on the systems we know: not empty, "." or "..",
// without '/', NUL and control characters, at most 255 bytes.
bool ValidFileName(std::string_view name);

// Raises ArgumentError with the reason unless ValidFileName(name). `what` says what the name
// belongs to, such as "camera".
void RequireFileName(std::string_view what, std::string_view name);

// For paths in commands that messages contain: `text` as one word of a POSIX shell, in single quotes where it needs them: 'out/two words'. As
// Python's shlex.quote.
std::string ShellWord(std::string_view text);

}  // namespace robocell::internal
