#include "robocell/scenes/houses/house_model.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <memory>
#include <string>

#include "robocell/base/files.h"
#include "robocell/scenes/houses/make_houses.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

TEST(HouseModel, StockMujocoLoadsItAndNothingPenetrates) {
  const TempDir folder;
  const HouseOptions options{.seed = 3, .most_objects = 12, .kinds = {RoomKind::kKitchen}};
  PrepareHouseFolder(folder.path(), options);
  const SettledHouse settled = SettleHouse(PlanHouse(options, 0), "house", folder.path());
  EXPECT_NE(settled.xml, settled.ceiling_xml);
  for (const std::string& xml : {settled.xml, settled.ceiling_xml}) {
    AtomicWrite(folder / "house.xml", xml);
    char error[500] = "";
    const std::shared_ptr<mjModel> m(
        mj_loadXML((folder / "house.xml").c_str(), nullptr, error, sizeof error), &mj_deleteModel);
    ASSERT_NE(m, nullptr) << error;
    const std::shared_ptr<mjData> d(mj_makeData(m.get()), &mj_deleteData);
    mj_forward(m.get(), d.get());
    EXPECT_GT(d->ncon, 0);
    for (int c = 0; c < d->ncon; ++c) EXPECT_GT(d->contact[c].dist, -1e-3);
    for (const FilledSlot& slot : settled.house.slots)
      EXPECT_GE(mj_name2id(m.get(), mjOBJ_BODY, slot.body.c_str()), 0);
    for (const HousePiece& object : settled.house.objects)
      EXPECT_GE(mj_name2id(m.get(), mjOBJ_BODY, object.thing.body.name.c_str()), 0);
  }
}

}  // namespace
}  // namespace robocell::internal
