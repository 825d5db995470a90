// Tests Reset: what it restores, in which order, and that nothing of the past remains.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "robocell/assets/resolve.h"
#include "robocell/base/error.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

SceneSpec Busy() {
  SceneSpec spec = EmptyScene();
  spec.robots.push_back(
      {.config = RobotConfig::Load(assets::BuiltinRobotFile("rc7")), .prefix = "r_"});
  for (int i = 0; i < 4; ++i)
    spec.objects.push_back(BoxObject("cube" + std::to_string(i), {0.4, 0.03 * i, 0.02 + 0.05 * i}));
  return spec;
}

// Writes everything that can be written to the data before a reset.
void LiveThrough(Scene& scene, Rng rng) {
  mjData* data = scene.data();
  const mjModel* m = scene.model();
  for (int round = 0; round < 5; ++round) {
    for (int i = 0; i < m->nu; ++i) data->ctrl[i] = rng.Uniform(-1, 1);
    for (int i = 0; i < m->nv; ++i) data->qfrc_applied[i] = rng.Uniform(-1, 1);
    for (int i = 0; i < 6 * m->nbody; ++i) data->xfrc_applied[i] = rng.Uniform(-0.1, 0.1);
    for (int i = 0; i < 3 * m->nmocap; ++i) data->mocap_pos[i] = rng.Uniform(-0.1, 0.1);
    for (int i = 0; i < m->neq; ++i) data->eq_active[i] = rng.UniformInt(2) == 0;
    EXPECT_TRUE(scene.StepN(static_cast<int>(rng.UniformInt(40))).ok());
  }
}

// The states of a simulation after a reset, to the bit.
std::vector<std::vector<double>> Trajectory(Scene& scene, uint64_t seed) {
  std::vector<std::vector<double>> states;
  scene.Reset({.seed = seed});
  for (int i = 0; i < 20; ++i) {
    states.push_back(scene.state());
    scene.data()->ctrl[0] = 0.1 * i;
    EXPECT_TRUE(scene.StepN(10).ok());
  }
  return states;
}

TEST(Reset, RestoresTheInitialState) {
  Scene fresh = Scene::Build(Busy()), lived = Scene::Build(Busy());
  const auto expected = Trajectory(fresh, 3);
  for (uint64_t seed = 0; seed < 10; ++seed) {
    LiveThrough(lived, Rng::Stream(seed, "life"));
    Trajectory(lived, seed + 10);
    EXPECT_TRUE(Trajectory(lived, 3) == expected) << "after life " << seed;
  }
}

TEST(Reset, RecoversFromADivergence) {
  Scene fresh = Scene::Build(Busy()), broken = Scene::Build(Busy());
  broken.data()->qvel[0] = 1e12;
  EXPECT_FALSE(broken.StepN(5).ok());
  EXPECT_TRUE(Trajectory(broken, 1) == Trajectory(fresh, 1));
}

TEST(Reset, DrawsHomeNoiseFromTheSeed) {
  Scene scene = Scene::Build(Busy());
  const auto arm = [&](std::optional<uint64_t> seed) {
    scene.Reset({.seed = seed});
    std::vector<double> q;
    for (int i = 1; i <= 7; ++i) {
      const int joint = RequireId(scene.model(), mjOBJ_JOINT, "r_joint" + std::to_string(i), "");
      q.push_back(scene.data()->qpos[scene.model()->jnt_qposadr[joint]]);
    }
    return q;
  };
  const std::vector<double> home = arm({});
  EXPECT_THAT(home, ElementsAre(0, -0.15, 0, 1.9, 0, 1.39159, 0));
  EXPECT_EQ(arm(5), arm(5));
  EXPECT_NE(arm(5), arm(6));
  for (int seed = 0; seed < 50; ++seed) {
    const std::vector<double> q = arm(seed);
    for (size_t i = 0; i < q.size(); ++i) {
      EXPECT_LE(std::abs(q[i] - home[i]), 0.03);
      EXPECT_NE(q[i], home[i]);
    }
  }
}

TEST(Reset, KeepsServosHoldingTheNoisyPose) {
  Scene scene = Scene::Build(Busy());
  scene.Reset({.seed = 5});
  for (int i = 1; i <= 7; ++i) {
    const int joint = RequireId(scene.model(), mjOBJ_JOINT, "r_joint" + std::to_string(i), "");
    EXPECT_NEAR(scene.actuator_ctrl("r_servo" + std::to_string(i)),
                scene.data()->qpos[scene.model()->jnt_qposadr[joint]], 1e-12);
  }
}

