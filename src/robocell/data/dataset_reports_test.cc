#include "robocell/data/dataset_reports.h"

#include <sys/stat.h>
#include <unistd.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/checked_json.h"
#include "robocell/base/hash.h"
#include "robocell/data/dataset.h"
#include "robocell/data/testing/dataset_of_three.h"
#include "robocell/data/verify.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

class DatasetReports : public DatasetOfThree {};

TEST_F(DatasetReports, NamesEpisodesOfAReportThatAreMissing) {
  const auto report_of = [](const std::string& episodes) {
    return InsertSelfHash("{\"episodes\": [" + episodes + "], \"json_sha256\": \"" +
                          std::string(kHashPlaceholder) + "\"}");
  };
  Store(folder_ / "report.json",
        report_of(R"({"id": "a", "success": true}, {"id": "d", "success": true},
                     {"id": "e", "success": false}, {"id": "b", "success": true})"));
  EXPECT_EQ(Verify(folder_.path()).problems.size(), 1u);
  EXPECT_EQ(Verify(folder_.path()).problems[0].Text(),
            "d: a report says that it was made, and it is gone. `robocell generate` with the run's "
            "file makes it again");
  EXPECT_EQ(Repair(folder_.path()).remaining.size(), 1u);
  fs::rename(folder_ / "b", folder_ / "b_a02");  // one of its attempts, kept beside others
  EXPECT_THAT(LostEpisodes(folder_.path()), ElementsAre("d"));
  fs::resize_file(folder_ / "b_a02" / "steps.h5", 10);
  fs::create_directory(folder_ / ".quarantine");
  fs::rename(folder_ / "b_a02", folder_ / ".quarantine" / "b_a02.1");
  EXPECT_THAT(LostEpisodes(folder_.path()), ElementsAre("d")) << "it is known where b is";
}

TEST_F(DatasetReports, HousesAreThoseOfTheCommandThatEndedLast) {
  const auto store = [&](const char* name, const std::string& houses, const std::string& finished) {
    Store(folder_ / name, InsertSelfHash("{\"commands\": [{\"finished\": \"" + finished +
                                         "\"}], \"houses\": " + houses + ", \"json_sha256\": \"" +
                                         std::string(kHashPlaceholder) + "\"}"));
  };
  EXPECT_EQ(HousesOfReports(folder_.path()), std::nullopt);
  store("report.json", "[3, 1]", "2026-01-02T00:00:00Z");
  store("report-0-of-2.json", "[7]", "2026-01-01T23:59:59Z");
  EXPECT_THAT(HousesOfReports(folder_.path()).value(), ElementsAre(3, 1));
  store("report-1-of-2.json", "[]", "2026-01-03T00:00:00Z");
  EXPECT_THAT(HousesOfReports(folder_.path()).value(), IsEmpty());
  Store(folder_ / "report-1-of-2.json", "{}");
  EXPECT_THAT(HousesOfReports(folder_.path()).value(), ElementsAre(3, 1)) << "that one is damaged";
}

TEST_F(DatasetReports, NamesAndQuarantinesADamagedReport) {
  Store(folder_ / "report-0-of-2.json", "{}");
  const VerifyResult result = Verify(folder_.path());
  EXPECT_THAT(result.Text(), HasSubstr("report-0-of-2.json: it carries no hash of itself"));
  EXPECT_THAT(Repair(folder_.path()).moved, ElementsAre("report-0-of-2.json"));
  EXPECT_TRUE(Verify(folder_.path()).ok());
}

// A report.json that was copied from another dataset.
TEST_F(DatasetReports, NamesAndIgnoresAReportOfAnotherRun) {
  WriteManifest(folder_.path(), R"({"identity": "seed: 0"})");
  const auto account = [](const std::string& identity) {
    return InsertSelfHash(fmt::format(R"({{"run": "pick", "identity": "{}", "episodes": )"
                                      R"([{{"id": "z", "success": true}}], "json_sha256": "{}"}})",
                                      Sha256(identity), kHashPlaceholder));
  };
  Store(folder_ / "report.json", account("seed: 0"));
  EXPECT_THAT(LostEpisodes(folder_.path()), ElementsAre("z"));
  Store(folder_ / "report.json", account("seed: 7"));
  EXPECT_THAT(LostEpisodes(folder_.path()), IsEmpty());
  const VerifyResult result = Verify(folder_.path());
  ASSERT_EQ(result.problems.size(), 1u) << result.Text();
  EXPECT_EQ(result.problems[0].Text(),
            "report.json: it belongs to another run ('pick') and does not count");
  EXPECT_THAT(Repair(folder_.path()).moved, ElementsAre("report.json"));
  EXPECT_TRUE(Verify(folder_.path()).ok());
}

}  // namespace
}  // namespace robocell
