#include "common/async_requests.h"

#include <errno.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <optional>
#include <utility>

#include "shm/request_board.h"

namespace gateway {
namespace {

base::Result<shm::Reply> ask(std::optional<shm::Requester>& requester, std::uint32_t server_id, const shm::Request& request,
                             std::chrono::nanoseconds left) {
  if (left.count() <= 0) return base::Error{"the simulator has not answered in time"};
  if (!requester || requester->simulation().status() != shm::Status::live) {
    requester.reset();
    auto opened = shm::Requester::open(server_id);
    if (!opened) return opened.error();
    requester.emplace(std::move(*opened));
  }
  auto reply = requester->ask(request, left);
  if (!reply) {
    requester.reset();
    return reply;
  }
  if (reply->status != shm::RequestStatus::ok) return base::Error{reply->message};
  return reply;
}

void ring(int descriptor) {
  const std::uint64_t one = 1;
  while (::write(descriptor, &one, sizeof one) < 0 && errno == EINTR) {
  }
}

}  // namespace

AsyncRequests::AsyncRequests(std::uint32_t server_id)
    : server_id_(server_id),
      descriptor_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

AsyncRequests::~AsyncRequests() {
  thread_.request_stop();
  thread_.join();
  ::close(descriptor_);
}

void AsyncRequests::post(shm::Request request, Done done, std::chrono::nanoseconds timeout, Work work) {
  {
    auto queues = queues_.lock();
    if (queues->jobs.size() < max_waiting) {
      queues->jobs.push_back({std::move(request), std::move(done), std::chrono::steady_clock::now() + timeout, std::move(work)});
      posted_.notify_one();
      return;
    }
    queues->answers.push_back({std::move(done), base::Error{"too many requests wait for the simulator"}});
  }
  ring(descriptor_);
}

void AsyncRequests::deliver() {
  std::uint64_t count = 0;
  while (::read(descriptor_, &count, sizeof count) < 0 && errno == EINTR) {
  }
  std::deque<Answer> answers;
  queues_.lock()->answers.swap(answers);
  for (Answer& answer : answers) answer.done(std::move(answer.reply));
}

void AsyncRequests::run(const std::stop_token& stop) {
  std::optional<shm::Requester> requester;
  while (true) {
    Job job;
    {
      auto queues = queues_.lock();
      if (!queues.wait(posted_, stop, [&] { return !queues->jobs.empty(); }) || stop.stop_requested()) return;
      job = std::move(queues->jobs.front());
      queues->jobs.pop_front();
    }
    auto reply = ask(requester, server_id_, job.request, job.deadline - std::chrono::steady_clock::now());
    if (job.work) job.work(reply);
    queues_.lock()->answers.push_back({std::move(job.done), std::move(reply)});
    ring(descriptor_);
  }
}

}  // namespace gateway
