// Preloaded into a program, writes down in order what it does to files below
// $DISK_LOG_FOLDER: every write with its bytes, every sync, every change of a
// name. One record is one write(2) to a file opened for appending, so that
// processes share a log; calls and records of one process are kept together by
// a mutex.
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
#include <sys/stat.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

struct head {
  uint32_t size;  // of all that follows
  uint32_t process;
  int32_t handle;
  uint32_t first_size;  // bytes of the first of the two texts that follow
  uint64_t node;
  uint64_t offset;
  char kind;
  char padding[7];
};

static pthread_mutex_t turn = PTHREAD_MUTEX_INITIALIZER;
static char folder[PATH_MAX];
static size_t folder_size;
static int log_handle = -1;

#define REAL(name) ((__typeof__(&name))real(#name))

static void *real(const char *name) {
  void *found = dlsym(RTLD_NEXT, name);
  if (!found) abort();
  return found;
}

__attribute__((constructor)) static void begin(void) {
  const char *where = getenv("DISK_LOG_FOLDER"), *log = getenv("DISK_LOG");
  if (!where || !log || !realpath(where, folder)) return;
  folder_size = strlen(folder);
  log_handle = REAL(open)(log, O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0600);
}

static void put(char kind, int handle, uint64_t node, uint64_t offset, const void *first, size_t first_size,
                const void *second, size_t second_size) {
  struct head head = {.process = (uint32_t)getpid(),
                      .handle = handle,
                      .first_size = (uint32_t)first_size,
                      .node = node,
                      .offset = offset,
                      .kind = kind};
  head.size = (uint32_t)(sizeof head - sizeof head.size + first_size + second_size);
  struct iovec parts[] = {{&head, sizeof head}, {(void *)first, first_size}, {(void *)second, second_size}};
  if (REAL(writev)(log_handle, parts, 3) != (ssize_t)(sizeof head + first_size + second_size)) abort();
}

static int is_inside(const char *path) {
  return strncmp(path, folder, folder_size) == 0 && (path[folder_size] == '/' || path[folder_size] == 0);
}

// The name of a file that may not be there yet, whole; false where it is
// elsewhere.
static int resolve(const char *path, char *whole) {
  char copy[PATH_MAX], parent[PATH_MAX];
  if (log_handle < 0 || strlen(path) >= sizeof copy) return 0;
  strcpy(copy, path);
  char *slash = strrchr(copy, '/');
  const char *name = slash ? slash + 1 : copy;
  if (slash) *slash = 0;
  if (!realpath(slash ? (slash == copy ? "/" : copy) : ".", parent)) return 0;
  return snprintf(whole, PATH_MAX, "%s/%s", parent, name) < PATH_MAX && is_inside(whole);
}

static int is_ours(int handle, struct stat *found) {
  char link[64], path[PATH_MAX];
  if (log_handle < 0 || handle == log_handle) return 0;
  snprintf(link, sizeof link, "/proc/self/fd/%d", handle);
  ssize_t size = readlink(link, path, sizeof path - 1);
  if (size < 0) return 0;
  path[size] = 0;
  return is_inside(path) && fstat(handle, found) == 0 && (S_ISREG(found->st_mode) || S_ISDIR(found->st_mode));
}

static int opened(const char *path, int flags, mode_t mode) {
  char whole[PATH_MAX];
  struct stat found;
  if (!(flags & (O_CREAT | O_TRUNC)) || (flags & O_TMPFILE) == O_TMPFILE || !resolve(path, whole))
    return REAL(open64)(path, flags, mode);
  pthread_mutex_lock(&turn);
  int there = lstat(whole, &found) == 0;
  int handle = REAL(open64)(path, flags, mode);
  int kept = errno;
  if (handle >= 0 && fstat(handle, &found) == 0 && S_ISREG(found.st_mode)) {
    if (!there)
      put('c', handle, found.st_ino, 0, whole, strlen(whole), "", 0);
    else if (flags & O_TRUNC)
      put('t', handle, found.st_ino, 0, "", 0, "", 0);
  }
  pthread_mutex_unlock(&turn);
  errno = kept;
  return handle;
}

