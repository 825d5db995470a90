// A shim to preload: a chosen call of a program that changes a file fails, or kills the program.
// What a full disk, a dying disk and a power cut do, at a chosen instant.
//
//   LD_PRELOAD=libfault_io.so FAULT_PROGRAM=write_ledger FAULT_UNDER=/data FAULT_AT=17 FAULT_DO=full
//
// FAULT_UNDER: how the paths begin that are watched. FAULT_AT: the number of the call, counted in
// each process; or a pattern, as of file names, for "<call> <path>": "rename */dataset.json"; or
// "1000 bytes" for the write that would be more than so much, by all processes together when
// FAULT_SHARED names a file of eight zeros for the count. FAULT_DO: fail (the call: EIO), full
// (the call and all later ones: ENOSPC), kill_before, kill_after, stop (the process, as SIGSTOP does:
// the call is made when somebody continues it). A write that fails or kills takes half of its bytes
// first, as disks do. The instant is told on standard error as "fault: <call> <path>". FAULT_ONCE
// names a file that is not there: the first process that is struck writes its number into it, and no
// other one is. Calls that take space away again (unlink) never fail.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <fnmatch.h>
#include <limits.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

enum { kPass, kFail, kKillBefore, kKillAfter };

static atomic_long calls;
static atomic_int struck;

static const char* Setting(const char* name) {
  const char* value = getenv(name);
  return value ? value : "";
}

static int Watched(const char* path) {
  const char* folder = Setting("FAULT_UNDER");
  return *folder && strcmp(program_invocation_short_name, Setting("FAULT_PROGRAM")) == 0 &&
         strncmp(path, folder, strlen(folder)) == 0;
}

