#include "robocell/scenes/houses/furniture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>

namespace robocell::internal {
namespace {

constexpr double kHandle = 0.06;  // metres in front of a piece

// Calls f(part, its middle in the piece) for all parts, with doors and drawers closed.
void ForEachPart(const HouseBody& body, const Eigen::Vector3d& at,
                 const std::function<void(const HousePart&, const Eigen::Vector3d&)>& f) {
  for (const HousePart& part : body.parts) f(part, at + part.pos);
  for (const HouseBody& child : body.children) ForEachPart(child, at + child.pos, f);
}

TEST(Furniture, FillsItsSizeAndNoMore) {
  for (const std::string& kind : FurnitureKinds()) {
    Rng rng = Rng::Stream(1, kind);
    const HouseThing thing = MakeFurniture(kind, rng);
    EXPECT_EQ(thing.category, kind);
    double top = 0;
    ForEachPart(thing.body, {0, 0, 0}, [&](const HousePart& part, const Eigen::Vector3d& middle) {
      if (part.shape != PartShape::kBox) return;
      EXPECT_LE(std::abs(middle.x()) + part.half.x(), thing.size.x() / 2 + 1e-6)
          << kind << part.name;
      EXPECT_GE(middle.y() - part.half.y(), -thing.size.y() / 2 - 1e-6) << kind << part.name;
      EXPECT_LE(middle.y() + part.half.y(), thing.size.y() / 2 + kHandle) << kind << part.name;
      EXPECT_GE(middle.z() - part.half.z(), -1e-6) << kind << part.name;
      top = std::max(top, middle.z() + part.half.z());
    });
    EXPECT_NEAR(top, thing.size.z(), 0.12) << kind;
  }
}

TEST(Furniture, JointsOpenToTheFrontAndHaveHandles) {
  int joints = 0;
  const std::function<void(const HouseBody&)> check = [&](const HouseBody& body) {
    if (body.joint) {
      ++joints;
      EXPECT_GT(body.joint->range, 0.1) << body.name;
      bool has_handle = false;
      Eigen::Vector3d handle = Eigen::Vector3d::Zero();
      for (const HousePart& part : body.parts) {
        if (part.name.find("handle") == std::string::npos) continue;
        has_handle = true;
        handle = part.pos;
      }
      EXPECT_TRUE(has_handle) << body.name;
      // A small opening moves the handle to the front.
      const Eigen::Vector3d moved =
          body.joint->is_slide ? body.joint->axis : Eigen::Vector3d(body.joint->axis.cross(handle));
      EXPECT_GT(moved.y(), 0) << body.name;
    }
    for (const HouseBody& child : body.children) check(child);
  };
  for (const std::string& kind : FurnitureKinds()) {
    Rng rng = Rng::Stream(2, kind);
    check(MakeFurniture(kind, rng).body);
  }
  EXPECT_GT(joints, 15);
}

}  // namespace
}  // namespace robocell::internal