#define MODE(flags)                        \
  mode_t mode = 0;                         \
  if ((flags) & (O_CREAT | __O_TMPFILE)) { \
    va_list more;                          \
    va_start(more, flags);                 \
    mode = va_arg(more, mode_t);           \
    va_end(more);                          \
  }

int open(const char *path, int flags, ...) {
  MODE(flags)
  return opened(path, flags, mode);
}

int open64(const char *path, int flags, ...) {
  MODE(flags)
  return opened(path, flags, mode);
}

#define WROTE(handle, call, at, bytes)                                          \
  struct stat found;                                                            \
  if (!is_ours(handle, &found)) return call;                                    \
  pthread_mutex_lock(&turn);                                                    \
  ssize_t done = call;                                                          \
  int kept = errno;                                                             \
  if (done > 0) put('w', handle, found.st_ino, at, "", 0, bytes, (size_t)done); \
  pthread_mutex_unlock(&turn);                                                  \
  errno = kept;                                                                 \
  return done;

ssize_t write(int handle, const void *bytes, size_t size){
    WROTE(handle, REAL(write)(handle, bytes, size), (uint64_t)(lseek(handle, 0, SEEK_CUR) - done), bytes)}

ssize_t pwrite(int handle, const void *bytes, size_t size, off_t offset){
    WROTE(handle, REAL(pwrite)(handle, bytes, size, offset), (uint64_t)offset, bytes)}

ssize_t pwrite64(int handle, const void *bytes, size_t size, off64_t offset) {
  WROTE(handle, REAL(pwrite64)(handle, bytes, size, offset), (uint64_t)offset, bytes)
}

#define DONE(handle, call, kind, at)                                              \
  struct stat found;                                                              \
  if (!is_ours(handle, &found)) return call;                                      \
  pthread_mutex_lock(&turn);                                                      \
  int result = call;                                                              \
  int kept = errno;                                                               \
  if (result == 0) put(kind, handle, found.st_ino, (uint64_t)(at), "", 0, "", 0); \
  pthread_mutex_unlock(&turn);                                                    \
  errno = kept;                                                                   \
  return result;

int ftruncate(int handle, off_t size) { DONE(handle, REAL(ftruncate)(handle, size), 't', size) }
int ftruncate64(int handle, off64_t size) { DONE(handle, REAL(ftruncate64)(handle, size), 't', size) }
int fsync(int handle) { DONE(handle, REAL(fsync)(handle), 's', 0) }
int fdatasync(int handle) { DONE(handle, REAL(fdatasync)(handle), 's', 0) }

#define NAMED(kind, call, is_there, first)                              \
  char one[PATH_MAX], two[PATH_MAX] = "";                               \
  if (!resolve(first, one) || !(is_there)) return call;                 \
  pthread_mutex_lock(&turn);                                            \
  int result = call;                                                    \
  int kept = errno;                                                     \
  struct stat found = {0};                                              \
  if (result == 0) {                                                    \
    lstat(*two ? two : one, &found);                                    \
    put(kind, -1, found.st_ino, 0, one, strlen(one), two, strlen(two)); \
  }                                                                     \
  pthread_mutex_unlock(&turn);                                          \
  errno = kept;                                                         \
  return result;

int rename(const char *from, const char *to) { NAMED('r', REAL(rename)(from, to), resolve(to, two), from) }
int link(const char *from, const char *to) { NAMED('l', REAL(link)(from, to), resolve(to, two), from) }
int unlink(const char *path) { NAMED('u', REAL(unlink)(path), 1, path) }
int mkdir(const char *path, mode_t mode) { NAMED('m', REAL(mkdir)(path, mode), 1, path) }