// Written by all processes together, when FAULT_SHARED names a file for the count.
static atomic_long* Bytes(void) {
  static atomic_long own;
  static _Atomic(atomic_long*) shared;
  if (*Setting("FAULT_SHARED") == 0) return &own;
  if (atomic_load(&shared)) return atomic_load(&shared);
  const int file = (int)syscall(SYS_openat, AT_FDCWD, Setting("FAULT_SHARED"), O_RDWR | O_CLOEXEC);
  void* count = mmap(NULL, sizeof own, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  close(file);
  if (count == MAP_FAILED) abort();
  atomic_store(&shared, (atomic_long*)count);
  return atomic_load(&shared);
}

// Whether a call is the one that FAULT_AT means.
static int IsChosen(const char* call, const char* path, size_t size) {
  const char* at = Setting("FAULT_AT");
  char* unit;
  const long number = strtol(at, &unit, 10);
  if (strcmp(unit, " bytes") == 0)
    return atomic_fetch_add(Bytes(), (long)size) + (long)size > number;
  if (*unit == 0) return atomic_fetch_add(&calls, 1) + 1 == number;
  char text[PATH_MAX + 32];
  snprintf(text, sizeof text, "%s %s", call, path);
  return fnmatch(at, text, 0) == 0;
}

// Whether this process is struck, of all that meet the fault.
static int IsTheOne(void) {
  const char* file = Setting("FAULT_ONCE");
  if (*file == 0) return 1;
  const int flags = O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC;
  const int once = (int)syscall(SYS_openat, AT_FDCWD, file, flags, 0644);
  if (once < 0) return 0;
  dprintf(once, "%d\n", getpid());
  close(once);
  return 1;
}

// What becomes of a call that changes `path`, by `size` bytes.
static int Decide(const char* call, const char* path, size_t size) {
  if (!Watched(path)) return kPass;
  const char* action = Setting("FAULT_DO");
  const int full = strcmp(action, "full") == 0;
  if (!IsChosen(call, path, size) && !(full && atomic_load(&struck))) return kPass;
  if (!IsTheOne()) return kPass;
  atomic_store(&struck, 1);
  dprintf(2, "fault: %s %s\n", call, path);
  if (strcmp(action, "kill_before") == 0) return kKillBefore;
  if (strcmp(action, "kill_after") == 0) return kKillAfter;
  if (strcmp(action, "stop") == 0) {
    raise(SIGSTOP);  // this thread goes no further
    return kPass;
  }
  errno = full ? ENOSPC : EIO;
  return kFail;
}

static int DecideOpen(const char* call, int descriptor, size_t size) {
  char link[64], path[PATH_MAX];
  snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  const ssize_t length = readlink(link, path, sizeof path - 1);
  if (length < 0) return kPass;
  path[length] = 0;
  return Decide(call, path, size);
}

static void Die(void) {
  kill(getpid(), SIGKILL);
  for (;;) pause();
}

// Runs the real call unless it is to fail; `half` comes first when it fails or kills.
#define FAULTY(decision, half, real)  \
  do {                                \
    const int what = (decision);      \
    const int reason = errno;         \
    if (what == kPass) return (real); \
    if (what == kKillAfter) {         \
      (void)!(real);                  \
      Die();                          \
    }                                 \
    (void)!(half);                    \
    if (what == kKillBefore) Die();   \
    errno = reason;                   \
    return -1;                        \
  } while (0)

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

ssize_t write(int fd, const void* data, size_t size) {
  FAULTY(DecideOpen("write", fd, size), REAL(write)(fd, data, size / 2),
         REAL(write)(fd, data, size));
}
ssize_t pwrite(int fd, const void* data, size_t size, off_t at) {
  FAULTY(DecideOpen("pwrite", fd, size), REAL(pwrite)(fd, data, size / 2, at),
         REAL(pwrite)(fd, data, size, at));
}
ssize_t pwrite64(int fd, const void* data, size_t size, off64_t at) {
  FAULTY(DecideOpen("pwrite", fd, size), REAL(pwrite64)(fd, data, size / 2, at),
         REAL(pwrite64)(fd, data, size, at));
}
static size_t SizeOf(const struct iovec* parts, int count) {
  size_t size = 0;
  for (int i = 0; i < count; ++i) size += parts[i].iov_len;
  return size;
}
ssize_t writev(int fd, const struct iovec* parts, int count) {
  FAULTY(DecideOpen("writev", fd, SizeOf(parts, count)), REAL(writev)(fd, parts, count / 2),
         REAL(writev)(fd, parts, count));
}
int fsync(int fd) { FAULTY(DecideOpen("fsync", fd, 0), 0, REAL(fsync)(fd)); }
int fdatasync(int fd) { FAULTY(DecideOpen("fdatasync", fd, 0), 0, REAL(fdatasync)(fd)); }
int ftruncate(int fd, off_t size) {
  FAULTY(DecideOpen("ftruncate", fd, 0), 0, REAL(ftruncate)(fd, size));
}
int ftruncate64(int fd, off64_t size) {
  FAULTY(DecideOpen("ftruncate", fd, 0), 0, REAL(ftruncate64)(fd, size));
}
int mkdir(const char* path, mode_t mode) {
  FAULTY(Decide("mkdir", path, 0), 0, REAL(mkdir)(path, mode));
}
int rename(const char* from, const char* to) {
  FAULTY(Decide("rename", to, 0), 0, REAL(rename)(from, to));
}
int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) {
  FAULTY(Decide("rename", to, 0), 0, REAL(renameat2)(from_folder, from, to_folder, to, flags));
}

// Opening counts when it may make a file.
static int DecideCreation(const char* path, int flags) {
  return flags & O_CREAT ? Decide("create", path, 0) : kPass;
}
int open(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = flags & (O_CREAT | __O_TMPFILE) ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  FAULTY(DecideCreation(path, flags), 0, REAL(open)(path, flags, mode));
}
int open64(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = flags & (O_CREAT | __O_TMPFILE) ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  FAULTY(DecideCreation(path, flags), 0, REAL(open64)(path, flags, mode));
}
