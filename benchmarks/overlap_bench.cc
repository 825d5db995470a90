// The gain of overlapping the stages of an episode: the Runner with two cameras, beside its stages
// one after the other, which a user without the Runner would need: acting (the Runner without
// cameras), drawing the images of the resulting states, encoding them. Row P12 of RESULTS.md.
//
//   build/release/overlap_bench [RUN.yaml ...]   default: examples/demo.yaml
//
// The run's own cameras, at 640x480, in a run with one worker. Every side makes, draws or encodes
// the same episodes. The stages have one thread each; the Runner has all cores. Where OpenGL is,
// the images are also drawn by it without effects, as robocell did before it had a rasteriser.
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bench.h"
#include "robocell/media/video_writer.h"
#include "robocell/render/stream_camera.h"
#include "robocell/rollout/episode_cameras.h"
#include "robocell/rollout/prepare.h"

namespace robocell {
namespace {

constexpr int kEpisodes = 2;
constexpr int kWidth = 640, kHeight = 480;

// A rollout as the expert saw it: once per row, before the action.
struct Rollout {
  Scene scene;
  std::vector<std::vector<double>> states = {};
};
using Rollouts = std::vector<Rollout>;

// Acts like another expert and records each state.
class Watching : public Expert {
 public:
  Watching(std::shared_ptr<Expert> inner, Rollouts& rollouts)
      : inner_(std::move(inner)), rollouts_(rollouts) {}
  void Begin(const Scene& scene, Rng& rng) override {
    rollouts_.push_back({scene});
    inner_->Begin(scene, rng);
  }
  Action Act(const Scene& scene, Rng& rng) override {
    rollouts_.back().states.push_back(scene.state());
    return inner_->Act(scene, rng);
  }
  bool done() const override { return inner_->done(); }
  std::string failure() const override { return inner_->failure(); }
  int phase() const override { return inner_->phase(); }
  std::vector<std::string> phase_names() const override { return inner_->phase_names(); }

 private:
  std::shared_ptr<Expert> inner_;
  Rollouts& rollouts_;
};

class Making {
 public:
  explicit Making(const std::string& run_file) : run_(RunConfig::Load(run_file)) {
    run_.output = folder_ / "dataset";
    run_.workers = 1;
    run_.cameras.resolution = {kWidth, kHeight};
    for (CameraConfig& stream : run_.cameras.streams) stream.width = stream.height = {};
    RunConfig blind = run_, plain = run_;
    blind.cameras.streams.clear();
    plain.cameras.renderer.quality = {};
    runner_ = std::make_unique<Runner>(run_);
    blind_ = std::make_unique<Runner>(blind);
    plain_ = std::make_unique<Runner>(plain);
    WatchOnce(blind);
    for (const Rollout& rollout : rollouts_) {
      const std::vector<std::vector<uint8_t>> frames(
          rollout.states.size(), std::vector<uint8_t>(size_t{3} * kWidth * kHeight));
      videos_.insert(videos_.end(), run_.cameras.streams.size(), frames);
    }
    renderer_ = MakeRenderer(
        {.backend = run_.cameras.renderer.backend, .quality = run_.cameras.renderer.quality});
    Images();
    try {
      gl_ = MakeRenderer({.backend = "gl"});
      GlImages();
    } catch (const Error& error) {
      std::fprintf(stderr, "left out: images by gl: %s\n", error.what());
    }
  }
  bool has_gl() const { return gl_ != nullptr; }
  const RunConfig& run() const { return run_; }
  double frames() const {
    double rows = 0;
    for (const Rollout& rollout : rollouts_) rows += static_cast<double>(rollout.states.size());
    return rows * static_cast<double>(run_.cameras.streams.size());
  }

