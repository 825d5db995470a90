#include "robocell/data/folder_names.h"

#include <algorithm>
#include <system_error>

#include "robocell/base/io_error.h"

namespace robocell {

std::vector<std::string> FolderNames(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (std::filesystem::directory_iterator it(folder, error), end; !error && it != end;
       it.increment(error)) {
    names.push_back(it->path().filename().string());
  }
  if (error) ThrowIoError("list", folder, error.value());
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace robocell
