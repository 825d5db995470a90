#include "robocell/scenes/randomized_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/mujoco/names.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

Scene CubeOnFloor() {
  SceneSpec spec{.timestep = 0.002, .add_floor = true, .add_skybox = true};
  spec.objects.push_back({.name = "cube",
                          .shape = Shape::kBox,
                          .size = Vec3{0.1, 0.1, 0.1},
                          .rgba = Vec4{0.8, 0.4, 0.2, 1},
                          .mass = 0.5,
                          .friction = Vec3{1, 0.005, 0.0001},
                          .pos = Vec3{0, 0, 0.1}});
  spec.objects.push_back({.name = "door", .mjcf_path = "cupboard", .pos = Vec3{1, 0, 0}});
  AddStudio(spec);
  return Scene::Build(spec);
}

RandomizedValues Everything() {
  return {{"light/number", {.numbers = {2}}},
          {"light/0/azimuth", {.numbers = {40}}},
          {"light/0/elevation", {.numbers = {50}}},
          {"light/0/colour", {.numbers = {1, 0.8, 0.6}}},
          {"light/1/intensity", {.numbers = {0.7}}},
          {"light/ambient", {.numbers = {0.1}}},
          {"sky/horizon", {.numbers = {1, 0.5, 0.2}}},
          {"sky/zenith", {.numbers = {0.1, 0.1, 0.4}}},
          {"cube/texture", {.numbers = {}, .word = "checker"}},
          {"cube/texture_seed", {.numbers = {7}}},
          {"cube/mass_scale", {.numbers = {1.7}}},
          {"cube/inertia_scale", {.numbers = {1.3}}},
          {"cube/friction", {.numbers = {0.3}}},
          {"floor/texture", {.numbers = {}, .word = "stripes"}},
          {"floor/specular", {.numbers = {0.9}}},
          {"door/colour_scale", {.numbers = {0.5, 1.5, 1}}},
          {"door/damping_scale", {.numbers = {3}}},
          {"door/mass", {.numbers = {5}}}};
}

std::vector<std::byte> BytesOf(const mjModel* m) {
  const auto* buffer = static_cast<const std::byte*>(m->buffer);
  std::vector<std::byte> bytes(buffer, buffer + m->nbuffer);
  const auto* vis = reinterpret_cast<const std::byte*>(&m->vis);
  const auto* stat = reinterpret_cast<const std::byte*>(&m->stat);
  bytes.insert(bytes.end(), vis, vis + sizeof m->vis);
  bytes.insert(bytes.end(), stat, stat + sizeof m->stat);
  return bytes;
}

TEST(RandomizedModel, RestoringGivesTheModelBackToTheByte) {
  Scene scene = CubeOnFloor();
  const std::vector<std::byte> before = BytesOf(scene.model());
  {
    RandomizedModel model(scene);
    model.Apply(Everything());
    EXPECT_NE(BytesOf(scene.model()), before);
    model.Restore();
    EXPECT_EQ(BytesOf(scene.model()), before);
    model.Apply(Everything());
  }
  EXPECT_EQ(BytesOf(scene.model()), before) << "the destructor restores too";
}

// A part with all that follows from masses and from the pose of the reference.
Scene Machine(const TempDir& folder) {
  AtomicWrite(folder / "machine.xml", R"(<mujoco><worldbody><body name="machine">
<geom size="0.05" mass="1"/><site name="wall" pos="0 0 0.1"/>
<body name="arm" pos="0 0 0.2"><joint axis="0 1 0"/>
<geom type="capsule" fromto="0 0 0 0.2 0 0" size="0.01"/><site name="end" pos="0.1 0 0"/></body>
<body name="rod" pos="0.3 0 0.2"><joint axis="0 1 0"/><geom size="0.02"/></body>
<body name="net" pos="1 0 1">
<flexcomp name="net" type="grid" count="3 3 1" spacing="0.05 0.05 0.05" dim="2" mass="0.1"
 radius="0.005"><edge equality="true"/></flexcomp></body></body></worldbody>
<equality><connect body1="arm" body2="rod" anchor="0.2 0 0"/></equality>
<tendon><spatial name="cord"><site site="wall"/><site site="end"/></spatial></tendon>
<actuator><muscle name="pull" tendon="cord" lengthrange="0.01 1"/></actuator></mujoco>)");
  SceneSpec spec{.timestep = 0.002, .add_floor = false, .add_skybox = false};
  spec.objects.push_back(
      {.name = "m", .mjcf_path = (folder / "machine.xml").string(), .fixed = true});
  return Scene::Build(spec);
}

TEST(RandomizedModel, RestoresWhatFollowsFromMassesOfFlexesTendonsAndMuscles) {
  const TempDir folder;
  Scene scene = Machine(folder);
  const mjModel* m = scene.model();
  ASSERT_GT(m->nflexedge, 0);
  ASSERT_GT(m->ntendon, 0);
  const std::vector<std::byte> before = BytesOf(m);
  const mjtNum flex = m->flexedge_invweight0[0], tendon = m->tendon_invweight0[0];
  RandomizedModel model(scene);
  model.Apply({{"m/mass_scale", {.numbers = {2}}}});
  EXPECT_NEAR(m->tendon_invweight0[0], tendon / 2, 1e-9 * tendon);
  EXPECT_NEAR(m->flexedge_invweight0[0], flex / 2, 1e-9 * flex);
  model.Restore();
  EXPECT_EQ(BytesOf(m), before);
}

