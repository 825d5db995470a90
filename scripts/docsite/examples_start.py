import numpy as np

import robocell as rc
import robocell.export
import robocell.gym

spec = rc.SceneSpec(name="cell", timestep=0.002, add_floor=True, add_skybox=True)
config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
spec.robots.append(rc.RobotSpec(name="arm", config=config))
cube = rc.SceneObject(name="cube", shape="box", size=[0.02, 0.02, 0.02], pos=[0.5, 0, 0.02])
cube.rgba, cube.mass, cube.friction = [1, 0.5, 0, 1], 0.1, [0.8, 0.02, 0.001]
spec.objects.append(cube)
scene = rc.Scene.build(spec)
robot = rc.Robot.of(scene, "arm")
env = rc.Env(rc.EnvConfig.load(rc.models.cell_file("rc7")))
run = rc.RunConfig.load("examples/demo.yaml", ["output=examples_output"])
dataset = rc.Dataset("experiment_output/demo")  # `make demo` makes it
episode = dataset[0]
