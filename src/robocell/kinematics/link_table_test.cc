#include "robocell/kinematics/link_table.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <string>

#include "robocell/base/rng.h"
#include "robocell/kinematics/chain.h"
#include "robocell/kinematics/chain_model.h"
#include "robocell/kinematics/testing/models.h"

namespace robocell {
namespace {

TEST(LinkTable, HasAColumnForEachLinkOfTheChain) {
  Rng rng = Rng::Stream(1, "link table");
  const TestModel t =
      TestModel::FromXml(RandomChainXml(&rng, {.joints = 9, .slide_share = 0.4}).Write());
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  const ChainModel& model = chain.model();
  const LinkTable table = Tabulate(model);
  ASSERT_EQ(table.n, 9);
  for (int i = 0; i < table.n; ++i) {
    const JointModel& joint = model.joints[i];
    const Transform& step = joint.fixed;
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column)
        EXPECT_EQ(table.rotation[3 * column + row][i], step.rotation(row, column));
      // The first translation is the origin, from which kernels count.
      EXPECT_EQ(table.translation[row][i] + (i == 0 ? table.origin[row] : 0),
                step.translation[row]);
    }
    EXPECT_EQ(table.slides[i], joint.slide ? 1 : 0);
    EXPECT_EQ(table.turns[i], joint.slide ? 0 : 1);
    EXPECT_EQ(table.inertia[4][i], joint.link.inertia(0, 2));
  }
}

// The engine sums the masses of each body's subtree.
TEST(LinkTable, MassesBehindALinkAreThoseOfTheEnginesSubtrees) {
  Rng rng = Rng::Stream(2, "link table");
  const TestModel t = TestModel::FromXml(RandomChainXml(&rng, {.joints = 7}).Write());
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  const LinkTable table = Tabulate(chain.model());
  for (int i = 0; i < table.n; ++i) {
    const std::string& name = chain.joints()[i].body;
    const int body = mj_name2id(t.model(), mjOBJ_BODY, name.c_str());
    EXPECT_NEAR(table.mass_behind[i], t.model()->body_subtreemass[body], 1e-12) << name;
  }
}

}  // namespace
}  // namespace robocell
