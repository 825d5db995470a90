#include "robocell/base/npz.h"

#include <zlib.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <string_view>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/files.h"

namespace robocell::internal {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kMostBytes = 2ULL << 30;
constexpr uint64_t kMostInflation = 1100;  // deflate makes data at most 1032 times smaller
constexpr size_t kMostWidth = 1 << 20;     // bytes of a text
constexpr uint32_t kLocal = 0x04034b50, kCentral = 0x02014b50, kEnd = 0x06054b50;
constexpr size_t kLocalSize = 30, kCentralSize = 46, kEndSize = 22;
constexpr uint32_t kIn64 = 0xffffffff;  // the real number is in the zip64 field
constexpr std::string_view kMagic = "\x93NUMPY";

class Fault {
 public:
  explicit Fault(const fs::path& path) : path_(path) {}
  [[noreturn]] void Throw(const std::string& what) const {
    throw IoError(fmt::format("{}: {}", path_.string(), what));
  }
  void Require(bool ok, const char* what) const {
    if (!ok) Throw(fmt::format("damaged, or no .npz file: {}", what));
  }

 private:
  const fs::path& path_;
};

template <class T>
T Little(std::string_view bytes, size_t at) {
  T value = 0;
  for (size_t i = 0; i < sizeof(T); ++i)
    value |= static_cast<T>(static_cast<unsigned char>(bytes[at + i])) << (8 * i);
  return value;
}

template <class T>
void PutLittle(T value, std::string* out) {
  for (size_t i = 0; i < sizeof(T); ++i) out->push_back(static_cast<char>(value >> (8 * i) & 0xff));
}

std::string Inflate(std::string_view packed, size_t size, const Fault& fault) {
  // No memory is set aside for what the packed bytes cannot contain.
  fault.Require(size <= kMostInflation * (packed.size() + 1), "an array cannot be unpacked");
  std::string out(size, '\0');
  z_stream stream = {};
  fault.Require(inflateInit2(&stream, -MAX_WBITS) == Z_OK, "it cannot be unpacked");
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(size);
  const int end = inflate(&stream, Z_FINISH);
  const bool whole = end == Z_STREAM_END && stream.total_out == size;
  inflateEnd(&stream);
  fault.Require(whole, "an array cannot be unpacked");
  return out;
}

// Returns the names of the arrays of a zip archive, with the .npy files of those that are wanted.
std::map<std::string, std::string> Unzip(const fs::path& path,
                                         const std::function<bool(const std::string&)>& wanted) {
  constexpr std::string_view kSuffix = ".npy";
  const Fault fault(path);
  const std::string all = ReadFile(path);
  fault.Require(all.size() >= kEndSize, "it is too short");
  fault.Require(all.size() < kMostBytes, "it is too large");
  size_t end = all.size() - kEndSize;
  const size_t least = end > 0xffff ? end - 0xffff : 0;  // a comment may follow
  while (end > least && Little<uint32_t>(all, end) != kEnd) --end;
  fault.Require(Little<uint32_t>(all, end) == kEnd, "the list of its arrays is missing");
  const size_t count = Little<uint16_t>(all, end + 10);
  size_t at = Little<uint32_t>(all, end + 16);
  uint64_t total = 0;
  std::map<std::string, std::string> files;
  for (size_t i = 0; i < count; ++i) {
    fault.Require(at + kCentralSize <= all.size() && Little<uint32_t>(all, at) == kCentral,
                  "the list of its arrays is cut off");
    const auto method = Little<uint16_t>(all, at + 10);
    const auto checksum = Little<uint32_t>(all, at + 16);
    const auto packed = Little<uint32_t>(all, at + 20), size = Little<uint32_t>(all, at + 24);
    const size_t name_size = Little<uint16_t>(all, at + 28), extra = Little<uint16_t>(all, at + 30),
                 comment = Little<uint16_t>(all, at + 32);
    const size_t local = Little<uint32_t>(all, at + 42);
    fault.Require(at + kCentralSize + name_size <= all.size(), "the name of an array is cut off");
    std::string name = all.substr(at + kCentralSize, name_size);
    at += kCentralSize + name_size + extra + comment;
    if (!name.ends_with(kSuffix)) continue;
    name.resize(name.size() - kSuffix.size());
    std::string& content = files[name];
    if (!wanted(name)) continue;
    fault.Require(packed != kIn64 && size != kIn64, "an array is larger than 4 GiB");
    total += size;
    if (total > kMostBytes) fault.Throw("its arrays are larger than 2 GiB when unpacked");
    fault.Require(local + kLocalSize <= all.size() && Little<uint32_t>(all, local) == kLocal,
                  "an array is missing");
    const size_t begin =
        local + kLocalSize + Little<uint16_t>(all, local + 26) + Little<uint16_t>(all, local + 28);
    fault.Require(begin + packed <= all.size(), "an array is cut off");
    const std::string_view bytes = std::string_view(all).substr(begin, packed);
    if (method != 0 && method != 8)
      fault.Throw(
          fmt::format("'{}' is packed by method {}, which is not read; write the file again "
                      "with numpy.savez_compressed",
                      name, method));
    fault.Require(method != 0 || packed == size, "the sizes of an array differ");
    content = method == 0 ? std::string(bytes) : Inflate(bytes, size, fault);
    const auto sum =
        crc32(0, reinterpret_cast<const Bytef*>(content.data()), static_cast<uInt>(content.size()));
    fault.Require(sum == checksum, "the checksum of an array is wrong");
  }
  return files;
}

struct Header {
  std::string type;
  bool fortran = false;
  std::vector<size_t> shape;
};

// Parses "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 4, 4), }".
Header ParseHeader(std::string_view text, const Fault& fault) {
  const auto after = [&](std::string_view key) {
    const size_t at = text.find(key);
    fault.Require(at != std::string_view::npos, "the header of an array is incomplete");
    return text.substr(at + key.size());
  };
  Header header;
  std::string_view type = after("'descr':");
  const size_t open = type.find_first_not_of(' ');
  fault.Require(open != std::string_view::npos, "the header of an array is incomplete");
  if (type[open] != '\'') fault.Throw("an array has fields; only plain numbers and texts are read");
  type.remove_prefix(open + 1);
  header.type = type.substr(0, type.find('\''));
  header.fortran = after("'fortran_order':").substr(0, 6).find("True") != std::string_view::npos;
  std::string_view shape = after("'shape':");
  const size_t begin = shape.find('('), close = shape.find(')');
  fault.Require(begin != std::string_view::npos && close != std::string_view::npos && begin < close,
                "the shape of an array is missing");
  shape = shape.substr(begin + 1, close - begin - 1);
  uint64_t product = 1;
  for (size_t i = 0; i < shape.size();) {
    if (std::isdigit(static_cast<unsigned char>(shape[i])) == 0) {
      ++i;
      continue;
    }
    uint64_t value = 0;
    for (; i < shape.size() && std::isdigit(static_cast<unsigned char>(shape[i])) != 0; ++i) {
      value = value * 10 + static_cast<uint64_t>(shape[i] - '0');
      fault.Require(value < kMostBytes, "the shape of an array is too large");
    }
    header.shape.push_back(value);
    product *= std::max<uint64_t>(value, 1);
    fault.Require(product < kMostBytes, "the shape of an array is too large");
  }
  return header;
}

double Half(uint16_t bits) {
  const int exponent = bits >> 10 & 31, fraction = bits & 1023;
  const double sign = bits >> 15 ? -1 : 1;
  if (exponent == 31)
    return fraction ? std::numeric_limits<double>::quiet_NaN()
                    : sign * std::numeric_limits<double>::infinity();
  return sign * (exponent ? std::ldexp(1024 + fraction, exponent - 25) : std::ldexp(fraction, -24));
}

double NumberOf(char kind, std::string bytes, bool big) {
  if (big) std::ranges::reverse(bytes);
  const auto as = [&]<class T>(T value) {
    std::memcpy(&value, bytes.data(), sizeof(T));
    return value;
  };
  const size_t size = bytes.size();
  if (kind == 'f' && size == 2) return Half(as(uint16_t{}));
  if (kind == 'f') return size == 4 ? as(float{}) : as(double{});
  if (kind == 'i') {
    if (size == 1) return as(int8_t{});
    if (size == 2) return as(int16_t{});
    return size == 4 ? as(int32_t{}) : static_cast<double>(as(int64_t{}));
  }
  if (size == 1) return as(uint8_t{});
  if (size == 2) return as(uint16_t{});
  return size == 4 ? as(uint32_t{}) : static_cast<double>(as(uint64_t{}));
}

void AppendUtf8(uint32_t code, std::string* out) {
  if (code < 0x80) {
    out->push_back(static_cast<char>(code));
    return;
  }
  const int more = code < 0x800 ? 1 : code < 0x10000 ? 2 : 3;
  out->push_back(static_cast<char>((0xff00 >> (more + 1) & 0xff) | code >> (6 * more)));
  for (int i = more - 1; i >= 0; --i)
    out->push_back(static_cast<char>(0x80 | (code >> (6 * i) & 0x3f)));
}

std::string TextOf(const std::string& bytes, bool wide, bool big) {
  std::string text;
  if (!wide) return bytes.substr(0, bytes.find('\0'));
  for (size_t i = 0; i + 4 <= bytes.size(); i += 4) {
    std::string unit = bytes.substr(i, 4);
    if (big) std::ranges::reverse(unit);
    const auto code = Little<uint32_t>(unit, 0);
    if (code == 0) break;
    AppendUtf8(code, &text);
  }
  return text;
}

// Returns the index in memory of each element in C order.
size_t PlaceOf(size_t index, const Header& header) {
  if (!header.fortran) return index;
  size_t place = 0, stride = 1;
  std::vector<size_t> at(header.shape.size());
  for (size_t i = header.shape.size(); i-- > 0; index /= header.shape[i])
    at[i] = index % header.shape[i];
  for (size_t i = 0; i < at.size(); stride *= header.shape[i], ++i) place += at[i] * stride;
  return place;
}

// Subtracts the memory of the array from `bytes_left`.
NpzArray ParseArray(const std::string& name, const std::string& file, const Fault& fault,
                    uint64_t* bytes_left) {
  fault.Require(file.size() >= 12 && file.starts_with(kMagic), "an array has no header");
  const bool small = file[6] == 1;
  const size_t begin = small ? 10 : 12;
  const size_t size = small ? Little<uint16_t>(file, 8) : Little<uint32_t>(file, 8);
  fault.Require(begin + size <= file.size(), "the header of an array is cut off");
  const Header header = ParseHeader(std::string_view(file).substr(begin, size), fault);
  const char kind = header.type.size() > 1 ? header.type[1] : '?';
  size_t width = 0;
  for (size_t i = 2; i < header.type.size() && width < kMostWidth; ++i)
    width = width * 10 + static_cast<size_t>(header.type[i] - '0');
  if (kind == 'U') width *= 4;
  const bool number = std::string_view("fiub").find(kind) != std::string_view::npos;
  const bool known = (number && (width == 1 || width == 2 || width == 4 || width == 8) &&
                      !(kind == 'f' && width == 1)) ||
                     ((kind == 'U' || kind == 'S') && width > 0 && width < kMostWidth);
  if (!known) {
    fault.Throw(fmt::format("array '{}' has the type '{}'{}; numbers, bools and texts are read",
                            name, header.type, kind == 'O' ? " (Python objects)" : ""));
  }
  size_t count = 1;
  for (const size_t n : header.shape) count *= n;
  fault.Require(file.size() - begin - size == count * width, "the size of an array is wrong");
  const uint64_t each = number ? sizeof(double) : sizeof(std::string) + width;
  if (count > *bytes_left / each)
    fault.Throw(
        fmt::format("array '{}' takes more than 2 GiB of memory with those before it", name));
  *bytes_left -= count * each;
  const bool big = header.type[0] == '>';
  NpzArray array{.shape = header.shape};
  for (size_t i = 0; i < count; ++i) {
    const std::string bytes = file.substr(begin + size + PlaceOf(i, header) * width, width);
    if (number) {
      array.numbers.push_back(NumberOf(kind, bytes, big));
    } else {
      array.texts.push_back(TextOf(bytes, kind == 'U', big));
    }
  }
  return array;
}

// Returns the code points of UTF-8; bytes that are no UTF-8 stand for themselves.
std::vector<uint32_t> CodePoints(std::string_view text) {
  std::vector<uint32_t> codes;
  for (size_t i = 0; i < text.size();) {
    const auto first = static_cast<unsigned char>(text[i]);
    const int more = first < 0xc0 ? 0 : first < 0xe0 ? 1 : first < 0xf0 ? 2 : 3;
    uint32_t code = more == 0 ? first : first & (0x3f >> more);
    for (int k = 1; k <= more && i + k < text.size(); ++k)
      code = code << 6 | (static_cast<unsigned char>(text[i + k]) & 0x3f);
    codes.push_back(code);
    i += static_cast<size_t>(more) + 1;
  }
  return codes;
}

std::string FileOf(const NpzArray& array) {
  const bool texts = !array.texts.empty();
  size_t longest = 1;
  std::vector<std::vector<uint32_t>> codes;
  for (const std::string& text : array.texts)
    longest = std::max(longest, codes.emplace_back(CodePoints(text)).size());
  std::string shape = fmt::format("{}", fmt::join(array.shape, ", "));
  if (array.shape.size() == 1) shape += ",";
  std::string header = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}), }}",
                                   texts ? fmt::format("<U{}", longest) : "<f8", shape);
  constexpr size_t kAlign = 64;
  header.append((kAlign - (10 + header.size() + 1) % kAlign) % kAlign, ' ');
  header += '\n';
  std::string file(kMagic);
  file += std::string("\x01\x00", 2);
  PutLittle(static_cast<uint16_t>(header.size()), &file);
  file += header;
  for (const double number : array.numbers) PutLittle(std::bit_cast<uint64_t>(number), &file);
  for (std::vector<uint32_t>& text : codes) {
    text.resize(longest, 0);
    for (const uint32_t code : text) PutLittle(code, &file);
  }
  return file;
}

}  // namespace

