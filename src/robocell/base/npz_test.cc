#include "robocell/base/npz.h"

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

}  // namespace
}  // namespace robocell::internal
