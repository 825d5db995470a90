#include "robocell/media/video_reader.h"

#include <fmt/format.h>

#include <bit>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/stored_file.h"
#include "robocell/media/child_process.h"
#include "robocell/media/ffmpeg.h"

namespace robocell {
namespace {

// Pixels are little-endian in the pipe.
std::span<uint8_t> LittleEndian(std::span<uint16_t> pixels) {
  static_assert(std::endian::native == std::endian::little);
  return {reinterpret_cast<uint8_t*>(pixels.data()), pixels.size_bytes()};
}

}  // namespace

struct VideoReader::Impl {
  std::filesystem::path path;
  VideoInfo info;
  std::unique_ptr<internal::ChildProcess> decoder;
  int64_t position = 0;
  std::vector<uint8_t> skipped;

  [[noreturn]] void Fail(const std::string& what) {
    decoder.reset();
    throw IoError(fmt::format("video '{}': {}", path.string(), what));
  }

  // Half a frame before the wanted one, so that rounding cannot choose a neighbour.
  std::vector<std::string> SeekArguments(int64_t index) const {
    if (index == 0) return {};
    const double seconds = (static_cast<double>(index) - 0.5) * info.fps_den / info.fps_num;
    return {"-ss", fmt::format("{:.6f}", seconds)};
  }

  void Start(int64_t index) {
    std::vector<std::string> arguments = {FindFfmpeg(), "-hide_banner", "-nostdin",
                                          "-loglevel",  "error",        "-xerror"};
    auto add = [&](std::vector<std::string> more) {
      arguments.insert(arguments.end(), more.begin(), more.end());
    };
    add({"-threads", "1", "-noautorotate"});
    add(SeekArguments(index));
    // Named, so that a file from elsewhere cannot pass for a playlist of other files.
    add({"-f", "mov", "-i", FfmpegInput(path), "-an", "-fps_mode", "passthrough", "-filter_threads",
         "1"});
    const bool gray = info.kind == VideoKind::kGray16;
    if (!gray) add({"-vf", "scale=flags=bicubic+accurate_rnd+full_chroma_int+bitexact"});
    add({"-f", "rawvideo", "-pix_fmt", gray ? "gray16le" : "rgb24", "pipe:1"});
    decoder = std::make_unique<internal::ChildProcess>(
        arguments, internal::ChildProcessOptions{.pipe_stdout = true, .warm = true});
    position = index;
  }

  // The decoder's last messages only count at the end: our own early stop is no error.
  void RequireCleanEnd() {
    if (!decoder) return;
    const int code = decoder->Wait();
    const std::string errors = decoder->Errors();
    if (code != 0 || !errors.empty()) Fail(fmt::format("it does not decode cleanly: '{}'", errors));
    decoder.reset();
  }

  void ReadNext(std::span<uint8_t> rgb) {
    if (!decoder) Start(position);
    if (decoder->Read(rgb) != rgb.size()) {
      decoder->Kill();
      Fail(fmt::format("frame {} of {} cannot be decoded: '{}'", position, info.frames,
                       decoder->Errors()));
    }
    ++position;
    if (position == info.frames) RequireCleanEnd();
  }

  void RequireBuffer(VideoKind kind, size_t bytes) const {
    const size_t needed = FrameBytes(info.kind, info.width, info.height);
    if (kind == info.kind && bytes == needed) return;
    throw ArgumentError(
        fmt::format("video '{}': expected a buffer of {}x{}x{} = {} bytes{}, got {}", path.string(),
                    info.height, info.width, FrameBytes(info.kind, 1, 1), needed,
                    kind == info.kind                 ? ""
                    : info.kind == VideoKind::kGray16 ? " as uint16"
                                                      : " as uint8",
                    bytes));
  }

  bool Next(VideoKind kind, std::span<uint8_t> frame) {
    RequireBuffer(kind, frame.size());
    if (position >= info.frames) return false;
    ReadNext(frame);
    return true;
  }

  void Read(VideoKind kind, int64_t index, std::span<uint8_t> frame) {
    if (index < 0 || index >= info.frames) {
      throw ArgumentError(fmt::format("video '{}': no frame {}. It has frames 0 ... {}",
                                      path.string(), index, info.frames - 1));
    }
    RequireBuffer(kind, frame.size());
    SkipTo(index);
    ReadNext(frame);
  }

  void SkipTo(int64_t index) {
    if (!decoder || index < position || index > position + kNearAhead) return Start(index);
    skipped.resize(FrameBytes(info.kind, info.width, info.height));
    while (position < index) ReadNext(skipped);
  }
};

VideoReader::VideoReader(std::filesystem::path path) : impl_(std::make_unique<Impl>()) {
  impl_->info = ReadVideoInfo(path);
  impl_->path = std::move(path);
  if (!impl_->info.constant_rate)
    impl_->Fail("its frames are not evenly spaced in time, or there are none");
}

VideoReader::~VideoReader() = default;
VideoReader::VideoReader(VideoReader&&) noexcept = default;
VideoReader& VideoReader::operator=(VideoReader&&) noexcept = default;

const VideoInfo& VideoReader::info() const { return impl_->info; }
size_t VideoReader::frame_bytes() const {
  return FrameBytes(impl_->info.kind, impl_->info.width, impl_->info.height);
}
int64_t VideoReader::position() const { return impl_->position; }

bool VideoReader::Next(std::span<uint8_t> rgb) { return impl_->Next(VideoKind::kColour, rgb); }
bool VideoReader::Next(std::span<uint16_t> pixels) {
  return impl_->Next(VideoKind::kGray16, LittleEndian(pixels));
}
void VideoReader::Read(int64_t index, std::span<uint8_t> rgb) {
  impl_->Read(VideoKind::kColour, index, rgb);
}
void VideoReader::Read(int64_t index, std::span<uint16_t> pixels) {
  impl_->Read(VideoKind::kGray16, index, LittleEndian(pixels));
}

}  // namespace robocell
