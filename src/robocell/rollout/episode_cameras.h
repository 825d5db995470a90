// The image streams of a recorded episode: hands the images that were shown to the writer, one of
// each stream per row, whether a run drew them (features/cell_images.h) or an environment showed
// them (env/env_cameras.h).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "robocell/base/ratio.h"
#include "robocell/data/episode_writer.h"
#include "robocell/features/cell_images.h"
#include "robocell/scene/scene.h"

namespace robocell::internal {

// The times of frames: those of their rows, or their own, which may be earlier.
enum class FrameTimes { kOfRows, kOwn };

class EpisodeCameras {
 public:
  // Declares a stream for each image. `rate`: rows per second.
  EpisodeCameras(EpisodeSchema& schema, const Scene& scene, std::span<const CellImage> images,
                 const Ratio& rate, FrameTimes times = FrameTimes::kOfRows);
  // Writes the images of a row, in the order of the declared ones, and a row of extrinsics per
  // stream. `times`: s since the start of the episode, if frames have any.
  void Put(EpisodeWriter& writer, std::span<const CellImage> images,
           std::span<const double> times = {}) const;

 private:
  struct Stream {
    CameraId video;
    ColumnId extrinsics, time;  // `time` only with times
  };
  std::vector<Stream> streams_;
};

// Labels of the body ids in the scene's segmentation: the name of each body, and its object or
// robot.
std::vector<SegmentLabel> SegmentLabelsOf(const Scene& scene);

}  // namespace robocell::internal
