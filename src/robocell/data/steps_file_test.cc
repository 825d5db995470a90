#include "robocell/data/steps_file.h"

#include <gtest/gtest.h>

#include <fstream>

#include "robocell/base/error.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

struct TwoColumns {
  EpisodeSchema schema;
  ColumnId q = schema.AddColumn({.name = "q", .shape = {3}});
  ColumnId done = schema.AddColumn({.name = "done", .type = ColumnType::kBool});

  void PutRow(StepsFile& file, double value) const {
    const std::vector<double> numbers(3, value);
    const bool flag = value > 2;
    file.Put(q, ColumnType::kFloat64, std::as_bytes(std::span(numbers)));
    file.Put(done, ColumnType::kBool, std::as_bytes(std::span(&flag, 1)));
    file.EndRow(kStepsTable);
  }
};

TEST(StepsFile, ReadsBackTheWrittenRows) {
  TempDir folder;
  const TwoColumns two;
  StepsFile file(folder / "steps.h5", "episode 'e'", two.schema);
  for (int row = 0; row < 1000; ++row) two.PutRow(file, row);
  EXPECT_EQ(file.rows(kStepsTable), 1000);
  file.Close();
  file.VerifyContent();
  const auto read = hdf5::File::OpenReadOnly(folder / "steps.h5");
  const hdf5::H5Dataset q = read.Open("q");
  EXPECT_EQ(q.shape(), (std::vector<int64_t>{1000, 3}));
  std::vector<double> row(3);
  q.ReadRows(999, 1, std::as_writable_bytes(std::span(row)));
  EXPECT_EQ(row, std::vector<double>(3, 999));
}

TEST(StepsFile, RejectsIncompleteRowsByName) {
  TempDir folder;
  const TwoColumns two;
  StepsFile file(folder / "steps.h5", "episode 'e'", two.schema);
  const std::vector<double> numbers(3);
  const auto bytes = std::as_bytes(std::span(numbers));
  file.Put(two.q, ColumnType::kFloat64, bytes);
  ExpectThrow<ArgumentError>([&] { file.EndRow(kStepsTable); }, "done");
  ExpectThrow<ArgumentError>([&] { file.Put(two.q, ColumnType::kFloat64, bytes); }, "q");
  ExpectThrow<ArgumentError>([&] { file.Put(two.done, ColumnType::kFloat64, bytes); }, "done");
  ExpectThrow<ArgumentError>([&] { file.Close(); }, "episode 'e'");
}

TEST(StepsFile, AChangedByteIsFound) {
  TempDir folder;
  const TwoColumns two;
  StepsFile file(folder / "steps.h5", "episode 'e'", two.schema);
  for (int row = 0; row < 10; ++row) two.PutRow(file, 3.25);
  file.Close();
  const auto path = folder / "steps.h5";
  std::fstream bytes(path, std::ios::in | std::ios::out | std::ios::binary);
  const std::string whole((std::istreambuf_iterator<char>(bytes)),
                          std::istreambuf_iterator<char>());
  const double value = 3.25;
  const size_t at = whole.find(std::string_view(reinterpret_cast<const char*>(&value), 8));
  ASSERT_NE(at, std::string::npos);
  bytes.clear();
  bytes.seekp(static_cast<std::streamoff>(at));
  bytes.put('\x7f');
  bytes.close();
  ExpectThrow<IoError>([&] { file.VerifyContent(); }, "episode 'e'");
}

}  // namespace
}  // namespace robocell::internal
