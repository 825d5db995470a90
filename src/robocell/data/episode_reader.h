// Reads one committed episode.
//
//   Episode episode("dataset/pick-000017");
//   const auto qpos = episode.Read<double>("robots/xarm7/arm/qpos");  // rows() * 7, row-major
//   const auto row = episode.Read<double>("robots/xarm7/arm/qpos", {.first = 20, .count = 1});
//   VideoReader wrist = episode.Video("wrist");                       // frame i belongs to row i
//   episode.ReadFrame("wrist", ImageKind::kColour, 17, rgb);          // one frame, in any order
//
// Opening reads episode.json and checks that the files exist with their sizes; Verify
// (data/verify.h) checks whether their bytes are intact. Throws IoError with file and reason,
// NotFoundError with the nearest names, and ArgumentError for another type or rows beyond the end.
// Several threads may call const functions.
//
// Thousands of episodes may be open at once: all episodes of a process share a few open files and
// decoders (ReleaseIdleFiles). They also work in a forked child.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "robocell/data/column.h"
#include "robocell/data/episode_schema.h"
#include "robocell/data/feature_schema.h"
#include "robocell/media/video_reader.h"

namespace robocell {

struct ColumnInfo {
  ColumnSpec spec;
  std::string table;  // "steps", "control"; "" for a constant
  int64_t rows = 0;   // rows of its table; 0 for a constant
};

struct CameraInfo {
  std::string name;
  std::string file;
  std::string depth_file;         // "" when the camera has no depth
  std::string segmentation_file;  // "" when the camera has no segmentation
  std::string table;
  int64_t frames = 0;
  int width = 0;
  int height = 0;
  int fps_num = 0;
  int fps_den = 1;
};

enum class ImageKind {
  kColour,        // RGB, uint8
  kDepth,         // uint16, millimetres along the camera's axis
  kSegmentation,  // uint16, numbers of segment_labels()
};
std::string_view NameOf(ImageKind kind);  // "rgb", "depth", "segmentation"

// A video of an episode.
struct ImageStream {
  std::string name;  // "wrist", "wrist.depth", "wrist.segmentation": the file without its ending
  std::string camera;
  ImageKind kind = ImageKind::kColour;
};

struct RowRange {
  int64_t first = 0;
  std::optional<int64_t> count;  // unset: to the end
};

// State of the bytes of steps.h5: they must be compared with their hash first, or they were just
// compared, so that HDF5 may read them right away.
enum class StepsBytes { kCompare, kCompared };

class Episode {
 public:
  explicit Episode(const std::filesystem::path& folder, StepsBytes steps = StepsBytes::kCompare);
  ~Episode();
  Episode(Episode&&) noexcept;
  Episode& operator=(Episode&&) noexcept;

  const std::filesystem::path& folder() const;
  const std::string& id() const;
  bool success() const;
  bool terminated() const;
  bool truncated() const;
  const std::string& end_reason() const;
  const std::vector<std::string>& warnings() const;
  // Return the text of episode.json, and of its parts.
  const std::string& json() const;
  std::string metadata_json() const;
  std::string results_json() const;
  std::string versions_json() const;
  std::string run_json() const;
  // Returns the features of the columns; empty in episodes that were recorded without features.
  const FeatureSchema& features() const;

  int64_t rows(const std::string& table = "steps") const;
  std::vector<std::string> tables() const;
  // Returns all columns including constants, by name.
  const std::vector<ColumnInfo>& columns() const;
  const ColumnInfo& column(const std::string& name) const;

  // T must be the column's type: double, float, int64_t, int32_t, uint8_t or bool (as uint8_t:
  // std::vector<bool> has no contiguous values). A constant has no rows: its range must be the
  // default.
  template <typename T>
  std::vector<T> Read(const std::string& name, const RowRange& range = {}) const {
    static_assert(!std::is_same_v<T, bool>, "read a bool column as uint8_t");
    std::vector<T> values(ValueCount(name, range));
    ReadBytes(name, range, ColumnTypeOf<T>(), std::as_writable_bytes(std::span(values)));
    return values;
  }
  size_t ValueCount(const std::string& name, const RowRange& range = {}) const;
  void ReadBytes(const std::string& name, const RowRange& range, ColumnType type,
                 std::span<std::byte> bytes) const;

  const std::vector<CameraInfo>& cameras() const;
  const CameraInfo& camera(const std::string& name) const;
  VideoReader Video(const std::string& camera) const;
  // Returns the depth of a camera, uint16 millimetres. Throws NotFoundError if it has none.
  VideoReader DepthVideo(const std::string& camera) const;
  // Returns the segmentation video of a camera, uint16: each pixel is an index of segment_labels(),
  // or kNoSegment. Throws NotFoundError if the camera has no segmentation.
  VideoReader SegmentationVideo(const std::string& camera) const;
  // Returns all videos, by camera and kind.
  std::vector<ImageStream> streams() const;
  // Returns the stream of that name in the list. Throws NotFoundError with the nearest names.
  ImageStream stream(const std::string& name) const;
  // Reads one frame, in any order, through decoders that all episodes share: see
  // media/frame_pool.h. Use bytes for colour, uint16 for the other kinds. Throws ArgumentError if
  // there is no such frame.
  void ReadFrame(const std::string& camera, ImageKind kind, int64_t index,
                 std::span<uint8_t> rgb) const;
  void ReadFrame(const std::string& camera, ImageKind kind, int64_t index,
                 std::span<uint16_t> pixels) const;
  // Returns, for each row of a table, the camera's frame at that time: the last one that is not
  // newer than the row, -1 where there is none yet. For the camera's own table it is the row
  // itself; for any other it follows from the column `time` of both, to a microsecond. Throws
  // ArgumentError if one of them has no such column.
  std::vector<int64_t> FramesOfRows(const std::string& camera,
                                    const std::string& table = "steps") const;
  // Returns the labels of 0, 1, ... in the segmentation of all cameras; empty if no camera has it.
  const std::vector<SegmentLabel>& segment_labels() const;
  // Returns the models of its scene: names in the metadata -> paths in the dataset
  // ("models/rc7-0123456789abcdef/rc7.xml").
  std::map<std::string, std::string> models() const;
  // Returns all files but episode.json, as listed in it.
  std::vector<std::string> files() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Closes the files and ends the decoders that episodes keep for their next call, for example before
// a dataset is moved or deleted. Episodes open them again when they need them.
void ReleaseIdleFiles();

}  // namespace robocell
