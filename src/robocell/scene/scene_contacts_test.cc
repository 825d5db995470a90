#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "robocell/assets/resolve.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/workplace.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

TEST(SceneContacts, ReportBodiesAndForces) {
  Scene scene = Scene::Build(Workplace());
  EXPECT_TRUE(scene.StepN(200).ok());
  const std::vector<Contact> contacts = scene.contacts("cube");
  ASSERT_THAT(contacts, SizeIs(4));
  Eigen::Vector3d on_cube = Eigen::Vector3d::Zero();
  for (const Contact& c : contacts) {
    EXPECT_EQ(c.geom1, "floor");
    EXPECT_EQ(c.geom2, "cube_geom");
    EXPECT_EQ(c.body1, "world");
    EXPECT_EQ(c.body2, "cube");
    EXPECT_NEAR(c.distance, 0, 1e-3);
    EXPECT_NEAR(std::abs(c.position.x() - 0.5), 0.02, 1e-3);
    on_cube += c.force;
  }
  EXPECT_NEAR(on_cube.z(), 0.1 * 9.81, 0.01);
  EXPECT_THAT(scene.contacts("base_link"), IsEmpty());
}

}  // namespace
}  // namespace robocell
