// EnvCameras: the image streams of an environment. Each takes a frame at the first engine step with
// t >= k/rate, stamped with the true time, and shows it until the next one; with rate 0 it takes
// one with every observation.
//
// The state of a frame is stored when it is due and drawn when the step has ended: skipped frames
// are not drawn, and rendering does not affect physics.
//
//   cameras.Reset();
//   ... per engine step: cameras.Tick(time) ...
//   cameras.Draw(time);
//   for (const CellImage& frame : cameras.frames()) ...
//
// With a SharedDrawing (copies of one environment that one renderer draws in turn) its owner calls
// Draw, on one thread at a time.
//
// The constructor throws NotFoundError for a stream with an unknown camera, and Error without
// OpenGL.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "robocell/features/cell_images.h"
#include "robocell/mujoco/owners.h"
#include "robocell/render/renderer.h"
#include "robocell/scene/scene.h"
#include "robocell/spec/camera_spec.h"

namespace robocell::internal {

// One renderer for copies of one model.
struct SharedDrawing {
  std::shared_ptr<Renderer> renderer;
  // Separate model that takes each copy's colours; set if copies differ in colour.
  ModelPtr model;
  bool has_looks = false;  // copies also differ in materials, textures and lights

  // Uses the colours of this copy of the model for the next drawing. Copies have no other visible
  // difference.
  void TakeColours(const mjModel* copy);
};

class EnvCameras {
 public:
  EnvCameras(Scene scene, const CameraSystemConfig& config,
             std::shared_ptr<SharedDrawing> shared = nullptr);

  // Makes a frame of each stream due at time 0.
  void Reset() { GoOnFrom(0); }
  // Continues from `time`, with a frame of each stream at that time.
  void GoOnFrom(double time);
  // Stores the state for the streams that are due at `time` (s since the reset).
  void Tick(double time);
  // Draws the stored frames, and those that are taken with every observation.
  void Draw(double time);
  // Returns the last frame of each stream. Images that the stream does not take are empty.
  const std::vector<CellImage>& frames() const { return frames_; }

  // Remembers the frames that are due, to return to them after a look ahead.
  void Mark() { marked_ = streams_; }
  void GoBackToMark() { streams_ = marked_; }

 private:
  struct Stream {
    CameraConfig config;
    CameraView view;
    int64_t taken = 0;     // frames since the reset
    bool pending = false;  // stored and not yet drawn
    double time = 0;
    std::vector<double> qpos, mocap_pos, mocap_quat;
  };

  // Looks cameras up again after a rebuild of the scene.
  void Bind();
  void Keep(Stream& stream, double time);
  void DrawOne(Stream& stream, CellImage& frame);

  Scene scene_;
  uint64_t generation_ = 0;
  std::shared_ptr<SharedDrawing> shared_;
  std::shared_ptr<Renderer> renderer_;
  DataPtr scratch_;
  std::vector<Stream> streams_, marked_;
  std::vector<CellImage> frames_;
  std::vector<int32_t> ids_;  // bodies, as the renderer returns them
};

}  // namespace robocell::internal
