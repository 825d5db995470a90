#include "robocell/mujoco/tree.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/names.h"

namespace robocell::internal {
namespace {

class Tree : public ::testing::Test {
 protected:
  int Body(const char* name) const { return RequireId(m, mjOBJ_BODY, name, "tree"); }

  ModelPtr model = Compile(ParseXmlString(R"(<mujoco><worldbody>
      <body name="a"><body name="b"><body name="c"/><body name="d"/></body><body name="e"/></body>
      <body name="f"/></worldbody></mujoco>)",
                                          "tree")
                               .get(),
                           nullptr, "tree");
  const mjModel* m = model.get();
};

TEST_F(Tree, SubtreesContainTheirRootAndDescendants) {
  for (const auto& [body, root, inside] : {std::tuple{"a", "a", true},
                                           {"d", "a", true},
                                           {"c", "b", true},
                                           {"e", "b", false},
                                           {"a", "b", false},
                                           {"f", "a", false},
                                           {"f", "world", true}}) {
    EXPECT_EQ(IsInSubtree(m, Body(body), Body(root)), inside) << body << " in " << root;
    EXPECT_EQ(SubtreeMask(m, Body(root))[Body(body)], inside) << body << " in " << root;
  }
  EXPECT_FALSE(IsInSubtree(m, Body("c"), -1)) << "a body that was not found";
}

TEST_F(Tree, TheCommonAncestorIsTheLowestSharedBody) {
  for (const auto& [a, b, ancestor] : {std::tuple{"c", "d", "b"},
                                       {"d", "c", "b"},
                                       {"c", "e", "a"},
                                       {"c", "b", "b"},
                                       {"e", "e", "e"},
                                       {"c", "f", "world"}}) {
    EXPECT_EQ(CommonAncestor(m, Body(a), Body(b)), Body(ancestor)) << a << ", " << b;
  }
}

TEST_F(Tree, FindsElementsOfABodyByKind) {
  const ModelPtr part = Compile(
      ParseXmlString(R"(<mujoco><asset><mesh name="m" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/></asset>
      <worldbody><body name="a"><body name="b"><joint name="j"/><geom name="g" size="1"/><site name="s"/>
      <camera name="c"/><light name="l"/></body></body></worldbody></mujoco>)",
                     "part")
          .get(),
      nullptr, "part");
  const int b = RequireId(part.get(), mjOBJ_BODY, "b", "part");
  for (const auto& [kind, name] : {std::pair{mjOBJ_BODY, "b"},
                                   {mjOBJ_JOINT, "j"},
                                   {mjOBJ_GEOM, "g"},
                                   {mjOBJ_SITE, "s"},
                                   {mjOBJ_CAMERA, "c"},
                                   {mjOBJ_LIGHT, "l"}}) {
    EXPECT_EQ(BodyOf(part.get(), kind, RequireId(part.get(), kind, name, "part")), b) << name;
  }
  EXPECT_EQ(BodyOf(part.get(), mjOBJ_DOF, 0), b);
  EXPECT_EQ(BodyOf(part.get(), mjOBJ_MESH, 0), -1);
}

}  // namespace
}  // namespace robocell::internal
