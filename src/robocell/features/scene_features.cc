#include "robocell/features/scene_features.h"

#include <utility>

namespace robocell::internal {

SceneFeatures::SceneFeatures(Scene given, std::vector<Robot> robots,
                             const std::vector<std::string>& objects, const ObjectOfName& object_of)
    : FeatureSource(std::move(given)), robots_(std::move(robots)) {
  Add({.column = {.name = "time", .units = "s"}, .source = "scene"});
  for (const std::string& object : objects) {
    objects_.emplace_back(scene(), object, object_of);
    const std::string source = "object " + object;
    Add(PoseFeature("objects/" + object + "/pose", "world", FeatureRole::kPrivileged, source,
                    "Pose of the object's root body."));
    for (const Robot& robot : robots_) {
      const std::string path = "robots/" + robot.name() + "/objects/" + object;
      Add(PoseFeature(path + "/pose_in_base", "base of " + robot.name(), FeatureRole::kPrivileged,
                      source, "Pose of the object's root body."));
      if (!robot.has_arm()) continue;
      Add(PoseFeature(path + "/pose_in_tcp", "TCP of " + robot.name(), FeatureRole::kPrivileged,
                      source, "Pose of the object's root body."));
    }
  }
}

void SceneFeatures::ReadNumbers(std::span<double> out) {
  out[0] = scene().time();
  out = out.subspan(1);
  const auto put = [&](const Pose& pose) {
    PutPose(pose, out);
    out = out.subspan(kPoseNumbers);
  };
  for (ObservedObject& object : objects_) {
    const Pose in_world = object.pose_in_world();
    put(in_world);
    for (const Robot& robot : robots_) {
      put(robot.base_in_world().inverse() * in_world);
      if (robot.has_arm()) put(robot.tcp_in_world().inverse() * in_world);
    }
  }
}

}  // namespace robocell::internal
