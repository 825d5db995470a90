#include "robocell/data/own_folders.h"

#include <fmt/format.h>

#include <system_error>

#include "robocell/base/error.h"
#include "robocell/base/real_file.h"
#include "robocell/data/episode_files.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;

bool Is(const fs::path& path, std::initializer_list<fs::file_type> types) {
  std::error_code ignored;
  const fs::file_type type = fs::symlink_status(path, ignored).type();
  for (const fs::file_type each : types) {
    if (type == each) return true;
  }
  return false;
}

}  // namespace

std::vector<ForeignThing> NotOwn(const fs::path& dataset) {
  std::vector<ForeignThing> found;
  const auto add = [&](const fs::path& path) {
    found.push_back({path.lexically_relative(dataset).generic_string(), WhatIsAt(path)});
  };
  for (const std::string_view name : {kModelsFolder, kQuarantineFolder, kLogsFolder}) {
    const fs::path folder = dataset / name;
    if (!Is(folder, {fs::file_type::directory, fs::file_type::not_found})) add(folder);
  }
  if (!Is(dataset / kLogsFolder, {fs::file_type::directory})) return found;
  std::error_code error;  // logs come and go beside us
  for (fs::recursive_directory_iterator it(dataset / kLogsFolder, error), end; !error && it != end;
       it.increment(error)) {
    if (!Is(it->path(),
            {fs::file_type::regular, fs::file_type::directory, fs::file_type::not_found}))
      add(it->path());
  }
  return found;
}

void RequireOwnFolders(const fs::path& dataset) {
  for (const ForeignThing& thing : NotOwn(dataset)) {
    throw IoError(
        fmt::format("cannot use '{}': it is {}, so what is written into it would leave the "
                    "dataset. Remove it, or put what it leads to there itself",
                    (dataset / thing.name).string(), thing.what));
  }
}

}  // namespace robocell
