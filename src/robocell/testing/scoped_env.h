// An environment variable for the duration of a test.
#pragma once

#include <cstdlib>
#include <string>

namespace robocell {

// Sets it, and restores the former value at the end.
class ScopedEnv {
 public:
  ScopedEnv(const char* name, const std::string& value) : name_(name) {
    if (const char* former = std::getenv(name)) former_ = former, had_ = true;
    setenv(name, value.c_str(), 1);
  }
  ~ScopedEnv() { had_ ? setenv(name_, former_.c_str(), 1) : unsetenv(name_); }
  ScopedEnv(const ScopedEnv&) = delete;
  ScopedEnv& operator=(const ScopedEnv&) = delete;

 private:
  const char* name_;
  std::string former_;
  bool had_ = false;
};

}  // namespace robocell
