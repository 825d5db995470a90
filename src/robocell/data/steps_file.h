// Streams the tables of an episode into steps.h5. Internal to data/; EpisodeWriter is the public
// interface.
//
// Rows are collected in one buffer per column and written when a chunk is full, so memory does not
// grow with the episode. Filling a row does not allocate. After the file is closed, VerifyContent
// reads it back and compares every byte with the values put.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "robocell/base/hash.h"
#include "robocell/data/episode_schema.h"
#include "robocell/data/hdf5.h"

namespace robocell::internal {

class StepsFile {
 public:
  // `name` begins messages: "episode 'pick-3'".
  StepsFile(std::filesystem::path path, std::string name, const EpisodeSchema& schema);

  // Rows that Close() did not write are lost.
  ~StepsFile();
  StepsFile(const StepsFile&) = delete;
  StepsFile& operator=(const StepsFile&) = delete;

  // Throws ArgumentError for an unknown column, another type, a wrong length, or a column put twice
  // in a row.
  void Put(ColumnId column, ColumnType type, std::span<const std::byte> values);
  // Completes the row. Throws ArgumentError that names the columns without a value.
  void EndRow(TableId table);
  int64_t rows(TableId table) const;

  // Writes everything and closes the file. Throws ArgumentError if a row is incomplete.
  void Close();
  // Opens the closed file and compares.
  void VerifyContent() const;

 private:
  struct Column {
    const ColumnSpec* spec;
    size_t row_bytes;
    std::vector<std::byte> chunk;
    int64_t rows_put = 0;
    hdf5::H5Dataset dataset;
    Sha256Stream content;
  };
  struct Table {
    const TableSpec* spec;
    int64_t rows = 0;
    int64_t rows_in_chunk = 0;
    std::vector<Column> columns;
  };

  void Create();
  Column MakeColumn(const ColumnSpec& spec, const TableSpec& table);
  void Flush(Table& table);
  void RequireNoOpenRow(const Table& table) const;
  Table& At(TableId id);
  void RequireColumn(const Column& column) const;

  std::filesystem::path path_;
  std::string name_;
  EpisodeSchema schema_;
  hdf5::File file_;
  std::vector<Table> tables_;
};

}  // namespace robocell::internal
