// Collision-aware planning, for row P15 of RESULTS.md.
//
//   build/release/motion_bench PROBLEMS ROBOT.yaml...
//
// Seeded problems for each robot in four families of scenes: a table with boxes, a shelf, a deep
// box, a clutter of floating objects; each also in a hard form: narrower, or with twice the objects. Start and goal are joint positions whose TCP is at work there
// and whose clearance is at least 3 mm. Each is planned once, with a clearance of 1.2 mm, by a
// planner that was made for its scene; the time is the processor's for
// MotionPlanner::PlanFrom, path checked and shortened. Prints one line of JSON for each robot and family: problems, solved, p50, p99 and
// max in ms, and `collisions`: paths that the engine's collision detection, which the planner does
// not use, finds nearer than 1 mm at steps of half a degree; `straight`: solved without a search.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <functional>
#include <string>
#include <vector>

#include "robocell/motion/motion_planner.h"
#include "robocell/robot/collision_filter.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"

namespace robocell {
namespace {

constexpr int kScenes = 10;          // of each family
constexpr double kPlanned = 0.0012;  // m
constexpr double kChecked = 0.001;
constexpr double kProblem = 0.003;

SceneObject Fixed(const std::string& name, Shape shape, const Vec3& size, const Vec3& pos,
                  double yaw = 0) {
  SceneObject object{.name = name, .shape = shape, .size = size, .pos = pos};
  object.euler = {0, 0, yaw};
  object.rgba = Vec4{0.6, 0.6, 0.6, 1};
  object.mass = 1;
  object.friction = Vec3{1, 0.01, 0.001};
  object.fixed = true;
  return object;
}

// Returns the processor time of this thread, which other programs on the core do not change.
double ProcessorMs() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

struct Region {  // where the TCP works, in the robot's frame
  Eigen::Vector3d low, high;
};

struct Family {
  std::string name;
  std::function<std::vector<Region>(double reach, bool hard, Rng&, SceneSpec*)> build;
  bool hard = false;
};

std::vector<Region> Tabletop(double reach, bool hard, Rng& rng, SceneSpec* spec) {
  const double r = reach;
  spec->objects.push_back(
      Fixed("table", Shape::kBox, {0.35 * r, 0.8 * r, 0.02}, {0.6 * r, 0, -0.03}));
  for (int k = 0; k < (hard ? 12 : 6); ++k) {
    const double height = (hard ? rng.Uniform(0.1, 0.3) : rng.Uniform(0.05, 0.2)) * r;
    const double x = rng.Uniform(0.35, 0.75) * r, y = rng.Uniform(-0.5, 0.5) * r;
    spec->objects.push_back(
        Fixed("box" + std::to_string(k), Shape::kBox,
              {rng.Uniform(0.03, 0.07) * r, rng.Uniform(0.03, 0.07) * r, height},
              {x, y, height - 0.01}, rng.Uniform(0, 180)));
  }
  return {{{0.35 * r, -0.6 * r, 0.05 * r}, {0.75 * r, 0.6 * r, 0.35 * r}}};
}

std::vector<Region> Shelf(double reach, bool hard, Rng& rng, SceneSpec* spec) {
  const double r = reach, x = rng.Uniform(0.65, 0.75) * r,
               gap = (hard ? 0.27 : rng.Uniform(0.3, 0.38)) * r;
  std::vector<Region> bays;
  for (int k = 0; k < 3; ++k) {
    const double z = 0.1 * r + k * gap;
    spec->objects.push_back(
        Fixed("board" + std::to_string(k), Shape::kBox, {0.15 * r, 0.45 * r, 0.01}, {x, 0, z}));
    if (k < 2) {
      bays.push_back(
          {{x - 0.12 * r, -0.35 * r, z + 0.08 * r}, {x + 0.05 * r, 0.35 * r, z + gap - 0.08 * r}});
    }
  }
  const double middle = 0.1 * r + gap;
  spec->objects.push_back(
      Fixed("back", Shape::kBox, {0.01, 0.45 * r, gap}, {x + 0.16 * r, 0, middle}));
  for (const int side : {-1, 1}) {
    spec->objects.push_back(Fixed("side" + std::to_string(side + 1), Shape::kBox,
                                  {0.15 * r, 0.01, gap}, {x, side * 0.46 * r, middle}));
  }
  return bays;
}

std::vector<Region> DeepBox(double reach, bool hard, Rng& rng, SceneSpec* spec) {
  const double r = reach, x = rng.Uniform(0.5, 0.6) * r, y = rng.Uniform(-0.2, 0.2) * r;
  const double a = (hard ? 0.15 : rng.Uniform(0.17, 0.22)) * r;
  const double b = (hard ? 0.18 : rng.Uniform(0.2, 0.26)) * r, h = (hard ? 0.19 : 0.15) * r;
  spec->objects.push_back(Fixed("bottom", Shape::kBox, {a, b, 0.01}, {x, y, -0.02}));
  for (const int side : {-1, 1}) {
    const std::string end = std::to_string(side + 1);
    spec->objects.push_back(
        Fixed("end" + end, Shape::kBox, {0.01, b, h}, {x + side * a, y, h - 0.02}));
    spec->objects.push_back(
        Fixed("side" + end, Shape::kBox, {a, 0.01, h}, {x, y + side * b, h - 0.02}));
  }
  return {{{x - 0.5 * a, y - 0.5 * b, 0.1 * r}, {x + 0.5 * a, y + 0.5 * b, 0.25 * r}},
          {{0.2 * r, -0.6 * r, 0.4 * r}, {0.7 * r, 0.6 * r, 0.7 * r}}};
}

std::vector<Region> Clutter(double reach, bool hard, Rng& rng, SceneSpec* spec) {
  const double r = reach;
  for (int k = 0; k < (hard ? 40 : 20); ++k) {
    const double yaw = rng.Uniform(-180, 180), distance = rng.Uniform(0.35, 0.95) * r;
    const Vec3 at = {distance * std::cos(yaw * M_PI / 180), distance * std::sin(yaw * M_PI / 180),
                     rng.Uniform(0.0, 0.9) * r};
    const Shape shape = rng.Choice(std::vector{Shape::kBox, Shape::kSphere, Shape::kCylinder});
    const Vec3 size = {rng.Uniform(0.03, 0.08) * r, rng.Uniform(0.03, 0.08) * r,
                       rng.Uniform(0.03, 0.08) * r};
    spec->objects.push_back(Fixed("thing" + std::to_string(k), shape, size, at, yaw));
  }
  return {{{-0.8 * r, -0.8 * r, 0.1 * r}, {0.8 * r, 0.8 * r, 0.9 * r}}};
}

struct Times {
  std::vector<double> ms;
  int solved = 0, problems = 0, collisions = 0, straight = 0;
  double At(double part) const {
    return ms.empty() ? 0 : ms[static_cast<size_t>(part * static_cast<double>(ms.size() - 1))];
  }
};

// Returns a free configuration whose TCP is in one of the regions, from all sides for a clutter.
std::optional<std::vector<double>> Draw(const Robot& robot, const MotionPlanner& planner,
                                        CollisionFilter* filter, const Region& region, bool inwards,
                                        Rng& rng) {
  Eigen::Vector3d at;
  for (int i = 0; i < 3; ++i) at[i] = rng.Uniform(region.low[i], region.high[i]);
  const double yaw =
      inwards ? std::atan2(at.y(), at.x()) + rng.Uniform(-0.5, 0.5) : rng.Uniform(-M_PI, M_PI);
  // The approach axis: forwards and somewhat down, or anywhere.
  const double pitch = rng.Uniform(inwards ? M_PI / 2 : 0, M_PI);
  const Pose tcp = Pose::FromRpy(at, {0, 0, yaw}) * Pose::FromRpy({0, 0, 0}, {0, pitch, 0}) *
                   Pose::FromRpy({0, 0, 0}, {0, 0, rng.Uniform(-M_PI, M_PI)});
  JointVector seed(robot.n_joints());
  for (int i = 0; i < seed.size(); ++i) {
    const Interval limits = planner.joint_limits()[i];
    seed[i] = rng.Uniform(std::max(limits.lower, -3.1), std::min(limits.upper, 3.1));
  }
  const IkResult found = robot.Ik(tcp, {.seed = seed, .max_restarts = 20});
  if (!found.success || !filter->IsFree(found.q)) return std::nullopt;
  std::vector<double> q(found.q.begin(), found.q.end());
  for (double& x : q) x = std::remainder(x, 2 * M_PI);  // of joints without limits
  for (int i = 0; i < seed.size(); ++i) {
    const Interval limits = planner.joint_limits()[i];
    if (q[i] < limits.lower || q[i] > limits.upper) q[i] = found.q[i];
  }
  return q;
}

bool Collides(CollisionFilter* filter, const std::vector<std::vector<double>>& path) {
  for (size_t k = 1; k < path.size(); ++k) {
    double longest = 0;
    for (size_t i = 0; i < path[k].size(); ++i)
      longest = std::max(longest, std::abs(path[k][i] - path[k - 1][i]));
    const int steps = std::max(1, static_cast<int>(std::ceil(longest / (M_PI / 360))));
    for (int s = 0; s <= steps; ++s) {
      std::vector<double> q(path[k].size());
      for (size_t i = 0; i < q.size(); ++i)
        q[i] = path[k - 1][i] + s * (path[k][i] - path[k - 1][i]) / steps;
      if (!filter->IsFree(q)) return true;
    }
  }
  return false;
}

Times Run(const std::string& file, const Family& family, int problems) {
  Times times;
  for (int s = 0; s < kScenes; ++s) {
    Rng rng = Rng::Stream(15, family.name, s);
    RobotConfig config = RobotConfig::Load(file);
    config.base.kind = BaseKind::kFixed;
    SceneSpec spec{.name = "plan", .timestep = 0.002, .add_floor = false, .add_skybox = false};
    spec.robots.push_back({.name = "robot", .config = config});
    double reach = 0;
    {
      const Scene bare = Scene::Build(spec);
      reach = Robot::Of(bare, "robot").reach();
    }
    const std::vector<Region> regions = family.build(reach, family.hard, rng, &spec);
    Scene scene = Scene::Build(spec);
    scene.Reset();
    const Robot robot = Robot::Of(scene, "robot");
    MotionPlanner planner(robot, {.clearance = kPlanned});
    CollisionFilter apart(robot, {.clearance = kProblem}), checked(robot, {.clearance = kChecked});
    int made = 0;
    for (int tries = 0; tries < 40000 && made < problems / kScenes; ++tries) {
      const Region& a = rng.Choice(regions);
      const Region& b = regions.size() == 2 ? regions[&a == regions.data() ? 1 : 0] : a;
      const bool inwards = family.name.find("clutter") == std::string::npos;
      const auto start = Draw(robot, planner, &apart, a, inwards, rng);
      if (!start) continue;
      std::optional<std::vector<double>> goal;
      for (int k = 0; k < 200 && !goal; ++k) goal = Draw(robot, planner, &apart, b, inwards, rng);
      if (!goal) continue;
      ++made;
      const MotionGoal goals[] = {MotionGoal::Joints(*goal)};
      const double begin = ProcessorMs();
      const MotionResult result = planner.PlanFrom(*start, goals);
      const double ms = ProcessorMs() - begin;
      ++times.problems;
      times.solved += result.success;
      if (result.success) times.ms.push_back(ms);
      times.straight += result.success && result.iterations == 0;
      if (!result.success) std::fprintf(stderr, "%s\n", result.message.c_str());
      if (result.success && Collides(&checked, result.path)) ++times.collisions;
    }
  }
  std::sort(times.ms.begin(), times.ms.end());
  return times;
}

}  // namespace
}  // namespace robocell

int main(int argc, char** argv) try {
  using namespace robocell;
  const int problems = argc > 1 ? std::atoi(argv[1]) : 50;
  const Family families[] = {{"tabletop", Tabletop},
                             {"shelf", Shelf},
                             {"box", DeepBox},
                             {"clutter", Clutter},
                             {"hard tabletop", Tabletop, true},
                             {"hard shelf", Shelf, true},
                             {"hard box", DeepBox, true},
                             {"hard clutter", Clutter, true}};
  for (int k = 2; k < argc; ++k) {
    for (const Family& family : families) {
      const Times times = Run(argv[k], family, problems);
      std::printf(
          "{\"robot\": \"%s\", \"family\": \"%s\", \"problems\": %d, \"solved\": %d, \"p50\": "
          "%.3f, "
          "\"p99\": %.3f, \"max\": %.3f, \"collisions\": %d, \"straight\": %d}\n",
          argv[k], family.name.c_str(), times.problems, times.solved, times.At(0.5), times.At(0.99),
          times.At(1), times.collisions, times.straight);
      std::fflush(stdout);
    }
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "error: %s\n", error.what());
  return 1;
}
