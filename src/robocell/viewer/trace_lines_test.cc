#include "robocell/viewer/trace_lines.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "robocell/base/error.h"

namespace robocell {
namespace {

TEST(TraceLines, APathKeepsItsLastSeconds) {
  TraceLines traces;
  traces.set_length(1);
  for (int i = 0; i <= 300; ++i) traces.Extend("tip", 0.01 * i, {0.01 * i, 0, 0});
  const auto& path = traces.paths().at("tip");
  EXPECT_NEAR(path.front().time, 2, 0.02);
  EXPECT_EQ(path.back().time, 3);
  traces.Extend("tip", 0.5, {0, 0, 0});  // after a reset
  EXPECT_EQ(path.size(), 1u);
}

TEST(TraceLines, APointAtRestAddsNothing) {
  TraceLines traces;
  for (int i = 0; i < 100; ++i) traces.Extend("tip", i, {1, 2, 3});
  traces.Extend("tip", 101, {std::numeric_limits<double>::quiet_NaN(), 0, 0});
  EXPECT_EQ(traces.paths().at("tip").size(), 1u);
  traces.Drop("tip");
  EXPECT_TRUE(traces.paths().empty());
}

TEST(TraceLines, KeepsTheNewestSegments) {
  TraceLines traces;
  for (size_t i = 0; i < TraceLines::kMostSegments + 10; ++i)
    traces.AddSegment({static_cast<double>(i), 0, 0}, {0, 0, 1});
  EXPECT_EQ(traces.segments().size(), TraceLines::kMostSegments);
  EXPECT_EQ(traces.segments().front().from.x(), 10);
  traces.Clear();
  EXPECT_TRUE(traces.segments().empty());
}

TEST(TraceLines, RefusesWhatIsNotFinite) {
  TraceLines traces;
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(traces.set_length(kNan), ArgumentError);
  EXPECT_THROW(traces.set_length(-1), ArgumentError);
  EXPECT_THROW(traces.AddSegment({kNan, 0, 0}, {0, 0, 1}), ArgumentError);
  EXPECT_THROW(traces.AddSegment({0, 0, 0}, {0, 0, 1}, {std::nanf(""), 0, 0, 1}), ArgumentError);
  EXPECT_TRUE(traces.segments().empty());
  EXPECT_EQ(traces.length(), 5);
}

}  // namespace
}  // namespace robocell
