#include "robocell/rollout/run_renderer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

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

TEST_F(RunRendererTest, AWorkerDrawsOnTheCoresThatTheOthersLeave) {
  const std::unique_ptr<Renderer> soft = MakeRenderer({.backend = "soft"});
  for (const auto& [workers, cores, threads] : std::vector<std::array<int, 3>>{
           {1, 1, 1}, {1, 2, 2}, {2, 2, 1}, {3, 8, 2}, {16, 8, 1}, {1, 64, 3}}) {
    run.workers = workers;
    EXPECT_EQ(DrawingThreads(run, *soft, cores), threads) << workers << " on " << cores;
  }
  run.workers = 1;
  EXPECT_GE(DrawingThreads(run, *soft), 1);
}

TEST_F(RunRendererTest, OpenGlHasOneDrawingThread) {
  class Gl : public Renderer {
   public:
    void SetModel(const mjModel*) override {}
    CameraModel Render(const mjData*, const RenderRequest&, const RenderOutputs&) override {
      return {};
    }
    const RenderQuality& quality() const override { return quality_; }
    const std::string& description() const override { return description_; }

   private:
    RenderQuality quality_;
    std::string description_ = "gl: egl: llvmpipe";
  };
  EXPECT_EQ(DrawingThreads(run, Gl(), 8), 1);
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
