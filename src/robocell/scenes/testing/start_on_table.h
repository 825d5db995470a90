// For tests only: objects of a start on the built-in table.
#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/scenes/object_places.h"
#include "robocell/scenes/related_places.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {

inline SceneObject Block(const std::string& name, const Vec3& half) {
  SceneObject block = BoxObject(name, {0, 0, 0});
  block.pos.reset();
  block.size = half;
  return block;
}

// A table and a start on it.
struct Start {
  SceneSpec base{.name = "kitchen", .base = "tabletop", .add_floor = true};
  std::vector<SceneObject> objects;
  std::vector<std::string> kinds;

  explicit Start(std::vector<SceneObject> of) : objects(std::move(of)) {
    for (const SceneObject& object : objects) kinds.push_back(object.shape ? "box" : "tray");
  }
  std::vector<ObjectSize> sizes() const {
    std::vector<ObjectSize> out;
    ObjectSizes measured;
    for (const SceneObject& object : objects) out.push_back(measured.Of(object));
    return out;
  }
  RelatedPlaces Related(const Map<ObjectPlace>& places,
                        const Map<ObjectPlace>& of_task = {}) const {
    const std::vector<StatedPlaces> stated = {{places, "start.places"},
                                              {of_task, "task", "places()"}};
    const auto may_come = [](const std::string& name) { return name == "mug"; };
    Problems problems;
    RelatedPlaces related(
        LinkPlaces(LandmarksOf(base), stated, {objects, kinds, may_come}, problems));
    problems.Throw("start");
    return related;
  }
  std::string Error(const Map<ObjectPlace>& places) const {
    return ExpectThrow<SpecError>([&] { (void)Related(places); }, "");
  }
  // Puts all, those without a place on the table.
  std::optional<std::string> Put(const RelatedPlaces& related, Rng& rng) {
    const Support table = FindSupport(base);
    const std::vector<ObjectSize> all = sizes();
    std::vector<SceneObject> loose;
    std::vector<ObjectSize> loose_sizes;
    for (size_t i = 0; i < objects.size(); ++i) {
      if (related.IsRelated(i)) continue;
      loose.push_back(objects[i]);
      ForgetPose(loose.back());
      loose_sizes.push_back(all[i]);
    }
    if (!PlaceOn(table, loose_sizes, loose, rng)) return "no room on the table";
    for (size_t i = 0, next = 0; i < objects.size(); ++i) {
      if (!related.IsRelated(i)) objects[i] = loose[next++];
    }
    return related.Put(table, all, objects, rng);
  }
  // The scene after everything came to rest.
  Scene Settled() const {
    SceneSpec spec = base;
    for (const SceneObject& object : objects) spec.objects.push_back(object);
    Scene scene = Scene::Build(spec);
    scene.Reset();
    EXPECT_TRUE(scene.StepN(400).ok());
    return scene;
  }
};

}  // namespace robocell::internal
