#include "robocell/media/video_reader.h"

#include <fmt/format.h>

#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/media/child_process.h"
#include "robocell/media/ffmpeg.h"

namespace robocell {
namespace {

// Decoding on to a frame this near ahead is cheaper than a new decoder.
constexpr int64_t kNearAhead = 60;

}  // namespace

struct VideoReader::Impl {
  std::filesystem::path path;
  VideoInfo info;
  std::unique_ptr<ChildProcess> decoder;
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
    add({"-i", "file:" + path.string(), "-an", "-fps_mode", "passthrough", "-filter_threads", "1"});
    add({"-vf", "scale=flags=bicubic+accurate_rnd+full_chroma_int+bitexact"});
    add({"-f", "rawvideo", "-pix_fmt", "rgb24", "pipe:1"});
    decoder = std::make_unique<ChildProcess>(arguments, ChildProcessOptions{.pipe_stdout = true});
    position = index;
  }

  // The decoder's last words count only at the end: an early stop of ours is no error.
  void CheckEnd() {
    if (!decoder) return;
    const int code = decoder->Wait();
    const std::string said = decoder->Errors();
    if (code != 0 || !said.empty()) Fail(fmt::format("it does not decode cleanly: '{}'", said));
  }

  void ReadNext(std::span<uint8_t> rgb) {
    if (!decoder) Start(position);
    if (decoder->Read(rgb) != rgb.size()) {
      decoder->Kill();
      Fail(fmt::format("frame {} of {} cannot be decoded: '{}'", position, info.frames,
                       decoder->Errors()));
    }
    ++position;
    if (position == info.frames) CheckEnd();
  }

  void SkipTo(int64_t index) {
    if (!decoder || index < position || index > position + kNearAhead) return Start(index);
    skipped.resize(size_t{3} * info.width * info.height);
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
  return size_t{3} * impl_->info.width * impl_->info.height;
}
int64_t VideoReader::position() const { return impl_->position; }

bool VideoReader::Next(std::span<uint8_t> rgb) {
  if (rgb.size() != frame_bytes()) {
    throw ArgumentError(fmt::format("video '{}': expected a buffer of {}x{}x3 = {} bytes, got {}",
                                    impl_->path.string(), impl_->info.height, impl_->info.width,
                                    frame_bytes(), rgb.size()));
  }
  if (impl_->position >= impl_->info.frames) return false;
  impl_->ReadNext(rgb);
  return true;
}

void VideoReader::Read(int64_t index, std::span<uint8_t> rgb) {
  if (index < 0 || index >= impl_->info.frames) {
    throw ArgumentError(fmt::format("video '{}': no frame {}. It has frames 0 ... {}",
                                    impl_->path.string(), index, impl_->info.frames - 1));
  }
  impl_->SkipTo(index);
  Next(rgb);
}

}  // namespace robocell
