#include "robocell/rollout/run_renderer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "robocell/base/error.h"
#include "robocell/data/dataset.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

class RunRendererTest : public testing::Test {
 protected:
  RunRendererTest() {
    run.run = "r";
    run.output = folder.path().string();
    run.cameras.streams.push_back({.name = "front", .camera = "front"});
  }
  void Store(const std::string& backend) {
    WriteManifest(folder.path(), R"({"renderer": ")" + backend + "\"}\n");
  }

  TempDir folder;
  RunConfig run;
};

TEST_F(RunRendererTest, UsesTheBackEndOfTheDataset) {
  EXPECT_EQ(BackendOf(run), "auto");
  Store("soft");
  EXPECT_EQ(BackendOf(run), "soft");
  EXPECT_THAT(MakeRendererOf(run)->description(), testing::StartsWith("soft: "));
}

TEST_F(RunRendererTest, UsesTheBackEndOfTheRun) {
  Store("gl");
  run.cameras.renderer.backend = "soft";
  EXPECT_EQ(BackendOf(run), "soft");
  EXPECT_EQ(BackendToBeginWith(run), "soft");
}

TEST_F(RunRendererTest, UsesTheRenderSettingOfTheRunOrTheDataset) {
  EXPECT_EQ(RenderOf(run), RenderWhen::kAlways);
  Store("soft");
  EXPECT_EQ(RenderOf(run), RenderWhen::kAlways)
      << "a dataset that was begun before there was a choice";
  WriteManifest(folder.path(), R"({"render": "kept"})");
  EXPECT_EQ(RenderOf(run), RenderWhen::kKept);
  run.render = RenderWhen::kAlways;
  EXPECT_EQ(RenderOf(run), RenderWhen::kAlways);
}

TEST_F(RunRendererTest, FailsIfTheBackEndOfTheDatasetDoesNotWork) {
  Store("crayons");
  ExpectThrow<Error>([&] { MakeRendererOf(run); },
                     "are drawn with 'crayons', which does not work here: ");
}

TEST_F(RunRendererTest, StoresNothingForARunWithoutCameras) {
  run.cameras.streams.clear();
  EXPECT_EQ(BackendToBeginWith(run), "");
}

TEST_F(RunRendererTest, StartsWithTheBackEndOfTheEnvironmentVariable) {
  ASSERT_EQ(setenv("ROBOCELL_RENDERER", "soft", 1), 0);
  EXPECT_EQ(BackendToBeginWith(run), "soft");
  ASSERT_EQ(unsetenv("ROBOCELL_RENDERER"), 0);
  EXPECT_THAT(BackendToBeginWith(run), testing::AnyOf("gl", "soft"));
}

}  // namespace
}  // namespace robocell::internal
