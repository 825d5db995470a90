#include "robocell/base/file_set.h"

#include <sys/stat.h>
#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <mutex>
#include <sstream>
#include <string_view>
#include <system_error>

#include "robocell/base/io_error.h"
#include "robocell/base/real_file.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;

constexpr size_t kHashDigits = 64;
constexpr std::string_view kBetween = "  ";

// Changes whenever the file does.
using Mark = std::array<int64_t, 6>;

Mark MarkOf(const fs::path& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0) ThrowIoError("look at", path, errno);
  return {static_cast<int64_t>(info.st_ino),
          static_cast<int64_t>(info.st_size),
          info.st_mtim.tv_sec,
          info.st_mtim.tv_nsec,
          info.st_ctim.tv_sec,
          info.st_ctim.tv_nsec};
}

// Hashes of files that were computed before.
class Memory {
 public:
  using Compute = std::string (*)(const fs::path&);
  explicit Memory(Compute compute) : compute_(compute) {}

  std::string Of(const fs::path& path) {
    const Mark mark = MarkOf(path);
    {
      const std::lock_guard lock(mutex_);
      if (const auto it = known_.find(path); it != known_.end() && it->second.mark == mark)
        return it->second.hash;
    }
    const std::string hash = compute_(path);
    const std::lock_guard lock(mutex_);
    known_[path] = {mark, hash};
    return hash;
  }

 private:
  struct Known {
    Mark mark;
    std::string hash;
  };
  Compute compute_;
  std::mutex mutex_;
  std::map<fs::path, Known> known_;
};

fs::path CommonFolder(fs::path a, const fs::path& b) {
  while (*b.lexically_relative(a).begin() == "..") a = a.parent_path();
  return a;
}

}  // namespace

std::string HashOfFile(const fs::path& path) {
  static Memory memory(Sha256File);
  return memory.Of(path);
}

std::string FingerprintOfFile(const fs::path& path) {
  static Memory memory(FingerprintFile);
  return memory.Of(path);
}

FileSet MakeFileSet(const fs::path& main, const std::vector<fs::path>& files,
                    const Hashing& hashing) {
  fs::path folder = main.parent_path();
  for (const fs::path& file : files) folder = CommonFolder(folder, file);
  FileSet set{.main = main.lexically_relative(folder).generic_string(), .files = {}, .hash = {}};
  FileSums sums;
  for (const fs::path& file : files) {
    const std::string name = file.lexically_relative(folder).generic_string();
    set.files[name] = file;
    sums[name] = hashing.of_file(file);
  }
  set.hash = hashing.of_text(TextOf(sums));
  return set;
}

FileSums SumsOfFolder(const fs::path& folder) {
  FileSums sums;
  std::error_code error;
  for (fs::recursive_directory_iterator it(folder, error), end; !error && it != end;
       it.increment(error)) {
    if (fs::is_directory(it->symlink_status(error))) continue;
    sums[it->path().lexically_relative(folder).generic_string()] =
        internal::Sha256RealFile(it->path());
  }
  if (error) ThrowIoError("list", folder, error.value());
  return sums;
}

std::string TextOf(const FileSums& sums) {
  std::string text;
  for (const auto& [name, sum] : sums) text += fmt::format("{}{}{}\n", sum, kBetween, name);
  return text;
}

std::optional<FileSums> ParseSums(const std::string& text) {
  FileSums sums;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.size() <= kHashDigits + kBetween.size() ||
        line.compare(kHashDigits, kBetween.size(), kBetween) != 0)
      return std::nullopt;
    sums[line.substr(kHashDigits + kBetween.size())] = line.substr(0, kHashDigits);
  }
  return sums;
}

}  // namespace robocell
