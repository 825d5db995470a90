// StartContents: what a task adds to the scene of a start: its objects and their kinds.
//
//   SceneSpec spec = MakeBaseScene(run, 0);
//   const StartContents contents = PrepareContents(*task, {.known = known, .kind = "stack"}, spec, rng);
#pragma once

#include <string>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/scene/scene.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/spec/scene_object.h"
#include "robocell/spec/scene_spec.h"
#include "robocell/task/start_turn.h"
#include "robocell/task/task.h"

namespace robocell {

struct StartContents {
  std::vector<SceneObject> objects;  // the target first
  std::vector<std::string> kinds;    // kind of each object (Task::kind_of)
};

// How a task is asked for its contents.
struct StartPreparation {
  const Task::KnownScene& known;  // annotations of the scene
  const std::string& kind;        // of the task, in messages
  StartTurn turn = {};
};

void AppendTo(StartContents& contents, const StartContents& more);
// Replaces the objects of a scene from number `before` on, and adds those that it lacks.
void ReplaceObjects(SceneSpec& spec, size_t before, const std::vector<SceneObject>& objects);

// Calls Prepare, and returns what it added to the scene.
StartContents PrepareContents(Task& task, const StartPreparation& how, SceneSpec& spec, Rng& rng);

// Throws HookError for objects that are not valid or too large to be handled: they are measured before
// they are compiled into a scene. Throws the errors of BuildPrepared for models that do not compile.
// `kind` names the task.
void RequireSound(const StartContents& contents, const Task& task, const std::string& kind,
                  ObjectSizes& sizes);

// Builds a scene to which the task added its objects from number `before` on. Errors about them name
// the line of its prepare(), if the task is a user's.
Scene BuildPrepared(const SceneSpec& spec, size_t before, const Task& task,
                    const DataFactory& scene_data = {});

// Returns one object of each kind in `contents`, which is named by its kind if that can be a name.
// Contents in which objects are attached to each other give all of their objects, by their names.
std::vector<SceneObject> OneOfEachKind(const std::vector<StartContents>& contents);

}  // namespace robocell
