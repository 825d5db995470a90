#include "robocell/base/npz.h"

#include <zlib.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/rng.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

TEST(Npz, ReadsWhatItWrote) {
  const TempDir folder;
  Rng rng = Rng::Stream(1, "npz");
  std::vector<double> numbers;
  for (int i = 0; i < 3 * 4 * 4; ++i) numbers.push_back(rng.Normal());
  WriteNpz(folder / "a.npz", {{"poses", NpzArray::Numbers({3, 4, 4}, numbers)},
                              {"empty", NpzArray::Numbers({0, 4, 4}, {})},
                              {"words", NpzArray::Texts({"rim", "", "öffnen"})}});
  const NpzArrays read = ReadNpz(folder / "a.npz");
  ASSERT_EQ(read.size(), 3u);
  EXPECT_EQ(read.at("poses").shape, (std::vector<size_t>{3, 4, 4}));
  EXPECT_EQ(read.at("poses").numbers, numbers);
  EXPECT_EQ(read.at("empty").shape, (std::vector<size_t>{0, 4, 4}));
  EXPECT_EQ(read.at("words").texts, (std::vector<std::string>{"rim", "", "öffnen"}));
}

// Any damage is an IoError with the path, never a crash or other numbers.
TEST(Npz, DamagedFilesAreErrorsThatNameThePath) {
  const TempDir folder;
  WriteNpz(folder / "a.npz", {{"x", NpzArray::Numbers({2}, {1, 2})}});
  const std::string good = ReadFile(folder / "a.npz");
  int errors = 0;
  const auto check = [&](const std::string& bytes) {
    std::ofstream(folder / "b.npz", std::ios::binary) << bytes;
    try {
      for (const auto& [name, array] : ReadNpz(folder / "b.npz"))
        EXPECT_THAT(array.numbers, testing::AnyOf(testing::ElementsAre(1, 2), testing::IsEmpty()));
    } catch (const IoError& error) {
      ++errors;
      EXPECT_THAT(error.what(), testing::HasSubstr("b.npz"));
    }
  };
  for (size_t size = 0; size < good.size(); size += 7) check(good.substr(0, size));
  Rng rng = Rng::Stream(2, "damage");
  for (int i = 0; i < 300; ++i) {
    std::string bad = good;
    bad[rng.UniformInt(bad.size())] ^= static_cast<char>(1 << rng.UniformInt(8));
    check(bad);
  }
  EXPECT_GT(errors, 100);
}

// Returns an .npz file with an array x: the header's type and shape, and the bytes after it.
std::string FileWithArray(const TempDir& folder, const std::string& type, const std::string& shape,
                          size_t bytes) {
  // A written array is replaced by one of the same length, with its checksum.
  WriteNpz(folder / "w.npz",
           {{"x", NpzArray::Numbers({bytes / 8}, std::vector<double>(bytes / 8))}});
  std::string file = ReadFile(folder / "w.npz");
  const size_t begin = file.find("\x93NUMPY"), text = begin + 10, size = 118 + bytes;
  std::string header =
      "{'descr': '" + type + "', 'fortran_order': False, 'shape': " + shape + ", }";
  header.resize(117, ' ');
  file.replace(text, 118, header + "\n");
  const uLong sum =
      crc32(0, reinterpret_cast<const Bytef*>(file.data() + begin), static_cast<uInt>(10 + size));
  for (const size_t at : {size_t{14}, file.find("PK\x01\x02") + 16})
    for (int i = 0; i < 4; ++i) file[at + i] = static_cast<char>(sum >> (8 * i) & 0xff);
  return file;
}

// A small file asks for much memory: texts without width, and numbers of one byte each.
TEST(Npz, FilesThatWouldTakeMuchMemoryAreErrors) {
  const TempDir folder;
  const auto error_of = [&](const std::string& bytes) -> std::string {
    AtomicWrite(folder / "b.npz", bytes);
    try {
      ReadNpz(folder / "b.npz");
    } catch (const IoError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(error_of(FileWithArray(folder, "<f8", "(2,)", 16)), "");
  EXPECT_EQ(error_of(FileWithArray(folder, "|S2", "(8,)", 16)), "");
  for (const char* type : {"<U0", "|S0", ">U0"})
    for (const char* shape : {"(2000000000,)", "(1,)", "(0,)"})
      EXPECT_THAT(error_of(FileWithArray(folder, type, shape, 0)), testing::HasSubstr(type));
  EXPECT_THAT(error_of(FileWithArray(folder, "|S99999999999999999999", "(1,)", 16)),
              testing::HasSubstr("'x' has the type '|S99999999999999999999'"));
  // The file says that its array is 2 GB large, packed in a few bytes.
  std::string bomb = FileWithArray(folder, "<f8", "(2,)", 16);
  const size_t list = bomb.find("PK\x01\x02");
  bomb[list + 10] = 8;
  for (int i = 0; i < 4; ++i) bomb[list + 24 + i] = static_cast<char>(0x7f000000 >> (8 * i) & 0xff);
  EXPECT_THAT(error_of(bomb), testing::HasSubstr("cannot be unpacked"));
}

TEST(Npz, OnlyTheArraysThatAreAskedForAreRead) {
  const TempDir folder;
  const std::string bad = FileWithArray(folder, "|O", "(2,)", 16);  // Python objects
  AtomicWrite(folder / "b.npz", bad);
  EXPECT_THROW(ReadNpz(folder / "b.npz"), IoError);
  EXPECT_TRUE(ReadNpz(folder / "b.npz", {"transforms"}).empty());
  EXPECT_THAT(NpzNames(folder / "b.npz"), testing::ElementsAre("x"));
}

}  // namespace
}  // namespace robocell::internal
