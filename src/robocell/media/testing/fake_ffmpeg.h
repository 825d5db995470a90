// For tests only: programs that replace ffmpeg, and processes for them.
#pragma once

#include <stdlib.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "robocell/testing/temp_dir.h"

namespace robocell {

// Runs `body` in a process of its own and returns its exit code.
template <typename Body>
int InOwnProcess(Body body) {
  const pid_t pid = fork();
  if (pid == 0) _exit(body());
  int status = 0;
  waitpid(pid, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
}

// A program that replaces ffmpeg during the lifetime of the object.
class FakeFfmpeg {
 public:
  explicit FakeFfmpeg(const std::string& script) {
    const std::filesystem::path program = folder_ / "ffmpeg";
    std::ofstream(program) << "#!/bin/sh\n" << script << "\n";
    chmod(program.c_str(), 0755);
    setenv("ROBOCELL_FFMPEG", program.c_str(), 1);
  }
  ~FakeFfmpeg() { unsetenv("ROBOCELL_FFMPEG"); }

 private:
  TempDir folder_;
};

}  // namespace robocell
