// A file's bytes where the system keeps them, without a copy: for large files that nobody changes
// in place. (A file that shrinks while it is mapped ends the process that looks at what is gone;
// files that others may write to are read with files.h.)
//
//   const MappedFile entry(path);
//   Use(entry.bytes());
#pragma once

#include <cstddef>
#include <filesystem>
#include <string_view>

namespace robocell {

class MappedFile {
 public:
  // IoError when it cannot be read.
  explicit MappedFile(const std::filesystem::path& path);
  ~MappedFile();
  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&&) = delete;

  // As long as this object lives.
  std::string_view bytes() const { return {static_cast<const char*>(data_), size_}; }

 private:
  void* data_ = nullptr;
  size_t size_ = 0;
};

}  // namespace robocell
