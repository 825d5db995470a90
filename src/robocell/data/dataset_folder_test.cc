#include "robocell/data/dataset_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<std::string> NamesOf(const std::vector<ForeignEntry>& entries) {
  std::vector<std::string> names;
  for (const ForeignEntry& entry : entries) names.push_back(entry.name);
  return names;
}

TEST(DatasetFolder, RejectsLinksAsItsOwnFolders) {
  const TempDir folder, elsewhere;
  std::filesystem::create_directories(folder / ".logs/worker");
  AtomicWrite(folder / ".logs/worker/0.log", "a log");
  EXPECT_THAT(NotOwn(folder.path()), IsEmpty());
  EXPECT_NO_THROW(RequireOwnFolders(folder.path()));

  std::filesystem::create_directory_symlink(elsewhere.path(), folder / "models");
  std::filesystem::create_symlink(elsewhere / "stolen", folder / ".logs/worker/1.log");
  AtomicWrite(folder / ".quarantine", "a file");
  EXPECT_THAT(NamesOf(NotOwn(folder.path())),
              ElementsAre("models", ".quarantine", ".logs/worker/1.log"));
  ExpectThrow<IoError>([&] { RequireOwnFolders(folder.path()); },
                       "models': it is a link to '" + elsewhere.path().string() + "'");
}

TEST(DatasetFolder, AnyFileOfADatasetIdentifiesIt) {
  for (const char* name : {"dataset.json", ".quarantine", "models", "report.json"}) {
    const TempDir folder;
    AtomicWrite(folder / name, "{}");
    EXPECT_NO_THROW(RequireDataset(folder.path())) << name;
  }
}

TEST(DatasetFolder, ANonDatasetErrorNamesANearbyDataset) {
  const TempDir folder;
  ExpectThrow<ArgumentError>([&] { RequireDataset(folder.path()); },
                             "it has neither a dataset.json nor episodes, it is empty");
  for (const char* name : {"first", "second"}) {
    std::filesystem::create_directories(folder / name / "figures");
    AtomicWrite(folder / name / "dataset.json", "{}");
    if (std::string(name) == "first") {
      ExpectThrow<ArgumentError>([&] { RequireDataset(folder.path()); },
                                 "Did you mean '" + (folder / "first").string() + "'?");
    }
  }
  ExpectThrow<ArgumentError>([&] { RequireDataset(folder.path()); },
                             "It holds 2 datasets, give one of them: ");
  ExpectThrow<ArgumentError>(
      [&] { RequireDataset(folder / "first/figures"); },
      "It is a part of a dataset; give '" + (folder / "first").string() + "'");
}

TEST(DatasetFolder, QuarantineKeepsANameThatIsFree) {
  const TempDir folder;
  for (const char* content : {"one", "two", "three"}) {
    std::filesystem::create_directories(folder / "models/rc7");
    AtomicWrite(folder / "models/rc7/rc7.xml", content);
    const std::string name = Quarantine(folder.path(), "models/rc7");
    EXPECT_EQ(ReadFile(folder / ".quarantine" / name / "rc7.xml"), content);
    EXPECT_FALSE(std::filesystem::exists(folder / "models/rc7"));
  }
  EXPECT_TRUE(std::filesystem::is_directory(folder / ".quarantine/rc7"));
  EXPECT_TRUE(std::filesystem::is_directory(folder / ".quarantine/rc7.1"));
  EXPECT_TRUE(std::filesystem::is_directory(folder / ".quarantine/rc7.2"));
}

TEST(DatasetFolder, QuarantineFollowsNoLink) {
  const TempDir folder, elsewhere;
  std::filesystem::create_directory(folder / "a");
  std::filesystem::create_directory_symlink(elsewhere.path(), folder / ".quarantine");
  EXPECT_THROW(Quarantine(folder.path(), "a"), IoError);
  EXPECT_TRUE(std::filesystem::is_directory(folder / "a"));
  EXPECT_TRUE(std::filesystem::is_empty(elsewhere.path()));
}

}  // namespace
}  // namespace robocell
