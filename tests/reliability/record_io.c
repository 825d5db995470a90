// A shim to preload: records every call of a program, and of those that it starts, that changes a
// file below a folder, with its bytes, in the order in which they happen. `power.py` builds from
// the record the folders that a power cut may leave.
//
//   LD_PRELOAD=librecord_io.so RECORD_UNDER=/data RECORD_TO=/tmp/record python -c ...
//
// What is written to standard output is recorded too: it is what a program acknowledges. A record
// is a header (`struct Event`), a path, a second path and bytes. Files are known by the numbers of
// their inodes; a number may be used again after a file is gone, and then has a new "create".
// Not seen are writes through mmap and by stdio: the test compares the record with the folder.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/sendfile.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

struct Event {
  char op[4];
  uint32_t path, other, bytes;  // sizes of what follows
  uint64_t inode;
  int64_t at;  // where the bytes are written, or the new size
};

static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
static int record = -1;

static void Take(void) { pthread_mutex_lock(&mutex); }
static void Give(void) { pthread_mutex_unlock(&mutex); }
__attribute__((constructor)) static void Begin(void) { pthread_atfork(Take, Give, Give); }

static const char* Setting(const char* name) {
  const char* value = getenv(name);
  return value ? value : "";
}

static int Lock(int type) {
  struct flock whole = {.l_type = (short)type, .l_whence = SEEK_SET};
  while (fcntl(record, F_SETLKW, &whole) != 0) {
    if (errno != EINTR) return -1;
  }
  return 0;
}

// One event after the other, in all threads and processes.
static void Enter(void) {
  const int error = errno;
  Take();
  if (record < 0 || Lock(F_WRLCK) != 0) {
    const int flags = O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC;
    const int low = (int)syscall(SYS_openat, AT_FDCWD, Setting("RECORD_TO"), flags, 0644);
    record = fcntl(low, F_DUPFD_CLOEXEC, 700);  // where no program looks
    // Closing `low` would give the lock back, so it comes first.
    syscall(SYS_close, low);
    if (record < 0 || Lock(F_WRLCK) != 0) abort();
  }
  errno = error;
}

static void Leave(void) {
  const int error = errno;
  Lock(F_UNLCK);
  Give();
  errno = error;
}

static void Note(const char* op, const char* path, const char* other, const void* bytes,
                 size_t size, uint64_t inode, int64_t at) {
  const int error = errno;
  struct Event event = {.path = (uint32_t)strlen(path),
                        .other = (uint32_t)strlen(other),
                        .bytes = (uint32_t)size,
                        .inode = inode,
                        .at = at};
  memcpy(event.op, op, 4);
  const struct iovec parts[] = {{&event, sizeof event},
                                {(void*)path, event.path},
                                {(void*)other, event.other},
                                {(void*)bytes, size}};
  const ssize_t whole = (ssize_t)(sizeof event + event.path + event.other + size);
  if (syscall(SYS_writev, record, parts, 4) != whole) abort();
  errno = error;
}

static int Watched(const char* path) {
  const char* folder = Setting("RECORD_UNDER");
  return *folder && strncmp(path, folder, strlen(folder)) == 0;
}

static int PathOf(int descriptor, char* path) {
  char link[64];
  snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  const ssize_t length = readlink(link, path, PATH_MAX - 1);
  path[length < 0 ? 0 : length] = 0;
  return length >= 0;
}

// Makes a path absolute. Returns whether it is watched.
static int Full(int folder, const char* given, char* path) {
  const int error = errno;
  char start[PATH_MAX] = "";
  if (given[0] != '/') {
    if (folder == AT_FDCWD) {
      if (!getcwd(start, sizeof start)) start[0] = 0;
    } else {
      PathOf(folder, start);
    }
    strncat(start, "/", sizeof start - strlen(start) - 1);
  }
  snprintf(path, 2 * PATH_MAX, "%s%s", start, given);
  errno = error;
  return Watched(path);
}

static uint64_t InodeAt(const char* path) {
  const int error = errno;
  struct stat status;
  const uint64_t inode = lstat(path, &status) == 0 ? status.st_ino : 0;
  errno = error;
  return inode;
}

static uint64_t InodeOf(int descriptor) {
  const int error = errno;
  struct stat status;
  const uint64_t inode = fstat(descriptor, &status) == 0 ? status.st_ino : 0;
  errno = error;
  return inode;
}

static int WatchedFile(int descriptor) {
  const int error = errno;
  char path[PATH_MAX];
  const int is = PathOf(descriptor, path) && Watched(path);
  errno = error;
  return is;
}

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

// Writing.

static void NoteWritten(int file, const void* bytes, size_t size, int64_t at) {
  char path[PATH_MAX];
  PathOf(file, path);
  Note("writ", path, "", bytes, size, InodeOf(file), at);
}

