#include "robocell/spec/render_quality.h"

#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

TEST(RenderQuality, EachNameCostsMoreThanTheOneBefore) {
  RenderQuality last = NamedQuality(RenderQualities().front());
  EXPECT_EQ(last, RenderQuality()) << "the first has no effects";
  for (size_t i = 1; i < RenderQualities().size(); ++i) {
    const RenderQuality next = NamedQuality(RenderQualities()[i]);
    EXPECT_TRUE(next.shadows);
    EXPECT_GT(next.multisamples, last.multisamples);
    EXPECT_GE(next.reflections, last.reflections);
    last = next;
  }
}

TEST(RenderQuality, SuggestsTheNearestName) {
  ExpectThrow<NotFoundError>([] { NamedQuality("standart"); }, "Did you mean 'standard'?");
}

}  // namespace
}  // namespace robocell
