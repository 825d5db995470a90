#include "robocell/base/lfs_pointer.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <string_view>

#include "robocell/base/real_file.h"
#include "robocell/base/suggestions.h"

namespace robocell::internal {
namespace {

constexpr std::string_view kPointerBegins = "version https://git-lfs.github.com/";

}  // namespace

bool IsLfsPointer(const std::filesystem::path& file) {
  if (!CanReadFile(file)) return false;  // a pipe is not opened: that may wait for ever
  std::ifstream stream(file, std::ios::binary);
  std::string beginning(kPointerBegins.size(), '\0');
  return stream.read(beginning.data(), std::ssize(beginning)) && beginning == kPointerBegins;
}

std::string LfsPointerAdvice(const std::vector<std::filesystem::path>& files) {
  std::vector<std::filesystem::path> pointers;
  std::copy_if(files.begin(), files.end(), std::back_inserter(pointers), IsLfsPointer);
  if (pointers.empty()) return "";
  const int64_t more = std::ssize(pointers) - 1;
  const std::string others =
      more == 0 ? "" : ", as " + Counted(more, "more file") + (more == 1 ? " is" : " are");
  return pointers.front().string() + ": a pointer of Git LFS, not the file itself" + others +
         ": run `git lfs pull` where the repository was cloned, or download the " +
         (more == 0 ? "file" : "files");
}

}  // namespace robocell::internal
