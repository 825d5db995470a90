#include "robocell/rollout/rollout_recording.h"

#include <signal.h>
#include <unistd.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <filesystem>
#include <fstream>
#include <future>
#include <iterator>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/media/warm_program.h"
#include "robocell/rollout/testing/rollout_test_base.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

// Rollouts with two cameras, drawn by the back end that every machine has.
class FilmedRolloutTest : public RolloutTest {
 protected:
  FilmedRolloutTest() {
    run.cameras.resolution = {64, 48};
    run.cameras.streams.push_back({.name = "wrist", .camera = "wrist_camera", .depth = true});
    run.cameras.streams.push_back({.name = "exo", .camera = "exo_camera", .segmentation = true});
    start->scene.SetState(state);
  }
  RolloutResult Film(Expert& expert, const std::string& id, RenderWhen render,
                     bool keep_failures = false, const StopRequest& stop = {}) {
    start->scene.SetState(state);
    Rng rng = Rng::Stream(2, "expert");
    return RunRollout(run, *start, expert, rng,
                      {.dataset = folder.path(),
                       .episode_id = id,
                       .metadata_json = "{}",
                       .keep_failures = keep_failures,
                       .renderer = renderer.get(),
                       .more_renderers = more,
                       .render = render,
                       .stop = stop});
  }
  // All files but the description, which has times and the id.
  void ExpectSameBytes(const std::string& a, const std::string& b) {
    for (const char* file :
         {"steps.h5", "wrist.mp4", "wrist.depth.mov", "exo.mp4", "exo.segmentation.mov"})
      EXPECT_EQ(ReadFile(folder / a / file), ReadFile(folder / b / file)) << file;
  }
  size_t entries() const {
    return static_cast<size_t>(
        std::distance(std::filesystem::directory_iterator(folder.path()), {}));
  }

  std::unique_ptr<Renderer> renderer = MakeRenderer({.backend = "soft"});
  std::vector<Renderer*> more;  // of further threads
  std::vector<double> state = start->scene.state();
};

// Moves, and changes how the cell looks in every row.
class Painting : public Commanding {
 public:
  Painting(Pose leaf, Scene scene) : Commanding(std::move(leaf), 6), scene_(std::move(scene)) {}
  void Begin(const Scene& scene, Rng& rng) override {
    Commanding::Begin(scene, rng);
    Paint(0.3F);
  }
  Action Act(const Scene& scene, Rng& rng) override {
    Paint(0.1F * static_cast<float>(++row_));
    return Commanding::Act(scene, rng);
  }

 private:
  void Paint(float red) {
    mjModel* model = scene_.mutable_model();
    for (int geom = 0; geom < model->ngeom; ++geom) model->geom_rgba[4 * geom] = red;
    model->vis.headlight.ambient[1] = red;
  }
  Scene scene_;
  int row_ = 0;
};

TEST_F(FilmedRolloutTest, ImagesDoNotDependOnTheTimeOfRendering) {
  start->task = std::make_shared<Content>();
  const Pose leaf = Robot::Of(start->scene, "rc7").FkFrame();
  const auto film = [&](const std::string& id, RenderWhen render, bool looks) {
    class Looking : public Painting {
     public:
      Looking(Pose leaf, Scene scene, bool looks)
          : Painting(std::move(leaf), std::move(scene)), looks_(looks) {}
      void See(const CellRow& row) override {
        if (!looks_ || ++rows_ < 3) return;
        reds.push_back(row.images.images()[1].rgb);
      }
      std::vector<std::vector<uint8_t>> reds;

     private:
      bool looks_;
      int rows_ = 0;
    } expert(leaf, start->scene, looks);
    EXPECT_TRUE(Film(expert, id, render).committed);
    return expert.reds;
  };
  film("always", RenderWhen::kAlways, false);
  film("kept", RenderWhen::kKept, false);
  const auto seen = film("always_seen", RenderWhen::kAlways, true);
  EXPECT_EQ(film("kept_seen", RenderWhen::kKept, true), seen);
  ASSERT_EQ(seen.size(), 4);
  EXPECT_NE(seen[0], seen[1]) << "each row looks otherwise";
  for (const char* other : {"kept", "always_seen", "kept_seen"}) ExpectSameBytes("always", other);
}

