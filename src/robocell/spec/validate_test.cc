#include "robocell/spec/validate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<std::string> Found(const std::function<void(Problems&)>& validate) {
  Problems problems;
  validate(problems);
  std::vector<std::string> lines;
  for (const Problem& problem : problems.list())
    lines.push_back((problem.path.empty() ? "" : problem.path + ": ") + problem.message);
  return lines;
}

std::vector<std::string> OfNumber(double value, Bound bound) {
  return Found([&](Problems& problems) { ValidateNumber(value, bound, problems); });
}

TEST(ValidateNumber, BoundsIncludeWhatTheySay) {
  EXPECT_THAT(OfNumber(-1e300, Bound::kNone), IsEmpty());
  EXPECT_THAT(OfNumber(0, Bound::kPositive), ElementsAre("0 must be greater than 0"));
  EXPECT_THAT(OfNumber(1e-300, Bound::kPositive), IsEmpty());
  EXPECT_THAT(OfNumber(-0.0, Bound::kNonNegative), IsEmpty());
  EXPECT_THAT(OfNumber(-1, Bound::kNonNegative), ElementsAre("-1 must not be negative"));
  EXPECT_THAT(OfNumber(0, Bound::kFraction), IsEmpty());
  EXPECT_THAT(OfNumber(1, Bound::kFraction), IsEmpty());
  EXPECT_THAT(OfNumber(1.01, Bound::kFraction), ElementsAre("1.01 must lie between 0 and 1"));
}

TEST(ValidateNumber, NumbersThatAreNotFiniteSayWhatToWrite) {
  for (const double value : {double(NAN), double(INFINITY), -double(INFINITY)}) {
    for (const Bound bound :
         {Bound::kNone, Bound::kPositive, Bound::kNonNegative, Bound::kFraction})
      EXPECT_THAT(OfNumber(value, bound), ElementsAre(HasSubstr("is not a finite number; write ")));
  }
}

TEST(ValidatePlacement, ARotationIsGivenOnceAndHasLengthOne) {
  const auto found = [](const Vec3& euler, const Vec4& quat) {
    return Found([&](Problems& problems) { ValidatePlacement(euler, quat, problems); });
  };
  const double half = std::sqrt(0.5);
  EXPECT_THAT(found({}, kIdentityQuat), IsEmpty());
  EXPECT_THAT(found({90, 0, 0}, kIdentityQuat), IsEmpty());
  EXPECT_THAT(found({}, {0, 0, half, half}), IsEmpty());
  EXPECT_THAT(found({90, 0, 0}, {0, 0, half, half}),
              ElementsAre("quat: both quat and euler are set; keep one of them"));
  EXPECT_THAT(found({}, {0, 0, 0, 2}), ElementsAre(HasSubstr("has length 2, a rotation needs 1")));
  EXPECT_THAT(found({}, {NAN, 0, 0, 1}), IsEmpty()) << "ValidateNumber reports it";
}

TEST(ValidateAttachTarget, OnlyElementsHaveNames) {
  const auto found = [](AttachTarget target) {
    return Found([&](Problems& problems) { ValidateAttachTarget(target, problems); });
  };
  EXPECT_THAT(found({.kind = AttachKind::kWorld}), IsEmpty());
  EXPECT_THAT(found({.kind = AttachKind::kSite, .name = "tip"}), IsEmpty());
  EXPECT_THAT(found({.kind = AttachKind::kSite}),
              ElementsAre("which site? Its name is missing; write {site: name}"));
  EXPECT_THAT(found({.kind = AttachKind::kWorld, .name = "desk"}),
              ElementsAre(HasSubstr("'world' is a separate frame and takes no name; 'desk'")));
}

TEST(ValidateElementRef, ANameOrAPlace) {
  const auto found = [](ElementRef ref) {
    return Found([&](Problems& problems) { ValidateElementRef(ref, problems); });
  };
  EXPECT_THAT(found({.name = "tip"}), IsEmpty());
  EXPECT_THAT(found({.body = "hand", .index = 2}), IsEmpty());
  EXPECT_THAT(found({}), ElementsAre(HasSubstr("names no element")));
  EXPECT_THAT(found({.name = "tip", .body = "hand"}), ElementsAre(HasSubstr("keep one of them")));
  EXPECT_THAT(found({.body = "hand", .index = -1}),
              ElementsAre("index -1 is negative; the first is 0"));
}

TEST(ValidateNames, PartsOfColumnsHaveNoSlash) {
  const auto found = [](const std::string& name) {
    return Found([&](Problems& problems) { ValidateNamePart(name, "name", problems); });
  };
  EXPECT_THAT(found("left_arm"), IsEmpty());
  EXPECT_THAT(found("greifer_größe"), IsEmpty());
  EXPECT_THAT(found("left/arm"), ElementsAre(HasSubstr("name: 'left/arm' cannot be a name here")));
  EXPECT_THAT(found("left\narm").size(), 1);
}

TEST(ValidateNames, ListsNameEachOnce) {
  const auto found = [](NameList names) {
    return Found([&](Problems& problems) { ValidateNameList(names, problems); });
  };
  EXPECT_THAT(found({"a", "b"}), IsEmpty());
  EXPECT_THAT(found({"a", "", "a"}), ElementsAre("holds an empty name", "'a' is listed twice"));
}

TEST(ValidateNames, SharedOnesNameBothEntries) {
  const auto found = [](const std::vector<std::string>& names, const char* what) {
    return Found([&](Problems& problems) { ValidateUnique(names, "robots", what, problems); });
  };
  EXPECT_THAT(found({"a", "b"}, "name"), IsEmpty());
  EXPECT_THAT(found({"a", "b", "a"}, "name"),
              ElementsAre(HasSubstr("robots[2]: name 'a' is also that of robots[0]")));
  EXPECT_THAT(found({"", ""}, "prefix"), ElementsAre(HasSubstr("`prefix: right_`")));
}

TEST(ValidateRange, TheSmallestComesFirst) {
  const auto found = [](Vec2 range) {
    return Found([&](Problems& problems) { ValidateRange(range, "height", problems); });
  };
  EXPECT_THAT(found({1, 1}), IsEmpty());
  EXPECT_THAT(found({2, 1}),
              ElementsAre("height: [2, 1] is [smallest, largest]; the first is larger"));
}

struct Wheel {
  double radius = 0.1;
  std::vector<double> spokes = {};
  static constexpr const char* kTypeName = "Wheel";
  template <class V>
  static void Fields(V&& v) {
    v("radius", &Wheel::radius, "", Bound::kPositive);
    v("spokes", &Wheel::spokes, "", Bound::kFraction);
  }
  void Validate(Problems& problems) const {
    if (spokes.size() == 1) problems.AddAt("spokes", "one spoke is not enough");
  }
};

TEST(RequireValid, ReportsFieldsAndTheWholeTogether) {
  RequireValid(Wheel(), "the wheel");
  const std::string message = ExpectThrow<SpecError>(
      [] { RequireValid(Wheel{.radius = -1, .spokes = {2}}, "the wheel"); }, "the wheel");
  EXPECT_THAT(message, HasSubstr("radius: -1 must be greater than 0"));
  EXPECT_THAT(message, HasSubstr("spokes[0]: 2 must lie between 0 and 1"));
  EXPECT_THAT(message, HasSubstr("one spoke is not enough"));
}

}  // namespace
}  // namespace robocell
