// The first program of a project with robocell in its tree: builds a cell of a built-in robot and
// steps it.
#include <robocell/robocell.h>

#include <iostream>

int main() {
  robocell::SceneSpec spec{.timestep = 0.002, .add_floor = true, .add_skybox = false};
  const std::string file = robocell::assets::BuiltinRobotFile("rc7");
  spec.robots.push_back({.name = "arm", .config = robocell::RobotConfig::Load(file)});
  robocell::Scene scene = robocell::Scene::Build(spec);
  const bool stepped = scene.Step().ok();
  std::cout << robocell::Version() << ' ' << robocell::Robot::Of(scene, "arm").tcp_in_world()
            << '\n';
  return stepped ? 0 : 1;
}
