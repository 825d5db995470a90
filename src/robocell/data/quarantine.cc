#include "robocell/data/quarantine.h"

#include <fmt/format.h>

#include <system_error>

#include "robocell/base/io_error.h"
#include "robocell/base/real_file.h"
#include "robocell/data/episode_files.h"

namespace robocell {

namespace fs = std::filesystem;

std::string Quarantine(const fs::path& dataset, const std::string& name) {
  const fs::path folder = dataset / kQuarantineFolder;
  std::error_code error;
  RequireRealFolder(folder);
  fs::create_directory(folder, error);
  if (error) ThrowIoError("create", folder, error.value());
  const std::string own = fs::path(name).filename().string();
  std::string target = own;
  for (int i = 1; fs::exists(fs::symlink_status(folder / target)); ++i)
    target = fmt::format("{}.{}", own, i);
  fs::rename(dataset / name, folder / target, error);
  if (error) ThrowIoError("move aside", dataset / name, error.value());
  return target;
}

}  // namespace robocell
