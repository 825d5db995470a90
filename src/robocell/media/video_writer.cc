#include "robocell/media/video_writer.h"

#include <signal.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>
#include <optional>
#include <system_error>
#include <vector>

#include "robocell/base/files.h"
#include "robocell/base/suggestions.h"
#include "robocell/media/child_process.h"
#include "robocell/media/ffmpeg.h"
#include "robocell/media/yuv420.h"

namespace robocell {
namespace {

// With 2 pixels in a direction FFV1 of ffmpeg 5.1 silently returns wrong images.
constexpr int kLeastGrayPixels = 4;

std::string KindName(VideoKind kind) { return kind == VideoKind::kGray16 ? "16-bit" : "colour"; }

std::string PixelFormat(VideoKind kind) {
  return kind == VideoKind::kGray16 ? "gray16le" : "yuv420p";
}

constexpr char kRendered[] = "rendered";
const std::vector<std::string> kPresets = {kRendered, "ultrafast", "superfast", "veryfast",
                                           "faster",  "fast",      "medium",    "slow",
                                           "slower",  "veryslow"};

void Append(std::vector<std::string>& arguments, const std::vector<std::string>& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
}

std::vector<std::string> ColourArguments(const VideoOptions& options) {
  // One thread: x264's bytes depend on the number. No B-frames: frame i has time i / fps from the
  // first byte on.
  const bool is_rendered = options.preset == kRendered;
  std::vector<std::string> arguments = {
      "-c:v", "libx264", "-threads", "1", "-preset", is_rendered ? "superfast" : options.preset};
  if (is_rendered) Append(arguments, {"-coder", "vlc", "-x264-params", "subme=0"});
  Append(arguments, {"-crf", std::to_string(options.crf)});
  Append(arguments, {"-g", std::to_string(options.keyframe_interval), "-bf", "0"});
  // The output of yuv420.h. Readers that ignore these flags assume the same.
  Append(arguments, {"-color_range", "tv", "-colorspace", "smpte170m"});
  Append(arguments, {"-color_primaries", "bt709", "-color_trc", "iec61966-2-1"});
  return arguments;
}

// FFV1 version 3 (RFC 9043) with a checksum per slice; docs/decisions/006 has the measurements.
std::vector<std::string> GrayArguments() {
  return {"-c:v", "ffv1", "-level",  "3", "-coder",    "1", "-context", "0",
          "-g",   "1",    "-slices", "4", "-slicecrc", "1", "-threads", "1"};
}

std::vector<std::string> Arguments(const std::string& ffmpeg, const std::string& output,
                                   const VideoOptions& options) {
  std::vector<std::string> arguments = {ffmpeg,      "-hide_banner", "-nostdin",
                                        "-loglevel", "error",        "-y"};
  const auto add = [&](const std::vector<std::string>& more) { Append(arguments, more); };
  add({"-f", "rawvideo", "-pix_fmt", PixelFormat(options.kind)});
  add({"-s", fmt::format("{}x{}", options.width, options.height)});
  add({"-framerate", fmt::format("{}/{}", options.fps_num, options.fps_den), "-i", "pipe:0"});
  add({"-an", "-map_metadata", "-1", "-fps_mode", "passthrough"});
  add(options.kind == VideoKind::kGray16 ? GrayArguments() : ColourArguments(options));
  add({"-flags", "+bitexact", "-fflags", "+bitexact"});
  add({"-f", options.kind == VideoKind::kGray16 ? "mov" : "mp4", "file:" + output});
  return arguments;
}

std::string OddSize(const std::string& name, int width, int height) {
  return fmt::format(
      "{}: {}x{} px cannot be encoded, h264 with yuv420p needs an even width and height. Nearest "
      "even size: {}x{}.",
      name, width, height, width + width % 2, height + height % 2);
}

}  // namespace

void RequireVideoOptions(const std::string& name, const VideoOptions& options) {
  const int w = options.width;
  const int h = options.height;
  if (w < 1 || h < 1 || w > 16384 || h > 16384) {
    throw ArgumentError(
        fmt::format("{}: size {}x{} px is not between 2x2 and 16384x16384", name, w, h));
  }
  const bool colour = options.kind == VideoKind::kColour;
  if (!colour && std::min(w, h) < kLeastGrayPixels) {
    throw ArgumentError(
        fmt::format("{}: 16-bit images of {}x{} px cannot be encoded, they need at least {} px "
                    "in both directions",
                    name, w, h, kLeastGrayPixels));
  }
  if (colour && (w % 2 != 0 || h % 2 != 0)) throw ArgumentError(OddSize(name, w, h));
  if (options.fps_num < 1 || options.fps_den < 1) {
    throw ArgumentError(fmt::format("{}: rate {}/{} frames per second is not positive", name,
                                    options.fps_num, options.fps_den));
  }
  if (std::find(kPresets.begin(), kPresets.end(), options.preset) == kPresets.end()) {
    throw ArgumentError(NoSuchName(name, "preset", options.preset, kPresets));
  }
  if (options.crf < 0 || options.crf > 51) {
    throw ArgumentError(fmt::format("{}: crf {} is not in 0 (lossless) ... 51", name, options.crf));
  }
  if (options.keyframe_interval < 1) {
    throw ArgumentError(
        fmt::format("{}: keyframe_interval {} is less than 1", name, options.keyframe_interval));
  }
}

namespace {

// Players and our own readers recognise the format by the ending.
void RequireEnding(const std::string& name, const std::filesystem::path& path, VideoKind kind) {
  const char* ending = kind == VideoKind::kColour ? ".mp4" : ".mov";
  if (path.extension() == ending) return;
  throw ArgumentError(fmt::format("{}: {} videos are {} files; name it '{}'", name, KindName(kind),
                                  ending + 1,
                                  std::filesystem::path(path).replace_extension(ending).string()));
}

}  // namespace

struct VideoWriter::Impl {
  std::filesystem::path path;
  std::filesystem::path partial;
  std::string name;
  VideoOptions options;
  std::optional<internal::Yuv420Converter> convert;  // colour only: halves the encoder's input
  std::unique_ptr<internal::ChildProcess> encoder;
  int64_t frames = 0;
  std::string failure;
  bool finished = false;

