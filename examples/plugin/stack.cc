// A custom task and its expert in C++: put the red cube on the blue one. The same in Python:
// ../stack_cubes.py. CMakeLists.txt builds it and shows how to run it.
#include <robocell/robocell.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace rc = robocell;

namespace {

// The fields of `task:`.
struct StackConfig {
  double edge = 0.04;
  static constexpr const char* kKind = "red_on_blue";
  static constexpr const char* kTypeName = "StackConfig";
  template <class V>
  static void Fields(V&& v) {
    v("edge", &StackConfig::edge, "Of the cubes, metres.", rc::Bound::kPositive);
  }
};

// Success: red lies on blue, and nothing else touches it.
class Stack : public rc::Task {
 public:
  explicit Stack(const StackConfig& fields) : edge_(fields.edge) {}

  void Prepare(rc::SceneSpec& spec, rc::Rng& /*rng*/) override {
    AddCube(spec, "red", {0.9, 0.2, 0.15, 1});
    AddCube(spec, "blue", {0.15, 0.35, 0.9, 1});
  }
  rc::TaskVerdict Judge(const rc::Scene& scene) override {
    const Eigen::Vector3d way =
        scene.body_pose("red").translation() - scene.body_pose("blue").translation();
    const double aside = way.head<2>().norm();
    bool success = std::abs(way.z() - edge_) < 0.003 && aside < edge_ / 3;
    bool on_blue = false;
    for (const rc::Contact& contact : scene.contacts("red")) {
      const std::string& other = contact.body1 == "red" ? contact.body2 : contact.body1;
      on_blue |= other == "blue";
      success &= other == "blue";
    }
    success &= on_blue;
    return {.reward = success ? 1 : 0.5 * std::exp(-10 * aside), .success = success};
  }
  std::string instruction() const override { return "put the red cube on the blue one"; }
  std::vector<std::string> objects() const override { return {"red", "blue"}; }

 private:
  void AddCube(rc::SceneSpec& spec, const std::string& name, const rc::Vec4& rgba) const {
    spec.objects.push_back({.name = name,
                            .shape = rc::Shape::kBox,
                            .size = rc::Vec3{edge_ / 2, edge_ / 2, edge_ / 2},
                            .rgba = rgba,
                            .mass = 0.08,
                            .friction = rc::Vec3{1, 0.02, 0.001}});
  }
  double edge_;
};

// Picks red up like the built-in expert, then moves it over blue, lowers it and lets go.
class Stacker : public rc::PickPlanner {
 public:
  Stacker(const rc::RunConfig& run, const rc::EpisodeStart& start)
      : PickPlanner(run, start),
        robot_(run.robot.config.name),
        edge_(run.task.As<StackConfig>().edge) {}

  rc::Action Act(const rc::Scene& scene, rc::Rng& rng) override {
    if (!PickPlanner::done()) return PickPlanner::Act(scene, rng);
    if (stops_.empty()) PlanStops(scene);
    const Stop& stop = stops_[at_];
    const Eigen::Vector3d way = stop.place - tcp_.translation();
    const double share = std::min(1.0, 0.02 / std::max(way.norm(), 1e-9));
    tcp_ = rc::Pose(tcp_.translation() + share * way, tcp_.quaternion());
    waited_ = way.norm() < 1e-6 ? waited_ + 1 : 0;
    if (waited_ > kWait && at_ + 1 < stops_.size()) ++at_;
    return {{robot_,
             {{"arm", rc::GroupCommand::LeafPose(base_ * tcp_)},
              {"gripper", rc::GroupCommand::Opening(stop.opening)}}}};
  }
  bool done() const override {
    return !failure().empty() || (at_ + 1 == stops_.size() && waited_ > kWait);
  }

 private:
  static constexpr int kWait = 6;  // actions in a stop
  struct Stop {
    Eigen::Vector3d place;  // position of the TCP
    double opening;
  };
  void PlanStops(const rc::Scene& scene) {
    const rc::Robot robot = rc::Robot::Of(scene, robot_);
    tcp_ = robot.tcp_in_world();
    base_ = robot.base_in_world().inverse();
    const Eigen::Vector3d on = tcp_.translation() - scene.body_pose("red").translation() +
                               scene.body_pose("blue").translation() +
                               Eigen::Vector3d(0, 0, edge_ + 0.002);
    const Eigen::Vector3d up(0, 0, 0.07);
    stops_ = {{on + up, 0}, {on, 0}, {on, 1}, {on + up, 1}};
  }

  std::string robot_;
  double edge_;
  std::vector<Stop> stops_;
  size_t at_ = 0;
  int waited_ = 0;
  rc::Pose tcp_, base_;
};

class StackerKind : public rc::ExpertKind {
  std::shared_ptr<rc::Expert> Make(const rc::RunConfig& run,
                                   const rc::EpisodeStart& start) const override {
    return std::make_shared<Stacker>(run, start);
  }
};

void Register() {
  rc::RegisterTask<StackConfig>(std::make_shared<rc::TaskKindOf<StackConfig, Stack>>());
  rc::RegisterExpert(StackConfig::kKind, std::make_shared<StackerKind>());
}

}  // namespace

ROBOCELL_PLUGIN(Register)
