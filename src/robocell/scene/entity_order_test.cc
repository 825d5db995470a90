#include "robocell/scene/entity_order.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

Entity Object(const std::string& name, AttachTarget target = {}) {
  return {"object '" + name + "'", "objects", std::move(target), "", {{AttachKind::kBody, name}}};
}

Entity Arm(const std::string& name, AttachTarget target = {}) {
  return {"robot '" + name + "'",
          "robots",
          std::move(target),
          name,
          {{AttachKind::kSite, name + "_flange"}}};
}

std::string ProblemsOf(const std::vector<Entity>& entities) {
  CompileLog log;
  BuildOrder(entities, {{AttachKind::kSite, "table_top"}}, log);
  try {
    log.Throw("test");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(EntityOrder, IndependentEntitiesKeepTheirOrder) {
  CompileLog log;
  EXPECT_THAT(BuildOrder({Object("a"), Object("b"), Arm("r")}, {}, log), ElementsAre(0, 1, 2));
}

TEST(EntityOrder, EachFollowsItsParent) {
  CompileLog log;
  const std::vector<Entity> entities = {Object("badge", Site("right_flange")), Object("table"),
                                        Arm("left", Body("table")),
                                        Arm("right", RobotBase("left"))};
  EXPECT_THAT(BuildOrder(entities, {}, log), ElementsAre(1, 2, 3, 0));
  log.Throw("test");
}

TEST(EntityOrder, TheBaseComesFirst) {
  EXPECT_EQ(ProblemsOf({Object("cup", Site("table_top"))}), "");
}

TEST(EntityOrder, AMissingElementSuggestsTheNearest) {
  EXPECT_EQ(ProblemsOf({Object("table"), Object("cup", Body("tabel"))}),
            "scene 'test' / object 'cup': attach_to: the scene: no body 'tabel'. Its bodies: "
            "table. Did you mean 'table'?");
  EXPECT_EQ(ProblemsOf({Object("cup", Attachment("lft")), Arm("left")}),
            "scene 'test' / object 'cup': attach_to: the scene: no robot 'lft'. Its robots: left. "
            "Did you mean 'left'?");
  EXPECT_EQ(ProblemsOf({Object("cup", Site("top"))}),
            "scene 'test' / object 'cup': attach_to: the scene: no site 'top'. Its sites: "
            "table_top. Did you mean 'table_top'?");
}

TEST(EntityOrder, AReferenceToALaterEntityNamesBoth) {
  EXPECT_EQ(ProblemsOf({Object("cup", Body("table")), Object("table")}),
            "scene 'test' / object 'cup': is attached to body 'table' of object 'table', which is "
            "declared later; move "
            "object 'table' before it");
}

TEST(EntityOrder, ACycleNamesItsMembers) {
  EXPECT_EQ(ProblemsOf({Object("cup", Site("r_flange")), Arm("r", Body("cup"))}),
            "scene 'test': entities are attached to each other in a circle: object 'cup' -> robot "
            "'r' -> object 'cup'");
  EXPECT_EQ(
      ProblemsOf({Arm("r", RobotBase("r"))}),
      "scene 'test': entities are attached to each other in a circle: robot 'r' -> robot 'r'");
}

TEST(EntityOrder, DependentsOfAProblemAreOmittedSilently) {
  CompileLog log;
  const auto order =
      BuildOrder({Object("a", Body("nowhere")), Object("b", Body("a")), Object("c")}, {}, log);
  EXPECT_THAT(order, ElementsAre(2));
  ExpectThrow<NotFoundError>([&] { log.Throw("test"); }, "scene 'test' / object 'a': ");
}

}  // namespace
}  // namespace robocell::internal
