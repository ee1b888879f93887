/* Preloaded into a program: while the file named by STICKSLIP_NO_LOCKS exists, no file can be locked, as on a file system
 * whose lock service is away (ENOLCK, flock(2)). */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <stdlib.h>
#include <sys/file.h>
#include <unistd.h>

int flock(int file, int operation) {
  const char* switch_file = getenv("STICKSLIP_NO_LOCKS");
  if (switch_file != NULL && access(switch_file, F_OK) == 0 && operation != LOCK_UN) {
    errno = ENOLCK;
    return -1;
  }
  int (*system_flock)(int, int) = (int (*)(int, int))dlsym(RTLD_NEXT, "flock");
  return system_flock(file, operation);
}
