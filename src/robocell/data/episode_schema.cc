#include "robocell/data/episode_schema.h"

#include <fmt/format.h>

#include <algorithm>

#include "robocell/base/error.h"
#include "robocell/base/paths.h"
#include "robocell/base/suggestions.h"
#include "robocell/media/video_writer.h"

namespace robocell {
namespace {

// Steps are written out a little at a time: an episode has hundreds.
constexpr int64_t kStepsChunkRows = 64;

std::string Called(const ColumnSpec& column) { return fmt::format("column '{}'", column.name); }

bool IsInteger(ColumnType type) {
  return type != ColumnType::kFloat64 && type != ColumnType::kFloat32;
}

// A path of one or more names.
void RequirePath(const std::string& name) {
  size_t begin = 0;
  for (;;) {
    const size_t slash = name.find('/', begin);
    const std::string part = name.substr(begin, slash - begin);
    if (!internal::ValidFileName(part)) {
      throw ArgumentError(
          fmt::format("column '{}': '{}' is not a valid part of a path", name, part));
    }
    if (slash == std::string::npos) return;
    begin = slash + 1;
  }
}

void RequireShape(const ColumnSpec& column) {
  for (const int64_t size : column.shape) {
    if (size >= 1) continue;
    throw ArgumentError(fmt::format("{}: shape {} has an axis shorter than 1", Called(column),
                                    ShapeText(column.shape)));
  }
}

void RequireNames(const ColumnSpec& column) {
  if (column.names.empty()) return;
  const int64_t last = column.shape.empty() ? 1 : column.shape.back();
  if (static_cast<int64_t>(column.names.size()) == last) return;
  throw ArgumentError(fmt::format("{}: {} names ({}) for a last axis of length {}", Called(column),
                                  column.names.size(), ListNames(column.names), last));
}

void RequireColumn(const ColumnSpec& column) {
  RequirePath(column.name);
  RequireShape(column);
  RequireNames(column);
  if (!column.values.empty() && !IsInteger(column.type)) {
    throw ArgumentError(fmt::format("{}: names of values need an integer type, not {}",
                                    Called(column), NameOf(column.type)));
  }
}

bool Overlap(const std::string& a, const std::string& b) {
  return a == b || a.starts_with(b + "/") || b.starts_with(a + "/");
}

}  // namespace

EpisodeSchema::EpisodeSchema() { tables_.push_back({"steps", "", kStepsChunkRows, {}}); }

std::vector<std::string> EpisodeSchema::AllNames() const {
  std::vector<std::string> names;
  for (const TableSpec& table : tables_) {
    for (const ColumnSpec& column : table.columns) names.push_back(column.name);
  }
  for (const ConstantSpec& constant : constants_) names.push_back(constant.column.name);
  return names;
}

void EpisodeSchema::RequireFreeName(const std::string& name) const {
  for (const std::string& other : AllNames()) {
    if (!Overlap(name, other)) continue;
    throw ArgumentError(
        name == other ? fmt::format("column '{}' is declared twice", name)
                      : fmt::format("columns '{}' and '{}' cannot both exist: one name is a folder "
                                    "of the other",
                                    other, name));
  }
}

void EpisodeSchema::RequireOutsideOtherTables(const ColumnSpec& column,
                                              const TableSpec* own) const {
  for (const TableSpec& table : tables_) {
    if (&table == own || table.group.empty() || !Overlap(column.name, table.name)) continue;
    throw ArgumentError(fmt::format("{}: the folder '{}' belongs to table '{}'", Called(column),
                                    table.group, table.name));
  }
}

TableSpec& EpisodeSchema::Target(TableId id) {
  if (id.index >= 0 && id.index < static_cast<int>(tables_.size())) return tables_[id.index];
  throw ArgumentError(fmt::format("episode schema: there is no table number {}; it has {}",
                                  id.index, tables_.size()));
}

TableId EpisodeSchema::AddTable(const std::string& name, int64_t chunk_rows) {
  internal::RequireFileName("table", name);
  if (chunk_rows < 1)
    throw ArgumentError(fmt::format("table '{}': chunk_rows {} is less than 1", name, chunk_rows));
  for (const TableSpec& table : tables_) {
    if (table.name == name) throw ArgumentError(fmt::format("table '{}' is declared twice", name));
  }
  for (const std::string& column : AllNames()) {
    if (Overlap(name, column)) {
      throw ArgumentError(
          fmt::format("table '{}': column '{}' already uses that folder", name, column));
    }
  }
  tables_.push_back({name, name + "/", chunk_rows, {}});
  return {static_cast<int>(tables_.size()) - 1};
}

ColumnId EpisodeSchema::AddColumn(ColumnSpec column, TableId table) {
  TableSpec& target = Target(table);
  RequireColumn(column);
  column.name = target.group + column.name;
  RequireFreeName(column.name);
  RequireOutsideOtherTables(column, &target);
  target.columns.push_back(std::move(column));
  return {table.index, static_cast<int>(target.columns.size()) - 1};
}

void EpisodeSchema::AddConstant(ColumnSpec column, std::span<const double> values) {
  RequireColumn(column);
  RequireFreeName(column.name);
  RequireOutsideOtherTables(column, nullptr);
  if (column.type != ColumnType::kFloat64) {
    throw ArgumentError(
        fmt::format("constant '{}' must be float64, not {}", column.name, NameOf(column.type)));
  }
  if (static_cast<int64_t>(values.size()) != RowValues(column.shape)) {
    throw ArgumentError(fmt::format("constant '{}': expected {} of shape {}, got {}", column.name,
                                    Counted(RowValues(column.shape), "value"),
                                    ShapeText(column.shape), values.size()));
  }
  constants_.push_back({std::move(column), {values.begin(), values.end()}});
}

CameraId EpisodeSchema::AddCamera(CameraStream stream, TableId table) {
  Target(table);
  const std::string name = fmt::format("camera '{}'", stream.name);
  internal::RequireFileName("camera", stream.name);
  RequireVideoOptions(name, {.width = stream.width,
                             .height = stream.height,
                             .fps_num = stream.fps_num,
                             .fps_den = stream.fps_den});
  if (stream.depth || stream.segmentation) {
    RequireVideoOptions(
        name, {.kind = VideoKind::kGray16, .width = stream.width, .height = stream.height});
  }
  for (const CameraEntry& camera : cameras_) {
    if (camera.stream.name == stream.name) throw ArgumentError(name + " is declared twice");
  }
  if (stream.intrinsics) {
    AddConstant({.name = fmt::format("cameras/{}/intrinsics", stream.name),
                 .shape = {3, 3},
                 .units = "px",
                 .description = "camera matrix, OpenCV axes, integer pixel centres"},
                *stream.intrinsics);
  }
  cameras_.push_back({std::move(stream), table});
  return {static_cast<int>(cameras_.size()) - 1};
}

void EpisodeSchema::SetSegmentLabels(std::vector<SegmentLabel> labels) {
  if (labels.empty() || labels.size() > kNoSegment) {
    throw ArgumentError(
        fmt::format("segmentation: {} labels are declared; its images hold 1 to {} of them",
                    labels.size(), kNoSegment));
  }
  segment_labels_ = std::move(labels);
}

const ColumnSpec& EpisodeSchema::column(ColumnId id) const {
  return tables_.at(id.table).columns.at(id.index);
}

ColumnId EpisodeSchema::FindColumn(std::string_view name) const {
  std::vector<std::string> names;
  for (size_t table = 0; table < tables_.size(); ++table) {
    const auto& columns = tables_[table].columns;
    for (size_t i = 0; i < columns.size(); ++i) {
      if (columns[i].name == name) return {static_cast<int>(table), static_cast<int>(i)};
      names.push_back(columns[i].name);
    }
  }
  throw NotFoundError(NoSuchName("episode schema", "column", name, names));
}

CameraId EpisodeSchema::FindCamera(std::string_view name) const {
  std::vector<std::string> names;
  for (size_t i = 0; i < cameras_.size(); ++i) {
    if (cameras_[i].stream.name == name) return {static_cast<int>(i)};
    names.push_back(cameras_[i].stream.name);
  }
  throw NotFoundError(NoSuchName("episode schema", "camera", name, names));
}

}  // namespace robocell
