#include "robocell/render/pixel_buffer.h"

#include <string>

#include "robocell/base/error.h"

namespace robocell::internal {
namespace {

template <class Function>
void Load(const GlContext& context, Function*& function, const char* name) {
  function = reinterpret_cast<Function*>(context.Function(name));
  if (!function) throw Error(context.description() + " has no " + name);
}

}  // namespace

PixelBuffer::PixelBuffer(const GlContext& context) {
  Load(context, generate_, "glGenBuffers");
  Load(context, delete_, "glDeleteBuffers");
  Load(context, bind_, "glBindBuffer");
  Load(context, reserve_, "glBufferData");
  Load(context, copy_, "glGetBufferSubData");
  generate_(1, &buffer_);
}

PixelBuffer::~PixelBuffer() { delete_(1, &buffer_); }

void PixelBuffer::Begin(size_t bytes) {
  bind_(kPackBuffer, buffer_);
  if (bytes <= bytes_) return;
  reserve_(kPackBuffer, static_cast<std::ptrdiff_t>(bytes), nullptr, kStreamRead);
  bytes_ = bytes;
}

void PixelBuffer::End() { bind_(kPackBuffer, 0); }

void PixelBuffer::Copy(size_t at, std::span<std::byte> to) {
  bind_(kPackBuffer, buffer_);
  copy_(kPackBuffer, static_cast<std::ptrdiff_t>(at), static_cast<std::ptrdiff_t>(to.size()),
        to.data());
  bind_(kPackBuffer, 0);
}

}  // namespace robocell::internal
