// Owners for the objects of the HDF5 C library that episodes need. Internal to data/; the library's
// header stays in hdf5.cc.
//
// Every call checks its result and throws an IoError with the file, the attempted action and the
// library's innermost reason. One lock serialises all calls, so that any build of the library may
// be used from several threads. Files contain no times: the same calls give the same bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "robocell/data/column.h"

namespace robocell::internal::hdf5 {

// Returns "1.10.8".
std::string Version();

// Calls fork(2). The child may use the library if it was used before: the fork happens at an
// instant when no other thread is in it.
int Fork();

// Owns an id of the library.
class Id {
 public:
  using Closer = int (*)(int64_t);
  Id() = default;
  Id(int64_t id, Closer closer) : id_(id), closer_(closer) {}
  ~Id();
  Id(Id&& other) noexcept;
  Id& operator=(Id&& other) noexcept;

  int64_t get() const { return id_; }
  // Returns false if the library refused; the id is then still owned, and may be closed later.
  bool Close();
  // Gives the id up without closing it.
  void Forget() { id_ = -1; }

 private:
  int64_t id_ = -1;
  Closer closer_ = nullptr;
};

// An array in a file. The first axis of an extendible one counts rows.
class H5Dataset {
 public:
  H5Dataset() = default;

  const std::string& name() const { return name_; }
  ColumnType type() const { return type_; }
  // Returns the shape with the row axis.
  const std::vector<int64_t>& shape() const { return shape_; }

  // Rows are whole entries of the first axis.
  //
  // Adds `count` rows as the next chunk: `bytes` holds a whole chunk that begins with the rows. All
  // chunks but the last must be full.
  void AppendChunk(int64_t count, std::span<const std::byte> bytes);
  void ReadRows(int64_t first, int64_t count, std::span<std::byte> bytes) const;
  void ReadAll(std::span<std::byte> bytes) const;
  void WriteAll(std::span<const std::byte> bytes);
  size_t row_bytes() const;

  void SetText(const std::string& key, const std::string& value);
  void SetTexts(const std::string& key, const std::vector<std::string>& values);
  // Return "" or {} if there is no such attribute.
  std::string Text(const std::string& key) const;
  std::vector<std::string> Texts(const std::string& key) const;

  void Close();

 private:
  friend class File;
  [[noreturn]] void Fail(const std::string& what) const;
  Id SelectRows(int64_t first, int64_t count) const;

  Id id_;
  std::string file_;  // file name for messages
  std::string name_;
  ColumnType type_ = ColumnType::kFloat64;
  std::vector<int64_t> shape_;
};

class File {
 public:
  // Fails if the file exists.
  static File Create(const std::filesystem::path& path);
  static File OpenReadOnly(const std::filesystem::path& path);
  // Opens the bytes of a file, which the library copies; `path` is for messages.
  static File OpenBytes(std::string bytes, const std::filesystem::path& path);

  File(File&&) = default;
  File& operator=(File&&) = default;

  // Creates the groups on the way. `shape` is that of one row; memory and file grow by `chunk_rows`
  // at a time.
  H5Dataset CreateExtendible(const std::string& name, ColumnType type,
                             const std::vector<int64_t>& shape, int64_t chunk_rows);
  H5Dataset CreateFixed(const std::string& name, ColumnType type,
                        const std::vector<int64_t>& shape);
  H5Dataset Open(const std::string& name) const;
  // Returns all arrays, by name.
  std::vector<std::string> DatasetNames() const;

  // Sets an attribute of a group; "/" is the root. The group is created if needed.
  void SetText(const std::string& group, const std::string& key, const std::string& value);
  void SetInteger(const std::string& group, const std::string& key, int64_t value);
  std::string Text(const std::string& group, const std::string& key) const;
  int64_t Integer(const std::string& group, const std::string& key) const;

  // Writes buffered data; the datasets must have been closed before.
  void Close();
  // Discards unwritten data, so that the library can release an open file whose disk is full;
  // otherwise it would keep its memory and descriptor for ever. Closes nothing.
  void Discard() noexcept;

 private:
  [[noreturn]] void Fail(const std::string& what) const;
  Id Group(const std::string& name);
  void MakeParents(const std::string& name);
  H5Dataset Created(Id id, const std::string& name, ColumnType type,
                    std::vector<int64_t> shape) const;

  File(Id id, std::string path) : id_(std::move(id)), path_(std::move(path)) {}

  Id id_;
  std::string path_;
};

}  // namespace robocell::internal::hdf5
