#include "robocell/base/name_pattern.h"

#include <cstddef>

namespace robocell::internal {

// Only the last `*` ever has to take more characters: those before it took the shortest part that
// lets the rest between them fit.
bool FitsPattern(std::string_view pattern, std::string_view name) {
  size_t at = 0, in_name = 0;
  size_t star = std::string_view::npos, after_star = 0;  // the last `*`, and where its part ends
  while (in_name < name.size()) {
    if (at < pattern.size() && pattern[at] == '*') {
      star = at++;
      after_star = in_name;
    } else if (at < pattern.size() && (pattern[at] == '?' || pattern[at] == name[in_name])) {
      ++at;
      ++in_name;
    } else if (star != std::string_view::npos) {
      at = star + 1;
      in_name = ++after_star;
    } else {
      return false;
    }
  }
  while (at < pattern.size() && pattern[at] == '*') ++at;
  return at == pattern.size();
}

bool IsNamePattern(std::string_view text) {
  return text.find_first_of("*?") != std::string_view::npos;
}

}  // namespace robocell::internal
