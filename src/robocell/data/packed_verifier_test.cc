#include "robocell/data/packed_verifier.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "robocell/base/files.h"
#include "robocell/testing/sample_pack.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(PackedVerifier, NamesWhatIsDamagedBesideTheEpisodes) {
  const TempDir folder;
  const SamplePack pack(folder.path());
  const auto problems = [&] {
    std::vector<std::string> found;
    VerifyPack(folder.path(), *PackedIndexOf(folder.path()),
               [&](const std::string& file, const std::string& reason, const std::exception*) {
                 found.push_back(file + ": " + reason);
               });
    return found;
  };
  EXPECT_THAT(problems(), IsEmpty());
  AtomicWrite(folder / "s.zip", "--{}..xyz");
  EXPECT_THAT(problems(), IsEmpty()) << "the verifier of episodes finds it";
  AtomicWrite(folder / "s.zip", "-?{}..abc");
  EXPECT_THAT(problems(), ElementsAre("s.zip: the zip file's own tables are damaged; its episodes "
                                      "are read without them"));
  AtomicWrite(folder / "s.zip", "--{}..ab");
  AtomicWrite(folder / "dataset.json", "[]");
  EXPECT_THAT(problems(), ElementsAre("s.zip: it is cut short: 8 of 9 bytes are there",
                                      "dataset.json: its hash does not match its bytes"));
  std::filesystem::remove(folder / "s.zip");
  std::filesystem::remove(folder / "dataset.json");
  EXPECT_THAT(problems(), ElementsAre("s.zip: it is missing",
                                      "dataset.json: it is missing: packed.json lists it"));
}

TEST(PackedVerifier, ComparesFilesOfOtherFolders) {
  const TempDir folder;
  const SamplePack pack(folder.path());
  std::string shards = SamplePack::Shards();
  const std::string last = "\"e/steps.h5\"";
  pack.Write(shards.replace(shards.find(last), last.size(), "\"policy_calls/e.json\""));
  AtomicWrite(folder / "s.zip", "--{}..xyz");
  std::vector<std::string> found;
  VerifyPack(folder.path(), *PackedIndexOf(folder.path()),
             [&](const std::string& file, const std::string&, const std::exception*) {
               found.push_back(file);
             });
  EXPECT_THAT(found, ElementsAre("policy_calls/e.json"));
}

}  // namespace
}  // namespace robocell::internal