// Each row looks otherwise, and a policy that looks has its images drawn by the first thread.
TEST_F(FilmedRolloutTest, SeveralThreadsDrawTheSameBytes) {
  class Looking : public Painting {
   public:
    Looking(Pose leaf, Scene scene, int first) : Painting(std::move(leaf), scene), first_(first) {}
    void See(const CellRow& row) override {
      if (rows_++ >= first_) reds.push_back(row.images.images()[1].rgb);
    }
    std::vector<std::vector<uint8_t>> reds;

   private:
    int first_, rows_ = 0;
  };
  start->task = std::make_shared<Content>();
  const Pose leaf = Robot::Of(start->scene, "rc7").FkFrame();
  constexpr int kNever = 100;
  Painting alone(leaf, start->scene);
  EXPECT_TRUE(Film(alone, "alone", RenderWhen::kAlways).committed);
  const std::unique_ptr<Renderer> second = MakeRenderer({.backend = "soft"});
  const std::unique_ptr<Renderer> third = MakeRenderer({.backend = "soft"});
  more = {second.get(), third.get()};
  std::vector<std::vector<uint8_t>> seen;
  for (const RenderWhen render : {RenderWhen::kAlways, RenderWhen::kKept}) {
    for (const int first : {kNever, 3, 0}) {
      const std::string id = fmt::format("{}_{}", ToString(render), first);
      Looking expert(leaf, start->scene, first);
      EXPECT_TRUE(Film(expert, id, render).committed);
      ExpectSameBytes("alone", id);
      if (first > 0) continue;
      if (seen.empty()) seen = expert.reds;
      EXPECT_EQ(expert.reds, seen);
    }
  }
  EXPECT_EQ(seen.size(), 6);
}

TEST_F(FilmedRolloutTest, FailuresAreRenderedOnlyIfKept) {
  class Counting : public Renderer {
   public:
    explicit Counting(std::unique_ptr<Renderer> inner) : inner_(std::move(inner)) {}
    void SetModel(const mjModel* model) override { inner_->SetModel(model); }
    CameraModel Render(const mjData* data, const RenderRequest& request,
                       const RenderOutputs& outputs) override {
      ++images;
      return inner_->Render(data, request, outputs);
    }
    const RenderQuality& quality() const override { return inner_->quality(); }
    const std::string& description() const override { return inner_->description(); }
    int images = 0;

   private:
    std::unique_ptr<Renderer> inner_;
  };
  auto counting = std::make_unique<Counting>(std::move(renderer));
  const Counting& counted = *counting;
  renderer = std::move(counting);
  const Pose leaf = Robot::Of(start->scene, "rc7").FkFrame();
  Commanding dropped(leaf, 4), kept(leaf, 4);
  EXPECT_FALSE(Film(dropped, "e", RenderWhen::kKept).committed);
  EXPECT_EQ(counted.images, 0);
  EXPECT_EQ(entries(), 0);
  EXPECT_TRUE(Film(kept, "e", RenderWhen::kKept, true).committed);
  EXPECT_EQ(counted.images, 2 * 4);
}

TEST_F(FilmedRolloutTest, AStopBetweenActingAndDrawingLeavesNothing) {
  start->task = std::make_shared<Content>();
  Commanding expert(Robot::Of(start->scene, "rc7").FkFrame(), 4);
  int polls = 0;
  const RolloutResult result =
      Film(expert, "e", RenderWhen::kKept, false, [&] { return ++polls > 4; });
  EXPECT_TRUE(result.stopped);
  EXPECT_FALSE(result.committed);
  EXPECT_EQ(result.rows, 4) << "all of it was acted";
  EXPECT_EQ(entries(), 0);
}

TEST_F(FilmedRolloutTest, ReportsADiskFailureDuringRendering) {
  start->task = std::make_shared<Content>();
  const Pose leaf = Robot::Of(start->scene, "rc7").FkFrame();
  for (const RenderWhen render : {RenderWhen::kAlways, RenderWhen::kKept}) {
    Commanding expert(leaf, 4);
    std::filesystem::create_directory(folder / "e");
    AtomicWrite(folder / "e" / "in_the_way", "x");
    ExpectThrow<IoError>([&] { Film(expert, "e", render); }, (folder / "e").string());
    std::filesystem::remove_all(folder / "e");
    EXPECT_EQ(entries(), 0);
  }
}

// The encoders of this process, and not what waits to become one.
std::vector<pid_t> Encoders() {
  std::vector<pid_t> found;
  const std::string own = std::to_string(getpid());
  std::ifstream children("/proc/" + own + "/task/" + own + "/children");
  for (pid_t child = 0; children >> child;) {
    if (child != WarmProgramPid()) found.push_back(child);
  }
  return found;
}

