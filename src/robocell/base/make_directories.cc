#include "robocell/base/make_directories.h"

#include <unistd.h>

#include <fmt/format.h>

#include <system_error>

#include "robocell/base/files.h"
#include "robocell/base/io_error.h"

namespace robocell::internal {

namespace fs = std::filesystem;

void MakeDirectories(const fs::path& path, std::string_view what) {
  std::error_code error;
  if (fs::is_directory(path, error)) return;
  // Not normalised: behind a link, ".." is another folder than the text says.
  fs::path full = fs::absolute(path, error);
  if (error) ThrowIoError(fmt::format("create {}", what), path, error.value());
  if (!full.has_filename()) full = full.parent_path();  // "a/b/"
  fs::path there = full;
  while (!fs::exists(there, error) && there != there.root_path()) there = there.parent_path();
  fs::create_directories(full, error);
  if (error) ThrowIoError(fmt::format("create {}", what), path, error.value());
  for (fs::path made = full; made != there; made = made.parent_path()) {
    const fs::path parent = made.parent_path();
    if (::access(parent.c_str(), R_OK) == 0) FsyncDirectory(parent);
  }
}

}  // namespace robocell::internal
