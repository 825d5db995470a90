#include "robocell/data/dataset.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/log.h"
#include "robocell/data/testing/sample_episode.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;

TEST(Dataset, EpisodesAreSortedById) {
  TempDir folder;
  for (const char* id : {"e-10", "e-02", "e-01"}) SampleEpisode(0, false).Write(folder.path(), id);
  const Dataset dataset(folder.path());
  std::vector<std::string> ids;
  for (const Episode& episode : dataset) ids.push_back(episode.id());
  EXPECT_THAT(ids, ElementsAre("e-01", "e-02", "e-10"));
  ExpectThrow<NotFoundError>([&] { dataset.Open("e-03"); }, "no episode 'e-03'");
}

TEST(Dataset, CountsOnlyCommittedEpisodes) {
  TempDir folder;
  const SampleEpisode sample(0, false);
  EpisodeWriter unfinished(folder.path(), "b", sample.schema);
  fs::create_directory(folder / "notes");
  fs::create_directory(folder / "c");
  AtomicWrite(folder / "c" / "steps.h5", "x");
  Dataset dataset(folder.path());
  EXPECT_EQ(dataset.size(), 0u);
  sample.Write(folder.path(), "a");
  EXPECT_FALSE(dataset.Contains("a"));  // a snapshot
  dataset.Refresh();
  EXPECT_THAT(dataset.ids(), ElementsAre("a"));
  EXPECT_THAT(dataset.broken(), ElementsAre("c")) << "not dropped silently";
}

TEST(Dataset, ReportsCopiedAndRenamedEpisodes) {
  TempDir folder;
  for (const char* id : {"a", "b"}) SampleEpisode(0, false).Write(folder.path(), id);
  fs::copy(folder / "a", folder / "a_copy");
  fs::rename(folder / "b", folder / "c");
  std::vector<std::string> logged;
  const ScopedLogSink log([&](LogLevel, std::string_view text) { logged.emplace_back(text); });
  const Dataset dataset(folder.path());
  EXPECT_THAT(dataset.ids(), ElementsAre("a"));
  EXPECT_THAT(dataset.misnamed(), ElementsAre(Pair("a_copy", "a"), Pair("c", "b")));
  EXPECT_THAT(logged,
              ElementsAre(HasSubstr("a_copy' holds episode 'a': it was copied or renamed"),
                          HasSubstr("c' holds episode 'b': it was copied or renamed, and does "
                                    "not count. Remove the copy, or give the folder its name "
                                    "back")));
}

TEST(Dataset, ASelectionContainsOnlyItsEpisodes) {
  TempDir folder;
  for (const char* id : {"a", "b", "c"}) SampleEpisode(0, false).Write(folder.path(), id, 1);
  const Dataset dataset(folder.path());
  Dataset some = dataset.Select({"c", "a"});
  EXPECT_TRUE(some.is_selection());
  std::vector<std::string> ids;
  for (const Episode& episode : some) ids.push_back(episode.id());
  EXPECT_THAT(ids, ElementsAre("c", "a"));
  EXPECT_EQ(some.Open("a").id(), "a");
  EXPECT_FALSE(some.Contains("b"));
  ExpectThrow<NotFoundError>([&] { some.Open("b"); }, "selection of dataset");
  ExpectThrow<NotFoundError>([&] { dataset.Select({"a", "d"}); }, "no episode 'd'");
  fs::remove_all(folder / "a");
  SampleEpisode(0, false).Write(folder.path(), "d", 1);
  some.Refresh();
  EXPECT_THAT(some.ids(), ElementsAre("c")) << "what is new is not selected";
}

TEST(Dataset, RestoresTheSameEpisodes) {
  TempDir folder;
  SampleEpisode(0, false).Write(folder.path(), "a", 1);
  const Dataset dataset(folder.path());
  SampleEpisode(0, false).Write(folder.path(), "b", 1);
  const Dataset restored = Dataset::Restore(dataset.folder(), dataset.ids(), false);
  EXPECT_THAT(restored.ids(), ElementsAre("a"));
  EXPECT_EQ(restored.At(0).id(), "a");
}

TEST(Dataset, AMissingFolderIsNamed) {
  ExpectThrow<IoError>([] { Dataset("/no/such/folder"); }, "/no/such/folder");
}

TEST(Manifest, RoundTrips) {
  TempDir folder;
  EXPECT_EQ(ReadManifest(folder.path()), std::nullopt);
  WriteManifest(folder.path(), R"({"run": "pick"})");
  const std::string text = ReadManifest(folder.path()).value();
  EXPECT_EQ(nlohmann::json::parse(text).at("run"), "pick");
  WriteManifest(folder.path(), text);
  EXPECT_EQ(ReadManifest(folder.path()), text);
  ExpectThrow<ArgumentError>([&] { WriteManifest(folder.path(), "[1]"); }, "must be a JSON object");
  for (const std::string& damaged :
       {text.substr(0, text.size() / 2), std::string("{\"run\": \"pick\"}"), text + " "}) {
    AtomicWrite(folder / "dataset.json", damaged);
    ExpectThrow<IoError>([&] { ReadManifest(folder.path()); }, "dataset.json' is damaged");
  }
}

}  // namespace
}  // namespace robocell
