// Quotes paths in the commands that messages contain.
#pragma once

#include <string>
#include <string_view>

namespace robocell {

// `text` as one word of a POSIX shell, in single quotes where it needs them: 'out/two words'. As
// Python's shlex.quote.
std::string ShellWord(std::string_view text);

}  // namespace robocell
