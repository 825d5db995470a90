#include "robocell/media/png.h"

#include <png.h>
#include <fmt/format.h>

#include <cctype>
#include <csetjmp>
#include <cstring>
#include <new>
#include <string>
#include <string_view>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/real_file.h"
#include "robocell/base/suggestions.h"

// libpng reports errors by longjmp. Every function between setjmp and libpng's calls is plain C:
// raw pointers only, no object with a destructor.
namespace robocell {
namespace {

constexpr uint64_t kMostFileBytes = uint64_t{1} << 30;

// Receives libpng's error text, and is the source or target of its data.
struct Channel {
  char message[200] = "";
  const uint8_t* input = nullptr;
  size_t input_left = 0;
  std::vector<uint8_t>* output = nullptr;
};

void OnError(png_structp png, png_const_charp message) {
  auto* channel = static_cast<Channel*>(png_get_error_ptr(png));
  std::strncpy(channel->message, message, sizeof channel->message - 1);
  png_longjmp(png, 1);
}

void OnWarning(png_structp, png_const_charp) {}

bool Append(std::vector<uint8_t>* output, const uint8_t* bytes, size_t count) {
  try {
    output->insert(output->end(), bytes, bytes + count);
    return true;
  } catch (const std::bad_alloc&) {
    return false;
  }
}

void OnWrite(png_structp png, png_bytep bytes, size_t count) {
  auto* channel = static_cast<Channel*>(png_get_io_ptr(png));
  if (!Append(channel->output, bytes, count)) png_error(png, "out of memory");
}

void OnFlush(png_structp) {}

void OnRead(png_structp png, png_bytep bytes, size_t count) {
  auto* channel = static_cast<Channel*>(png_get_io_ptr(png));
  if (count > channel->input_left) png_error(png, "the file is cut short");
  std::memcpy(bytes, channel->input, count);
  channel->input += count;
  channel->input_left -= count;
}

struct Format {
  int width;
  int height;
  int depth;
  int color;
};

bool Encode(Channel* channel, Format format, const uint8_t* pixels, size_t row_bytes,
            const png_text* texts, int text_count) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, channel, OnError, OnWarning);
  png_infop info = png == nullptr ? nullptr : png_create_info_struct(png);
  if (info == nullptr || setjmp(png_jmpbuf(png))) {
    png_destroy_write_struct(&png, &info);
    return false;
  }
  png_set_write_fn(png, channel, OnWrite, OnFlush);
  png_set_compression_level(png, 6);
  png_set_IHDR(png, info, format.width, format.height, format.depth, format.color,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (text_count > 0) png_set_text(png, info, texts, text_count);
  png_write_info(png, info);
  if (format.depth == 16) png_set_swap(png);  // the file is big-endian
  for (int y = 0; y < format.height; ++y) png_write_row(png, pixels + row_bytes * y);
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  return true;
}

std::vector<uint8_t> Encode(Format format, const uint8_t* pixels, size_t row_bytes,
                            const PngTexts& texts = {}) {
  std::vector<uint8_t> bytes;
  Channel channel;
  channel.output = &bytes;
  std::vector<png_text> chunks;
  for (const auto& [keyword, text] : texts) {
    png_text chunk{};
    chunk.compression = PNG_TEXT_COMPRESSION_NONE;
    chunk.key = const_cast<char*>(keyword.c_str());
    chunk.text = const_cast<char*>(text.c_str());
    chunk.text_length = text.size();
    chunks.push_back(chunk);
  }
  if (!Encode(&channel, format, pixels, row_bytes, chunks.data(),
              static_cast<int>(chunks.size()))) {
    throw Error(fmt::format("cannot encode a PNG: {}", channel.message));
  }
  return bytes;
}

void RequirePixels(int width, int height, int channels, size_t values) {
  const bool fits = width > 0 && height > 0 && values == size_t{1} * width * height * channels;
  if (fits) return;
  throw ArgumentError(fmt::format("PNG of {}x{} px with {} per pixel needs {} values, got {}",
                                  width, height, Counted(channels, "value"),
                                  size_t{1} * width * height * channels, values));
}

// One decoder in two steps, so that the caller can allocate the pixels between them.
class Decoder {
 public:
  // Delegates, so that the destructor also runs when this constructor throws.
  Decoder(const std::filesystem::path& path, const std::string& file) : Decoder(path) {
    channel_.input = reinterpret_cast<const uint8_t*>(file.data());
    channel_.input_left = file.size();
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, &channel_, OnError, OnWarning);
    info_ = png_ == nullptr ? nullptr : png_create_info_struct(png_);
    if (info_ == nullptr) Fail("out of memory");
    if (!ReadHeader()) Fail(channel_.message);
  }
  ~Decoder() { png_destroy_read_struct(&png_, &info_, nullptr); }
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;

  Format format() const {
    return {static_cast<int>(png_get_image_width(png_, info_)),
            static_cast<int>(png_get_image_height(png_, info_)), png_get_bit_depth(png_, info_),
            png_get_color_type(png_, info_)};
  }

  // Rows lie `row_bytes` apart. With `to_rgb` every kind of image becomes 8-bit RGB.
  void ReadPixels(uint8_t* pixels, size_t row_bytes, bool to_rgb) {
    if (!Transform(to_rgb)) Fail(channel_.message);
    if (png_get_rowbytes(png_, info_) != row_bytes) Fail("its rows have an unexpected length");
    std::vector<uint8_t*> rows(png_get_image_height(png_, info_));
    for (size_t y = 0; y < rows.size(); ++y) rows[y] = pixels + row_bytes * y;
    if (!ReadRows(rows.data())) Fail(channel_.message);
  }

