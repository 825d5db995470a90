// A library to preload (LD_PRELOAD) into a program that is started again and again: the program is
// loaded once, waits before its main function, and each start is a fork of it. The library knows
// nothing of the program. warm_program.cc is the other side; docs/decisions/030 says why.
//
// Descriptor 0 is a socket with these messages:
//   out  int32      1: ready; 0: the program has threads before its main function, so that a fork
//                   of it would lack them
//   in   uint32 n, n bytes: the arguments, each with its final zero; with the descriptors of stdin,
//                   stdout, stderr, the working folder and a socket
//   out  int32      the new process, a child of the one that started this one; or -errno
// The new process waits for a byte from that socket and ends without one. Whoever asked and got no
// answer may therefore start the program in another way; no second one will touch its files.
// The end of the socket, or a minute without a request, ends the process that waits.
#define _GNU_SOURCE
#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

typedef int Main(int, char**, char**);
typedef int StartMain(Main*, int, char**, void (*)(void), void (*)(void), void (*)(void), void*);

enum { kFolder = 3, kGo = 4, kDescriptors = 5, kIdleMs = 60000, kMostBytes = 1 << 20 };

static Main* main_of_program;
// Where the kernel shows the arguments of the process (/proc/PID/cmdline).
static char *shown, *shown_end;

static int IsSingleThreaded(void) {
  DIR* tasks = opendir("/proc/self/task");
  if (tasks == NULL) return 0;
  int count = 0;
  for (const struct dirent* entry; (entry = readdir(tasks)) != NULL;) {
    if (entry->d_name[0] != '.') ++count;
  }
  closedir(tasks);
  return count == 1;
}

static void Send(int32_t number) {
  if (send(0, &number, sizeof number, MSG_NOSIGNAL) != (ssize_t)sizeof number) _exit(0);
}

// The program's own children are none of ours. What was preloaded before stays.
static void ForgetPreload(void) {
  const char* preload = getenv("LD_PRELOAD");
  const char* others = preload == NULL ? NULL : strchr(preload, ':');
  if (others == NULL) {
    unsetenv("LD_PRELOAD");
  } else {
    setenv("LD_PRELOAD", others + 1, 1);
  }
}

static void ReceiveDescriptors(struct msghdr* message, int* descriptors) {
  const struct cmsghdr* control = CMSG_FIRSTHDR(message);
  if (control == NULL || control->cmsg_type != SCM_RIGHTS ||
      control->cmsg_len != CMSG_LEN(kDescriptors * sizeof(int)))
    _exit(0);
  memcpy(descriptors, CMSG_DATA(control), kDescriptors * sizeof(int));
}

// Waits for a request and returns its arguments, which are `size` bytes.
static char* Receive(uint32_t* size, int* descriptors) {
  struct pollfd socket = {.fd = 0, .events = POLLIN};
  int ready;
  while ((ready = poll(&socket, 1, kIdleMs)) < 0 && errno == EINTR) {
  }
  if (ready <= 0) _exit(0);
  union {
    struct cmsghdr aligned;
    char bytes[CMSG_SPACE(kDescriptors * sizeof(int))];
  } control;
  struct iovec head = {.iov_base = size, .iov_len = sizeof *size};
  struct msghdr message = {
      .msg_iov = &head, .msg_iovlen = 1, .msg_control = &control, .msg_controllen = sizeof control};
  if (recvmsg(0, &message, MSG_CMSG_CLOEXEC | MSG_WAITALL) != (ssize_t)sizeof *size) _exit(0);
  ReceiveDescriptors(&message, descriptors);
  if (*size == 0 || *size > kMostBytes) _exit(0);
  char* arguments = malloc(*size);
  if (arguments == NULL || recv(0, arguments, *size, MSG_WAITALL) != (ssize_t)*size) _exit(0);
  return arguments;
}

static void Show(const char* arguments, uint32_t size) {
  const size_t room = (size_t)(shown_end - shown);
  memset(shown, 0, room);
  memcpy(shown, arguments, size < room ? size : room - 1);
}

// Returns once the one who asked knows this process; ends it otherwise.
static void WaitForGo(int socket) {
  char go;
  ssize_t got;
  while ((got = read(socket, &go, 1)) < 0 && errno == EINTR) {
  }
  if (got != 1) _exit(0);
}

static int Run(char* arguments, uint32_t size, const int* descriptors) {
  setpgid(0, 0);
  WaitForGo(descriptors[kGo]);
  for (int i = 0; i < 3; ++i) {
    if (dup2(descriptors[i], i) < 0) _exit(127);
  }
  if (fchdir(descriptors[kFolder]) != 0) _exit(127);
  for (int i = 0; i < kDescriptors; ++i) close(descriptors[i]);
  int count = 0;
  for (uint32_t at = 0; at < size; at += (uint32_t)strlen(arguments + at) + 1) ++count;
  char** list = calloc((size_t)count + 1, sizeof(char*));
  if (list == NULL) _exit(127);
  count = 0;
  for (uint32_t at = 0; at < size; at += (uint32_t)strlen(arguments + at) + 1)
    list[count++] = arguments + at;
  Show(arguments, size);
  return main_of_program(count, list, environ);
}

// Takes the place of the program's main function. Returns only in the children, with what their main
// function returned.
static int Serve(int argc, char** argv, char** environment) {
  (void)environment;
  if (argc < 1) _exit(0);
  shown = argv[0];
  shown_end = argv[argc - 1] + strlen(argv[argc - 1]) + 1;
  ForgetPreload();
  const int single = IsSingleThreaded();
  Send(single);
  if (!single) _exit(0);
  for (;;) {
    uint32_t size = 0;
    int descriptors[kDescriptors];
    char* arguments = Receive(&size, descriptors);
    arguments[size - 1] = 0;
    // A sibling, so that the one who asked waits for it. The C library's fork cannot make one. Its
    // handlers (pthread_atfork) are not needed: there is one thread, and main has not begun.
    const pid_t child = (pid_t)syscall(SYS_clone, CLONE_PARENT | SIGCHLD, 0, 0, 0, 0);
    if (child == 0) return Run(arguments, size, descriptors);
    const int error = errno;
    free(arguments);
    for (int i = 0; i < kDescriptors; ++i) close(descriptors[i]);
    Send(child > 0 ? (int32_t)child : -error);
  }
}

__attribute__((visibility("default"))) int __libc_start_main(Main* main, int argc, char** argv,
                                                             void (*init)(void), void (*fini)(void),
                                                             void (*rtld_fini)(void),
                                                             void* stack_end) {
  StartMain* start;
  *(void**)&start = dlsym(RTLD_NEXT, "__libc_start_main");
  main_of_program = main;
  return start(Serve, argc, argv, init, fini, rtld_fini, stack_end);
}
