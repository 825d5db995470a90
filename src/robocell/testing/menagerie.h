// Finds the MuJoCo Menagerie's robots for tests. For tests only; the library has assets/.
//
// Looked at in this order, the first that is there wins:
//   1. the folder named by the environment variable MENAGERIE_ROOT
//   2. ../shared/menagerie beside the repository
//   3. the cache of the Python package mujoco-menagerie (MENAGERIE_CACHE_DIR, else the user's
//   cache)
// For 2, MENAGERIE_ROOT is set for this process, so that `menagerie:` names in specs and robot
// files resolve to the same files.
//
//   TEST(Chain, AgreesWithTheEngineOnXArm7) {
//     REQUIRE_MENAGERIE("ufactory_xarm7");
//     const std::string path = MenagerieModel("ufactory_xarm7", "xarm7.xml");
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "robocell/testing/skip.h"

namespace robocell {

// The models that tests may use: `REQUIRE_MENAGERIE()` without names requires all of them.
const std::vector<std::string>& MenagerieTestModels();

// Returns the full path of a model's folder or of one file in it, e.g. ("ufactory_xarm7",
// "xarm7.xml"). Throws IoError with MissingMenagerie's text if it is missing.
std::string MenagerieModel(std::string_view model, std::string_view file = "");

// Returns "" if all models (by default: MenagerieTestModels()) exist; else a sentence that names
// the missing ones, the searched places and the command that fetches them.
std::string MissingMenagerie(const std::vector<std::string>& models);

}  // namespace robocell

// Skips the running test (fails it with CI=true) unless the named models, or all, exist.
#define REQUIRE_MENAGERIE(...)                                                                     \
  do {                                                                                             \
    if (const std::string missing = ::robocell::MissingMenagerie({__VA_ARGS__}); !missing.empty()) \
      SKIP_OR_FAIL(missing);                                                                       \
  } while (false)
