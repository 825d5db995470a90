// Paths from files and users that must stay inside a folder.
//
//   const fs::path mesh = ConfinedPath(root, "assets/link 1.stl");  // root / "assets/link 1.stl"
//   ConfinedPath(root, "../../etc/passwd");                         // ArgumentError naming both
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace robocell::internal {

// Returns root / relative. Throws ArgumentError with both if `relative` is empty, absolute,
// contains ".." or a NUL byte, is longer than a path can be, or if a symbolic link on the way,
// including dangling ones, leads outside `root`. Any other name is accepted: spaces, quotes, $(),
// Unicode. Neither the path nor the root needs to exist. This protects against mistakes and hostile
// names, not against links that are swapped meanwhile.
std::filesystem::path ConfinedPath(const std::filesystem::path& root, std::string_view relative);

// Throws ArgumentError if `path` contains a NUL byte: the system would open another file, whose
// name ends there. `what` names the owner of the path, such as "model".
void RequireNoNul(std::string_view what, std::string_view path);

// Returns true if `name` can be the name of one file on the systems we know: not empty, "." or
// "..", without '/', NUL and control characters, at most 255 bytes.
bool ValidFileName(std::string_view name);

// Throws ArgumentError with the reason unless ValidFileName(name). `what` names the owner of the
// name, such as "camera".
void RequireFileName(std::string_view what, std::string_view name);

// Quotes `text` as one word of a POSIX shell where needed, for commands in messages: 'out/two
// words'. Like Python's shlex.quote.
std::string ShellWord(std::string_view text);

}  // namespace robocell::internal
