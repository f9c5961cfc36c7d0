#include "base/packet.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <string>

namespace base {
namespace {

struct Pair {
  Pair() {
    int ends[2] = {-1, -1};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends), 0);
    first = FileHandle(ends[0]);
    second = FileHandle(ends[1]);
  }
  FileHandle first, second;
};

std::span<const std::byte> bytes_of(const std::string& text) { return std::as_bytes(std::span(text)); }

struct Received {
  std::string text;
  std::vector<FileHandle> files;
};
std::optional<Received> receive(int socket, int flags = 0) {
  std::string space(100, '\0');
  auto packet = receive_packet(socket, std::as_writable_bytes(std::span(space)), flags);
  if (!packet) return std::nullopt;
  space.resize(packet->size);
  return Received{space, std::move(packet->files)};
}

TEST(Packet, arrives_whole_with_its_descriptors_in_their_order_and_closed_on_exec) {
  const Pair pair;
  const FileHandle null(::open("/dev/null", O_WRONLY)), zero(::open("/dev/zero", O_RDONLY));
  const std::array both{null.get(), zero.get()};
  ASSERT_TRUE(send_packet(pair.first.get(), bytes_of("one"), both));
  ASSERT_TRUE(send_packet(pair.first.get(), bytes_of("two"), {}));
  auto one = receive(pair.second.get());
  ASSERT_TRUE(one && one->files.size() == 2);
  EXPECT_EQ(one->text, "one");
  char byte = 1;
  EXPECT_EQ(::read(one->files[1].get(), &byte, 1), 1);
  EXPECT_EQ(byte, 0);
  EXPECT_EQ(::write(one->files[0].get(), &byte, 1), 1);
  for (const auto& file : one->files) EXPECT_TRUE(::fcntl(file.get(), F_GETFD) & FD_CLOEXEC);
  const auto two = receive(pair.second.get());
  ASSERT_TRUE(two);
  EXPECT_EQ(two->text, "two");
  EXPECT_TRUE(two->files.empty());
}

TEST(Packet, is_none_when_the_other_end_is_closed_or_nothing_has_come) {
  Pair pair;
  EXPECT_FALSE(receive(pair.second.get(), MSG_DONTWAIT));
  EXPECT_EQ(errno, EAGAIN);
  pair.first = FileHandle();
  EXPECT_FALSE(receive(pair.second.get()));
  EXPECT_FALSE(send_packet(pair.second.get(), bytes_of("lost"), {}));
  EXPECT_EQ(errno, EPIPE);
}

}  // namespace
}  // namespace base
