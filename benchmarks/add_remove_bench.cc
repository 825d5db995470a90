// Adds and removes an object: from the pool, and by compiling anew, beside mj_recompile of the same
// scene. Row P10 of RESULTS.md.
//
//   build/release/add_remove_bench [ROBOT.yaml ...]   default: the built-in rc7
#include <mujoco/mujoco.h>

#include <memory>
#include <string>

#include "bench.h"

namespace robocell {
namespace {

constexpr int kSwaps = 100, kRebuilds = 2;  // each adds and removes

SceneObject Box(const std::string& name, double y) {
  return {.name = name,
          .shape = Shape::kBox,
          .size = Vec3{0.02, 0.02, 0.02},
          .rgba = Vec4{1, 0.5, 0, 1},
          .mass = 0.1,
          .friction = Vec3{0.8, 0.02, 0.001},
          .pos = Vec3{0.6, y, 0.02}};
}

// A robot, a present box and a pool of eight.
SceneSpec Spec(const std::string& file) {
  SceneSpec spec{.name = "bench", .timestep = 0.002, .add_floor = true, .add_skybox = false};
  spec.robots.push_back({.name = "robot", .config = RobotConfig::Load(file)});
  spec.objects.push_back(Box("there", 0));
  for (int i = 0; i < 8; ++i) {
    spec.objects.push_back(Box("pool" + std::to_string(i), 0.1 * (i + 1)));
    spec.objects.back().parked = true;
  }
  return spec;
}

struct Swapping {
  explicit Swapping(const std::string& file)
      : scene(Scene::Build(Spec(file))),
        robot(Robot::Of(scene, "robot")),
        spec(CopySpec(scene.compiled()->mutable_spec())),
        model(mj_compile(spec.get(), nullptr)),
        data(mj_makeData(model)) {}
  ~Swapping() {
    mj_deleteData(data);
    mj_deleteModel(model);
  }
  Swapping(const Swapping&) = delete;
  Swapping& operator=(const Swapping&) = delete;

  void Swap() {
    for (int i = 0; i < kSwaps; ++i) {
      scene.AddObject(name);
      scene.RemoveObject(name);
    }
  }
  void Rebuild() {
    for (int i = 0; i < kRebuilds; ++i) {
      scene.AddObject(other);
      scene.RemoveObject(other.name);
    }
  }
  void Recompile() {
    for (int i = 0; i < 2 * kRebuilds; ++i) mj_recompile(spec.get(), nullptr, model, data);
  }
  std::string Problem() const {
    return scene.object_names().size() == 1 ? "" : "objects are left over";
  }

  Scene scene;
  Robot robot;  // follows every rebuild
  const std::string name = "pool3";
  const SceneObject other = Box("other", -0.2);
  SpecPtr spec;
  mjModel* model;
  mjData* data;
};

void Register(const std::string& file) {
  const auto it = std::make_shared<Swapping>(file);
  const std::string robot = RobotConfig::Load(file).name;
  bench::Add({.row = robot,
              .side = "pool",
              .count = 2 * kSwaps,
              .run = [=] { it->Swap(); },
              .problem = [=] { return it->Problem(); }});
  bench::Add({.row = robot,
              .side = "rebuild",
              .count = 2 * kRebuilds,
              .run = [=] { it->Rebuild(); },
              .problem = [=] { return it->Problem(); }});
  bench::Add({.row = robot, .side = "mj_recompile", .count = 2 * kRebuilds, .run = [=] {
                it->Recompile();
              }});
}

}  // namespace
}  // namespace robocell

int main(int argc, char** argv) {
  return robocell::bench::Main(argc, argv, robocell::Register,
                               robocell::assets::BuiltinRobotFile("rc7"));
}
