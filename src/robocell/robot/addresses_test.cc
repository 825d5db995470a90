#include "robocell/robot/addresses.h"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

namespace robocell {
namespace {

Addresses Of(const std::vector<int>& list) {
  Addresses addresses;
  for (const int first : list) addresses.Add(first);
  return addresses;
}

TEST(Addresses, GatherAndScatterInOrder) {
  std::vector<double> array(20);
  std::iota(array.begin(), array.end(), 0);
  for (const auto& list : std::vector<std::vector<int>>{
           {}, {7}, {3, 4, 5}, {3, 4, 5, 6, 7, 8, 9}, {5, 4, 3}, {1, 2, 9}, {2, 2}}) {
    const Addresses addresses = Of(list);
    ASSERT_EQ(addresses.list(), list);
    std::vector<double> out(list.size());
    addresses.Gather(array.data(), out);
    EXPECT_EQ(out, std::vector<double>(list.begin(), list.end()));
    std::vector<double> written(20, -1), expected = written;
    for (size_t i = 0; i < list.size(); ++i) expected[list[i]] = out[i] = 100.0 + list[i];
    addresses.Scatter(out, written.data());
    EXPECT_EQ(written, expected);
  }
}

TEST(Addresses, AreContiguousIfConsecutive) {
  const double array[20] = {};
  EXPECT_EQ(Of({3, 4, 5}).InARow(array), array + 3);
  EXPECT_EQ(Of({0}).InARow(array), array);
  for (const auto& list : std::vector<std::vector<int>>{{}, {3, 5}, {4, 3}})
    EXPECT_EQ(Of(list).InARow(array), nullptr);
  Addresses again = Of({9, 3});
  again.clear();
  again.Add(2, 7);
  EXPECT_EQ(again.InARow(array), array + 2);
  EXPECT_EQ(again.size(), 7u);
}

}  // namespace
}  // namespace robocell
