#include "robocell/rollout/validate_streams.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <new>

#include "robocell/base/error.h"
#include "robocell/base/paths.h"
#include "robocell/media/ffmpeg.h"
#include "robocell/render/renderer.h"
#include "robocell/render/stream_camera.h"
#include "robocell/rollout/episode_cameras.h"
#include "robocell/rollout/run_renderer.h"

namespace robocell {
namespace {

// What throws becomes a problem of the field, or of the whole stream.
template <class F>
void Try(Problems& problems, const char* field, F&& check) {
  try {
    check();
  } catch (const ArgumentError& error) {
    field ? problems.AddAt(field, error.what()) : problems.Add(error.what());
  } catch (const EngineError& error) {
    problems.Add(error.what());
  } catch (const std::bad_alloc&) {
    problems.Add("there is not enough memory for an image of this size");
  }
}

// Names and sizes as the episode's writer wants them; what ValidateFields has told is left out.
void ValidateVideo(const CameraSystemConfig& cameras, const CameraConfig& stream,
                   Problems& problems) {
  if (!stream.name.empty() && !ValidFileName(stream.name))
    return Try(problems, "name", [&] { RequireFileName("stream", stream.name); });
  const int width = cameras.width(stream), height = cameras.height(stream);
  if (stream.name.empty() || width < 1 || height < 1 || width % 2 != 0 || height % 2 != 0) return;
  Try(problems, nullptr, [&] {
    EpisodeSchema().AddCamera({.name = stream.name,
                               .width = width,
                               .height = height,
                               .depth = stream.depth,
                               .segmentation = stream.segmentation});
  });
}

std::string FailingStreams(const RunConfig& run) {
  const size_t count = run.cameras.streams.size();
  return fmt::format("run '{}' records {} camera stream{}, on this machine that fails: ", run.run,
                     count, count == 1 ? "" : "s");
}

// One that makes images with nothing in them: OpenGL in software takes 0.2 s to prepare for a
// model's textures, and is asked only whether it works.
std::unique_ptr<Renderer> RendererFor(const RunConfig& run) {
  try {
    FfmpegVersion();
    return MakeRendererOf(run, {.geom_groups = {}, .sites = false, .skybox = false});
  } catch (const IoError& error) {
    throw IoError(FailingStreams(run) + error.what());
  } catch (const Error& error) {
    throw Error(FailingStreams(run) + error.what());
  }
}

}  // namespace

void ValidateStreams(const RunConfig& run, Problems& problems) {
  Problems::Scope cameras(problems, "cameras.streams");
  for (size_t i = 0; i < run.cameras.streams.size(); ++i) {
    Problems::Scope item(problems, i);
    const CameraConfig& stream = run.cameras.streams[i];
    ValidateVideo(run.cameras, stream, problems);
    if (stream.rate != 0)
      problems.AddAt("rate", "records take one frame per action; leave rate at 0");
    if (!stream.rgb) problems.AddAt("rgb", "a recorded stream needs rgb: true");
  }
}

void ValidateStreamsHere(const RunConfig& run, const Scene& scene, Problems& problems) {
  if (run.cameras.streams.empty()) return;
  const std::unique_ptr<Renderer> renderer = RendererFor(run);
  {
    Problems::Scope quality(problems, "cameras.renderer.quality");
    const size_t before = problems.list().size();
    Try(problems, nullptr, [&] { renderer->SetModel(scene.model()); });
    if (problems.list().size() != before) return;
  }
  std::vector<uint8_t> rgb;
  for (size_t i = 0; i < run.cameras.streams.size(); ++i) {
    const CameraConfig& stream = run.cameras.streams[i];
    Problems::Scope cameras(problems, "cameras.streams");
    Problems::Scope item(problems, i);
    Try(problems, nullptr, [&] {
      const CameraView view = ViewOfStream(scene, stream);
      const int width = run.cameras.width(stream), height = run.cameras.height(stream);
      rgb.resize(3 * static_cast<size_t>(width) * static_cast<size_t>(height));
      renderer->Render(scene.data(), {.camera = view, .width = width, .height = height},
                       {.rgb = rgb});
    });
  }
}

}  // namespace robocell
