// An environment variable for as long as a test needs it.
#pragma once

#include <cstdlib>
#include <string>

namespace robocell {

// Sets it and puts the former value back.
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
