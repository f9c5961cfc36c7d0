/* For LD_PRELOAD: the clock of the wall jumps. How far, in seconds, stands as text in the file that RTMSIM_TEST_CLOCK names; it may change
 * at any time. Waits until a moment of that clock end when it is there at the moment of the call, as they would after a jump of the
 * kernel's clock. Clocks that only run forward are left alone. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <semaphore.h>
#include <stdlib.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

static long offset(void) {
  const int error = errno;
  char text[32] = "0";
  const char* name = getenv("RTMSIM_TEST_CLOCK");
  const int file = name != NULL ? open(name, O_RDONLY | O_CLOEXEC) : -1;
  if (file >= 0) {
    const ssize_t count = read(file, text, sizeof text - 1);
    text[count > 0 ? count : 0] = '\0';
    close(file);
  }
  errno = error;
  return atol(text);
}

static int real_time(struct timespec* now) { return (int)syscall(SYS_clock_gettime, CLOCK_REALTIME, now); }

int clock_gettime(clockid_t clock, struct timespec* now) {
  const int result = (int)syscall(SYS_clock_gettime, clock, now);
  if (result == 0 && (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE)) now->tv_sec += offset();
  return result;
}

int gettimeofday(struct timeval* now, void* zone) {
  struct timespec exact;
  (void)zone;
  if (real_time(&exact) != 0) return -1;
  now->tv_sec = exact.tv_sec + offset();
  now->tv_usec = exact.tv_nsec / 1000;
  return 0;
}

time_t time(time_t* where) {
  struct timespec now = {0, 0};
  real_time(&now);
  now.tv_sec += offset();
  if (where != NULL) *where = now.tv_sec;
  return now.tv_sec;
}

int pthread_cond_timedwait(pthread_cond_t* condition, pthread_mutex_t* mutex, const struct timespec* until) {
  /* Of conditions that wait by the wall's clock, which is the default: others are waited for by pthread_cond_clockwait here. */
  static int (*next)(pthread_cond_t*, pthread_mutex_t*, clockid_t, const struct timespec*);
  struct timespec moved = *until;
  if (next == NULL)
    *(void**)&next = dlsym(RTLD_NEXT, "pthread_cond_clockwait");  /* as POSIX has it */
  moved.tv_sec -= offset();
  if (moved.tv_sec < 0) moved.tv_sec = 0;
  return next(condition, mutex, CLOCK_REALTIME, &moved);
}

int sem_timedwait(sem_t* semaphore, const struct timespec* until) {
  static int (*next)(sem_t*, clockid_t, const struct timespec*);
  struct timespec moved = *until;
  if (next == NULL) *(void**)&next = dlsym(RTLD_NEXT, "sem_clockwait");
  moved.tv_sec -= offset();
  if (moved.tv_sec < 0) moved.tv_sec = 0;
  return next(semaphore, CLOCK_REALTIME, &moved);
}
