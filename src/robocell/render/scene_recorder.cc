#include "robocell/render/scene_recorder.h"

#include <algorithm>
#include <utility>

#include "robocell/base/error.h"

namespace robocell {
namespace {

bool IsOfScene(const std::string& camera, const SceneSpec& spec) {
  for (const CameraSpec& own : spec.cameras) {
    if (own.name == camera) return true;
  }
  return false;
}

}  // namespace

SceneRecorder::SceneRecorder(const Scene& scene, std::filesystem::path path,
                             const VideoRecorderOptions& options)
    : scene_(scene),
      recorder_(scene.model(), std::move(path), options),
      generation_(scene.generation()) {}

std::vector<std::string> SceneRecorder::camera_names() const {
  std::vector<std::string> names = RecorderCameras(scene_.model());
  std::stable_partition(names.begin(), names.end(),
                        [&](const std::string& name) { return !IsOfScene(name, scene_.spec()); });
  return names;
}

void SceneRecorder::UseCamera(std::string_view name) { FollowToChange().UseCamera(name); }

void SceneRecorder::UseCamera(const CameraView& view) { FollowToChange().UseCamera(view); }

void SceneRecorder::SetFreeCamera(double distance, double azimuth, double elevation,
                                  const Eigen::Vector3d& lookat) {
  FollowToChange().SetFreeCamera(distance, azimuth, elevation, lookat);
}

void SceneRecorder::SetTrackingCamera(std::string_view body, double distance, double azimuth,
                                      double elevation) {
  FollowToChange().SetTrackingCamera(body, distance, azimuth, elevation);
}

void SceneRecorder::RecordFrame() { Follow().RecordFrame(scene_.data()); }

// Every call to the recorder uses the present model.
VideoRecorder& SceneRecorder::Follow() {
  const SceneNow& now = scene_.now();
  if (now.generation == generation_) return recorder_;
  try {
    recorder_.SetModel(now.model);
  } catch (const NotFoundError&) {  // the camera in use is missing: the recorder has the model
    generation_ = now.generation;
    throw;
  }
  generation_ = now.generation;
  return recorder_;
}

// Allows a change of camera while the present one is missing.
VideoRecorder& SceneRecorder::FollowToChange() {
  try {
    return Follow();
  } catch (const NotFoundError&) {
    return recorder_;
  }
}

}  // namespace robocell
