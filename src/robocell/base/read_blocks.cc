#include "robocell/base/read_blocks.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <memory>

#include "robocell/base/io_error.h"

namespace robocell {
namespace {

constexpr size_t kBlock = 1 << 18;  // stays in the processor's cache until it is used

class OpenFile {
 public:
  explicit OpenFile(const std::filesystem::path& path)
      : descriptor_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
    if (descriptor_ < 0) ThrowIoError("read", path, errno);
  }
  ~OpenFile() { ::close(descriptor_); }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

}  // namespace

void ReadBlocks(const std::filesystem::path& path, const std::function<void(std::string_view)>& f) {
  const OpenFile file(path);
  ReadBlocks(file.descriptor(), path, f);
}

void ReadBlocks(int descriptor, const std::filesystem::path& path,
                const std::function<void(std::string_view)>& f) {
  const auto block = std::make_unique_for_overwrite<char[]>(kBlock);
  for (;;) {
    const ssize_t count = ::read(descriptor, block.get(), kBlock);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) ThrowIoError("read", path, errno);
    if (count == 0) return;
    f({block.get(), static_cast<size_t>(count)});
  }
}

}  // namespace robocell