// Servos that no group lists, one of them behind a tendon and a filter, hold the noisy positions.
TEST(Reset, UnlistedServosHoldTheNoisyPose) {
  ModelFolder folder;
  std::string model = kTwoJointArm;
  const std::string servo = R"(<position name="servo2" joint="elbow" kp="50" kv="5"/>)";
  model.replace(model.find(servo), servo.size(),
                R"(<position name="servo2" tendon="pull" kp="50" kv="5" timeconst="0.1"/>)");
  model += R"(<tendon><fixed name="pull"><joint joint="elbow" coef="2"/></fixed></tendon>)";
  model.replace(model.find(R"( ctrl="0.31 -0.41")"), 18, "");
  RobotConfig config = ArmConfig(folder.Write("arm", model));
  config.move_groups.at("arm").actuators = {};
  config.move_groups.at("arm").kind = MoveGroupKind::kGeneric;
  config.home_noise["arm"] = {0.5};
  SceneSpec spec = EmptyScene();
  spec.robots.push_back({.config = config});
  Scene scene = Scene::Build(spec);
  scene.Reset({.seed = 3});
  const mjData* data = scene.data();
  EXPECT_NE(data->qpos[0], 0.3);
  EXPECT_NEAR(scene.actuator_ctrl("servo1"), data->qpos[0], 1e-12);
  EXPECT_NEAR(scene.actuator_ctrl("servo2"), 2 * data->qpos[1], 1e-12);
  EXPECT_NEAR(data->act[0], 2 * data->qpos[1], 1e-12);
}

// Records the engine's data of a body.
struct Onlooker : SceneObserver {
  explicit Onlooker(const Scene& scene) : scene(scene.inner()) {}
  void OnReset() override { height = scene.data()->xpos[3 * body + 2]; }
  Scene scene;
  int body = RequireId(scene.model(), mjOBJ_BODY, "cube0", "");
  double height = 0;
};

TEST(Reset, HooksAndObserversSeeConsistentPoses) {
  Scene scene = Scene::Build(Busy());
  const auto onlooker = std::make_shared<Onlooker>(scene);
  scene.AddObserver(onlooker);
  double in_hook = 0;
  scene.AddResetHook([&](ResetContext& reset) {
    in_hook = reset.scene.data()->xpos[3 * onlooker->body + 2];
    reset.scene.data()->qpos[2] = 0.9;  // cube0
  });
  scene.data()->qpos[2] = 0.5;
  scene.Forward();
  scene.Reset();
  EXPECT_DOUBLE_EQ(in_hook, 0.02) << "that of home";
  EXPECT_EQ(onlooker->height, 0.9) << "that which the hook left";
}

TEST(Reset, KeepsNoiseInsideTheLimits) {
  ModelFolder folder;
  RobotConfig config = ArmConfig(folder.Write("arm", kTwoJointArm));
  config.home["arm"] = {1.99, 0};
  config.home_noise["arm"] = {0.5};
  SceneSpec spec = EmptyScene();
  spec.robots.push_back({.config = config});
  Scene scene = Scene::Build(spec);
  bool at_limit = false;
  for (int seed = 0; seed < 20; ++seed) {
    scene.Reset({.seed = seed});
    EXPECT_LE(scene.data()->qpos[0], 2.0);
    at_limit = at_limit || scene.data()->qpos[0] == 2.0;
  }
  EXPECT_TRUE(at_limit);
}

// Returns the largest error of the active constraints between joints.
double ErrorOfCouplings(const mjModel* m, const mjData* data) {
  double worst = 0;
  for (int e = 0; e < m->neq; ++e) {
    if (m->eq_type[e] != mjEQ_JOINT || !data->eq_active[e]) continue;
    const int leader = m->eq_obj2id[e];
    const int a = m->jnt_qposadr[m->eq_obj1id[e]], b = leader < 0 ? -1 : m->jnt_qposadr[leader];
    const double x = b < 0 ? 0 : data->qpos[b] - m->qpos0[b];
    const mjtNum* c = m->eq_data + mjNEQDATA * e;
    const double y = c[0] + x * (c[1] + x * (c[2] + x * (c[3] + x * c[4])));
    worst = std::max(worst, std::abs(data->qpos[a] - m->qpos0[a] - y));
  }
  return worst;
}

// Returns the names of joints that are outside of their limits.
std::vector<std::string> OutsideLimits(const mjModel* m, const mjData* data) {
  std::vector<std::string> out;
  for (int j = 0; j < m->njnt; ++j) {
    const double q = data->qpos[m->jnt_qposadr[j]];
    if (m->jnt_limited[j] && (q < m->jnt_range[2 * j] || q > m->jnt_range[2 * j + 1]))
      out.push_back(ElementName(m, mjOBJ_JOINT, j));
  }
  return out;
}

