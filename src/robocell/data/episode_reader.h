// Reads one committed episode.
//
//   Episode episode("dataset/pick-000017");
//   const auto qpos = episode.Read<double>("robots/xarm7/arm/qpos");  // rows() * 7, row-major
//   const auto row = episode.Read<double>("robots/xarm7/arm/qpos", {.first = 20, .count = 1});
//   VideoReader wrist = episode.Video("wrist");                       // frame i belongs to row i
//   episode.ReadFrame("wrist", ImageKind::kColour, 17, rgb);          // one frame, in any order
//
// Opening reads episode.json and checks that the files are there with their sizes; whether their
// bytes are intact is checked by Verify (data/verify.h). IoError names file and reason;
// NotFoundError the nearest names; ArgumentError for another type or rows beyond the end. Const
// functions may be called from several threads.
//
// Thousands of episodes may be open at once: all episodes of a process share a few open files and
// decoders (ReleaseIdleFiles). They go on working in a forked child.
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
  int64_t rows = 0;   // of its table; 0 for a constant
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

// One video of an episode.
struct ImageStream {
  std::string name;  // "wrist", "wrist.depth", "wrist.segmentation": the file without its ending
  std::string camera;
  ImageKind kind = ImageKind::kColour;
};

struct RowRange {
  int64_t first = 0;
  std::optional<int64_t> count;  // to the end if unset
};

// Whether the bytes of steps.h5 are still to be compared with their hash before HDF5 reads them, or
// were just compared.
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
  // The text of episode.json, and of its parts.
  const std::string& json() const;
  std::string metadata_json() const;
  std::string results_json() const;
  std::string versions_json() const;
  std::string run_json() const;
  // The features of the columns; empty in episodes that were recorded without features.
  const FeatureSchema& features() const;

  int64_t rows(const std::string& table = "steps") const;
  std::vector<std::string> tables() const;
  // Constants included, by name.
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
  // The depth of a camera, uint16 millimetres. NotFoundError when it has none.
  VideoReader DepthVideo(const std::string& camera) const;
  // Returns the segmentation video of a camera, uint16: each pixel is an index of segment_labels(),
  // or kNoSegment. NotFoundError if the camera has no segmentation.
  VideoReader SegmentationVideo(const std::string& camera) const;
  // All videos, by camera and kind.
  std::vector<ImageStream> streams() const;
  // By its name, as listed. NotFoundError with the nearest names.
  ImageStream stream(const std::string& name) const;
  // One frame, in any order, through decoders that all episodes share: see media/frame_pool.h.
  // Bytes are for colour, uint16 for the other kinds. ArgumentError if there is no such frame.
  void ReadFrame(const std::string& camera, ImageKind kind, int64_t index,
                 std::span<uint8_t> rgb) const;
  void ReadFrame(const std::string& camera, ImageKind kind, int64_t index,
                 std::span<uint16_t> pixels) const;
  // For each row of a table the camera's frame of that moment: the last one that is not newer than
  // the row, -1 where there is none yet. Of the table that the camera belongs to it is the row
  // itself; of any other it follows from the column `time` of both, to a microsecond. ArgumentError
  // if one of them has no such column.
  std::vector<int64_t> FramesOfRows(const std::string& camera,
                                    const std::string& table = "steps") const;
  // The labels of 0, 1, ... in the segmentation of all cameras; none when no camera has it.
  const std::vector<SegmentLabel>& segment_labels() const;
  // The models it was made in: their names in the metadata -> where the dataset keeps them
  // ("models/rc7-0123456789abcdef/rc7.xml").
  std::map<std::string, std::string> models() const;
  // All files but episode.json, as listed in it.
  std::vector<std::string> files() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Closes the files and ends the decoders that episodes keep for their next call; before a dataset is
// moved or deleted, for example. Episodes open them again when they need them.
void ReleaseIdleFiles();

}  // namespace robocell
