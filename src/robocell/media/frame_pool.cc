#include "robocell/media/frame_pool.h"

#include <algorithm>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "robocell/base/idle_pool.h"
#include "robocell/base/stored_file.h"
#include "robocell/media/video_reader.h"

namespace robocell::internal {
namespace {

template <typename Pixel>
struct KeptFrame {
  int64_t index;
  std::vector<Pixel> pixels;
};

// A reader and its last frames, the oldest first.
template <typename Pixel>
struct StreamDecoder {
  std::string identity;
  VideoReader reader;
  std::deque<KeptFrame<Pixel>> recent = {};

  void Read(int64_t index, std::span<Pixel> pixels, size_t recent_bytes) {
    for (const KeptFrame<Pixel>& frame : recent) {
      if (frame.index != index || frame.pixels.size() != pixels.size()) continue;
      std::ranges::copy(frame.pixels, pixels.begin());
      return;
    }
    // Frames on the way are decoded anyway, and a window with gaps needs them next.
    const int64_t at = reader.position();
    const bool near = !recent.empty() && at < index && index - at <= VideoReader::kNearAhead;
    for (int64_t k = near ? at : index; k <= index; ++k) {
      reader.Read(k, pixels);
      Keep(k, pixels, recent_bytes);
    }
  }

  void Keep(int64_t index, std::span<const Pixel> pixels, size_t recent_bytes) {
    const size_t most = recent_bytes / std::max<size_t>(pixels.size_bytes(), 1);
    if (most == 0) return;
    KeptFrame<Pixel> frame;
    if (recent.size() >= most) {  // reuses the oldest frame's memory
      frame = std::move(recent.front());
      recent.pop_front();
    }
    frame.index = index;
    frame.pixels.assign(pixels.begin(), pixels.end());
    recent.push_back(std::move(frame));
  }
};

template <typename Pixel>
void ReadFrom(IdlePool<StreamDecoder<Pixel>>& pool, const std::filesystem::path& video,
              int64_t index, std::span<Pixel> pixels, size_t recent_bytes) {
  std::string identity = StoredFileIdentity(video);
  auto decoder = pool.Take([&](const StreamDecoder<Pixel>& d) { return d.identity == identity; });
  if (!decoder) decoder.emplace(StreamDecoder<Pixel>{std::move(identity), VideoReader(video)});
  decoder->Read(index, pixels, recent_bytes);
  pool.Give(std::move(*decoder));
}

}  // namespace

struct FramePool::Impl {
  explicit Impl(const FramePoolOptions& its_options)
      : options(its_options), colour(options.decoders), gray(options.decoders) {}
  FramePoolOptions options;
  IdlePool<StreamDecoder<uint8_t>> colour;
  IdlePool<StreamDecoder<uint16_t>> gray;
};

FramePool::FramePool(const FramePoolOptions& options) : impl_(std::make_unique<Impl>(options)) {}
FramePool::~FramePool() = default;

FramePool& FramePool::Shared() {
  static FramePool pool;
  return pool;
}

void FramePool::Read(const std::filesystem::path& video, int64_t index, std::span<uint8_t> rgb) {
  ReadFrom(impl_->colour, video, index, rgb, impl_->options.recent_bytes);
}

void FramePool::Read(const std::filesystem::path& video, int64_t index,
                     std::span<uint16_t> pixels) {
  ReadFrom(impl_->gray, video, index, pixels, impl_->options.recent_bytes);
}

void FramePool::Clear() {
  impl_->colour.Clear();
  impl_->gray.Clear();
}

size_t FramePool::idle() const { return impl_->colour.idle() + impl_->gray.idle(); }

}  // namespace robocell::internal