TEST(Reset, NoiseKeepsCouplingsAndLimitsOfAllRobots) {
  int coupled = 0;
  for (const std::string& name : assets::BuiltinRobots()) {
    SCOPED_TRACE(name);
    RobotConfig config = RobotConfig::Load(assets::BuiltinRobotFile(name));
    for (const auto& [group, joints] : config.move_groups.entries())
      config.home_noise[group] = {0.2};
    SceneSpec spec = EmptyScene();
    spec.robots.push_back({.config = config});
    Scene scene = Scene::Build(spec);
    for (uint64_t seed = 0; seed < 5; ++seed) {
      scene.Reset({.seed = seed});
      EXPECT_LE(ErrorOfCouplings(scene.model(), scene.data()), 1e-9);
      EXPECT_THAT(OutsideLimits(scene.model(), scene.data()), IsEmpty());
    }
    coupled += scene.model()->neq > 0;
  }
  EXPECT_GT(coupled, 0);
}

TEST(Reset, NoiseOfARobotIsIndependentOfOtherRobots) {
  SceneSpec spec = Busy();
  Scene alone = Scene::Build(spec);
  RobotSpec other = spec.robots[0];
  other.prefix = "a_";
  other.pos = {0, 2, 0};
  spec.robots = {other, spec.robots[0]};
  Scene both = Scene::Build(spec);
  alone.Reset({.seed = 9});
  both.Reset({.seed = 9});
  EXPECT_EQ(alone.actuator_ctrl("r_servo3"), both.actuator_ctrl("r_servo3"));
  EXPECT_NE(both.actuator_ctrl("a_servo3"), both.actuator_ctrl("r_servo3"));
}

TEST(Reset, CanUseTheDefaultConfiguration) {
  Scene scene = Scene::Build(Busy());
  const ResetInfo info = scene.Reset({.use_keyframe = false});
  EXPECT_FALSE(info.used_keyframe);
  const int joint = RequireId(scene.model(), mjOBJ_JOINT, "r_joint4", "");
  EXPECT_EQ(scene.data()->qpos[scene.model()->jnt_qposadr[joint]], 0);
  EXPECT_EQ(scene.Reset().keyframe, scene.compiled()->home_key());
}

TEST(Reset, PartsWithoutKeyframesStartWhereTheirModelsDo) {
  ModelFolder folder;
  const std::string lamp = folder.Write("lamp", R"(<worldbody><body name="lamp">
      <joint name="hinge" ref="30"/><geom size="0.1"/></body></worldbody>)");
  SceneSpec spec = EmptyScene();
  spec.robots.push_back({.path = lamp});
  Scene alone = Scene::Build(spec);
  EXPECT_EQ(alone.Reset({.keyframe = 0}).keyframe, 0);
  EXPECT_NEAR(alone.joint_pos("hinge"), std::numbers::pi / 6, 1e-12);
  spec.robots.push_back({.path = folder.Write("arm", kTwoJointArm), .prefix = "a_"});
  Scene both = Scene::Build(spec);
  const ResetInfo info = both.Reset({.keyframe = 0});
  EXPECT_TRUE(info.used_keyframe);
  EXPECT_NEAR(both.joint_pos("hinge"), std::numbers::pi / 6, 1e-12);
  EXPECT_EQ(both.joint_pos("a_shoulder"), 0.3) << "the other part's key";
  EXPECT_FALSE(both.Reset({.use_keyframe = false}).used_keyframe);
  EXPECT_EQ(both.joint_pos("a_shoulder"), 0);
}

TEST(Reset, RejectsAMissingKeyframeEvenIfUnused) {
  Scene scene = Scene::Build(EmptyScene());
  EXPECT_FALSE(scene.Reset({.keyframe = 0, .use_keyframe = false}).used_keyframe);
  ExpectThrow<NotFoundError>(
      [&] { scene.Reset({.keyframe = std::string("nope"), .use_keyframe = false}); }, "'nope'");
}

TEST(Reset, RejectsAMissingKeyframe) {
  Scene scene = Scene::Build(Busy());
  ExpectThrow<ArgumentError>([&] { scene.Reset({.keyframe = 3}); },
                             "scene 'test': there is no keyframe 3; the scene has 1");
}

