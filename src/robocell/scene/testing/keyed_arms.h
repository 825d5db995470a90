// For tests only: models with keyframes, and the engine's own reset to them.
#pragma once

#include <gmock/gmock.h>
#include <mujoco/mujoco.h>

#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/scenes.h"

namespace robocell {

// Returns kTwoJointArm with other keyframes.
inline std::string ArmWithKeys(const std::string& keys) {
  std::string arm = kTwoJointArm;
  arm.resize(arm.find("<keyframe>"));
  return arm + "<keyframe>" + keys + "</keyframe>";
}

inline constexpr const char* kHomeAndRetract =
    R"(<key name="home" qpos="0.3 -0.4" ctrl="0.3 -0.4"/>
       <key name="retract" qpos="1 -1.5" ctrl="1 -1.5"/>)";

class KeyedArms : public ::testing::Test {
 protected:
  void AddArm(const std::string& keys, const std::string& prefix = "", double y = 0) {
    const std::string model = folder.Write("arm" + prefix, ArmWithKeys(keys));
    spec.robots.push_back({.config = ArmConfig(model), .prefix = prefix, .pos = {0, y, 0}});
  }

  ModelFolder folder;
  SceneSpec spec = EmptyScene();
};

// Compares with the engine's result for a key of the part's model, alone in an empty world.
inline void ExpectAsTheEngine(const Scene& scene, const std::string& file, const std::string& key) {
  const ModelPtr alone = Compile(ParseXmlFile(file).get());
  const mjModel* m = scene.model();
  const int own = FindId(alone.get(), mjOBJ_KEY, key), row = FindId(m, mjOBJ_KEY, key);
  ASSERT_GE(own, 0);
  ASSERT_GE(row, 0);
  ASSERT_EQ(m->nq, alone->nq);
  ASSERT_EQ(m->na, alone->na);
  const auto equal = [&](const mjtNum* ours, const mjtNum* theirs, mjtSize n) {
    for (mjtSize i = 0; i < n; ++i)
      EXPECT_NEAR(ours[row * n + i], theirs[own * n + i], 1e-12) << key << " " << i;
  };
  equal(m->key_qpos, alone->key_qpos, m->nq);
  equal(m->key_qvel, alone->key_qvel, m->nv);
  equal(m->key_act, alone->key_act, m->na);
  equal(m->key_ctrl, alone->key_ctrl, m->nu);
  equal(m->key_mpos, alone->key_mpos, 3 * m->nmocap);
  equal(m->key_mquat, alone->key_mquat, 4 * m->nmocap);
}

}  // namespace robocell