static ssize_t WriteHere(int file, const struct iovec* parts, int count) {
  if (file == STDOUT_FILENO && *Setting("RECORD_UNDER") && !WatchedFile(file)) {
    Enter();
    const ssize_t result = REAL(writev)(file, parts, count);
    if (result > 0) Note("says", "", "", parts[0].iov_base, parts[0].iov_len, 0, 0);
    Leave();
    return result;
  }
  if (file <= STDERR_FILENO || !WatchedFile(file)) return REAL(writev)(file, parts, count);
  Enter();
  const ssize_t result = REAL(writev)(file, parts, count);
  if (result > 0) {
    int64_t at = lseek(file, 0, SEEK_CUR) - result;
    ssize_t left = result;
    for (int i = 0; i < count && left > 0; ++i) {
      const ssize_t size = left < (ssize_t)parts[i].iov_len ? left : (ssize_t)parts[i].iov_len;
      NoteWritten(file, parts[i].iov_base, (size_t)size, at);
      at += size;
      left -= size;
    }
  }
  Leave();
  return result;
}
ssize_t writev(int file, const struct iovec* parts, int count) {
  return WriteHere(file, parts, count);
}
ssize_t write(int file, const void* bytes, size_t size) {
  const struct iovec part = {(void*)bytes, size};
  return WriteHere(file, &part, 1);
}

#define WRITE_AT(name, offset)                                        \
  ssize_t name(int file, const void* bytes, size_t size, offset at) { \
    if (!WatchedFile(file)) return REAL(name)(file, bytes, size, at); \
    Enter();                                                          \
    const ssize_t result = REAL(name)(file, bytes, size, at);         \
    if (result > 0) NoteWritten(file, bytes, (size_t)result, at);     \
    Leave();                                                          \
    return result;                                                    \
  }
WRITE_AT(pwrite, off_t)
WRITE_AT(pwrite64, off64_t)

// What the kernel copied is read again.
static void NoteCopied(int file, ssize_t size, int64_t at) {
  char link[64];
  snprintf(link, sizeof link, "/proc/self/fd/%d", file);
  const int again = (int)syscall(SYS_openat, AT_FDCWD, link, O_RDONLY | O_CLOEXEC);
  char* bytes = malloc((size_t)size);
  if (again < 0 || !bytes || pread(again, bytes, (size_t)size, at) != size) abort();
  NoteWritten(file, bytes, (size_t)size, at);
  free(bytes);
  syscall(SYS_close, again);
}
#define SEND(name, offset)                                                   \
  ssize_t name(int to, int from, offset* at, size_t size) {                  \
    if (!WatchedFile(to)) return REAL(name)(to, from, at, size);             \
    Enter();                                                                 \
    const ssize_t result = REAL(name)(to, from, at, size);                   \
    if (result > 0) NoteCopied(to, result, lseek(to, 0, SEEK_CUR) - result); \
    Leave();                                                                 \
    return result;                                                           \
  }
SEND(sendfile, off_t)
SEND(sendfile64, off64_t)
ssize_t copy_file_range(int from, off64_t* from_at, int to, off64_t* to_at, size_t size,
                        unsigned flags) {
  if (!WatchedFile(to)) return REAL(copy_file_range)(from, from_at, to, to_at, size, flags);
  Enter();
  const ssize_t result = REAL(copy_file_range)(from, from_at, to, to_at, size, flags);
  if (result > 0) NoteCopied(to, result, (to_at ? *to_at : lseek(to, 0, SEEK_CUR)) - result);
  Leave();
  return result;
}

static void NoteSize(int file, int64_t size) {
  char path[PATH_MAX];
  PathOf(file, path);
  Note("size", path, "", "", 0, InodeOf(file), size);
}

#define TRUNCATE(name, offset)                             \
  int name(int file, offset size) {                        \
    if (!WatchedFile(file)) return REAL(name)(file, size); \
    Enter();                                               \
    const int result = REAL(name)(file, size);             \
    if (result == 0) NoteSize(file, size);                 \
    Leave();                                               \
    return result;                                         \
  }
TRUNCATE(ftruncate, off_t)
TRUNCATE(ftruncate64, off64_t)

// Flushing.

#define FLUSH(name)                                                 \
  int name(int file) {                                              \
    if (!WatchedFile(file)) return REAL(name)(file);                \
    Enter();                                                        \
    const int result = REAL(name)(file);                            \
    if (result == 0) Note("sync", "", "", "", 0, InodeOf(file), 0); \
    Leave();                                                        \
    return result;                                                  \
  }
FLUSH(fsync)
FLUSH(fdatasync)

// Opening.

static int OpenAt(int folder, const char* given, int flags, mode_t mode) {
  char path[2 * PATH_MAX];
  if (!(flags & (O_CREAT | O_TRUNC)) || !Full(folder, given, path))
    return REAL(openat)(folder, given, flags, mode);
  Enter();
  const int is_there = InodeAt(path) != 0;
  const int file = REAL(openat)(folder, given, flags, mode);
  if (file >= 0 && !is_there) Note("make", path, "", "", 0, InodeOf(file), 0);
  if (file >= 0 && is_there && flags & O_TRUNC) NoteSize(file, 0);
  Leave();
  return file;
}

