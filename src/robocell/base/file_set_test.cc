#include "robocell/base/file_set.h"

#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/hash.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;

FileSet Arm(const fs::path& folder, const std::string& mesh = "mesh") {
  fs::create_directories(folder / "arm");
  fs::create_directories(folder / "common");
  AtomicWrite(folder / "arm/arm.xml", "model");
  AtomicWrite(folder / "common/a.stl", mesh);
  return MakeFileSet(folder / "arm/arm.xml", {folder / "arm/arm.xml", folder / "common/a.stl"});
}

TEST(FileSet, HasNamesRelativeToTheCommonFolder) {
  TempDir temp;
  const FileSet arm = Arm(temp.path());
  EXPECT_EQ(arm.main, "arm/arm.xml");
  EXPECT_EQ(arm.files.at("common/a.stl"), temp / "common/a.stl");
  EXPECT_EQ(MakeFileSet(temp / "arm/arm.xml", {temp / "arm/arm.xml"}).main, "arm.xml");
}

TEST(FileSet, HasTheSameHashInAnyFolder) {
  TempDir here, there;
  EXPECT_EQ(Arm(here.path()).hash, Arm(there.path()).hash);
  EXPECT_EQ(Arm(here.path()).hash, Sha256(TextOf(SumsOfFolder(there.path()))));
}

// Files of the same length written at the same time must be distinguished.
TEST(FileSet, HasAnotherHashWhenAFileChanges) {
  TempDir temp;
  const std::string before = Arm(temp.path()).hash;
  EXPECT_NE(Arm(temp.path(), "hsem").hash, before);
  EXPECT_EQ(Arm(temp.path(), "mesh").hash, before);
}

TEST(FileSet, HasAnotherHashWhenANameChanges) {
  TempDir temp;
  const std::string before = Arm(temp.path()).hash;
  fs::rename(temp / "common/a.stl", temp / "common/b.stl");
  EXPECT_NE(Sha256(TextOf(SumsOfFolder(temp.path()))), before);
}

TEST(FileSums, RoundTripThroughText) {
  const FileSums sums = {{"a b.xml", Sha256("a")}, {"assets/a.stl", Sha256("mesh")}};
  EXPECT_EQ(ParseSums(TextOf(sums)), sums);
  EXPECT_EQ(ParseSums(""), FileSums());
  EXPECT_EQ(ParseSums("no sums\n"), std::nullopt);
  EXPECT_EQ(ParseSums(Sha256("a") + "  "), std::nullopt);
}

TEST(FileSet, CachesTheRequestedHash) {
  TempDir temp;
  const auto quick = [&](const std::string& mesh) {
    const FileSet arm = Arm(temp.path(), mesh);
    std::vector<fs::path> files;
    for (const auto& [name, file] : arm.files) files.push_back(file);
    return MakeFileSet(files.front(), files, kFingerprints).hash;
  };
  const std::string before = quick("mesh");
  EXPECT_NE(before, Arm(temp.path()).hash);
  EXPECT_NE(quick("hsem"), before);
  EXPECT_EQ(quick("mesh"), before);
}

TEST(FileSet, NamesAMissingFile) {
  ExpectThrow<IoError>([] { MakeFileSet("/no/such.xml", {"/no/such.xml"}); }, "/no/such.xml");
  ExpectThrow<IoError>([] { SumsOfFolder("/no/such"); }, "/no/such");
}

}  // namespace
}  // namespace robocell
