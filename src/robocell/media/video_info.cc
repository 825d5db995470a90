#include "robocell/media/video_info.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/stored_file.h"

namespace robocell {
namespace {

using Bytes = std::span<const uint8_t>;

constexpr uint64_t kMostTableBytes = 256u << 20;

// Thrown inside this file; the file's name is added outside.
struct Malformed {
  std::string reason;
};

uint64_t BigEndian(Bytes bytes, size_t offset, int width) {
  if (bytes.size() < offset + width) throw Malformed{"a table ends early"};
  uint64_t value = 0;
  for (int i = 0; i < width; ++i) value = value << 8 | bytes[offset + i];
  return value;
}

uint32_t U32(Bytes bytes, size_t offset) {
  return static_cast<uint32_t>(BigEndian(bytes, offset, 4));
}

struct Box {
  std::string_view type;
  Bytes content;
};

// Splits off the first box of `bytes` (ISO/IEC 14496-12, 4.2).
Box TakeBox(Bytes& bytes) {
  uint64_t size = U32(bytes, 0);
  size_t header = 8;
  if (size == 1) {
    size = BigEndian(bytes, 8, 8);
    header = 16;
  } else if (size == 0) {
    size = bytes.size();
  }
  if (size < header || size > bytes.size()) throw Malformed{"a box is larger than what holds it"};
  Box box{{reinterpret_cast<const char*>(bytes.data()) + 4, 4},
          bytes.subspan(header, size - header)};
  bytes = bytes.subspan(size);
  return box;
}

// Returns the first box of that type among the children; empty if there is none.
Bytes Child(Bytes parent, std::string_view type) {
  while (parent.size() >= 8) {
    const Box box = TakeBox(parent);
    if (box.type == type) return box.content;
  }
  return {};
}

Bytes Descend(Bytes box, std::initializer_list<std::string_view> path) {
  for (std::string_view type : path) box = Child(box, type);
  return box;
}

// Returns the first track whose handler declares video.
Bytes VideoTrack(Bytes moov) {
  while (moov.size() >= 8) {
    const Box box = TakeBox(moov);
    if (box.type != "trak") continue;
    const Bytes handler = Descend(box.content, {"mdia", "hdlr"});
    if (handler.size() >= 12 && U32(handler, 8) == 0x76696465) return box.content;  // 'vide'
  }
  throw Malformed{"it has no video track"};
}

uint32_t Timescale(Bytes track) {
  const Bytes header = Descend(track, {"mdia", "mdhd"});
  const bool wide = !header.empty() && header[0] == 1;
  const uint32_t timescale = U32(header, wide ? 20 : 12);
  if (timescale == 0) throw Malformed{"its time scale is 0"};
  return timescale;
}

void ReadRate(Bytes table, uint32_t timescale, VideoInfo& info) {
  const Bytes times = Child(table, "stts");
  const uint32_t entries = U32(times, 4);
  uint64_t duration = 0;
  uint64_t frames = 0;
  for (uint32_t i = 0; i < entries; ++i) {
    const uint64_t count = U32(times, 8 + 8 * size_t{i});
    frames += count;
    duration += count * U32(times, 12 + 8 * size_t{i});
  }
  if (frames != static_cast<uint64_t>(info.frames))
    throw Malformed{"its frame counts contradict each other"};
  if (frames == 0 || duration == 0) return;
  const uint64_t numerator = frames * timescale;
  const uint64_t divisor = std::gcd(numerator, duration);
  info.fps_num = static_cast<int64_t>(numerator / divisor);
  info.fps_den = static_cast<int64_t>(duration / divisor);
  info.constant_rate = entries == 1;
}

uint64_t ChunkOffset(Bytes offsets, bool wide, uint32_t chunk) {
  return wide ? BigEndian(offsets, 8 + 8 * size_t{chunk}, 8) : U32(offsets, 8 + 4 * size_t{chunk});
}

// Requires the file to be at least as long as all its frames together, and to reach beyond the
// start of its last chunk.
void RequireSamplesFit(Bytes table, uint64_t file_size) {
  const Bytes sizes = Child(table, "stsz");
  const uint64_t fixed = U32(sizes, 4);
  const uint32_t count = U32(sizes, 8);
  uint64_t total = fixed * count;
  for (uint32_t i = 0; fixed == 0 && i < count; ++i) total += U32(sizes, 12 + 4 * size_t{i});
  Bytes offsets = Child(table, "stco");
  const bool wide = offsets.empty();
  if (wide) offsets = Child(table, "co64");
  const uint32_t chunks = U32(offsets, 4);
  uint64_t furthest = 0;
  for (uint32_t i = 0; i < chunks; ++i)
    furthest = std::max(furthest, ChunkOffset(offsets, wide, i));
  if (total > file_size || (chunks > 0 && furthest >= file_size)) {
    throw Malformed{"it is cut short: its tables name frames beyond its end"};
  }
}

VideoInfo Parse(Bytes moov, uint64_t file_size) {
  VideoInfo info;
  const Bytes track = VideoTrack(moov);
  const Bytes table = Descend(track, {"mdia", "minf", "stbl"});
  const Bytes description = Child(table, "stsd");
  // The entry's type is its codec (14496-12, 8.5.2); depth is what we write as FFV1.
  if (U32(description, 8 + 4) == 0x46465631) info.kind = VideoKind::kGray16;  // 'FFV1'
  info.width = static_cast<int>(BigEndian(description, 8 + 32, 2));
  info.height = static_cast<int>(BigEndian(description, 8 + 34, 2));
  info.frames = U32(Child(table, "stsz"), 8);
  ReadRate(table, Timescale(track), info);
  RequireSamplesFit(table, file_size);
  return info;
}

struct File {
  std::ifstream stream;
  uint64_t begin = 0;  // where the video begins in it: that of a packed dataset is in a shard
  uint64_t size = 0;

