// The back ends of gl_context.h, EGL and OSMesa, whose libraries are opened at run time. Internal
// to render/.
#pragma once

#include <memory>
#include <string>

#include "robocell/render/gl_context.h"

namespace robocell::internal {

// A shared library opened at run time.
class GlLibrary {
 public:
  // Opens the first existing one of the names. Never closed: GL drivers do not survive unloading.
  // Throws IoError with the loader's reasons.
  explicit GlLibrary(std::initializer_list<const char*> names);

  // Throws IoError if the function is missing.
  void* Symbol(const char* name) const;
  template <class Function>
  void Load(Function*& function, const char* name) const {
    function = reinterpret_cast<Function*>(Symbol(name));
  }

  // Makes the library's functions visible to MuJoCo, which looks for eglGetProcAddress and others
  // among the global symbols of the process.
  void MakeGlobal() const;

 private:
  void* handle_ = nullptr;
  std::string name_;
};

// Throws IoError with everything that was tried. egl_context.cc
std::unique_ptr<GlContext> CreateEglContext();

// Throws IoError with the reason. osmesa_context.cc
std::unique_ptr<GlContext> CreateOsmesaContext();

}  // namespace robocell::internal