TEST(RandomizedModel, KeepsAnchorsThatMovedSinceTheModelWasCompiled) {
  const TempDir folder;
  Scene scene = Machine(folder);
  mjModel* m = scene.mutable_model();
  int connect = 0;
  while (m->eq_type[connect] != mjEQ_CONNECT) ++connect;
  mjtNum* anchor = m->eq_data + static_cast<ptrdiff_t>(mjNEQDATA) * connect;
  anchor[4] += 0.25;  // on the second body: mj_setConst would compute it from the reference
  const std::vector<mjtNum> moved(anchor, anchor + mjNEQDATA);
  const std::vector<std::byte> before = BytesOf(m);
  RandomizedModel model(scene);
  model.Apply({{"m/mass_scale", {.numbers = {2}}}});
  EXPECT_EQ(std::vector<mjtNum>(anchor, anchor + mjNEQDATA), moved);
  model.Restore();
  EXPECT_EQ(BytesOf(m), before);
}

TEST(RandomizedModel, AnotherObjectCannotHaveTheNameOfTheStudio) {
  SceneSpec spec;
  spec.objects.push_back({.name = "studio", .mjcf_path = "mug"});
  ExpectThrow<ArgumentError>([&] { AddStudio(spec); }, "give the object another name");
}

// Its lights and materials are those of the built-in model, not those of names that begin alike.
TEST(RandomizedModel, AnObjectWhoseNameBeginsLikeTheStudioKeepsItsLights) {
  const TempDir folder;
  AtomicWrite(folder / "lamp.xml",
              "<mujoco><worldbody><body name='lamp'><geom size='0.1'/>"
              "<light name='bulb'/></body></worldbody></mujoco>");
  SceneSpec spec{.timestep = 0.002, .add_floor = false, .add_skybox = false};
  spec.objects.push_back(
      {.name = "studio_lamp", .mjcf_path = (folder / "lamp.xml").string(), .fixed = true});
  AddStudio(spec);
  const Scene scene = Scene::Build(spec);
  const mjModel* m = scene.model();
  RandomizedModel model(scene);
  ExpectThrow<ArgumentError>(
      [&] {
        model.Apply({{"light/number", {.numbers = {5}}}});
      },
      "lights for 0 to 4");
  model.Apply({{"light/number", {.numbers = {4}}}});
  for (int i = 0; i < m->nlight; ++i) {
    const bool is_studio = ElementName(m, mjOBJ_LIGHT, i).starts_with("studio_light_");
    if (is_studio) EXPECT_TRUE(m->light_active[i]);
  }
}

TEST(RandomizedModel, ValuesAreOfTheModelsOwnHoweverOftenTheyAreApplied) {
  Scene scene = CubeOnFloor();
  RandomizedModel model(scene);
  model.Apply(Everything());
  const std::vector<std::byte> once = BytesOf(scene.model());
  RandomizedValues reversed = Everything();
  std::ranges::reverse(reversed.entries());
  model.Apply(reversed);
  EXPECT_EQ(BytesOf(scene.model()), once);
  const mjModel* m = scene.model();
  const int cube = FindId(m, mjOBJ_BODY, "cube");
  EXPECT_DOUBLE_EQ(m->body_mass[cube], 0.5 * 1.7);
  EXPECT_DOUBLE_EQ(m->body_inertia[3 * cube], 0.5 * 0.2 * 0.2 / 6 * 1.7 * 1.3);
  double mass = 0;
  for (const int b : model.targets().At("door", "").bodies) mass += m->body_mass[b];
  EXPECT_NEAR(mass, 5, 1e-12);
}

TEST(RandomizedModel, WhatIsNotThereIsNamedWithTheNearest) {
  Scene scene = CubeOnFloor();
  RandomizedModel model(scene);
  const auto apply = [&](const std::string& name, RandomizedValue value) {
    model.Apply({{name, std::move(value)}});
  };
  ExpectThrow<NotFoundError>([&] { apply("cubes/mass_scale", {.numbers = {1}}); },
                             "Did you mean 'cube'?");
  ExpectThrow<NotFoundError>([&] { apply("cube/mas_scale", {.numbers = {1}}); },
                             "Did you mean 'mass'?");
  ExpectThrow<NotFoundError>([&] { apply("light/9/azimuth", {.numbers = {1}}); },
                             "light/0/azimuth");
  ExpectThrow<ArgumentError>([&] { apply("cube/colour", {.numbers = {1}}); },
                             "red, green and blue");
  ExpectThrow<ArgumentError>([&] { apply("cube/mass", {.numbers = {0}}); }, "must be above 0");
}

}  // namespace
}  // namespace robocell::internal
