// A shim to preload: a machine without graphics libraries. dlopen(3) finds no library of OpenGL,
// EGL, OSMesa, GLX or Vulkan, and fails with the message of a missing file.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

static int is_graphics(const char* name) {
  static const char* const kNames[] = {"libEGL", "libGL", "libOSMesa", "libOpenGL", "libvulkan"};
  const char* slash = strrchr(name, '/');
  const char* file = slash ? slash + 1 : name;
  for (size_t i = 0; i < sizeof kNames / sizeof *kNames; ++i) {
    if (strncmp(file, kNames[i], strlen(kNames[i])) == 0) return 1;
  }
  return 0;
}

void* dlopen(const char* name, int flags) {
  char missing[4096];
  if (name && is_graphics(name)) {
    snprintf(missing, sizeof missing, "/no/graphics/%s", strrchr(name, '/') ? "" : name);
    name = missing;
  }
  return ((__typeof__(&dlopen))dlsym(RTLD_NEXT, "dlopen"))(name, flags);
}
