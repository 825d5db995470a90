#include "robocell/data/hdf5.h"

#include <gtest/gtest.h>

#include <numeric>
#include <string>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

std::vector<double> Numbers(int count) {
  std::vector<double> numbers(count);
  std::iota(numbers.begin(), numbers.end(), 0.5);
  return numbers;
}

// Seven rows of two numbers, three rows to a chunk.
void WriteRows(const std::filesystem::path& path) {
  hdf5::File file = hdf5::File::Create(path);
  hdf5::H5Dataset rows = file.CreateExtendible("a/b/rows", ColumnType::kFloat64, {2}, 3);
  const std::vector<double> numbers = Numbers(18);  // whole chunks
  const auto bytes = std::as_bytes(std::span(numbers));
  const size_t chunk = 3 * rows.row_bytes();
  rows.AppendChunk(3, bytes.subspan(0, chunk));
  rows.AppendChunk(3, bytes.subspan(chunk, chunk));
  rows.AppendChunk(1, bytes.subspan(2 * chunk, chunk));
  rows.SetText("units", "rad");
  rows.SetTexts("names", {"shoulder", "elbow"});
  rows.Close();
  file.SetInteger("/", "version", 3);
  file.SetText("a", "kind", "arm");
  file.Close();
}

TEST(Hdf5, RowsAndAttributesRoundTrip) {
  TempDir folder;
  WriteRows(folder / "f.h5");
  const hdf5::File file = hdf5::File::OpenReadOnly(folder / "f.h5");
  EXPECT_EQ(file.DatasetNames(), std::vector<std::string>{"a/b/rows"});
  EXPECT_EQ(file.Integer("/", "version"), 3);
  EXPECT_EQ(file.Text("a", "kind"), "arm");
  const hdf5::H5Dataset rows = file.Open("a/b/rows");
  EXPECT_EQ(rows.type(), ColumnType::kFloat64);
  EXPECT_EQ(rows.shape(), (std::vector<int64_t>{7, 2}));
  EXPECT_EQ(rows.Text("units"), "rad");
  EXPECT_EQ(rows.Texts("names"), (std::vector<std::string>{"shoulder", "elbow"}));
  EXPECT_EQ(rows.Text("none"), "");
  std::vector<double> all(14);
  rows.ReadAll(std::as_writable_bytes(std::span(all)));
  EXPECT_EQ(all, Numbers(14));
  std::vector<double> some(4);
  rows.ReadRows(2, 2, std::as_writable_bytes(std::span(some)));
  EXPECT_EQ(some, (std::vector<double>{4.5, 5.5, 6.5, 7.5})) << "from two chunks";
}

TEST(Hdf5, TheSameCallsGiveTheSameBytes) {
  TempDir folder;
  WriteRows(folder / "a.h5");
  WriteRows(folder / "b.h5");
  EXPECT_EQ(ReadFile(folder / "a.h5"), ReadFile(folder / "b.h5"));
}

TEST(Hdf5, BytesAreOpenedWhateverHasTheirName) {
  TempDir folder;
  WriteRows(folder / "f.h5");
  const std::string bytes = ReadFile(folder / "f.h5");
  std::string other = bytes;
  other.replace(other.find("elbow"), 5, "wrist");
  const hdf5::File one = hdf5::File::OpenBytes(bytes, folder / "f.h5");
  const hdf5::File two = hdf5::File::OpenBytes(other, folder / "f.h5");
  EXPECT_EQ(one.Open("a/b/rows").Texts("names").at(1), "elbow");
  EXPECT_EQ(two.Open("a/b/rows").Texts("names").at(1), "wrist");
  ExpectThrow<IoError>([&] { hdf5::File::OpenBytes("no HDF5", folder / "f.h5"); }, "f.h5'");
}

TEST(Hdf5, ErrorsNameTheFile) {
  TempDir folder;
  WriteRows(folder / "f.h5");
  ExpectThrow<IoError>([&] { hdf5::File::Create(folder / "f.h5"); }, "f.h5");
  ExpectThrow<IoError>([&] { hdf5::File::OpenReadOnly(folder / "none.h5"); }, "none.h5");
  const hdf5::File file = hdf5::File::OpenReadOnly(folder / "f.h5");
  ExpectThrow<IoError>([&] { file.Open("a/b/none"); }, "f.h5");
  AtomicWrite(folder / "text.h5", "no file of HDF5");
  ExpectThrow<IoError>([&] { hdf5::File::OpenReadOnly(folder / "text.h5"); }, "text.h5");
}

}  // namespace
}  // namespace robocell::internal
