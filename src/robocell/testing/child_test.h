// Runs some of this test program's own tests in a child process with other environment variables.
// For tests only: for resources that exist once per process, such as the OpenGL library.
//
//   const ChildRun run = RunTestsInChild("Projection.*", "ROBOCELL_GL=osmesa");
//   EXPECT_TRUE(run.passed) << run.output;
#pragma once

#include <sys/wait.h>

#include <cstdio>
#include <filesystem>
#include <string>

namespace robocell {

struct ChildRun {
  bool passed = false;   // exit status 0: no test failed
  bool skipped = false;  // a test skipped itself
  std::string output;    // stdout and stderr
};

// `filter` is GoogleTest's.
inline ChildRun RunTestsInChild(const std::string& filter, const std::string& environment) {
  const std::string self = std::filesystem::read_symlink("/proc/self/exe");
  // Also works if this program runs only its share of the tests.
  const std::string command = "env -u GTEST_TOTAL_SHARDS -u GTEST_SHARD_INDEX " + environment +
                              " '" + self + "' --gtest_filter='" + filter + "' 2>&1";
  ChildRun run;
  FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) return run;
  char buffer[4096];
  while (const size_t n = fread(buffer, 1, sizeof buffer, pipe)) run.output.append(buffer, n);
  const int status = pclose(pipe);
  run.passed = WIFEXITED(status) && WEXITSTATUS(status) == 0 &&
               run.output.find("[  PASSED  ]") != std::string::npos;
  run.skipped = run.output.find("[  SKIPPED ]") != std::string::npos;
  return run;
}

}  // namespace robocell
