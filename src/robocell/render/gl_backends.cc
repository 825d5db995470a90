#include "robocell/render/gl_backends.h"

#include <dlfcn.h>

#include "robocell/base/error.h"

namespace robocell::internal {

GlLibrary::GlLibrary(std::initializer_list<const char*> names) {
  std::string reasons;
  for (const char* name : names) {
    handle_ = dlopen(name, RTLD_NOW | RTLD_LOCAL);
    if (handle_) {
      name_ = name;
      return;
    }
    const char* reason = dlerror();
    reasons += (reasons.empty() ? "" : "; ") + std::string(reason ? reason : name);
  }
  throw IoError(reasons);
}

void* GlLibrary::Symbol(const char* name) const {
  void* symbol = dlsym(handle_, name);
  if (!symbol) throw IoError(name_ + " has no function " + name);
  return symbol;
}

void GlLibrary::MakeGlobal() const { dlopen(name_.c_str(), RTLD_NOW | RTLD_GLOBAL | RTLD_NOLOAD); }

}  // namespace robocell::internal