// Records the order of events.
struct Diary : SceneObserver {
  explicit Diary(std::vector<std::string>& entries) : entries(entries) {}
  void OnReset() override { entries.push_back("observer"); }
  void OnResetDone() override { entries.push_back("done"); }
  void OnClose() override { entries.push_back("closed"); }
  std::vector<std::string>& entries;
};

TEST(Reset, CallsHooksAndObserversBeforeComputingPoses) {
  Scene scene = Scene::Build(Busy());
  std::vector<std::string> entries;
  const auto diary = std::make_shared<Diary>(entries);
  scene.AddObserver(diary);
  scene.AddResetHook([&](ResetContext& reset) {
    entries.push_back(reset.info.used_keyframe && reset.options.seed == 4u ? "hook"
                                                                           : "wrong context");
    EXPECT_EQ(reset.scene.time(), 0);
    reset.scene.data()->qpos[0] = 0.9;  // cube0
    reset.scene.data()->qfrc_applied[0] = 100;
  });
  const int id = scene.AddResetHook([&](ResetContext& reset) {
    entries.push_back(reset.scene.data()->qpos[0] == 0.9 ? "second hook" : "wrong order");
  });
  EXPECT_TRUE(scene.StepN(3).ok());
  scene.Reset({.seed = 4});
  EXPECT_THAT(entries, ElementsAre("hook", "second hook", "observer", "done"));
  EXPECT_EQ(scene.body_pose("cube0").translation().x(), 0.9) << "poses follow what the hook wrote";
  EXPECT_EQ(scene.data()->qfrc_applied[0], 0);
  scene.RemoveResetHook(id);
  entries.clear();
  scene.Reset({.seed = 4});
  EXPECT_THAT(entries, ElementsAre("hook", "observer", "done"));
}

TEST(Reset, PlacesBodiesAtTheGivenPoses) {
  const Pose there = Pose::FromRpy({0.5, 0.3, 0.4}, {0.1, 0.2, 0.3});
  const Pose aside(Eigen::Vector3d(0.1, 0.5, 0.1));
  Scene moved = Scene::Build(Busy()), observed = Scene::Build(Busy());
  const auto onlooker = std::make_shared<Onlooker>(observed);
  observed.AddObserver(onlooker);
  observed.AddResetHook([&](ResetContext& reset) {
    const Pose cube = reset.scene.body_pose("cube0");
    EXPECT_EQ(cube.is_close(there, 1e-12, 1e-12), !reset.options.body_poses.empty());
    reset.scene.SetBodyPose("cube0", aside);
    reset.scene.SetBodyPose("cube1", aside);
  });
  moved.Reset({.seed = 3});
  for (const char* cube : {"cube1", "cube0"})
    moved.SetBodyPose(cube, cube == std::string("cube0") ? there : aside);
  EXPECT_TRUE(observed.StepN(10).ok());
  observed.Reset({.seed = 3, .body_poses = {{"cube0", there}}});
  EXPECT_DOUBLE_EQ(onlooker->height, 0.4);
  const auto qpos = [](const Scene& s) {
    return std::vector<double>(s.data()->qpos, s.data()->qpos + s.model()->nq);
  };
  EXPECT_EQ(qpos(observed), qpos(moved));
  EXPECT_THAT(std::span(observed.data()->qvel, observed.model()->nv), Each(0.0));
  EXPECT_EQ(observed.contacts().size(), moved.contacts().size());
  observed.Reset({.seed = 3});
  EXPECT_EQ(observed.body_pose("cube0").translation().x(), 0.1) << "it holds for one reset";
}

TEST(Reset, RejectsImmovableBodiesWithoutAChange) {
  Scene scene = Scene::Build(Busy());
  EXPECT_TRUE(scene.StepN(10).ok());
  const std::vector<double> before = scene.state();
  ExpectThrow<NotFoundError>(
      [&] {
        scene.Reset({.body_poses = {{"cube", Pose()}}});
      },
      "no body 'cube'");
  ExpectThrow<ArgumentError>(
      [&] {
        scene.Reset({.body_poses = {{"r_link1", Pose()}}});
      },
      "body 'r_link1' cannot be moved by its pose: it is neither free");
  EXPECT_EQ(scene.state(), before);
}

TEST(Reset, AHookThatClosesTheSceneEndsTheReset) {
  Scene scene = Scene::Build(Busy());
  scene.AddResetHook([](ResetContext& reset) { reset.scene.Close(); });
  EXPECT_THROW(scene.Reset(), ClosedError);
  EXPECT_TRUE(scene.closed());
}

