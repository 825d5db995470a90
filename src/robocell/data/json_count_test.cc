#include "robocell/data/json_count.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace robocell {
namespace {

using Json = nlohmann::ordered_json;

TEST(JsonCount, TakesWholeNumbersOfItsRangeOnly) {
  EXPECT_EQ(JsonCount<int>(Json::parse("0")), 0);
  EXPECT_EQ(JsonCount<int>(Json::parse("2147483647")), 2147483647);
  EXPECT_EQ(JsonCount<uint64_t>(Json::parse("18446744073709551615")), ~uint64_t{0});
  for (const char* text : {"2147483648", "-1", "1.0", "5.3e81", "\"1\"", "null", "[1]"})
    EXPECT_THROW(JsonCount<int>(Json::parse(text)), nlohmann::json::exception) << text;
}

}  // namespace
}  // namespace robocell
