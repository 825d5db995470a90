// The image streams of a recorded episode: renders each camera once per row and hands the frames to
// the writer.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "robocell/base/ratio.h"
#include "robocell/data/episode_writer.h"
#include "robocell/render/renderer.h"
#include "robocell/robot/robot.h"
#include "robocell/spec/camera_spec.h"

namespace robocell {

class EpisodeCameras {
 public:
  // `renderer` is shared by all episodes of a process; it must outlive this object. `rate` is how
  // many rows there are per second.
  EpisodeCameras(EpisodeSchema& schema, const Scene& scene, const CameraSystemConfig& config,
                 Renderer* renderer, const Ratio& rate);
  // One frame per kind of image and one extrinsics row per stream, of the present state.
  void PutFrames(EpisodeWriter& writer);

 private:
  struct Stream {
    CameraView view;
    int width, height;
    CameraId video;
    ColumnId extrinsics;
    std::vector<uint8_t> rgb;
    std::vector<uint16_t> depth_mm;  // empty unless wanted, as the two below
    std::vector<int32_t> bodies;
    std::vector<uint16_t> labels;  // the same as they are recorded
  };
  Scene scene_;
  Renderer* renderer_;
  std::vector<Stream> streams_;
};

// What body ids of the scene's segmentation show: the name of each body, and the object or robot
// that it belongs to.
std::vector<SegmentLabel> SegmentLabelsOf(const Scene& scene);

}  // namespace robocell