  ~Impl() {
    encoder.reset();
    std::error_code ignored;
    if (!finished && !partial.empty()) std::filesystem::remove(partial, ignored);
  }

  [[noreturn]] void Fail(const std::string& what) {
    failure = fmt::format("{}: {}", name, what);
    throw IoError(failure);
  }
  [[noreturn]] void FailDead(const std::string& what) {
    failure = fmt::format("{}: {}", name, what);
    throw EncoderDied(failure);
  }

  // Stores the error, so that every later call throws an IoError with the same text.
  template <typename Action>
  void Guarded(Action action) {
    try {
      action();
    } catch (const EncoderDied&) {
      throw;
    } catch (const IoError& error) {
      if (failure.empty()) failure = fmt::format("{}: {}", name, error.what());
      throw IoError(failure);
    }
  }

  void RequireUsable(const char* what) const {
    if (finished) {
      throw ClosedError(
          fmt::format("{}: it is finished, so it cannot be {}; begin another video", name, what));
    }
    if (!failure.empty()) throw IoError(failure);
  }

  [[noreturn]] void EncoderFailed() {
    encoder->CloseStdin();
    encoder->Wait();
    const std::string errors = encoder->Errors();
    const std::string what =
        fmt::format("the encoder {} after {}; it said {}", encoder->DescribeEnd(),
                    Counted(frames, "frame"), errors.empty() ? "nothing" : "'" + errors + "'");
    // SIGXFSZ: a limit on the size of files, which the next one would meet too.
    if (encoder->signal() != 0 && encoder->signal() != SIGXFSZ) FailDead(what);
    Fail(what);
  }

