// PixelBuffer: memory of the graphics card that images are read into while it goes on drawing. What
// has been read is copied later, when it is wanted: only then does the processor wait.
//
//   PixelBuffer buffer(context);
//   {
//     const PixelBuffer::Reading reading(buffer, bytes);  // images are read into the buffer
//     mjr_readPixels(reinterpret_cast<unsigned char*>(PixelBuffer::kFirst), ...);
//   }
//   ...                                                   // other drawings
//   buffer.Copy(PixelBuffer::kFirst, rgb);
//
// Every call needs the GL context current on this thread. Internal to render/.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "robocell/render/gl_context.h"

namespace robocell::internal {

class PixelBuffer {
 public:
  // The first place of an image in a buffer. Place 0 is the null pointer, which means no image.
  static constexpr size_t kFirst = 64;

  // Throws Error if the driver has no such buffers.
  explicit PixelBuffer(const GlContext& context);
  ~PixelBuffer();
  PixelBuffer(const PixelBuffer&) = delete;
  PixelBuffer& operator=(const PixelBuffer&) = delete;

  // Until its end, reading an image writes to the buffer, which holds at least `bytes`.
  class Reading {
   public:
    Reading(PixelBuffer& buffer, size_t bytes) : buffer_(buffer) { buffer_.Begin(bytes); }
    ~Reading() { buffer_.End(); }
    Reading(const Reading&) = delete;
    Reading& operator=(const Reading&) = delete;

   private:
    PixelBuffer& buffer_;
  };
  // Waits until the reading has ended, and fills `to` with the bytes from place `at` on.
  void Copy(size_t at, std::span<std::byte> to);

 private:
  using Enum = unsigned int;
  void Begin(size_t bytes);
  void End();

  static constexpr Enum kPackBuffer = 0x88EB, kStreamRead = 0x88E1;

  void (*generate_)(int, unsigned int*) = nullptr;
  void (*delete_)(int, const unsigned int*) = nullptr;
  void (*bind_)(Enum, unsigned int) = nullptr;
  void (*reserve_)(Enum, std::ptrdiff_t, const void*, Enum) = nullptr;
  void (*copy_)(Enum, std::ptrdiff_t, std::ptrdiff_t, void*) = nullptr;
  unsigned int buffer_ = 0;
  size_t bytes_ = 0;
};

}  // namespace robocell::internal