TEST_F(FilmedRolloutTest, AKilledEncoderLosesNoEpisodeAndChangesNoByte) {
  // Kills all encoders in the middle of the first rollouts.
  class Killing : public Commanding {
   public:
    Killing(Pose leaf, int times) : Commanding(std::move(leaf), 6), times_(times) {}
    Action Act(const Scene& scene, Rng& rng) override {
      if (++rows_ > 2 && times_-- > 0) {
        for (const pid_t encoder : Encoders()) kill(encoder, SIGKILL);
      }
      return Commanding::Act(scene, rng);
    }

   private:
    int times_, rows_ = 0;
  };
  start->task = std::make_shared<Content>();
  const Pose leaf = Robot::Of(start->scene, "rc7").FkFrame();
  Killing calm(leaf, 0), disturbed(leaf, 1), shared(leaf, 1);
  EXPECT_TRUE(Film(calm, "calm", RenderWhen::kAlways).committed);
  EXPECT_TRUE(Film(disturbed, "disturbed", RenderWhen::kAlways).committed);
  ExpectSameBytes("calm", "disturbed");
  const std::unique_ptr<Renderer> second = MakeRenderer({.backend = "soft"});
  more = {second.get()};
  EXPECT_TRUE(Film(shared, "shared", RenderWhen::kAlways).committed);
  ExpectSameBytes("calm", "shared");
  EXPECT_EQ(entries(), 4) << "the episodes and their models, and nothing half-written";
}

// A renderer that fails is no fault of the policy that looks at its images.
TEST_F(FilmedRolloutTest, ExceptionsOfTheRendererPropagate) {
  class Failing : public Renderer {
   public:
    void SetModel(const mjModel*) override {}
    CameraModel Render(const mjData*, const RenderRequest&, const RenderOutputs&) override {
      throw EngineError("the picture broke");
    }
    const RenderQuality& quality() const override { return quality_; }
    const std::string& description() const override { return description_; }

   private:
    RenderQuality quality_;
    std::string description_ = "failing";
  };
  class Looking : public Commanding {
   public:
    Looking() : Commanding(Pose(), 4) {}
    Action Act(const Scene&, Rng&) override { return {}; }
    void See(const CellRow& row) override { row.images.images(); }
  };
  renderer = std::make_unique<Failing>();
  for (const RenderWhen render : {RenderWhen::kAlways, RenderWhen::kKept}) {
    Looking looking;
    ExpectThrow<EngineError>([&] { Film(looking, "a", render); }, "the picture broke");
    Commanding blind(Pose(), 0);
    ExpectThrow<EngineError>([&] { Film(blind, "b", render, true); }, "the picture broke");
    EXPECT_EQ(entries(), 0);
  }
}

// Draws the first image only once the stop request has come.
TEST_F(FilmedRolloutTest, AStopEndsTheWaitForEarlierRowsOfAPolicyThatLooks) {
  class Waiting : public Renderer {
   public:
    Waiting(std::unique_ptr<Renderer> inner, std::shared_future<void> stopped)
        : inner_(std::move(inner)), stopped_(std::move(stopped)) {}
    void SetModel(const mjModel* model) override { inner_->SetModel(model); }
    CameraModel Render(const mjData* data, const RenderRequest& request,
                       const RenderOutputs& outputs) override {
      stopped_.wait();
      return inner_->Render(data, request, outputs);
    }
    const RenderQuality& quality() const override { return inner_->quality(); }
    const std::string& description() const override { return inner_->description(); }

   private:
    std::unique_ptr<Renderer> inner_;
    std::shared_future<void> stopped_;
  };
  class LookingLater : public Commanding {
   public:
    LookingLater() : Commanding(Pose(), 4) {}
    Action Act(const Scene&, Rng&) override { return {}; }
    void See(const CellRow& row) override {
      if (++rows < 2) return;
      is_looking = true;
      row.images.images();
    }
    int rows = 0;
    bool is_looking = false;
  } expert;
  std::promise<void> stopped;
  bool is_stopped = false;
  renderer = std::make_unique<Waiting>(std::move(renderer), stopped.get_future().share());
  const RolloutResult result = Film(expert, "e", RenderWhen::kAlways, true, [&] {
    if (expert.is_looking && !std::exchange(is_stopped, true)) stopped.set_value();
    return is_stopped;
  });
  EXPECT_TRUE(result.stopped);
  EXPECT_EQ(expert.rows, 2);
  EXPECT_EQ(entries(), 0);
}

}  // namespace
}  // namespace robocell::internal