  void RequireAtMost(uint64_t pixels) const {
    const Format size = format();
    if (uint64_t{1} * size.width * size.height <= pixels) return;
    Fail(fmt::format("it has {}x{} pixels, and at most {} are read", size.width, size.height,
                     pixels));
  }
  // Reads the pixels for the texts behind them.
  PngTexts ReadTexts() {
    if (!Transform(false)) Fail(channel_.message);
    std::vector<uint8_t> row(png_get_rowbytes(png_, info_));
    if (!ReadToTheEnd(row.data(), static_cast<int>(png_get_image_height(png_, info_))))
      Fail(channel_.message);
    PngTexts texts;
    png_textp chunks = nullptr;
    const png_uint_32 count = png_get_text(png_, info_, &chunks, nullptr);
    for (png_uint_32 i = 0; i < count; ++i) texts[chunks[i].key] = chunks[i].text;
    return texts;
  }

  [[noreturn]] void Fail(const std::string& reason) const {
    throw IoError(fmt::format("PNG '{}': {}", path_.string(), reason));
  }

 private:
  explicit Decoder(const std::filesystem::path& path) : path_(path) {}

  bool ReadHeader() {
    if (setjmp(png_jmpbuf(png_))) return false;
    png_set_read_fn(png_, &channel_, OnRead);
    png_set_user_limits(png_, 1 << 16, 1 << 16);
    png_read_info(png_, info_);
    return true;
  }
  bool Transform(bool to_rgb) {
    if (setjmp(png_jmpbuf(png_))) return false;
    if (to_rgb) {
      png_set_expand(png_);
      png_set_strip_16(png_);
      png_set_strip_alpha(png_);
      png_set_gray_to_rgb(png_);
    } else {
      png_set_swap(png_);
    }
    passes_ = png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
    return true;
  }
  // Rows of interlaced files are read as often as they have passes.
  bool ReadToTheEnd(uint8_t* row, int height) {
    if (setjmp(png_jmpbuf(png_))) return false;
    for (int pass = 0; pass < passes_; ++pass) {
      for (int y = 0; y < height; ++y) png_read_row(png_, row, nullptr);
    }
    png_read_end(png_, info_);
    return true;
  }
  bool ReadRows(uint8_t** rows) {
    if (setjmp(png_jmpbuf(png_))) return false;
    png_read_image(png_, rows);
    png_read_end(png_, nullptr);
    return true;
  }

  const std::filesystem::path& path_;
  Channel channel_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  int passes_ = 1;
};

// Programs recognise a file by its ending: few of them open a PNG called .jpg.
void RequirePngName(const std::filesystem::path& path) {
  std::string suffix = path.extension().string();
  for (char& c : suffix) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (suffix == ".png") return;
  throw ArgumentError(
      fmt::format("pictures are written as PNG, under names that end in .png or "
                  ".PNG: give '{}' instead of '{}'",
                  std::filesystem::path(path).replace_extension(".png").string(), path.string()));
}

std::string_view AsText(const std::vector<uint8_t>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

std::vector<uint8_t> EncodePng(int width, int height, std::span<const uint8_t> rgb,
                               const PngTexts& texts) {
  RequirePixels(width, height, 3, rgb.size());
  return Encode({width, height, 8, PNG_COLOR_TYPE_RGB}, rgb.data(), size_t{3} * width, texts);
}

std::vector<uint8_t> EncodePng(int width, int height, std::span<const uint16_t> gray) {
  RequirePixels(width, height, 1, gray.size());
  return Encode({width, height, 16, PNG_COLOR_TYPE_GRAY},
                reinterpret_cast<const uint8_t*>(gray.data()), size_t{2} * width);
}

void WritePng(const std::filesystem::path& path, const RgbImage& image) {
  RequirePngName(path);
  AtomicWrite(path, AsText(EncodePng(image.width, image.height, image.pixels)));
}

void WritePng(const std::filesystem::path& path, const GrayImage16& image) {
  RequirePngName(path);
  AtomicWrite(path, AsText(EncodePng(image.width, image.height, image.pixels)));
}

RgbImage ReadPngRgb(const std::filesystem::path& path, uint64_t most_pixels) {
  const std::string file = internal::ReadRealFile(path, kMostFileBytes);
  Decoder decoder(path, file);
  decoder.RequireAtMost(most_pixels);
  const Format format = decoder.format();
  RgbImage image{format.width, format.height,
                 std::vector<uint8_t>(size_t{3} * format.width * format.height)};
  decoder.ReadPixels(image.pixels.data(), size_t{3} * format.width, true);
  return image;
}

PngTexts ReadPngTexts(const std::filesystem::path& path, uint64_t most_pixels) {
  const std::string file = internal::ReadRealFile(path, kMostFileBytes);
  Decoder decoder(path, file);
  decoder.RequireAtMost(most_pixels);
  return decoder.ReadTexts();
}

GrayImage16 ReadPngGray16(const std::filesystem::path& path) {
  const std::string file = internal::ReadRealFile(path, kMostFileBytes);
  Decoder decoder(path, file);
  const Format format = decoder.format();
  if (format.depth != 16 || format.color != PNG_COLOR_TYPE_GRAY) {
    decoder.Fail(fmt::format("expected 16-bit gray, the file has {} bits and colour type {}",
                             format.depth, format.color));
  }
  GrayImage16 image{format.width, format.height,
                    std::vector<uint16_t>(size_t{1} * format.width * format.height)};
  decoder.ReadPixels(reinterpret_cast<uint8_t*>(image.pixels.data()), size_t{2} * format.width,
                     false);
  return image;
}

}  // namespace robocell
