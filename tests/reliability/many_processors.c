// A shim to preload: the machine seems to have 128 processors.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <sched.h>
#include <unistd.h>

enum { kProcessors = 128 };

int sched_getaffinity(pid_t process, size_t size, cpu_set_t* set) {
  (void)process;
  CPU_ZERO_S(size, set);
  for (int i = 0; i < kProcessors; ++i) CPU_SET_S(i, size, set);
  return 0;
}
int get_nprocs(void) { return kProcessors; }
int get_nprocs_conf(void) { return kProcessors; }
long sysconf(int name) {
  if (name == _SC_NPROCESSORS_ONLN || name == _SC_NPROCESSORS_CONF) return kProcessors;
  return ((__typeof__(&sysconf))dlsym(RTLD_NEXT, "sysconf"))(name);
}
