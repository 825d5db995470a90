// A shim to preload: flock(2) as NFS has it, where it is made of locks of byte ranges. An exclusive
// lock needs a descriptor that is open for writing, a shared one needs one that is open for reading;
// else EBADF. With NO_LOCKS every call fails with ENOLCK, as on a mount without a lock service.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <sys/file.h>

int flock(int descriptor, int operation) {
  const int access = fcntl(descriptor, F_GETFL) & O_ACCMODE;
  const int kind = operation & ~LOCK_NB;
  errno = getenv("NO_LOCKS") ? ENOLCK : EBADF;
  if (errno == ENOLCK) return -1;
  if (kind == LOCK_EX && access == O_RDONLY) return -1;
  if (kind == LOCK_SH && access == O_WRONLY) return -1;
  return ((__typeof__(&flock))dlsym(RTLD_NEXT, "flock"))(descriptor, operation);
}
