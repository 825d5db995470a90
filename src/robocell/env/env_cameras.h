// EnvCameras: the image streams of an environment. Each takes a frame at the first engine step with
// t >= k/rate, stamped with the true time, and shows the last one until the next; with rate 0 one
// with every observation.
//
// The state of a frame is kept when it is due, and drawn when the step has ended: frames that
// nobody sees are not drawn, and rendering does not affect physics.
//
//   cameras.Reset();
//   ... per engine step: cameras.Tick(time) ...
//   cameras.Draw(time);
//   for (const EnvFrame& frame : cameras.frames()) ...
//
// With a SharedDrawing (copies of one environment that are drawn in turn by one renderer) Draw is
// called by whoever owns it, on one thread at a time.
//
// Errors, both when it is made: NotFoundError for a stream with an unknown camera, Error without
// OpenGL.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "robocell/mujoco/owners.h"
#include "robocell/render/renderer.h"
#include "robocell/scene/scene.h"
#include "robocell/spec/camera_spec.h"

namespace robocell {

// The last frame of a stream. Images that the stream does not take are empty.
struct EnvFrame {
  std::string stream;
  int width = 0, height = 0;
  double time = 0;                    // simulated s since the reset
  CameraModel camera;                 // that it was drawn with: intrinsics, extrinsics
  std::vector<uint8_t> rgb;           // rows from the top
  std::vector<uint16_t> depth_mm;     // 0 where nothing is
  std::vector<int32_t> segmentation;  // body ids, -1 where nothing is
};

// One renderer for copies of one model.
struct SharedDrawing {
  std::shared_ptr<Renderer> renderer;
  // Set when copies differ in their colours: a model of its own that takes those of each copy.
  ModelPtr model;

  // The next drawing uses the colours of this copy of the model. Copies differ in nothing else that
  // is visible.
  void TakeColours(const mjModel* copy);
};

class EnvCameras {
 public:
  EnvCameras(Scene scene, const CameraSystemConfig& config,
             std::shared_ptr<SharedDrawing> shared = nullptr);

  // A frame of each stream is due at time 0.
  void Reset() { GoOnFrom(0); }
  // Goes on from `time`, with a frame of each stream of then.
  void GoOnFrom(double time);
  // Keeps what streams show that are due at `time` (s since the reset).
  void Tick(double time);
  // Draws what was kept, and what is taken with every observation.
  void Draw(double time);
  const std::vector<EnvFrame>& frames() const { return frames_; }

  // Remembers the frames that are due, to return to them after a look ahead.
  void Mark() { marked_ = streams_; }
  void GoBackToMark() { streams_ = marked_; }

 private:
  struct Stream {
    CameraConfig config;
    CameraView view;
    int64_t taken = 0;     // frames since the reset
    bool pending = false;  // kept and not yet drawn
    double time = 0;
    std::vector<double> qpos, mocap_pos, mocap_quat;
  };

  // Looks cameras up again after the scene was compiled anew.
  void Bind();
  void Keep(Stream& stream, double time);
  void DrawOne(Stream& stream, EnvFrame& frame);

  Scene scene_;
  uint64_t generation_ = 0;
  std::shared_ptr<SharedDrawing> shared_;
  std::shared_ptr<Renderer> renderer_;
  DataPtr scratch_;
  std::vector<Stream> streams_, marked_;
  std::vector<EnvFrame> frames_;
};

}  // namespace robocell
