// The image streams of a recorded episode: draws each camera once per row (features/cell_images.h) and
// hands the frames to the writer.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "robocell/base/ratio.h"
#include "robocell/data/episode_writer.h"
#include "robocell/features/cell_images.h"
#include "robocell/render/renderer.h"
#include "robocell/robot/robot.h"
#include "robocell/spec/camera_spec.h"

namespace robocell::internal {

class EpisodeCameras {
 public:
  // `renderer` is shared by all episodes of a process and must outlive this object. `rate`: rows
  // per second.
  EpisodeCameras(EpisodeSchema& schema, const Scene& scene, const CameraSystemConfig& config,
                 Renderer* renderer, const Ratio& rate);
  // Draws one frame per kind of image of the present state, and writes them with a row of
  // extrinsics per stream.
  void PutFrames(EpisodeWriter& writer);
  // Returns the images that were written last.
  const CellImages& images() const { return images_; }

 private:
  struct Stream {
    CameraId video;
    ColumnId extrinsics;
  };
  CellImages images_;
  std::vector<Stream> streams_;  // of each image
};

// Labels of the body ids in the scene's segmentation: the name of each body, and its object or
// robot.
std::vector<SegmentLabel> SegmentLabelsOf(const Scene& scene);

}  // namespace robocell::internal
