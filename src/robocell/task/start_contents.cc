#include "robocell/task/start_contents.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "robocell/base/call_hook.h"
#include "robocell/base/error.h"
#include "robocell/base/paths.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/validate.h"
#include "robocell/task/task_calls.h"

namespace robocell {
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
      if (const std::string why = WhyTooLarge(object, sizes.Of(object)); !why.empty())
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

}  // namespace robocell