NpzArray NpzArray::Numbers(std::vector<size_t> shape, std::vector<double> numbers) {
  return {.shape = std::move(shape), .numbers = std::move(numbers)};
}

NpzArray NpzArray::Texts(std::vector<std::string> texts) {
  NpzArray array{.shape = {texts.size()}};
  array.texts = std::move(texts);
  return array;
}

NpzArrays ReadNpz(const fs::path& path, const std::set<std::string>& names) {
  const auto wanted = [&](const std::string& name) {
    return names.empty() || names.contains(name);
  };
  const Fault fault(path);
  uint64_t bytes_left = kMostBytes;
  NpzArrays arrays;
  for (const auto& [name, file] : Unzip(path, wanted))
    if (wanted(name)) arrays[name] = ParseArray(name, file, fault, &bytes_left);
  return arrays;
}

std::set<std::string> NpzNames(const fs::path& path) {
  std::set<std::string> names;
  for (const auto& [name, file] : Unzip(path, [](const std::string&) { return false; }))
    names.insert(name);
  return names;
}

void WriteNpz(const fs::path& path, const NpzArrays& arrays) {
  std::string all, central;
  for (const auto& [name, array] : arrays) {
    const std::string file = FileOf(array), entry = name + ".npy";
    std::string common;  // of the local header and of the list
    PutLittle<uint16_t>(20, &common);
    PutLittle<uint16_t>(0, &common);
    PutLittle<uint16_t>(0, &common);  // stored
    PutLittle<uint16_t>(0, &common);
    PutLittle<uint16_t>(0x21, &common);  // 1980-01-01
    PutLittle(static_cast<uint32_t>(crc32(0, reinterpret_cast<const Bytef*>(file.data()),
                                          static_cast<uInt>(file.size()))),
              &common);
    PutLittle(static_cast<uint32_t>(file.size()), &common);
    PutLittle(static_cast<uint32_t>(file.size()), &common);
    PutLittle(static_cast<uint16_t>(entry.size()), &common);
    PutLittle<uint16_t>(0, &common);
    PutLittle(kCentral, &central);
    PutLittle<uint16_t>(20, &central);
    central += common;
    central.append(10, '\0');
    PutLittle(static_cast<uint32_t>(all.size()), &central);
    central += entry;
    PutLittle(kLocal, &all);
    all.append(common).append(entry).append(file);
  }
  const size_t start = all.size();
  all += central;
  PutLittle(kEnd, &all);
  PutLittle<uint32_t>(0, &all);
  PutLittle(static_cast<uint16_t>(arrays.size()), &all);
  PutLittle(static_cast<uint16_t>(arrays.size()), &all);
  PutLittle(static_cast<uint32_t>(central.size()), &all);
  PutLittle(static_cast<uint32_t>(start), &all);
  PutLittle<uint16_t>(0, &all);
  AtomicWrite(path, all);
}

}  // namespace robocell::internal
