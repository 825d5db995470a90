#include "robocell/rollout/run_files_watch.h"

#include <fmt/format.h>

#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/file_set.h"
#include "robocell/base/suggestions.h"

namespace robocell {
namespace {

constexpr size_t kShownFiles = 3;

bool IsUnchanged(const std::filesystem::path& path, const std::string& hash) {
  try {
    return HashOfFile(path) == hash;
  } catch (const IoError&) {  // it is gone
    return false;
  }
}

}  // namespace

void RunFilesWatch::RequireUnchanged(const RunConfig& run) const {
  std::vector<std::string> changed;
  for (const auto& [name, path] : inputs_.paths) {
    if (!IsUnchanged(path, inputs_.files.at(name))) changed.push_back("'" + path.string() + "'");
  }
  if (changed.empty()) return;
  throw IoError(fmt::format(
      "run '{}': {} changed while the dataset '{}' is being made: what was made with it is not "
      "kept. Put it back and give the same command again, or give another `output` to start a new "
      "dataset",
      run.run, ListNames(changed, kShownFiles), run.output));
}

}  // namespace robocell
