#include "robocell/base/folder_names.h"

#include <algorithm>
#include <system_error>

#include "robocell/base/io_error.h"

namespace robocell {
namespace {

// A range-based loop would throw the system's own error where the folder cannot be read further.
std::vector<std::string> ReadNames(const std::filesystem::path& folder, std::error_code& error) {
  std::vector<std::string> names;
  for (std::filesystem::directory_iterator it(folder, error), end; !error && it != end;
       it.increment(error)) {
    names.push_back(it->path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

std::vector<std::string> FolderNames(const std::filesystem::path& folder) {
  std::error_code error;
  std::vector<std::string> names = ReadNames(folder, error);
  if (error) ThrowIoError("list", folder, error.value());
  return names;
}

std::vector<std::string> FolderNamesIfAny(const std::filesystem::path& folder) {
  std::error_code ignored;
  return ReadNames(folder, ignored);
}

}  // namespace robocell
