// Publishing and reading while nobody waits makes no system call: done by a child that the kernel kills at the first one it makes.
#include <gtest/gtest.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstddef>
#include <iterator>

#include "shm/lockstep.h"
#include "shm/process.h"
#include "shm/request_board.h"
#include "shm/shm_support.h"

namespace shm::test {
namespace {

// From now on any system call but the end of the process kills it. (Strict mode would take the clock of the vdso away as well.)
void forbid_system_calls() {
  sock_filter program[] = {
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_exit_group, 0, 1),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_KILL_PROCESS),
  };
  const sock_fprog filter{std::size(program), program};
  prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  if (prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter) != 0) _exit(1);
}

// Runs `work` in a child of that kind. True when it came to its end.
template <class Work>
bool runs_without_system_calls(Work work) {
  const pid_t pid = fork();
  if (pid == 0) {
    forbid_system_calls();
    work();
    _exit(0);
  }
  int status = 0;
  waitpid(pid, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

TEST(NoSystemCall, the_test_itself_finds_one) {
  EXPECT_FALSE(runs_without_system_calls([] { (void)getppid(); }));
}

TEST(NoSystemCall, publishing_reading_and_polling_while_nobody_waits) {
#if defined(__SANITIZE_THREAD__) || defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "sanitizers make system calls of their own";
#endif
  if (!runs_without_system_calls([] { (void)wall_ns(); })) GTEST_SKIP() << "the clock of this machine needs a system call";
  Fixture f;
  auto simulation = f.make(simulation_spec(simulation_info()));
  auto laser = f.make(iface_spec(IfaceType::laser, "laser", laser_info()));
  auto camera = f.make(camera_spec(IfaceType::camera, "eye", camera_info()));
  auto base = f.make(iface_spec(IfaceType::position2d, "base", Position2dInfo{}));
  RequestBoard board(*simulation, *f.server);
  (void)board.poll();
  auto reader = f.open(IfaceType::laser, "laser");
  auto viewer = f.open(IfaceType::camera, "eye");
  ASSERT_TRUE(reader.subscribe());
  ASSERT_TRUE(viewer.subscribe());
  bool is_good = false;
  EXPECT_TRUE(runs_without_system_calls([&] {
    is_good = true;
    for (int i = 0; i < 1000; ++i) {
      laser->publish(1ms);
      is_good = is_good && laser->is_subscribed() && reader.read();
      is_good = is_good && camera->begin_frame().has_value();
      camera->publish_frame(1ms, identity_pose);
      is_good = is_good && viewer.hold().has_value();
      Command command{};
      is_good = is_good && base->poll_command(command) == CommandChange::none;
      is_good = is_good && board.poll().empty();
    }
    if (!is_good) (void)getppid();  // ends the child
  }));
}

}  // namespace
}  // namespace shm::test