  std::vector<uint8_t> Read(uint64_t offset, uint64_t count) {
    std::vector<uint8_t> bytes(std::min(count, size - std::min(offset, size)));
    stream.clear();
    stream.seekg(static_cast<std::streamoff>(begin + offset));
    stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<size_t>(std::max<std::streamsize>(stream.gcount(), 0)));
    return bytes;
  }
};

struct Found {
  std::vector<uint8_t> moov;
  std::vector<uint8_t> media_start;  // the first bytes of the frames: x264 writes its version there
};

Found Scan(File& file) {
  Found found;
  for (uint64_t at = 0; at + 8 <= file.size;) {
    const std::vector<uint8_t> header = file.Read(at, 16);
    uint64_t size = U32(header, 0);
    const std::string type(header.begin() + 4, header.begin() + 8);
    if (at == 0 && type != "ftyp") throw Malformed{"it does not begin like an mp4 file"};
    const uint64_t skip = size == 1 ? 16 : 8;
    if (size == 1) size = BigEndian(header, 8, 8);
    if (size == 0) size = file.size - at;
    if (size < skip || size > file.size - at) {
      throw Malformed{
          fmt::format("it is cut short: box '{}' at byte {} needs {} bytes, {} are there", type, at,
                      size, file.size - at)};
    }
    if (type == "moov" && size <= kMostTableBytes) found.moov = file.Read(at + skip, size - skip);
    if (type == "mdat" && found.media_start.empty()) found.media_start = file.Read(at + skip, 2048);
    at += size;
  }
  if (found.moov.empty())
    throw Malformed{"it has no table of contents (moov): it was not finished"};
  return found;
}

std::string EncoderName(const std::vector<uint8_t>& media_start) {
  constexpr std::string_view kMark = "x264 - core ";
  const std::string_view text(reinterpret_cast<const char*>(media_start.data()),
                              media_start.size());
  const size_t begin = text.find(kMark);
  if (begin == std::string_view::npos) return "";
  return std::string(text.substr(begin, text.find(" - ", begin + kMark.size()) - begin));
}

}  // namespace

size_t FrameBytes(VideoKind kind, int width, int height) {
  const size_t of_pixel = kind == VideoKind::kGray16 ? 2 : 3;
  return of_pixel * static_cast<size_t>(width) * static_cast<size_t>(height);
}

VideoInfo ReadVideoInfo(const std::filesystem::path& path) {
  File file;
  std::error_code ignored;
  const std::optional<internal::FilePart> part = PartAt(path);
  if (part || std::filesystem::exists(path, ignored))
    internal::RequireStoredFile(path);  // a pipe may never end
  file.stream.open(part ? part->shard : path, std::ios::binary);
  if (!file.stream)
    throw IoError(fmt::format("video '{}': {}", path.string(), std::strerror(errno)), errno);
  file.begin = part ? part->begin : 0;
  file.size = internal::StoredFileBytes(path);
  try {
    if (file.size == 0) throw Malformed{"it is empty"};
    const Found found = Scan(file);
    VideoInfo info = Parse(found.moov, file.size);
    info.encoder = EncoderName(found.media_start);
    return info;
  } catch (const Malformed& problem) {
    throw IoError(
        fmt::format("video '{}' is not a readable mp4: {}", path.string(), problem.reason));
  }
}

}  // namespace robocell
