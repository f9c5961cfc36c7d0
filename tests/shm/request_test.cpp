#include <gtest/gtest.h>
#include <cmath>
#include <cstring>
#include <random>
#include <thread>

#include "shm/process.h"
#include "shm/request_board.h"
#include "shm/shm_support.h"

namespace shm::test {
namespace {

template <class R>
R there_and_back(const R& request) {
  auto result = decode(encode(request));
  if (!result) throw std::runtime_error(result.error().message);
  return std::get<R>(*result);
}

TEST(Requests, all_kinds_survive_the_way_to_bytes_and_back) {
  EXPECT_EQ(there_and_back(StepRequest{17}).steps, 17);
  EXPECT_TRUE(there_and_back(StepRequest{.steps = 17, .ends_at_death = true}).ends_at_death);
  EXPECT_TRUE(there_and_back(ResetRequest{true}).poses_only);
  EXPECT_FALSE(there_and_back(ResetRequest{}).seed);
  EXPECT_EQ(there_and_back(ResetRequest{false, UINT64_MAX}).seed, UINT64_MAX);
  const auto pose = there_and_back(SetPoseRequest{"robot", {1, 2, 3, 2, 0, 0, 0}, false});
  EXPECT_EQ(pose.model, "robot");
  EXPECT_EQ(pose.pose.z, 3);
  EXPECT_EQ(pose.pose.qw, 1) << "normalised";
  EXPECT_NEAR(yaw_of(there_and_back(SetPoseRequest{"robot", planar_pose(1, 2, 0, 0.7), true}).pose), 0.7, 1e-12);
  const auto wrench = there_and_back(WrenchRequest{"robot::link", {1, 2, 3}, {4, 5, 6}, 0.5});
  EXPECT_EQ(wrench.torque[2], 6);
  EXPECT_EQ(wrench.duration, 0.5);
  EXPECT_FALSE(wrench.is_joint);
  const auto joint = there_and_back(WrenchRequest{"arm::elbow", {3}, {}, WrenchRequest::until_the_next, true});
  EXPECT_EQ(joint.force[0], 3);
  EXPECT_TRUE(joint.is_joint);
  EXPECT_EQ(there_and_back(SetVelocityRequest{"m", {1, 2, 3}, {4, 5, 6}}).angular[0], 4);
  const auto spawn = there_and_back(SpawnRequest{"<sdf/>", false, "box", true, planar_pose(1, 0, 0, 1)});
  EXPECT_EQ(spawn.sdf, "<sdf/>");
  EXPECT_FALSE(spawn.is_path);
  EXPECT_TRUE(spawn.has_pose);
  EXPECT_FALSE(spawn.is_confined);
  EXPECT_TRUE(there_and_back(SpawnRequest{"m", true, "", false, identity_pose, true}).is_confined);
  SpawnRequest with_joints{.sdf = "model://arm", .is_path = true, .name = {}};
  with_joints.gains = "elbow: {p: 1}\n", with_joints.joints = "elbow=1\nwaist=2";
  const auto spawned = there_and_back(with_joints);
  EXPECT_EQ(spawned.sdf, "model://arm");
  EXPECT_EQ(spawned.gains, "elbow: {p: 1}\n");
  EXPECT_EQ(spawned.joints, "elbow=1\nwaist=2");
  EXPECT_TRUE(spawned.is_path);
  ScreenshotRequest shot;
  shot.path = "/tmp/x.png";
  shot.view = ScreenshotRequest::View::follow;
  shot.follow = "robot";
  shot.with_scans = true;
  const auto shot_again = there_and_back(shot);
  EXPECT_EQ(shot_again.view, ScreenshotRequest::View::follow);
  EXPECT_TRUE(shot_again.with_scans);
  shot.path.clear();
  shot.as_pixels = true;
  EXPECT_TRUE(there_and_back(shot).as_pixels);
  EXPECT_EQ(there_and_back(ResetOdometryRequest{"base", 1, 2, 3, false, identity_pose}).a, 3);
  EXPECT_FALSE(there_and_back(SetMotorsRequest{"base", false}).are_enabled);
  EXPECT_EQ(there_and_back(SetRtfRequest{2.5}).rtf, 2.5);
  EXPECT_TRUE(there_and_back(ExportRequest{true}).with_collisions);
  EXPECT_EQ(there_and_back(TreeRequest{"robot"}).model, "robot");
  EXPECT_FALSE(there_and_back(TreeRequest{"robot"}).with_bounds);
  EXPECT_TRUE(there_and_back(TreeRequest{"", true}).with_bounds);
  there_and_back(PosesRequest{});
  there_and_back(ModelsRequest{});
  there_and_back(ShowRequest{});
  EXPECT_EQ(there_and_back(PoseLogRequest{72}).from, 72);
  EXPECT_EQ(there_and_back(PoseLogRequest{0, "arm::elbow\narm::waist"}).joints, "arm::elbow\narm::waist");
  const auto fault = there_and_back(FaultRequest{"robot::laser", "bias", -1.5, 2});
  EXPECT_EQ(fault.iface, "robot::laser");
  EXPECT_EQ(fault.kind, "bias");
  EXPECT_EQ(fault.amount, -1.5);
  EXPECT_EQ(fault.duration, 2);
  EXPECT_FALSE(there_and_back(FaultRequest{"robot::laser", "off", std::nullopt, 0}).amount);
  EXPECT_EQ(there_and_back(EndFaultsRequest{"", "stuck"}).kind, "stuck");
  EXPECT_EQ(there_and_back(FaultsRequest{"robot::laser"}).iface, "robot::laser");
  const auto tag = there_and_back(WriteTagRequest{"robot::rfid", "E200-0017", "shelf 3"});
  EXPECT_EQ(tag.iface, "robot::rfid");
  EXPECT_EQ(tag.id, "E200-0017");
  EXPECT_EQ(tag.data, "shelf 3");
  EXPECT_TRUE(there_and_back(WriteTagRequest{"robot::rfid", "E200-0017", ""}).data.empty());
}

TEST(Requests, nonsense_is_refused_with_a_message) {
  const auto message = [](const Request& request) {
    auto result = decode(encode(request));
    return result ? std::string("accepted") : result.error().message;
  };
  EXPECT_EQ(message(StepRequest{0}), "request step: steps must be 1 to 1e9, got 0");
  EXPECT_EQ(message(StepRequest{-1}), "request step: steps must be 1 to 1e9, got -1");
  EXPECT_EQ(message(SetPoseRequest{"r", {NAN, 0, 0, 1, 0, 0, 0}, false}), "request set-pose: numbers must be finite, got nan");
  EXPECT_EQ(message(SetPoseRequest{"r", {0, 0, 0, 0, 0, 0, 0}, false}), "request set-pose: the quaternion of the pose is zero");
  EXPECT_EQ(message(SetPoseRequest{"r", {1e308, 0, 0, 1, 0, 0, 0}, false}), "request set-pose: numbers must be below 1e12, got 1e+308");
  EXPECT_EQ(message(DeleteRequest{""}), "request delete: needs a name");
  EXPECT_EQ(message(PoseLogRequest{-1}), "request pose-log: the first byte must not be negative, got -1");
  EXPECT_EQ(message(SetRtfRequest{-1}), "request set-rtf: the real-time factor must not be negative, got -1");
  EXPECT_EQ(message(SpawnRequest{}), "request spawn: needs an SDF text or a path");
  ScreenshotRequest shot;
  shot.path = "relative.png";
  EXPECT_EQ(message(shot), "request screenshot: path must be absolute, got \"relative.png\"");
  shot.path = "/x.png";
  shot.width = 100000;
  EXPECT_EQ(message(shot), "request screenshot: size must be 1x1 to 8192x8192, got 100000x600");
  shot.width = 800;
  shot.as_pixels = true;
  EXPECT_EQ(message(shot), "request screenshot: pixels are no file; expected no path, got \"/x.png\"");
  EXPECT_EQ(message(ResetRequest{true, 5}), "request reset: a reset of the poses alone keeps the seed");
  EXPECT_EQ(message(FaultRequest{"", "off", std::nullopt, 0}), "request fault: needs a name");
  EXPECT_EQ(message(FaultRequest{"laser", "odd", std::nullopt, 0}),
            "fault \"odd\": unknown fault; expected one of off, stuck, bias, noise, missing, latency, dropout, weak, halted");
  EXPECT_EQ(message(FaultRequest{"laser", "dropout", 1.5, 0}), "fault dropout: its amount must be from 0 to 1, got 1.5");
  EXPECT_EQ(message(FaultRequest{"laser", "latency", 2.5, 0}), "fault latency: its amount must be a whole number of samples, got 2.5");
  EXPECT_EQ(message(FaultRequest{"laser", "off", std::nullopt, -1}), "request fault: duration must not be negative, got -1");
  RawRequest raw;
  raw.kind = 999;
  EXPECT_FALSE(decode(raw));
  raw.kind = RTMSIM_REQUEST_DELETE;
  std::memset(raw.body.name, 'x', sizeof raw.body.name);
  EXPECT_EQ(decode(raw).error().message, "request delete: its name has no end");
}

TEST(Requests, random_bytes_are_decoded_or_refused_but_never_worse) {
  std::mt19937_64 random(42);
  for (int n = 0; n < 20000; ++n) {
    RawRequest raw;
    raw.kind = static_cast<std::uint32_t>(random() % 31);
    auto* bytes = reinterpret_cast<unsigned char*>(&raw.body);
    for (std::size_t i = 0; i < sizeof raw.body; ++i) bytes[i] = static_cast<unsigned char>(random() % 4 == 0 ? random() : 0);
    raw.text.assign(random() % 50, static_cast<char>(random()));
    (void)decode(raw);
  }
}

struct BoardFixture : Fixture {
  std::unique_ptr<IfaceWriter> simulation = make(simulation_spec(simulation_info(), 4, 4));
  RequestBoard board{*simulation, *server};
  std::atomic<bool> is_over{false};