TEST(Reset, AThrowingHookLeavesAPlainReset) {
  Scene fresh = Scene::Build(Busy()), scene = Scene::Build(Busy());
  std::vector<std::string> entries;
  const auto diary = std::make_shared<Diary>(entries);
  scene.AddObserver(diary);
  const int id = scene.AddResetHook([](ResetContext& reset) {
    reset.scene.data()->qpos[0] = 0.9;
    reset.scene.data()->ctrl[0] = 0.7;
    reset.scene.data()->qfrc_applied[0] = 100;
    throw ArgumentError("no grasp for 'cube0'");
  });
  LiveThrough(scene, Rng::Stream(5, "life"));
  ExpectThrow<ArgumentError>([&] { scene.Reset({.seed = 4}); }, "no grasp for 'cube0'");
  EXPECT_THAT(entries, ElementsAre("observer", "done")) << "robots read the state again";
  fresh.Reset({.seed = 4});
  EXPECT_EQ(scene.state(), fresh.state());
  EXPECT_EQ(scene.body_pose("cube0").translation(), fresh.body_pose("cube0").translation());
  scene.RemoveResetHook(id);
  EXPECT_TRUE(Trajectory(scene, 3) == Trajectory(fresh, 3));
}

// Throws on request.
struct Sulky : SceneObserver {
  void OnReset() override {
    if (at_once) throw ArgumentError("I would rather not");
  }
  void OnResetDone() override { throw ArgumentError("nor now"); }
  bool at_once = true;
};

TEST(Reset, AThrowingObserverDoesNotStopAReset) {
  Scene fresh = Scene::Build(Busy()), scene = Scene::Build(Busy());
  std::vector<std::string> entries;
  const auto before = std::make_shared<Diary>(entries), after = std::make_shared<Diary>(entries);
  const auto sulky = std::make_shared<Sulky>();
  scene.AddObserver(before);
  scene.AddObserver(sulky);
  scene.AddObserver(after);
  fresh.Reset({.seed = 4});
  for (const char* message : {"I would rather not", "nor now"}) {
    entries.clear();
    LiveThrough(scene, Rng::Stream(6, "life"));
    ExpectThrow<ArgumentError>([&] { scene.Reset({.seed = 4}); }, message);
    EXPECT_THAT(entries, ElementsAre("observer", "observer", "done", "done"));
    EXPECT_EQ(scene.state(), fresh.state());
    EXPECT_EQ(scene.data()->qfrc_applied[0], 0);
    sulky->at_once = false;
  }
  const int id = scene.AddResetHook([](ResetContext&) { throw NotFoundError("no grasp"); });
  ExpectThrow<NotFoundError>([&] { scene.Reset({.seed = 4}); }, "no grasp");
  EXPECT_EQ(scene.state(), fresh.state());
  scene.RemoveResetHook(id);
}

TEST(Reset, IsRejectedInsideAHook) {
  Scene scene = Scene::Build(Busy());
  int calls = 0;
  const int id = scene.AddResetHook([&](ResetContext& reset) {
    ++calls;
    reset.scene.Reset();
  });
  ExpectThrow<Error>([&] { scene.Reset(); },
                     "scene 'test': reset() in a reset hook, which would call the hook again");
  EXPECT_EQ(calls, 1);
  scene.RemoveResetHook(id);
  EXPECT_TRUE(scene.Reset().used_keyframe) << "the next one is none in a hook";
}

TEST(Reset, RejectsInvalidHooks) {
  Scene scene = Scene::Build(Busy());
  ExpectThrow<ArgumentError>([&] { scene.AddResetHook(nullptr); },
                             "scene 'test': a reset hook cannot be empty; to take one away: "
                             "RemoveResetHook (in Python remove_reset_hook)");
  ExpectThrow<NotFoundError>([&] { scene.RemoveResetHook(7); },
                             "scene 'test': there is no reset hook 7. Ids of those there are, as "
                             "AddResetHook (in Python on_reset) returned them: none");
  const int id = scene.AddResetHook([](ResetContext&) {});
  ExpectThrow<NotFoundError>([&] { scene.RemoveResetHook(id + 1); },
                             "returned them: " + std::to_string(id));
  scene.RemoveResetHook(id);
}

TEST(Reset, AHookCanRemoveItself) {
  Scene scene = Scene::Build(Busy());
  int calls = 0, id = -1;
  id = scene.AddResetHook([&](ResetContext& reset) {
    ++calls;
    reset.scene.RemoveResetHook(id);
  });
  scene.Reset();
  scene.Reset();
  EXPECT_EQ(calls, 1);
}

}  // namespace
}  // namespace robocell
