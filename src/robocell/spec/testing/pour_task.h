// For tests only: a user's own kind of task, and run files that name it.
#pragma once

#include "robocell/spec/env_config.h"
#include "robocell/spec/kind_fields.h"
#include "robocell/spec/run_config.h"
#include "robocell/spec/task_spec.h"
#include "robocell/spec/yaml.h"

namespace robocell {

inline const std::string kRunHead = "run: r\nrobot: {name: a, model: b}\noutput: o\n";

inline RunConfig Parse(const std::string& task) {
  return ParseYaml<RunConfig>(kRunHead + "task: " + task + "\n", "run.yaml", "");
}

// A kind of this test's own, registered once.
struct PourConfig {
  double angle = 0.5;
  NameList cups = {};

  static constexpr const char* kKind = "pour_of_test";
  static constexpr const char* kTypeName = "PourConfig";
  template <class V>
  static void Fields(V&& v) {
    v("angle", &PourConfig::angle, "How far to tilt, radians.", Bound::kPositive);
    v("cups", &PourConfig::cups, "Names of the cups.");
  }
};

// Runs pour without cups, environments only with them.
class PourRules final : public KindRules {
 public:
  void ValidateRun(const RunConfig& run, Problems& problems) const override {
    if (!run.task.As<PourConfig>().cups.empty())
      problems.AddAt("task.cups", "belongs to environments");
  }
  void ValidateEnv(const EnvConfig& env, Problems& problems) const override {
    if (env.task->As<PourConfig>().cups.empty()) problems.AddAt("task.cups", "is required");
  }
};

inline void RegisterPour() {
  static const bool kDone = [] {
    TaskKindRegistry().Register(
        PourConfig::kKind,
        {std::make_shared<KindFieldsOf<PourConfig>>(), std::make_shared<PourRules>()}, false);
    return true;
  }();
  (void)kDone;
}

}  // namespace robocell
