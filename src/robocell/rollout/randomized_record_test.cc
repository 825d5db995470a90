#include "robocell/rollout/randomized_record.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace robocell::internal {
namespace {

TEST(RandomizedRecord, ValuesAreNumbersListsAndWords) {
  const RandomizedValues values = {{"light/0/intensity", {.numbers = {0.4}}},
                                   {"cube/colour", {.numbers = {1, 0, 0.5}}},
                                   {"table/texture", {.numbers = {}, .word = "wood"}}};
  EXPECT_EQ(RandomizedRecord(values), (nlohmann::json{{"light/0/intensity", 0.4},
                                                      {"cube/colour", {1.0, 0.0, 0.5}},
                                                      {"table/texture", "wood"}}));
}

}  // namespace
}  // namespace robocell::internal