  // Answers with the name that was asked for, `text` and values, until is_over.
  std::thread serve(std::string text = {}) {
    return std::thread([this, text = std::move(text)] {
      while (!is_over) {
        board.wait(std::chrono::steady_clock::now() + 100ms);
        for (auto& asked : board.poll()) {
          Reply reply;
          if (const auto* pose = std::get_if<GetPoseRequest>(&asked.request)) reply.message = pose->name;
          if (const auto* spawn = std::get_if<SpawnRequest>(&asked.request)) reply.count = static_cast<std::int64_t>(spawn->sdf.size());
          reply.text = text;
          reply.steps = 5;
          board.reply(asked.ticket, reply);
        }
      }
    });
  }
  void end(std::thread& thread) {
    is_over = true;
    board.wake();
    thread.join();
  }
};

TEST(RequestBoard, every_client_gets_its_own_reply) {
  BoardFixture f;
  auto server = f.serve();
  std::vector<std::thread> clients;
  for (int c = 0; c < 4; ++c) {
    clients.emplace_back([&f, c] {
      auto requester = Requester::open(f.id);
      ASSERT_TRUE(requester);
      for (int n = 0; n < 200; ++n) {
        const std::string name = "client " + std::to_string(c) + " request " + std::to_string(n);
        auto reply = requester->ask(GetPoseRequest{name}, 60s);
        ASSERT_TRUE(reply) << reply.error().message;
        ASSERT_EQ(reply->message, name);
        ASSERT_EQ(reply->steps, 5U);
      }
    });
  }
  for (auto& client : clients) client.join();
  f.end(server);
}

TEST(RequestBoard, texts_longer_than_a_slot_travel_in_pieces) {
  BoardFixture f;
  std::string long_text(100'000, 'x');
  for (std::size_t i = 0; i < long_text.size(); ++i) long_text[i] = static_cast<char>('a' + i % 23);
  auto server = f.serve(long_text);
  auto requester = Requester::open(f.id);
  for (const std::size_t size : {std::size_t{1}, text_piece, text_piece + 1, std::size_t{70'000}}) {
    auto reply = requester->ask(SpawnRequest{std::string(size, 's'), false, "", false, identity_pose}, 60s);
    ASSERT_TRUE(reply) << reply.error().message;
    EXPECT_EQ(reply->count, static_cast<std::int64_t>(size));
    EXPECT_EQ(reply->text, long_text);
  }
  f.end(server);
}

TEST(RequestBoard, a_bad_request_is_answered_by_the_board_itself) {
  BoardFixture f;
  auto server = f.serve();
  auto requester = Requester::open(f.id);
  RawRequest raw;
  raw.kind = 12345;
  auto reply = requester->ask_raw(raw, 60s);
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->status, RequestStatus::bad_request);
  EXPECT_EQ(reply->message, "unknown kind of request: 12345");
  EXPECT_TRUE(requester->ask(PauseRequest{}, 60s));
  f.end(server);
}

TEST(RequestBoard, a_client_that_gave_up_does_not_get_the_late_reply) {
  BoardFixture f;
  auto requester = Requester::open(f.id);
  auto first = requester->ask(GetPoseRequest{"late"}, 1ms);
  ASSERT_FALSE(first);
  EXPECT_NE(first.error().message.find("did not answer in time"), std::string::npos);
  EXPECT_TRUE(f.board.poll().empty()) << "withdrawn";
  std::thread client([&] {
    auto second = requester->ask(GetPoseRequest{"second"}, 60s);
    ASSERT_TRUE(second);
    EXPECT_EQ(second->message, "second");
  });
  std::vector<RequestBoard::Asked> asked;
  while (asked.empty()) asked = f.board.poll();
  Reply wrong;
  wrong.message = "late";
  RequestTicket old = asked[0].ticket;
  --old.id;
  f.board.reply(old, wrong);
  Reply right;
  right.message = "second";
  f.board.reply(asked[0].ticket, right);
  f.board.reply(asked[0].ticket, wrong);
  client.join();
}

TEST(RequestBoard, a_request_in_two_calls_is_answered_when_the_server_gets_to_it) {
  BoardFixture f;
  auto requester = Requester::open(f.id);
  EXPECT_FALSE(requester->await(0ms)) << "nothing was begun";
  ASSERT_TRUE(requester->begin(StepRequest{5}));
  auto early = requester->await(1ms);
  ASSERT_TRUE(early) << early.error().message;
  EXPECT_FALSE(*early);
  const auto asked = f.board.poll();
  ASSERT_EQ(asked.size(), 1U) << "waiting does not withdraw it";
  EXPECT_EQ(std::get<StepRequest>(asked[0].request).steps, 5);
  Reply reply;
  reply.steps = 5;
  reply.text = "done";
  f.board.reply(asked[0].ticket, reply);
  const auto answer = requester->await(60s);
  ASSERT_TRUE(answer && *answer);
  EXPECT_EQ((*answer)->steps, 5U);
  EXPECT_EQ((*answer)->text, "done");
  EXPECT_FALSE(requester->begin(SpawnRequest{.sdf = "<sdf/>", .name = {}})) << "a text goes by ask()";
}

TEST(RequestBoard, a_request_that_was_begun_and_abandoned_is_not_answered_into_the_next_one) {
  BoardFixture f;
  auto requester = Requester::open(f.id);
  ASSERT_TRUE(requester->begin(GetPoseRequest{"first"}));
  const auto first = f.board.poll();
  ASSERT_EQ(first.size(), 1U);
  ASSERT_TRUE(requester->begin(GetPoseRequest{"second"}));
  EXPECT_FALSE(f.board.is_awaited(first[0].ticket));
  Reply late;
  late.message = "first";
  f.board.reply(first[0].ticket, late);
  const auto second = f.board.poll();
  ASSERT_EQ(second.size(), 1U);
  Reply right;
  right.message = "second";
  f.board.reply(second[0].ticket, right);
  const auto answer = requester->await(60s);
  ASSERT_TRUE(answer && *answer);
  EXPECT_EQ((*answer)->message, "second");
}

TEST(RequestBoard, replies_may_come_later_and_in_any_order) {
  BoardFixture f;
  std::vector<std::thread> clients;
  for (int c = 0; c < 3; ++c) {
    clients.emplace_back([&f, c] {
      auto reply = Requester::open(f.id)->ask(GetPoseRequest{std::to_string(c)}, 60s);
      ASSERT_TRUE(reply);
      EXPECT_EQ(reply->message, std::to_string(c));
    });
  }
  std::vector<RequestBoard::Asked> all;
  while (all.size() < 3) {
    for (auto& asked : f.board.poll()) all.push_back(std::move(asked));
  }
  for (auto asked = all.rbegin(); asked != all.rend(); ++asked) {
    Reply reply;
    reply.message = std::get<GetPoseRequest>(asked->request).name;
    f.board.reply(asked->ticket, reply);
  }
  for (auto& client : clients) client.join();
}

// A client writes its slot in several words. The server may look between any two of them and must not ask twice for what it took once.
TEST(RequestBoard, a_client_seen_while_it_takes_its_slot_is_served_once) {
  BoardFixture f;
  RequestSlot& slot = f.simulation->segment().as<RequestSlot>(AreaIndex::requests, 0);
  const auto poll_after = [&](auto change) {
    change();
    f.board.wake();
    return f.board.poll();
  };
  const ProcessMark mark = own_mark();
  EXPECT_TRUE(poll_after([&] { store(slot.owner, (static_cast<std::uint64_t>(mark.pid) << 32) + 77); }).empty());
  store(slot.pid_namespace, mark.pid_namespace);
  // Asks before the server has seen its start time: what a board reads when the client goes on between reap and take.
  const RawRequest request = encode(GetPoseRequest{"robot"});
  const auto asked = poll_after([&] {
    store(slot.id, std::uint64_t{5});
    slot.kind = request.kind;
    slot.body = request.body;
    store(slot.state, static_cast<std::uint32_t>(RTMSIM_SLOT_ASKED));
  });
  ASSERT_EQ(asked.size(), 1U);
  EXPECT_TRUE(poll_after([&] { store(slot.start_time, mark.start_time); }).empty()) << "the same request, taken twice";
  EXPECT_TRUE(f.board.is_awaited(asked[0].ticket));
  f.board.reply(asked[0].ticket, {});
  EXPECT_EQ(load(slot.state), static_cast<std::uint32_t>(RTMSIM_SLOT_REPLIED));
}

// Also when it takes its slot and asks while the server is on its way from who is there to what they ask.
TEST(RequestBoard, clients_that_come_while_the_server_looks_are_served_once) {
  BoardFixture f;
  std::atomic<int> answered{0};
  std::thread clients([&] {
    for (int n = 0; n < 2000 && answered == n; ++n) {
      auto requester = Requester::open(f.id);
      if (requester && requester->ask(GetPoseRequest{"robot"}, 60s)) ++answered;
    }
    f.is_over = true;
  });
  std::size_t taken = 0;
  std::vector<RequestBoard::Asked> waiting;
  while (!f.is_over) {
    // Those of before wait for one more look, as steps do.
    f.board.wake();
    auto asked = f.board.poll();
    taken += asked.size();
    for (const auto& one : waiting) f.board.reply(one.ticket, {});
    waiting = std::move(asked);
  }
  clients.join();
  EXPECT_EQ(answered, 2000);
  EXPECT_EQ(taken, 2000U) << "the same request, taken twice";
}

TEST(RequestBoard, clients_beyond_the_slots_are_told_so) {
  BoardFixture f;
  auto server = f.serve();
  std::vector<Requester> requesters;
  for (int n = 0; n < 5; ++n) requesters.push_back(Requester::open(f.id).value());
  for (int n = 0; n < 4; ++n) ASSERT_TRUE(requesters[static_cast<std::size_t>(n)].ask(RunRequest{}, 60s));
  auto refused = requesters[4].ask(RunRequest{}, 60s);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("no free slot"), std::string::npos);
  requesters.erase(requesters.begin());
  EXPECT_TRUE(requesters[3].ask(RunRequest{}, 60s));
  f.end(server);
}

TEST(RequestBoard, a_request_to_a_server_that_ends_fails_at_once) {
  BoardFixture f;
  auto requester = Requester::open(f.id);
  std::thread ender([&] {
    std::vector<RequestBoard::Asked> asked;
    while (asked.empty()) asked = f.board.poll();
    store_closed(*f.simulation);
  });
  auto reply = requester->ask(RunRequest{}, 60s);
  ender.join();
  ASSERT_FALSE(reply);
  EXPECT_NE(reply.error().message.find("has ended"), std::string::npos) << reply.error().message;
}

}  // namespace
}  // namespace shm::test
