#include "async_requests.h"

#include <shm/request_board.h>

namespace iface {
namespace {

constexpr std::size_t longest_queue = 100;
constexpr std::chrono::seconds answer_limit{10};

}  // namespace

AsyncRequests::AsyncRequests(Say say) : say_(std::move(say)) {}

AsyncRequests::~AsyncRequests() = default;  // the thread is asked to stop and joined first

void AsyncRequests::post(int server_id, const shm::Request& request) {
  bool is_full = false;
  {
    auto jobs = jobs_.lock();
    is_full = jobs->size() >= longest_queue;
    if (!is_full) jobs->push_back({server_id, request});
  }
  {
    const auto mine = starting_.take();
    if (!thread_.joinable()) thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  }
  posted_.notify_one();
  if (is_full)
    say_(true, "request " + std::string(shm::request_name(request)) + ": dropped, the simulator does not answer the ones before");
}

void AsyncRequests::run(const std::stop_token& stop) {
  while (true) {
    Job job;
    {
      auto jobs = jobs_.lock();
      if (!jobs.wait(posted_, stop, [&] { return !jobs->empty(); })) return;
      job = std::move(jobs->front());
      jobs->pop_front();
    }
    const auto what = "request " + std::string(shm::request_name(job.request));
    auto requester = shm::Requester::open(static_cast<std::uint32_t>(job.server_id));
    if (!requester) {
      say_(true, what + ": " + requester.error().message);
      continue;
    }
    const auto reply = requester->ask(job.request, answer_limit);
    if (!reply) say_(true, what + ": " + reply.error().message);
    if (reply && reply->status != shm::RequestStatus::ok) say_(true, what + ": " + reply->message);
  }
}

}  // namespace iface
