#include "robocell/task/start_contents.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <set>
#include <string_view>
#include <utility>

#include "robocell/base/call_hook.h"
#include "robocell/base/error.h"
#include "robocell/base/paths.h"
#include "robocell/spec/locations.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/validate.h"
#include "robocell/task/task_calls.h"

namespace robocell {
namespace {

// A model that cannot be measured has the same error in a scene, where it has a place. Missing files
// are errors of the hook.
ObjectSize SizeOf(const SceneObject& object, const Task& task, ObjectSizes& sizes) {
  try {
    return sizes.Of(object);
  } catch (const NotFoundError&) {
    throw;
  } catch (const Error&) {
    SceneSpec alone{.timestep = 0.002, .add_floor = false, .add_skybox = false};
    alone.objects.push_back({.name = object.name, .mjcf_path = object.mjcf_path});
    BuildPrepared(alone, 0, task);
    throw;
  }
}

}  // namespace

Scene BuildPrepared(const SceneSpec& spec, size_t before, const Task& task,
                    const DataFactory& scene_data) {
  try {
    return Scene::Build(spec, scene_data);
  } catch (const Error&) {
    const std::string place = task.PlaceOfHook("prepare");
    if (place.empty() || before == spec.objects.size()) throw;
    SourceMap sources;
    for (size_t i = before; i < spec.objects.size(); ++i)
      sources[fmt::format("objects[{}]", i)] = place;
    SceneSpec located = spec;
    located.locations = Locations(std::make_shared<const SourceMap>(std::move(sources)));
    try {
      Scene::Build(located, scene_data);
    } catch (const Error& error) {
      if (std::string_view(error.what()).find(place) != std::string_view::npos) throw;
    }
    throw;  // it is not about them
  }
}

StartContents PrepareContents(Task& task, const StartPreparation& how, SceneSpec& spec, Rng& rng) {
  const size_t before = spec.objects.size();
  internal::TaskCalls calls(task);
  calls.Prepare(how.known, spec, rng, how.kind, how.turn);
  StartContents contents;
  for (size_t i = before; i < spec.objects.size(); ++i) {
    const std::string& name = spec.objects[i].name;
    contents.objects.push_back(spec.objects[i]);
    contents.kinds.push_back(calls.KindOf(name));
    if (!contents.kinds.back().empty()) continue;
    internal::CallHook(task, "kind_of", [&] {
      throw ArgumentError(fmt::format(
          "task '{}': kind_of() returned \"\" for object '{}'; return its name if it has no kind",
          how.kind, name));
    });
  }
  return contents;
}

void RequireSound(const StartContents& contents, const Task& task, const std::string& kind,
                  ObjectSizes& sizes) {
  internal::CallHook(task, "prepare", [&] {
    const std::string who = "task '" + kind + "': prepare added ";
    for (const SceneObject& object : contents.objects) {
      Problems problems;
      ValidateFields(object, problems);
      if (problems.empty()) continue;
      throw ArgumentError(fmt::format("{}object '{}', which is not valid: {}", who, object.name,
                                      fmt::join(LinesOf(problems), "; ")));
    }
    for (const SceneObject& object : contents.objects) {
      if (const std::string why = WhyTooLarge(object, SizeOf(object, task, sizes)); !why.empty())
        throw ArgumentError(fmt::format("{}an object that cannot be handled: {}", who, why));
    }
  });
}

std::vector<SceneObject> OneOfEachKind(const std::vector<StartContents>& contents) {
  std::vector<SceneObject> objects;
  std::set<std::string> known;
  for (const StartContents& each : contents) {
    const bool are_attached = std::ranges::any_of(each.objects, [](const SceneObject& object) {
      return !(object.attach_to == AttachTarget{});
    });
    for (size_t i = 0; i < each.objects.size(); ++i) {
      SceneObject object = each.objects[i];
      const std::string& kind = each.kinds[i];
      if (!known.insert(are_attached ? object.name : kind).second) continue;
      if (!are_attached && internal::ValidFileName(kind)) object.name = kind;
      objects.push_back(std::move(object));
    }
  }
  return objects;
}

void ReplaceObjects(SceneSpec& spec, size_t before, const std::vector<SceneObject>& objects) {
  for (size_t i = 0; i < objects.size(); ++i) {
    if (before + i < spec.objects.size())
      spec.objects[before + i] = objects[i];
    else
      spec.objects.push_back(objects[i]);
  }
}

void AppendTo(StartContents& contents, const StartContents& more) {
  contents.objects.insert(contents.objects.end(), more.objects.begin(), more.objects.end());
  contents.kinds.insert(contents.kinds.end(), more.kinds.begin(), more.kinds.end());
}

}  // namespace robocell
