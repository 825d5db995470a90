#include "robocell/base/cache_folder.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <string>

#include "robocell/base/files.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

TEST(PruneFolder, RemovesTheLeastRecentlyUsedFilesOfItsKind) {
  const TempDir folder;
  const auto now = std::filesystem::file_time_type::clock::now();
  for (int i = 0; i < 5; ++i) {
    const auto path = folder / (std::to_string(i) + ".npz");
    AtomicWrite(path, std::string(100, 'x'));
    std::filesystem::last_write_time(path, now - std::chrono::hours(10 - i));
  }
  AtomicWrite(folder / "other.txt", std::string(1000, 'x'));
  MarkUsed(folder / "0.npz");
  PruneFolder(folder.path(), ".npz", 300);
  for (const char* kept : {"0.npz", "4.npz", "3.npz", "other.txt"})
    EXPECT_TRUE(std::filesystem::exists(folder / kept)) << kept;
  for (const char* gone : {"1.npz", "2.npz"})
    EXPECT_FALSE(std::filesystem::exists(folder / gone)) << gone;
}

}  // namespace
}  // namespace robocell::internal
