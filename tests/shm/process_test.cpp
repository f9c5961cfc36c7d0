// Whether a process still lives.
#include "shm/process.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

namespace shm::test {
namespace {

TEST(Process, a_process_is_alive_until_it_is_dead_even_as_a_zombie) {
  EXPECT_TRUE(is_alive(own_mark()));
  ProcessMark wrong = own_mark();
  ++wrong.start_time;
  EXPECT_FALSE(is_alive(wrong)) << "the pid belongs to another process";
  EXPECT_FALSE(is_alive({0, 0, 0}));
  EXPECT_FALSE(is_alive({-5, 0, 0}));
  const pid_t pid = fork();
  if (pid == 0) _exit(0);
  siginfo_t ended{};
  waitid(P_PID, static_cast<id_t>(pid), &ended, WEXITED | WNOWAIT);
  EXPECT_FALSE(is_alive({pid, 0, 0}));
  waitpid(pid, nullptr, 0);
  EXPECT_FALSE(is_alive({pid, 0, 0}));
}

TEST(ProcessLife, is_one_for_all_who_ask_and_ends_with_the_process_even_when_nobody_has_waited_for_it) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const pid_t pid = fork();
  if (pid == 0) {
    const ProcessMark mine = own_mark();
    if (write(ends[1], &mine, sizeof mine) != static_cast<ssize_t>(sizeof mine)) _exit(1);
    while (true) pause();
  }
  ProcessMark child{};
  ASSERT_EQ(read(ends[0], &child, sizeof child), static_cast<ssize_t>(sizeof child));
  const auto life = ProcessLife::of(child);
  EXPECT_EQ(life, ProcessLife::of(child));
  EXPECT_NE(life, ProcessLife::of(own_mark()));
  EXPECT_TRUE(life->is_alive());
  ProcessMark wrong = child;
  ++wrong.start_time;
  EXPECT_FALSE(ProcessLife::of(wrong)->is_alive()) << "the pid belongs to another process";
  EXPECT_TRUE(ProcessLife::of({pid, 0, 0})->is_alive()) << "little is known of it";
  kill(pid, SIGKILL);
  siginfo_t ended{};
  waitid(P_PID, static_cast<id_t>(pid), &ended, WEXITED | WNOWAIT);
  EXPECT_FALSE(life->is_alive());
  waitpid(pid, nullptr, 0);
  EXPECT_FALSE(life->is_alive());
  EXPECT_FALSE(ProcessLife::of(child)->is_alive());
  close(ends[0]);
  close(ends[1]);
}

}  // namespace
}  // namespace shm::test