  Runner& runner() { return *runner_; }
  Runner& blind() { return *blind_; }  // without cameras
  Runner& plain() { return *plain_; }  // without effects in images
  void Prepare(const Runner& runner) {
    folder_.Clear();
    PrepareDataset(runner.run());
  }
  void Make(Runner& runner) {
    made_ = 0;
    const std::vector<PlanItem> plan = MakePlan(runner.run());
    for (int i = 0; i < kEpisodes; ++i) {
      const ItemResult result = runner.Run(plan.at(i));
      made_ += result.committed && !result.resumed;
    }
  }
  void Images() { DrawAll(*renderer_); }
  void GlImages() { DrawAll(*gl_); }
  void Encode() {
    for (size_t i = 0; i < videos_.size(); ++i) {
      VideoWriter video(folder_ / (std::to_string(i) + ".mp4"),
                        {.width = kWidth, .height = kHeight, .fps_num = 500, .fps_den = 33});
      for (const std::vector<uint8_t>& frame : videos_[i]) video.Write(frame);
      video.Finish();
    }
  }
  std::string Problem() const {
    return made_ == kEpisodes ? "" : "not all episodes are on the disk";
  }

 private:
  void WatchOnce(const RunConfig& blind) {
    PrepareDataset(blind);
    Runner watched(blind, {.expert = [&](const RunConfig& run, const EpisodeStart& start) {
                     return std::make_shared<Watching>(std::make_shared<PickPlanner>(run, start),
                                                       rollouts_);
                   }});
    Make(watched);
  }
  void DrawAll(Renderer& renderer) {
    size_t first = 0;
    for (Rollout& rollout : rollouts_) {
      Draw(renderer, rollout, first);
      first += run_.cameras.streams.size();
    }
  }
  // Draws into the videos from number `first` on.
  void Draw(Renderer& renderer, Rollout& rollout, size_t first) {
    const Scene& scene = rollout.scene;
    renderer.SetModel(scene.model());
    std::vector<CameraView> views;
    for (const CameraConfig& stream : run_.cameras.streams)
      views.push_back(
          NamedCamera(scene.model(), internal::FindCameraName(scene, stream), stream.name));
    for (size_t row = 0; row < rollout.states.size(); ++row) {
      rollout.scene.SetState(rollout.states[row]);
      for (size_t s = 0; s < views.size(); ++s) {
        renderer.Render(scene.data(), {.camera = views[s], .width = kWidth, .height = kHeight},
                        {.rgb = videos_[first + s][row]});
      }
    }
  }

  bench::Folder folder_;
  RunConfig run_;
  std::unique_ptr<Runner> runner_, blind_, plain_;
  Rollouts rollouts_;
  std::unique_ptr<Renderer> renderer_, gl_;                // gl_: null without OpenGL
  std::vector<std::vector<std::vector<uint8_t>>> videos_;  // their frames
  int made_ = kEpisodes;
};

void Register(const std::string& file) {
  const auto it = std::make_shared<Making>(file);
  const auto add = [&](const std::string& side, auto prepare, auto run) {
    bench::Add({.row = it->run().robot.config.name,
                .side = side,
                .count = it->frames(),
                .prepare = [=] { prepare(*it); },
                .run = [=] { run(*it); },
                .problem = [=] { return it->Problem(); }});
  };
  const auto add_run = [&](const std::string& side, auto runner) {
    add(
        side, [=](Making& m) { m.Prepare(runner(m)); }, [=](Making& m) { m.Make(runner(m)); });
  };
  const auto nothing = [](Making&) {};
  add_run("made", [](Making& m) -> Runner& { return m.runner(); });
  add_run("made without effects", [](Making& m) -> Runner& { return m.plain(); });
  add_run("acting", [](Making& m) -> Runner& { return m.blind(); });
  add("images", nothing, [](Making& m) { m.Images(); });
  add("encoding", nothing, [](Making& m) { m.Encode(); });
  if (it->has_gl()) add("images by gl", nothing, [](Making& m) { m.GlImages(); });
}

}  // namespace
}  // namespace robocell

int main(int argc, char** argv) {
  return robocell::bench::Main(argc, argv, robocell::Register, "examples/demo.yaml");
}
