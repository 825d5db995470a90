#include "robocell/data/steps_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <string_view>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/data/episode_files.h"

namespace robocell::internal {
namespace {

std::string_view AsText(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void SetIfAny(hdf5::H5Dataset& dataset, const std::string& key, const std::string& text) {
  if (!text.empty()) dataset.SetText(key, text);
}

void SetIfAny(hdf5::H5Dataset& dataset, const std::string& key,
              const std::vector<std::string>& texts) {
  if (!texts.empty()) dataset.SetTexts(key, texts);
}

void Describe(hdf5::H5Dataset& dataset, const ColumnSpec& spec) {
  SetIfAny(dataset, "units", spec.units);
  SetIfAny(dataset, "frame", spec.frame);
  SetIfAny(dataset, "names", spec.names);
  SetIfAny(dataset, "values", spec.values);
  SetIfAny(dataset, "description", spec.description);
}

void WriteConstant(hdf5::File& file, const ConstantSpec& constant) {
  hdf5::H5Dataset dataset =
      file.CreateFixed(constant.column.name, constant.column.type, constant.column.shape);
  Describe(dataset, constant.column);
  dataset.WriteAll(std::as_bytes(std::span(constant.values)));
  dataset.Close();
}

void WriteCamera(hdf5::File& file, const CameraEntry& camera, const std::string& table) {
  const std::string group = "cameras/" + camera.stream.name;
  file.SetText(group, "video", VideoFile(camera.stream.name));
  if (camera.stream.depth) {
    file.SetText(group, "depth", DepthFile(camera.stream.name));
    file.SetText(group, "depth_units", "mm");
  }
  if (camera.stream.segmentation)
    file.SetText(group, "segmentation", SegmentationFile(camera.stream.name));
  file.SetText(group, "table", table);
  file.SetInteger(group, "width", camera.stream.width);
  file.SetInteger(group, "height", camera.stream.height);
  file.SetInteger(group, "fps_num", camera.stream.fps_num);
  file.SetInteger(group, "fps_den", camera.stream.fps_den);
}

}  // namespace

StepsFile::StepsFile(std::filesystem::path path, std::string name, const EpisodeSchema& schema)
    : path_(std::move(path)),
      name_(std::move(name)),
      schema_(schema),
      file_(hdf5::File::Create(path_)) {
  Create();
}

StepsFile::~StepsFile() { file_.Discard(); }

void StepsFile::Create() {
  file_.SetText("/", "format", std::string(kEpisodeFormat));
  file_.SetInteger("/", "format_version", kEpisodeFormatVersion);
  for (const TableSpec& spec : schema_.tables()) {
    Table table{.spec = &spec};
    for (const ColumnSpec& column : spec.columns) table.columns.push_back(MakeColumn(column, spec));
    tables_.push_back(std::move(table));
  }
  for (const ConstantSpec& constant : schema_.constants()) WriteConstant(file_, constant);
  for (const CameraEntry& camera : schema_.cameras()) {
    WriteCamera(file_, camera, schema_.tables()[camera.table.index].name);
  }
}

StepsFile::Column StepsFile::MakeColumn(const ColumnSpec& spec, const TableSpec& table) {
  const size_t row_bytes = SizeOf(spec.type) * static_cast<size_t>(RowValues(spec.shape));
  Column column{.spec = &spec, .row_bytes = row_bytes};
  column.chunk.resize(row_bytes * static_cast<size_t>(table.chunk_rows));
  column.dataset = file_.CreateExtendible(spec.name, spec.type, spec.shape, table.chunk_rows);
  column.dataset.SetText("table", table.name);
  Describe(column.dataset, spec);
  return column;
}

StepsFile::Table& StepsFile::At(TableId id) {
  if (id.index >= 0 && id.index < static_cast<int>(tables_.size())) return tables_[id.index];
  throw ArgumentError(
      fmt::format("{}: there is no table number {}; it has {}", name_, id.index, tables_.size()));
}

void StepsFile::Put(ColumnId id, ColumnType type, std::span<const std::byte> values) {
  Table& table = At({id.table});
  if (id.index < 0 || id.index >= static_cast<int>(table.columns.size())) {
    throw ArgumentError(
        fmt::format("{}: table '{}' has no column number {}", name_, table.spec->name, id.index));
  }
  Column& column = table.columns[id.index];
  if (type != column.spec->type) {
    throw ArgumentError(fmt::format("{}: column '{}' holds {}, got {}", name_, column.spec->name,
                                    NameOf(column.spec->type), NameOf(type)));
  }
  if (values.size() != column.row_bytes) {
    throw ArgumentError(fmt::format("{}: column '{}' expects {} of shape {}, got {}", name_,
                                    column.spec->name,
                                    Counted(RowValues(column.spec->shape), "value"),
                                    ShapeText(column.spec->shape), values.size() / SizeOf(type)));
  }
  if (column.rows_put > table.rows) {
    throw ArgumentError(fmt::format("{}: column '{}' was put twice in row {}", name_,
                                    column.spec->name, table.rows));
  }
  std::memcpy(column.chunk.data() + column.row_bytes * table.rows_in_chunk, values.data(),
              values.size());
  ++column.rows_put;
}

void StepsFile::EndRow(TableId id) {
  Table& table = At(id);
  for (const Column& column : table.columns) {
    if (column.rows_put > table.rows) continue;
    std::vector<std::string> missing;
    for (const Column& other : table.columns) {
      if (other.rows_put <= table.rows) missing.push_back(other.spec->name);
    }
    throw ArgumentError(fmt::format("{}: row {} of table '{}' is not complete, missing: {}", name_,
                                    table.rows, table.spec->name, ListNames(missing)));
  }
  ++table.rows;
  ++table.rows_in_chunk;
  if (table.rows_in_chunk == table.spec->chunk_rows) Flush(table);
}

int64_t StepsFile::rows(TableId id) const { return tables_.at(id.index).rows; }

void StepsFile::Flush(Table& table) {
  if (table.rows_in_chunk == 0) return;
  for (Column& column : table.columns) {
    const size_t used = column.row_bytes * static_cast<size_t>(table.rows_in_chunk);
    std::fill(column.chunk.begin() + static_cast<std::ptrdiff_t>(used), column.chunk.end(),
              std::byte{0});
    column.dataset.AppendChunk(table.rows_in_chunk, column.chunk);
    column.content.Update(AsText(std::span(column.chunk).first(used)));
  }
  table.rows_in_chunk = 0;
}

void StepsFile::RequireNoOpenRow(const Table& table) const {
  std::vector<std::string> begun;
  for (const Column& column : table.columns) {
    if (column.rows_put > table.rows) begun.push_back(column.spec->name);
  }
  if (begun.empty()) return;
  throw ArgumentError(fmt::format("{}: row {} of table '{}' was begun ({}) but not ended", name_,
                                  table.rows, table.spec->name, ListNames(begun)));
}

void StepsFile::Close() {
  for (const Table& table : tables_) RequireNoOpenRow(table);
  for (Table& table : tables_) {
    Flush(table);
    for (Column& column : table.columns) column.dataset.Close();
    const std::string group = table.spec->group.empty() ? "/" : table.spec->name;
    file_.SetInteger(group, "rows", table.rows);
  }
  file_.Close();
}

void StepsFile::VerifyContent() const {
  const hdf5::File file = hdf5::File::OpenReadOnly(path_);
  std::vector<std::byte> rows;
  for (const Table& table : tables_) {
    for (const Column& column : table.columns) {
      const hdf5::H5Dataset dataset = file.Open(column.spec->name);
      Sha256Stream content;
      const int64_t stored = dataset.shape().empty() ? -1 : dataset.shape()[0];
      for (int64_t row = 0; stored == table.rows && row < stored; row += table.spec->chunk_rows) {
        const int64_t count = std::min(table.spec->chunk_rows, stored - row);
        rows.resize(column.row_bytes * static_cast<size_t>(count));
        dataset.ReadRows(row, count, rows);
        content.Update(AsText(rows));
      }
      if (stored == table.rows && content.Hex() == column.content.Hex()) continue;
      throw IoError(
          fmt::format("{}: '{}' does not contain the rows written to column '{}' ({} rows of {})",
                      name_, path_.string(), column.spec->name, stored, table.rows));
    }
  }
}

}  // namespace robocell::internal
