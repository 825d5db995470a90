// A shared library opened at run time, for the GL back ends. Internal to render/.
#pragma once

#include <string>

namespace robocell {

class GlLibrary {
 public:
  // Opens the first of the names that exists. Never closed: GL drivers do not survive being
  // unloaded. Throws IoError with the loader's reasons.
  explicit GlLibrary(std::initializer_list<const char*> names);

  // Throws IoError when the function is missing.
  void* Symbol(const char* name) const;
  template <class Function>
  void Load(Function*& function, const char* name) const {
    function = reinterpret_cast<Function*>(Symbol(name));
  }

  // Makes the library's functions visible to MuJoCo, which looks for eglGetProcAddress and the like
  // among the global symbols of the process.
  void MakeGlobal() const;

 private:
  void* handle_ = nullptr;
  std::string name_;
};

}  // namespace robocell