static mode_t ModeOf(int flags, va_list rest) {
  return flags & (O_CREAT | __O_TMPFILE) ? va_arg(rest, mode_t) : 0;
}
#define OPEN(name)                              \
  int name(const char* path, int flags, ...) {  \
    va_list rest;                               \
    va_start(rest, flags);                      \
    const mode_t mode = ModeOf(flags, rest);    \
    va_end(rest);                               \
    return OpenAt(AT_FDCWD, path, flags, mode); \
  }
#define OPEN_AT(name)                                      \
  int name(int folder, const char* path, int flags, ...) { \
    va_list rest;                                          \
    va_start(rest, flags);                                 \
    const mode_t mode = ModeOf(flags, rest);               \
    va_end(rest);                                          \
    return OpenAt(folder, path, flags, mode);              \
  }
OPEN(open)
OPEN(open64)
OPEN_AT(openat)
OPEN_AT(openat64)
int creat(const char* path, mode_t mode) {
  return OpenAt(AT_FDCWD, path, O_CREAT | O_WRONLY | O_TRUNC, mode);
}

// The bytes of a stream of C are not seen, those of C++ are.
#define STREAM(name)                                                                    \
  FILE* name(const char* given, const char* mode) {                                     \
    char path[2 * PATH_MAX];                                                            \
    if (mode[0] == 'r' || !Full(AT_FDCWD, given, path)) return REAL(name)(given, mode); \
    Enter();                                                                            \
    const int is_there = InodeAt(path) != 0;                                            \
    FILE* const file = REAL(name)(given, mode);                                         \
    if (file && !is_there) Note("make", path, "", "", 0, InodeOf(fileno(file)), 0);     \
    if (file && is_there && mode[0] == 'w') NoteSize(fileno(file), 0);                  \
    Leave();                                                                            \
    return file;                                                                        \
  }
STREAM(fopen)
STREAM(fopen64)

// Names.

#define NAMED(watched, call, note) \
  if (!(watched)) return (call);   \
  Enter();                         \
  const int result = (call);       \
  if (result == 0) (note);         \
  Leave();                         \
  return result

int mkdirat(int folder, const char* given, mode_t mode) {
  char path[2 * PATH_MAX];
  NAMED(Full(folder, given, path), REAL(mkdirat)(folder, given, mode),
        Note("fold", path, "", "", 0, InodeAt(path), 0));
}
int mkdir(const char* path, mode_t mode) { return mkdirat(AT_FDCWD, path, mode); }

int unlinkat(int folder, const char* given, int flags) {
  char path[2 * PATH_MAX];
  NAMED(Full(folder, given, path), REAL(unlinkat)(folder, given, flags),
        Note("gone", path, "", "", 0, 0, 0));
}
int unlink(const char* path) { return unlinkat(AT_FDCWD, path, 0); }
int rmdir(const char* path) { return unlinkat(AT_FDCWD, path, AT_REMOVEDIR); }
int remove(const char* path) {
  if (unlinkat(AT_FDCWD, path, 0) == 0) return 0;
  return errno == EISDIR || errno == EPERM ? unlinkat(AT_FDCWD, path, AT_REMOVEDIR) : -1;
}

int renameat2(int from_folder, const char* given, int to_folder, const char* given_to,
              unsigned flags) {
  char from[2 * PATH_MAX], to[2 * PATH_MAX];
  const int watched = Full(from_folder, given, from) | Full(to_folder, given_to, to);
  NAMED(watched, REAL(renameat2)(from_folder, given, to_folder, given_to, flags),
        Note("name", from, to, "", 0, 0, 0));
}
int renameat(int from_folder, const char* from, int to_folder, const char* to) {
  return renameat2(from_folder, from, to_folder, to, 0);
}
int rename(const char* from, const char* to) { return renameat2(AT_FDCWD, from, AT_FDCWD, to, 0); }

int linkat(int from_folder, const char* given, int to_folder, const char* given_to, int flags) {
  char from[2 * PATH_MAX], to[2 * PATH_MAX];
  const int watched = Full(from_folder, given, from) | Full(to_folder, given_to, to);
  NAMED(watched, REAL(linkat)(from_folder, given, to_folder, given_to, flags),
        Note("link", from, to, "", 0, InodeAt(to), 0));
}
int link(const char* from, const char* to) { return linkat(AT_FDCWD, from, AT_FDCWD, to, 0); }

int symlinkat(const char* content, int folder, const char* given) {
  char path[2 * PATH_MAX];
  NAMED(Full(folder, given, path), REAL(symlinkat)(content, folder, given),
        Note("symb", path, content, "", 0, InodeAt(path), 0));
}
int symlink(const char* content, const char* path) { return symlinkat(content, AT_FDCWD, path); }
