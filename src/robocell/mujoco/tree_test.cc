#include "robocell/mujoco/tree.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/names.h"

namespace robocell {
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

TEST_F(Tree, SubtreesHoldTheirRootAndWhatHangsOnIt) {
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
}

TEST_F(Tree, CommonAncestorIsTheLowestThatCarriesBoth) {
  for (const auto& [a, b, ancestor] : {std::tuple{"c", "d", "b"},
                                       {"d", "c", "b"},
                                       {"c", "e", "a"},
                                       {"c", "b", "b"},
                                       {"e", "e", "e"},
                                       {"c", "f", "world"}}) {
    EXPECT_EQ(CommonAncestor(m, Body(a), Body(b)), Body(ancestor)) << a << ", " << b;
  }
}

}  // namespace
}  // namespace robocell
