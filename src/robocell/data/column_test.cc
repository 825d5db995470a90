#include "robocell/data/column.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <set>
#include <string_view>

namespace robocell {
namespace {

template <class T>
void ExpectHolds(std::string_view numpys_name) {
  EXPECT_EQ(SizeOf(ColumnTypeOf<T>()), sizeof(T)) << numpys_name;
  EXPECT_EQ(NameOf(ColumnTypeOf<T>()), numpys_name);
}

TEST(Column, TypesHaveTheSizeOfTheirValuesAndNumpysNames) {
  ExpectHolds<double>("float64");
  ExpectHolds<float>("float32");
  ExpectHolds<int64_t>("int64");
  ExpectHolds<int32_t>("int32");
  ExpectHolds<uint8_t>("uint8");
  ExpectHolds<bool>("bool");
}

TEST(Column, ARowHasTheProductOfItsShape) {
  EXPECT_EQ(RowValues({}), 1) << "a number";
  EXPECT_EQ(RowValues({7}), 7);
  EXPECT_EQ(RowValues({4, 4}), 16);
  EXPECT_EQ(RowValues({3, 0, 5}), 0);
  EXPECT_EQ(RowValues({1 << 20, 1 << 20}), int64_t{1} << 40) << "more than 32 bits";
}

TEST(Column, ShapesAreWrittenInParentheses) {
  EXPECT_EQ(ShapeText({}), "()");
  EXPECT_EQ(ShapeText({7}), "(7)");
  EXPECT_EQ(ShapeText({480, 640, 3}), "(480, 640, 3)");
}

}  // namespace
}  // namespace robocell
