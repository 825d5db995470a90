// Declares the contents of an episode before its first row: tables with columns, constants and
// cameras.
//
// A table is one time base. Every episode has the table `steps` (row i is the state before action
// i); others, such as `control` for what happens at control rate, live in a group of that name. All
// columns of a table have the same length, and a camera has exactly one frame per row of its table.
//
//   EpisodeSchema schema;
//   const ColumnId time = schema.AddColumn({.name = "time", .units = "s"});
//   const ColumnId qpos = schema.AddColumn({.name = "robots/xarm7/arm/qpos", .shape = {7},
//                                           .units = "rad", .names = joint_names});
//   const CameraId wrist = schema.AddCamera({.name = "wrist", .width = 320, .height = 240});
//   const TableId control = schema.AddTable("control");
//   const ColumnId ctrl = schema.AddColumn({.name = "ctrl", .shape = {8}}, control);
//   // stored as control/ctrl
//
// Throws ArgumentError that names a wrong declaration. A value type; copies are independent.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "robocell/data/column.h"

namespace robocell {

// Handles of one schema; they are also valid for its copies.
struct TableId {
  int index = 0;
  bool operator==(const TableId&) const = default;
};

struct ColumnId {
  int table = 0;
  int index = 0;
  bool operator==(const ColumnId&) const = default;
};

struct CameraId {
  int index = 0;
  bool operator==(const CameraId&) const = default;
};

inline constexpr TableId kStepsTable{0};

// A colour video, stored as <name>.mp4, with optional depth beside it.
struct CameraStream {
  std::string name;  // a file name
  int width = 0;     // px, even
  int height = 0;    // px, even
  int fps_num = 30;  // the rate the video is played at: the table's rows per second
  int fps_den = 1;
  // 3x3 in row-major order, px, OpenCV axes; stored as cameras/<name>/intrinsics. A per-row
  // extrinsics column is added like any other column.
  std::optional<std::array<double, 9>> intrinsics;
  // Adds a lossless video <name>.depth.mov: uint16, millimetres along the camera's axis, 0 where
  // nothing was hit, 65535 for everything farther.
  bool depth = false;
  // Adds a lossless video <name>.segmentation.mov: uint16, the visible element of each pixel as an
  // index of the schema's segment labels, or kNoSegment. The schema then needs labels.
  bool segmentation = false;
};

// The meaning of one id in the segmentation of all cameras.
struct SegmentLabel {
  std::string name;   // "robot_0/link3": a body
  std::string owner;  // its owner, as columns name it: "robots/rc7", "objects/mug"; or ""
  bool operator==(const SegmentLabel&) const = default;
};

// A pixel of segmentation that shows no labelled element.
inline constexpr uint16_t kNoSegment = 65535;

// A value without time axis.
struct ConstantSpec {
  ColumnSpec column;
  std::vector<double> values;  // row-major
};

struct TableSpec {
  std::string name;                 // "steps", "control"
  std::string group;                // path of its columns: "" for steps, "control/" for control
  int64_t chunk_rows;               // rows written to the file at a time
  std::vector<ColumnSpec> columns;  // columns with full names
};

struct CameraEntry {
  CameraStream stream;
  TableId table;
};

class EpisodeSchema {
 public:
  EpisodeSchema();

  TableId AddTable(const std::string& name, int64_t chunk_rows = 512);
  ColumnId AddColumn(ColumnSpec column, TableId table = kStepsTable);
  // Adds numbers that do not change in the episode; column.type must be kFloat64.
  void AddConstant(ColumnSpec column, std::span<const double> values);
  CameraId AddCamera(CameraStream stream, TableId table = kStepsTable);
  // Sets the labels of 0, 1, ... in segmentation images: at least one, at most kNoSegment of them.
  void SetSegmentLabels(std::vector<SegmentLabel> labels);

  const std::vector<TableSpec>& tables() const { return tables_; }
  const std::vector<ConstantSpec>& constants() const { return constants_; }
  const std::vector<CameraEntry>& cameras() const { return cameras_; }
  const std::vector<SegmentLabel>& segment_labels() const { return segment_labels_; }
  const ColumnSpec& column(ColumnId id) const;

  // Finds a column by its full name. Throws NotFoundError with the nearest names.
  ColumnId FindColumn(std::string_view name) const;
  CameraId FindCamera(std::string_view name) const;

 private:
  void RequireFreeName(const std::string& name) const;
  void RequireOutsideOtherTables(const ColumnSpec& column, const TableSpec* own) const;
  TableSpec& Target(TableId id);
  std::vector<std::string> AllNames() const;

  std::vector<TableSpec> tables_;
  std::vector<ConstantSpec> constants_;
  std::vector<CameraEntry> cameras_;
  std::vector<SegmentLabel> segment_labels_;
};

}  // namespace robocell
