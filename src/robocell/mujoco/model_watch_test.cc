#include "robocell/mujoco/model_watch.h"

#include <gtest/gtest.h>

#include <utility>

#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/owners.h"

namespace robocell {
namespace {

ModelPtr WatchedModel() { return Compile(MakeSpec().get()); }

TEST(ModelWatch, DetectsAFreedModelOfAnyOwner) {
  ModelPtr model = WatchedModel();
  const ModelWatch first(model.get()), second(model.get()), copy = first;
  ModelPtr moved = std::move(model);
  EXPECT_FALSE(first.gone() || second.gone() || copy.gone());
  moved.reset();
  EXPECT_TRUE(first.gone() && second.gone() && copy.gone());
  EXPECT_FALSE(ModelWatch().gone());
}

TEST(ModelWatch, DistinguishesALaterModelAtTheSameAddress) {
  const ModelPtr model =
      WatchedModel();  // stands for two models at the same address, one after the other
  const ModelWatch before(model.get());
  ModelEnds(model.get());
  const ModelWatch after(model.get());
  EXPECT_TRUE(before.gone());
  EXPECT_FALSE(after.gone());
  ModelEnds(model.get());
  EXPECT_TRUE(after.gone());
}

}  // namespace
}  // namespace robocell
