#include "robocell/base/read_blocks.h"

#include <cerrno>
#include <cstdio>
#include <memory>

#include "robocell/base/io_error.h"

namespace robocell {
namespace {

constexpr size_t kBlock = 1 << 18;  // stays in the processor's cache until it is used

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

}  // namespace

void ReadBlocks(const std::filesystem::path& path, const std::function<void(std::string_view)>& f) {
  const std::unique_ptr<std::FILE, CloseFile> file(std::fopen(path.c_str(), "rbe"));
  if (!file) ThrowIoError("read", path, errno);
  std::setvbuf(file.get(), nullptr, _IONBF, 0);  // straight into the block
  const auto block = std::make_unique_for_overwrite<char[]>(kBlock);
  while (const size_t count = std::fread(block.get(), 1, kBlock, file.get())) {
    f({block.get(), count});
  }
  if (std::ferror(file.get())) ThrowIoError("read", path, errno);
}

}  // namespace robocell
