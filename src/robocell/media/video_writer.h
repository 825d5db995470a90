// Writes a video through an ffmpeg child process: an h264 mp4 from RGB frames, or a lossless FFV1
// .mov from images of uint16 a pixel, such as depth or ids.
//
// Guarantees: the file has exactly the written frames, at exactly the requested rate (a ratio of
// integers: 66 ms per frame is 500/33), and the same frames give the same bytes in every process,
// under any load, with the same ffmpeg. The file appears under its name after Finish() has checked
// it; before that, and if the writer is destroyed without Finish(), there is none (an older file of
// that name stays). A dying encoder is an IoError that quotes its last messages (EncoderDied if it
// was killed), never a signal, a zombie or a short video. ffmpeg is loaded once for all videos of a
// process (warm_program.h).
//
//   VideoWriter video("pick.mp4", {.width = 640, .height = 480, .fps_num = 500, .fps_den = 33});
//   for (const auto& frame : frames) video.Write(frame);  // row-major RGB, width * height * 3
//   video.Finish();
//
// One thread at a time; writers are independent of each other.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "robocell/base/error.h"
#include "robocell/media/video_info.h"

namespace robocell {

// The encoder was ended by a signal that has nothing to do with the video: another one may succeed.
class EncoderDied : public IoError {
 public:
  using IoError::IoError;
};

struct VideoOptions {
  VideoKind kind = VideoKind::kColour;
  // px; of colour even, as yuv420p halves the colour planes; of 16-bit images 4 and more.
  int width = 0;
  int height = 0;
  int fps_num = 30;
  int fps_den = 1;
  // Options of colour videos:
  // One of x264's, ultrafast ... veryslow, or `rendered`: superfast without arithmetic coding and
  // refined motion, which take a third of its time and save 7 % of the size of drawn images.
  std::string preset = "rendered";
  int crf = 18;                // x264's constant quality, 0 (lossless) ... 51; 18 gives about 40 dB
  int keyframe_interval = 30;  // frames; smaller makes random access faster and files larger
  double stall_timeout_s = 60;  // stops an encoder that takes no byte for so long
};

class VideoWriter {
 public:
  // Throws ArgumentError if the size is odd or empty, the rate is not positive or the preset is
  // unknown; IoError if the folder does not exist or cannot be written, or ffmpeg is missing.
  VideoWriter(std::filesystem::path path, const VideoOptions& options);
  ~VideoWriter();
  VideoWriter(VideoWriter&&) noexcept;
  VideoWriter& operator=(VideoWriter&&) noexcept;

  // Appends one frame. Throws ArgumentError for a wrong number of bytes; IoError in this and every
  // later call if the encoder failed; ClosedError after Finish().
  void Write(std::span<const uint8_t> rgb);
  // Appends a 16-bit image, width * height pixels.
  void Write(std::span<const uint16_t> pixels);

  // Ends the file, checks size, rate and frame count in it and gives it its name. Throws
  // ArgumentError for a video without frames.
  void Finish();

  int64_t frames() const;
  const std::filesystem::path& path() const;
  // Returns the encoder's process id, for tests and diagnosis.
  int encoder_pid() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Throws ArgumentError, with `name`, unless the options describe a valid video. VideoWriter calls
// it; call it earlier to reject a configuration before work begins.
void RequireVideoOptions(const std::string& name, const VideoOptions& options);

}  // namespace robocell
