#include "robocell/features/sensor_features.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <filesystem>

#include "robocell/base/files.h"
#include "robocell/data/episode_reader.h"
#include "robocell/data/episode_writer.h"
#include "robocell/mujoco/names.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

using ::testing::ElementsAre;

// The columns that a recorder makes of a source of features.
class Columns {
 public:
  Columns(EpisodeSchema& schema, SensorFeatures& features)
      : features_(features), numbers_(static_cast<size_t>(features.size())) {
    for (const Feature& feature : features.features())
      ids_.push_back(schema.AddColumn(feature.column));
  }
  void Put(EpisodeWriter& writer) {
    features_.Read(numbers_);
    std::span<const double> rest = numbers_;
    for (size_t i = 0; i < ids_.size(); ++i) {
      const auto size = static_cast<size_t>(features_.features()[i].size());
      writer.Put(ids_[i], rest.first(size));
      rest = rest.subspan(size);
    }
  }

 private:
  SensorFeatures& features_;
  std::vector<ColumnId> ids_;
  std::vector<double> numbers_;
};

// Two links that fall and swing, with a sensor of every stage: position, velocity, acceleration.
constexpr const char* kModel = R"(
<mujoco>
  <worldbody>
    <body name="fore" pos="0 0 1">
      <joint name="hinge" axis="0 1 0"/>
      <geom size="0.05 0.2" type="capsule" mass="1"/>
      <site name="wrist" pos="0 0 0.2" euler="10 20 30"/>
      <body name="slider" pos="0.1 0 0">
        <joint name="slide" type="slide" axis="1 0 0"/>
        <geom size="0.03" mass="0.5"/>
      </body>
    </body>
  </worldbody>
  <actuator><motor name="push" joint="slide" ctrlrange="-5 5"/></actuator>
  <sensor>
    <force name="arm/wrist_force" site="wrist"/>
    <torque name="arm/wrist_torque" site="wrist"/>
    <gyro name="gyro" site="wrist"/>
    <accelerometer name="accelerometer" site="wrist"/>
    <jointpos name="hinge_angle" joint="hinge"/>
    <jointvel name="slide_speed" joint="slide"/>
    <actuatorfrc name="pushed" actuator="push"/>
    <framequat name="turn" objtype="site" objname="wrist"/>
    <framepos name="place" objtype="site" objname="wrist" reftype="body" refname="fore"/>
    <clock/>
  </sensor>
</mujoco>)";

class SensorFeaturesTest : public ::testing::Test {
 protected:
  SensorFeaturesTest() {
    AtomicWrite(folder / "sensors.xml", kModel);
    SceneSpec spec{.name = "sensors", .base = (folder / "sensors.xml").string()};
    scene.emplace(Scene::Build(spec));
  }
  // Records `rows` rows, ten steps apart, and keeps the states that they were made from.
  Episode Record(int rows) {
    EpisodeSchema schema;
    SensorFeatures sensors(*scene);
    Columns columns(schema, sensors);
    EpisodeWriter writer(folder.path(), "e", schema);
    for (int i = 0; i < rows; ++i) {
      columns.Put(writer);
      writer.EndRow();
      states.push_back(scene->state());
      scene->SetActuatorCtrl("push", i % 2 ? 2.0 : -3.0);
      EXPECT_TRUE(scene->StepN(10).ok());
    }
    return Episode(writer.Commit({}));
  }

  TempDir folder;
  std::optional<Scene> scene;
  std::vector<std::vector<double>> states;
};

TEST_F(SensorFeaturesTest, MatchTheEngineAtTheStateOfTheRow) {
  const Episode episode = Record(20);
  const mjModel* m = scene->model();
  mjData* oracle = mj_makeData(m);
  double largest = 0;
  for (size_t row = 0; row < states.size(); ++row) {
    mj_setState(m, oracle, states[row].data(), mjSTATE_INTEGRATION);
    mj_forward(m, oracle);
    for (int s = 0; s < m->nsensor; ++s) {
      std::string name = ElementName(m, mjOBJ_SENSOR, s);
      if (name.empty()) name = "sensor_" + std::to_string(s);
      std::vector<double> expected(oracle->sensordata + m->sensor_adr[s],
                                   oracle->sensordata + m->sensor_adr[s] + m->sensor_dim[s]);
      if (m->sensor_type[s] == mjSENS_FRAMEQUAT)
        expected = {expected[1], expected[2], expected[3], expected[0]};
      const std::vector<double> all = episode.Read<double>("sensors/" + name);
      const std::vector<double> recorded(all.begin() + row * expected.size(),
                                         all.begin() + (row + 1) * expected.size());
      EXPECT_EQ(recorded, expected) << name << " row " << row;
      for (const double value : recorded) largest = std::max(largest, std::abs(value));
    }
  }
  mj_deleteData(oracle);
  EXPECT_GT(largest, 1) << "something happened";
}