  void Put(VideoKind kind, std::span<const uint8_t> frame) {
    RequireUsable("written to");
    const size_t expected = FrameBytes(options.kind, options.width, options.height);
    if (kind != options.kind || frame.size() != expected) {
      throw ArgumentError(fmt::format("{}: expected a {} frame of {}x{}x{} = {} bytes, got {}{}",
                                      name, KindName(options.kind), options.height, options.width,
                                      FrameBytes(options.kind, 1, 1), expected, frame.size(),
                                      kind == options.kind ? "" : " of " + KindName(kind)));
    }
    Guarded([&] {
      if (!encoder->Write(convert ? (*convert)(frame) : frame)) EncoderFailed();
    });
    ++frames;
  }

  void RequireResult() {
    const VideoInfo info = ReadVideoInfo(partial);
    const int divisor = std::gcd(options.fps_num, options.fps_den);
    const bool same_rate = info.constant_rate && info.fps_num == options.fps_num / divisor &&
                           info.fps_den == options.fps_den / divisor;
    if (info.kind != options.kind) Fail("the file is of another kind");
    if (info.frames != frames || !same_rate || info.width != options.width ||
        info.height != options.height) {
      Fail(fmt::format("wrote {} of {}x{} px at {}/{} fps, the file has {} of {}x{} at {}/{}",
                       Counted(frames, "frame"), options.width, options.height, options.fps_num,
                       options.fps_den, info.frames, info.width, info.height, info.fps_num,
                       info.fps_den));
    }
  }
};

VideoWriter::VideoWriter(std::filesystem::path path, const VideoOptions& options)
    : impl_(std::make_unique<Impl>()) {
  impl_->name = fmt::format("video '{}'", path.string());
  RequireEnding(impl_->name, path, options.kind);
  RequireVideoOptions(impl_->name, options);
  impl_->path = std::move(path);
  impl_->options = options;
  if (options.kind == VideoKind::kColour) impl_->convert.emplace(options.width, options.height);
  const std::string ffmpeg = FindFfmpeg();
  impl_->Guarded([&] { impl_->partial = MakeTempFile(impl_->path); });
  impl_->encoder = std::make_unique<internal::ChildProcess>(
      Arguments(ffmpeg, impl_->partial.string(), options),
      internal::ChildProcessOptions{
          .pipe_stdin = true, .warm = true, .stall_timeout_s = options.stall_timeout_s});
}

VideoWriter::~VideoWriter() = default;
VideoWriter::VideoWriter(VideoWriter&&) noexcept = default;
VideoWriter& VideoWriter::operator=(VideoWriter&&) noexcept = default;

void VideoWriter::Write(std::span<const uint8_t> rgb) { impl_->Put(VideoKind::kColour, rgb); }

void VideoWriter::Write(std::span<const uint16_t> pixels) {
  static_assert(std::endian::native == std::endian::little, "pixels are piped as they lie");
  impl_->Put(VideoKind::kGray16,
             {reinterpret_cast<const uint8_t*>(pixels.data()), pixels.size_bytes()});
}

void VideoWriter::Finish() {
  impl_->RequireUsable("finished again");
  if (impl_->frames == 0) throw ArgumentError(fmt::format("{}: no frame was written", impl_->name));
  impl_->Guarded([&] {
    impl_->encoder->CloseStdin();
    if (impl_->encoder->Wait() != 0 || !impl_->encoder->Errors().empty()) impl_->EncoderFailed();
    impl_->RequireResult();
    std::error_code error;
    std::filesystem::rename(impl_->partial, impl_->path, error);
    if (error) impl_->Fail("cannot rename the finished file: " + error.message());
  });
  impl_->finished = true;
}

int64_t VideoWriter::frames() const { return impl_->frames; }
const std::filesystem::path& VideoWriter::path() const { return impl_->path; }
int VideoWriter::encoder_pid() const { return impl_->encoder->pid(); }

}  // namespace robocell
