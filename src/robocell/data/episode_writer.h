// Writes one episode: a folder with steps.h5, the cameras' videos and episode.json, complete or
// absent.
//
// Everything is written under a hidden temporary name in the dataset's folder. Commit() closes and
// reads back the files, compares rows and frames with the given ones, writes episode.json, flushes
// all to the disk and renames the folder. Until then, and after Abort(), a failure, a crash or the
// destructor, no episode is visible. After an IoError the episode cannot be saved: every later call
// throws the same error. EncoderDied (media/video_writer.h) is one: another writer may succeed.
//
//   EpisodeWriter episode(dataset, "pick-000017", schema, {.metadata_json = R"({"seed": 17})"});
//   while (!done) {
//     episode.Put(time, t);
//     episode.Put(qpos, robot_qpos);            // each column of the table once, in any order
//     episode.EndRow();
//     episode.WriteFrame(wrist, rgb);
//   }
//   episode.Commit({.success = true});
//
// The same calls give the same bytes in steps.h5 and the videos, and in episode.json except for its
// `run` block. Put and EndRow allocate nothing of ours. One thread at a time per writer; writers in
// several threads are independent.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "robocell/base/file_set.h"
#include "robocell/data/episode_schema.h"
#include "robocell/data/feature_schema.h"

namespace robocell {

struct EpisodeOptions {
  // JSON objects, stored sorted by key. metadata: everything that describes the episode, for
  // example seeds, spec and task, without times and machine names. versions: of parts that this
  // layer does not know ("mujoco"); those of robocell, HDF5 and the encoder are added.
  std::string metadata_json = "{}";
  std::string versions_json = "{}";
  // The features of the columns; empty for other recordings.
  FeatureSchema features = {};
  // Options of the videos, as in VideoOptions.
  std::string video_preset = "rendered";
  int video_crf = 18;
  int video_keyframe_interval = 30;
};

struct EpisodeSummary {
  bool success = false;
  bool terminated = false;
  bool truncated = false;
  std::string end_reason;             // one of the stepper's: "success", "timeout", "diverged" ...
  std::vector<std::string> warnings;  // warnings of engine and robocell, one per line
  std::string results_json = "{}";    // an object: numbers for the report
  // An object for the `run` block: worker, attempt times. The only place for values that differ
  // between runs; `host`, `process`, `started`, `finished` and `json_sha256` are added.
  std::string run_json = "{}";
};

class EpisodeWriter {
 public:
  // Creates the temporary folder and starts the encoders. `dataset` must exist. Throws
  // ArgumentError for a bad id or JSON, IoError if an episode of that id exists or the folder
  // cannot be written.
  EpisodeWriter(const std::filesystem::path& dataset, const std::string& id,
                const EpisodeSchema& schema, const EpisodeOptions& options = {});
  ~EpisodeWriter();  // aborts
  EpisodeWriter(EpisodeWriter&&) noexcept;
  EpisodeWriter& operator=(EpisodeWriter&&) noexcept;

  // Puts one column's values of the current row, row-major. Throws ArgumentError, with the column,
  // for another type or length or a second value. Types must match exactly; NaN is allowed and
  // means "there is none".
  void Put(ColumnId column, std::span<const double> values);
  void Put(ColumnId column, std::span<const float> values);
  void Put(ColumnId column, std::span<const int64_t> values);
  void Put(ColumnId column, std::span<const int32_t> values);
  void Put(ColumnId column, std::span<const uint8_t> values);
  void Put(ColumnId column, std::span<const bool> values);
  void Put(ColumnId column, double value) { Put(column, std::span(&value, 1)); }
  void Put(ColumnId column, int64_t value) { Put(column, std::span(&value, 1)); }
  void Put(ColumnId column, int32_t value) { Put(column, std::span(&value, 1)); }
  void Put(ColumnId column, uint8_t value) { Put(column, std::span(&value, 1)); }
  void Put(ColumnId column, bool value) { Put(column, std::span(&value, 1)); }
  // Puts one row as bytes, for callers that do not know the type at compile time.
  void PutBytes(ColumnId column, ColumnType type, std::span<const std::byte> bytes);
  void EndRow(TableId table = kStepsTable);

  // Writes the frame of the next row without one: row-major RGB. May be called before or after
  // EndRow().
  void WriteFrame(CameraId camera, std::span<const uint8_t> rgb);
  // Takes a finished video as all frames of a camera, instead of WriteFrame(); the file is copied.
  // Throws ArgumentError if its size or rate is not the camera's, it is not a video, or the camera
  // has frames already.
  void AddVideo(CameraId camera, const std::filesystem::path& video);
  // Writes the image of a camera with depth: row-major millimetres. Also needed once per row.
  void WriteDepth(CameraId camera, std::span<const uint16_t> millimetres);
  // Writes the image of a camera with segmentation: indices of the schema's labels, or kNoSegment.
  // Throws ArgumentError for a number without a label.
  void WriteSegmentation(CameraId camera, std::span<const uint16_t> labels);

  // Adds another file to the episode, such as "notes.txt".
  void AddFile(const std::string& name, std::string_view bytes);

  // Adds a model of the episode's scene, by the name in its metadata. The dataset stores it once
  // (model_store.h), from the first commit of an episode that has it.
  void AddModel(const std::string& name, const FileSet& model);

  // Makes the episode visible and returns its folder. Throws ArgumentError if a row is unfinished,
  // there is no row, or a camera does not have one frame per row; the episode can then still be
  // corrected. The writer is closed afterwards.
  std::filesystem::path Commit(const EpisodeSummary& summary);
  // Removes the written files. Does nothing after Commit().
  void Abort() noexcept;

  int64_t rows(TableId table = kStepsTable) const;
  int64_t frames(CameraId camera) const;
  int64_t depth_frames(CameraId camera) const;
  int64_t segmentation_frames(CameraId camera) const;
  const std::string& id() const;
  bool is_open() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Returns true if `id` can be an episode's: a valid file name that does not begin with a dot.
bool IsEpisodeId(std::string_view id);

}  // namespace robocell