TEST_F(SensorFeaturesTest, HaveUnitsFramesAndNames) {
  const Episode episode = Record(1);
  const auto units = [&](const std::string& name) {
    return episode.column("sensors/" + name).spec.units;
  };
  EXPECT_EQ(units("arm/wrist_force"), "N");
  EXPECT_EQ(units("arm/wrist_torque"), "N m");
  EXPECT_EQ(units("gyro"), "rad/s");
  EXPECT_EQ(units("accelerometer"), "m/s^2");
  EXPECT_EQ(units("hinge_angle"), "rad");
  EXPECT_EQ(units("slide_speed"), "m/s");
  EXPECT_EQ(units("pushed"), "N");
  EXPECT_EQ(units("sensor_9"), "s");
  EXPECT_EQ(episode.column("sensors/gyro").spec.frame, "site 'wrist'");
  EXPECT_EQ(episode.column("sensors/turn").spec.frame, "world");
  EXPECT_EQ(episode.column("sensors/place").spec.frame, "body 'fore'");
  EXPECT_THAT(episode.column("sensors/turn").spec.names, ElementsAre("qx", "qy", "qz", "qw"));
  EXPECT_THAT(episode.column("sensors/gyro").spec.shape, ElementsAre(3));
  EXPECT_TRUE(episode.column("sensors/hinge_angle").spec.shape.empty());
}

TEST_F(SensorFeaturesTest, RecordingDoesNotChangeTheTrajectory) {
  const std::vector<double> start = scene->state();
  Record(20);
  const std::vector<double> recorded = scene->state();
  scene->SetState(start);
  for (int i = 0; i < 20; ++i) {
    scene->SetActuatorCtrl("push", i % 2 ? 2.0 : -3.0);
    EXPECT_TRUE(scene->StepN(10).ok());
  }
  EXPECT_EQ(scene->state(), recorded);
}

// The engine's pair is the reaction, the robot's sensor is the load.
TEST(SensorFeatures, ForceTorqueSensorsOfRobotsAreRecordedAsLoads) {
  RobotConfig config{.name = "probe", .model = "ft_sensor"};
  config.attachments.push_back({.mjcf_path = "mug", .attach_to = Site("wrist_ft_site")});
  config.ft_sensors = {{.name = "wrist_ft"}};
  SceneSpec spec{.name = "ft", .timestep = 0.002, .add_floor = false, .add_skybox = false};
  spec.robots.push_back({.name = "probe", .config = config, .prefix = "p/", .euler = {30, 40, 50}});
  const Scene scene = Scene::Build(spec);
  const TempDir folder;
  EpisodeSchema schema;
  SensorFeatures sensors(scene);
  Columns columns(schema, sensors);
  EpisodeWriter writer(folder.path(), "e", schema);
  columns.Put(writer);
  writer.EndRow();
  const Episode episode(writer.Commit({}));
  const auto load = episode.Read<double>("robots/probe/sensors/wrist_ft");
  auto reaction = episode.Read<double>("robots/probe/sensors/wrist_ft_force");
  const auto torque = episode.Read<double>("robots/probe/sensors/wrist_ft_torque");
  reaction.insert(reaction.end(), torque.begin(), torque.end());
  ASSERT_EQ(load.size(), 6u);
  for (size_t i = 0; i < 6; ++i) EXPECT_EQ(load[i], -reaction[i]);
  EXPECT_NEAR(std::hypot(load[0], load[1], load[2]), 0.107 * 9.81, 0.01) << "the mug's weight";
  const ColumnSpec& column = episode.column("robots/probe/sensors/wrist_ft").spec;
  EXPECT_EQ(column.units, "N, N m");
  EXPECT_EQ(column.frame, "site 'p/wrist_ft_site'");
  EXPECT_THAT(column.names, ElementsAre("fx", "fy", "fz", "tx", "ty", "tz"));
}

// Whatever prefix the robot has in the scene: a run, an environment and a scene give it others.
TEST(SensorFeatures, OfARobotHaveOneNameInAllScenes) {
  for (const std::string prefix : {"robot_0/", "robotprobe_", ""}) {
    SceneSpec spec{.name = "ft", .timestep = 0.002, .add_floor = false, .add_skybox = false};
    spec.robots.push_back({.name = "probe",
                           .config = RobotConfig{.name = "probe", .model = "ft_sensor"},
                           .prefix = prefix});
    const Scene scene = Scene::Build(spec);
    EXPECT_THAT(SensorNames(*scene.compiled()), ElementsAre("robots/probe/sensors/wrist_ft_force",
                                                            "robots/probe/sensors/wrist_ft_torque"))
        << prefix;
  }
}

TEST(SensorFeatures, KeepTheSceneNameIfTheRobotNameIsTaken) {
  RobotConfig config{.name = "probe", .model = "ft_sensor"};
  config.ft_sensors = {{.name = "wrist_ft_force",
                        .force_sensor = "wrist_ft_force",
                        .torque_sensor = "wrist_ft_torque"}};
  SceneSpec spec{.name = "ft", .timestep = 0.002, .add_floor = false, .add_skybox = false};
  spec.robots.push_back({.name = "probe", .config = config, .prefix = "p/"});
  const Scene scene = Scene::Build(spec);
  EXPECT_THAT(SensorNames(*scene.compiled()),
              ElementsAre("sensors/p/wrist_ft_force", "robots/probe/sensors/wrist_ft_torque"));
}

TEST(SensorFeatures, ASceneWithoutSensorsHasNone) {
  const SensorFeatures sensors(
      Scene::Build({.name = "empty", .timestep = 0.002, .add_floor = false, .add_skybox = false}));
  EXPECT_TRUE(sensors.features().empty());
  EXPECT_EQ(sensors.size(), 0);
}

}  // namespace
}  // namespace robocell::internal
