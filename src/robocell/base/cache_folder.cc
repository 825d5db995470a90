#include "robocell/base/cache_folder.h"

#include <algorithm>
#include <system_error>
#include <vector>

namespace robocell::internal {

namespace fs = std::filesystem;

void MarkUsed(const fs::path& file) {
  std::error_code error;
  fs::last_write_time(file, fs::file_time_type::clock::now(), error);
}

void PruneFolder(const fs::path& folder, const std::string& suffix, uint64_t most_bytes) {
  struct Entry {
    fs::file_time_type used;
    uint64_t bytes;
    fs::path path;
  };
  std::vector<Entry> entries;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (it->path().extension() != suffix) continue;
    std::error_code gone;  // another process prunes too
    const Entry entry{it->last_write_time(gone), it->file_size(gone), it->path()};
    if (!gone) entries.push_back(entry);
  }
  std::ranges::sort(entries, [](const Entry& a, const Entry& b) { return a.used > b.used; });
  uint64_t kept = 0;
  for (const Entry& entry : entries) {
    kept += entry.bytes;
    if (kept > most_bytes) fs::remove(entry.path, error);
  }
}

}  // namespace robocell::internal
