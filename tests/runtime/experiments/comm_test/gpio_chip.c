// A GPIO chip for the processes that load this (LD_PRELOAD): answers the calls
// of libgpiod as the kernel does. The chip is any link to /dev/null. Its line N
// is the file $MUCAT_GPIO_LINES/N: who holds the file's lock holds the line,
// and each level of the pin is a row of it, "low" or "high" with the steady
// time in ns. A pin that goes low resets the emulated board $MUCAT_GPIO_BOARD,
// where that is set.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <linux/gpio.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

enum { GPIO = 0xB4, LINES = 8 };

static int line = -1;
static int active_low;

static void note(const char *what) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  dprintf(line, "%s %lld\n", what, now.tv_sec * 1000000000LL + now.tv_nsec);
}

static void set_level(int active) {
  const char *board = getenv("MUCAT_GPIO_BOARD");
  int high = active != active_low;
  note(high ? "high" : "low");
  if (!high && board) {
    kill(atoi(board), SIGUSR1);
  }
}

static int request_line(struct gpio_v2_line_request *request) {
  char path[512];
  snprintf(path, sizeof path, "%s/%u", getenv("MUCAT_GPIO_LINES"),
           request->offsets[0]);
  int file = open(path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  if (file < 0 || flock(file, LOCK_EX | LOCK_NB)) {
    errno = EBUSY;
    return -1;
  }
  line = request->fd = file;
  active_low = !!(request->config.flags & GPIO_V2_LINE_FLAG_ACTIVE_LOW);
  note(request->config.flags & GPIO_V2_LINE_FLAG_OUTPUT ? "output" : "input");
  for (unsigned at = 0; at < request->config.num_attrs; at++) {
    if (request->config.attrs[at].attr.id ==
        GPIO_V2_LINE_ATTR_ID_OUTPUT_VALUES) {
      set_level(request->config.attrs[at].attr.values & 1);
    }
  }
  return 0;
}

int ioctl(int file, unsigned long number, ...) {
  static int (*real)(int, unsigned long, void *);
  unsigned request = number; // libgpiod extends its sign
  va_list arguments;
  va_start(arguments, number);
  void *argument = va_arg(arguments, void *);
  va_end(arguments);
  if (_IOC_TYPE(request) != GPIO) {
    if (!real) {
      real = (int (*)(int, unsigned long, void *))dlsym(RTLD_NEXT, "ioctl");
    }
    return real(file, number, argument);
  }
  if (request == GPIO_GET_CHIPINFO_IOCTL) {
    struct gpiochip_info info = {
        .name = "gpiochip0", .label = "fake", .lines = LINES};
    memcpy(argument, &info, sizeof info);
    return 0;
  }
  if (request == GPIO_V2_GET_LINEINFO_IOCTL) {
    struct gpio_v2_line_info *info = argument;
    *info = (struct gpio_v2_line_info){.offset = info->offset};
    errno = EINVAL;
    return info->offset < LINES ? 0 : -1;
  }
  if (request == GPIO_V2_GET_LINE_IOCTL) {
    return request_line(argument);
  }
  if (request == GPIO_V2_LINE_SET_VALUES_IOCTL && file == line) {
    set_level(((struct gpio_v2_line_values *)argument)->bits & 1);
    return 0;
  }
  errno = ENOTTY;
  return -1;
}

int close(int file) {
  static int (*real)(int);
  if (!real) {
    real = (int (*)(int))dlsym(RTLD_NEXT, "close");
  }
  if (file == line && file >= 0) {
    note("released");
    line = -1;
  }
  return real(file);
}

// libgpiod takes a device for a GPIO chip where sysfs says so.
char *realpath(const char *path, char *buffer) {
  static char *(*real)(const char *, char *);
  if (!real) {
    real = (char *(*)(const char *, char *))dlsym(RTLD_NEXT, "realpath");
  }
  if (strncmp(path, "/sys/dev/char/", 14)) {
    return real(path, buffer);
  }
  return buffer ? strcpy(buffer, "/sys/bus/gpio") : strdup("/sys/bus/gpio");
}
