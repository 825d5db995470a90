#include "robocell/base/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "robocell/base/io_error.h"

namespace robocell {
namespace {

struct Descriptor {
  int fd;
  ~Descriptor() { ::close(fd); }
};

}  // namespace

MappedFile::MappedFile(const std::filesystem::path& path) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) ThrowIoError("read", path, errno);
  const Descriptor closing{fd};
  struct stat status = {};
  if (::fstat(fd, &status) != 0) ThrowIoError("read", path, errno);
  size_ = static_cast<size_t>(status.st_size);
  if (size_ == 0) return;  // nothing to map
  data_ = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE | MAP_POPULATE, fd, 0);
  if (data_ != MAP_FAILED) return;
  ThrowIoError("read", path, errno);
}

MappedFile::~MappedFile() {
  if (data_) ::munmap(data_, size_);
}

MappedFile::MappedFile(MappedFile&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}

}  // namespace robocell
