// For tests only: a scene with a robot and a box, and random work in any scene.
#pragma once

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/assets/resolve.h"
#include "robocell/base/rng.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/scenes.h"

namespace robocell {

inline SceneSpec Workplace() {
  SceneSpec spec = EmptyScene();
  spec.robots.push_back({.config = RobotConfig::Load(assets::BuiltinRobotFile("rc7"))});
  spec.objects.push_back(BoxObject("cube", {0.5, 0, 0.02}));
  return spec;
}

// Steps with random controls, forces and switches.
inline void LiveOn(Scene& scene, Rng& rng) {
  const mjModel* m = scene.model();
  mjData* d = scene.data();
  const auto inputs = static_cast<int>(m->nu);
  for (int i = 0; i < inputs; ++i) {
    const mjtNum* range = m->actuator_ctrlrange + 2 * i;
    d->ctrl[i] = m->actuator_ctrllimited[i] ? rng.Uniform(range[0], range[1]) : rng.Uniform(-1, 1);
  }
  for (int i = 0; i < m->nv; ++i) d->qfrc_applied[i] = rng.Uniform(-0.01, 0.01);
  for (int i = 6; i < 6 * m->nbody; ++i) d->xfrc_applied[i] = rng.Uniform(-0.01, 0.01);
  for (int i = 0; i < m->neq; ++i) d->eq_active[i] = rng.UniformInt(2) == 0;
  for (int i = 0; i < 3 * m->nmocap; ++i) d->mocap_pos[i] += rng.Uniform(-0.001, 0.001);
  EXPECT_TRUE(scene.StepN(1 + static_cast<int>(rng.UniformInt(40))).ok());
}

}  // namespace robocell
