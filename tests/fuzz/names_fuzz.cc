// Names and paths from anybody: suggestions come from the candidates, and no path leaves its root.
// The first line is the name, the others are the candidates.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/names.h"
#include "robocell/base/paths.h"

namespace fs = std::filesystem;

namespace {

std::vector<std::string> Lines(std::string_view text) {
  std::vector<std::string> lines;
  for (size_t end = 0; end != std::string_view::npos;
       text.remove_prefix(std::min(end + 1, text.size()))) {
    end = text.find('\n');
    lines.emplace_back(text.substr(0, end));
  }
  return lines;
}

void Suggest(const std::string& name, const std::vector<std::string>& candidates) {
  for (const std::string& nearest : robocell::NearestNames(name, candidates)) {
    if (std::find(candidates.begin(), candidates.end(), nearest) == candidates.end()) std::abort();
  }
  if (robocell::NoSuchName("place", "thing", name, candidates).empty()) std::abort();
}

void Join(const std::string& name) {
  const fs::path root = "/nowhere/root";
  try {
    const fs::path inside =
        robocell::ConfinedPath(root, name).lexically_normal().lexically_relative(root);
    if (inside.empty() || *inside.begin() == "..") std::abort();
  } catch (const robocell::Error&) {
    return;  // refused, which is fine
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  std::vector<std::string> lines = Lines({reinterpret_cast<const char*>(data), size});
  const std::string name = lines.front();
  lines.erase(lines.begin());
  Suggest(name, lines);
  Join(name);
  return 0;
}
