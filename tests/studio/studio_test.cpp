// The parts of rtm-studio that need neither a socket nor a system.
#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <set>

#include "studio/acts.h"
#include "studio/client_message.h"
#include "studio/connection_graph.h"
#include "studio/foxglove.h"
#include "studio/late_models.h"
#include "studio/outbox.h"
#include "studio/parameters.h"
#include "studio/pose_board.h"
#include "studio/services.h"
#include "studio/session_hub.h"
#include "studio/signal_book.h"
#include "studio/signals.h"

namespace {

using studio::Json;

std::string text_of(std::optional<studio::Frame> frame) { return frame ? *frame->octets : "-"; }

TEST(Outbox, keeps_answers_in_order_and_of_everything_else_the_newest) {
  studio::Outbox box(100);
  box.put(studio::text_frame("first"));
  box.put_newest("poses", studio::text_frame("old"));
  box.put(studio::text_frame("second"));
  box.put_newest("poses", studio::text_frame("new"));
  box.put_newest("time", studio::text_frame("now"));
  box.drop("time");
  EXPECT_EQ(text_of(box.next()), "first");
  EXPECT_EQ(text_of(box.next()), "new");
  EXPECT_EQ(text_of(box.next()), "second");
  EXPECT_EQ(text_of(box.next()), "-");
}

TEST(Outbox, makes_a_frame_when_its_turn_comes_and_skips_one_that_is_empty) {
  studio::Outbox box(100);
  int made = 0;
  box.put_newest("a", [&]() -> std::optional<studio::Frame> { return ++made, std::nullopt; });
  box.put_newest("b", [&]() -> std::optional<studio::Frame> { return studio::text_frame("made"); });
  EXPECT_EQ(made, 0);
  EXPECT_EQ(text_of(box.next()), "made");
  EXPECT_EQ(made, 1);
}

TEST(Outbox, is_overfull_by_answers_alone) {
  studio::Outbox box(10);
  box.put_newest("large", studio::text_frame(std::string(1000, 'x')));
  EXPECT_FALSE(box.is_overfull());
  box.put(studio::text_frame(std::string(11, 'x')));
  EXPECT_TRUE(box.is_overfull());
  (void)box.next();
  (void)box.next();
  EXPECT_FALSE(box.is_overfull());
}

TEST(ClientMessage, reads_what_viewers_say) {
  auto message = studio::parse_message(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":7}]})");
  ASSERT_TRUE(message);
  EXPECT_EQ(std::get<studio::Subscribe>(*message).subscriptions.front(), std::pair(1u, 7u));
  message = studio::parse_message(R"({"op":"request","id":-3,"name":"run","dry":true})");
  ASSERT_TRUE(message);
  EXPECT_EQ(std::get<studio::Request>(*message).id, -3);
  EXPECT_TRUE(std::get<studio::Request>(*message).is_dry);
  message = studio::parse_message(R"({"op":"fetchAsset"})");
  ASSERT_TRUE(message);
  EXPECT_EQ(std::get<studio::Unused>(*message).op, "fetchAsset");
}

TEST(ClientMessage, reads_channels_and_parameters_of_foxglove_clients) {
  auto message = studio::parse_message(R"({"op":"advertise","channels":[{"id":3,"topic":"/A0/in","encoding":"json","schemaName":"x"}]})");
  ASSERT_TRUE(message);
  const auto& channel = std::get<studio::Advertise>(*message).channels.at(0);
  EXPECT_EQ(channel.id, 3U);
  EXPECT_EQ(channel.topic + channel.encoding + channel.schema, "/A0/injsonx");
  message = studio::parse_message(R"({"op":"unadvertise","channelIds":[3]})");
  ASSERT_TRUE(message);
  EXPECT_EQ(std::get<studio::Unadvertise>(*message).ids, std::vector<std::uint32_t>{3});
  message = studio::parse_message(R"({"op":"setParameters","parameters":[{"name":"A0.x","value":1.5}],"id":"7"})");
  ASSERT_TRUE(message);
  EXPECT_EQ(std::get<studio::SetParameters>(*message).values.at(0), std::pair(std::string("A0.x"), Json(1.5)));
  EXPECT_EQ(std::get<studio::SetParameters>(*message).id, "7");
  message = studio::parse_message(R"({"op":"subscribeParameterUpdates","parameterNames":[]})");
  ASSERT_TRUE(message);
  EXPECT_TRUE(std::get<studio::ParameterWish>(*message).is_wanted);
}

TEST(FoxgloveFrame, is_data_of_a_channel_or_a_call_of_a_service) {
  using namespace std::string_literals;
  const auto data = studio::parse_frame("\1\7\0\0\0{}"s);
  ASSERT_TRUE(data);
  EXPECT_EQ(std::get<studio::PublishedData>(*data).channel, 7U);
  const auto octets = "\2\1\0\0\0\11\0\0\0\4\0\0\0json{}"s;
  const auto call = studio::parse_frame(octets);
  ASSERT_TRUE(call);
  EXPECT_EQ(std::get<studio::ServiceCall>(*call).call, 9U);
  EXPECT_EQ(std::get<studio::ServiceCall>(*call).encoding, "json");
  for (std::size_t size = 0; size < 17; ++size) EXPECT_FALSE(studio::parse_frame(octets.substr(0, size))) << size;
  EXPECT_FALSE(studio::parse_frame("\1\7\0\0"s));
  EXPECT_FALSE(studio::parse_frame("\3\7\0\0\0\0\0\0\0\0\0\0\0\0"s));
}

TEST(Services, are_requests_to_the_simulator_with_the_schema_of_their_arguments) {
  const Json all = Json::parse(studio::advertise_services(true)), some = Json::parse(studio::advertise_services(false));
  EXPECT_GT(all["services"].size(), some["services"].size());
  for (const Json& one : all["services"]) {
    const auto service = studio::find_service(one["id"].get<std::uint32_t>());
    ASSERT_TRUE(service && service->act != nullptr) << one;
    EXPECT_EQ(one["name"].get<std::string>(), "/simulator/" + service->name);
    const Json schema = Json::parse(one["request"]["schema"].get<std::string>());
    for (const Json& name : schema["required"]) EXPECT_TRUE(schema["properties"].contains(name.get<std::string>())) << schema;
  }
  EXPECT_FALSE(studio::find_service(0));
  EXPECT_FALSE(studio::find_service(1000));
  EXPECT_FALSE(studio::arguments_of({1, 1, "cdr", "{}"}));
  EXPECT_FALSE(studio::arguments_of({1, 1, "json", "[]"}));
  EXPECT_EQ(*studio::arguments_of({1, 1, "json", " "}), Json::object());
}

TEST(Parameters, are_numbers_where_their_text_is_one_and_texts_again_when_they_are_set) {
  EXPECT_EQ(studio::value_from_text("0.5", "double"), Json(0.5));
  EXPECT_EQ(studio::value_from_text("0.5", "string"), Json("0.5"));
  EXPECT_EQ(studio::value_from_text("left", ""), Json("left"));
  EXPECT_EQ(*studio::text_from_value("x", Json(2)), "2");
  EXPECT_EQ(*studio::text_from_value("x", Json(true)), "true");
  EXPECT_EQ(*studio::text_from_value("x", Json::parse("[1,2.5]")), "1,2.5");
  for (const char* text : {"null", "{}", "[[1]]"}) EXPECT_FALSE(studio::text_from_value("x", Json::parse(text))) << text;
}

TEST(ClientMessage, says_in_one_line_what_is_wrong) {
  const std::string deep = R"({"op":"request","id":1,"name":"run","args":{"a":)" + std::string(30, '[') + std::string(30, ']') + "}}";
  for (const std::string& text :
       {std::string(), std::string("[]"), std::string("{"), std::string(R"({"op":3})"),
        std::string(R"({"op":"request","id":"1","name":"run"})"), std::string(R"({"op":"request","id":1.5,"name":"run"})"),
        std::string(R"({"op":"request","id":1,"name":7})"), std::string(R"({"op":"request","id":1,"name":"run","args":[]})"),
        std::string(R"({"op":"subscribe"})"), std::string(R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]})"),
        std::string(R"({"op":"subscribe","subscriptions":[1]})"), std::string(R"({"op":"unsubscribe","subscriptionIds":[4294967296]})"),
        deep, std::string(studio::max_message + 1, ' ')}) {
    const auto message = studio::parse_message(text);
    ASSERT_FALSE(message) << text.substr(0, 100);
    EXPECT_EQ(message.error().message.find('\n'), std::string::npos);
  }
}

TEST(ClientMessage, brackets_in_texts_do_not_count) {
  EXPECT_TRUE(studio::parse_message(R"({"op":"request","id":1,"name":"run","args":{"a":"\"[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[["}})"));
}

// Whatever comes: an answer or a refusal.
TEST(ClientMessage, mutated_messages_do_no_harm) {
  const std::vector<std::string> seeds = {
      R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":7}]})",
      R"({"op":"request","id":1,"name":"set_pose","args":{"model":"a","pose":[0,0,0,1,0,0,0]},"dry":true})",
      R"({"op":"request","id":2,"name":"connect","args":{"ports":["a:b","c:d"],"properties":{"k":"v"}}})",
      R"({"op":"unsubscribe","subscriptionIds":[1,2,3]})",
      R"({"op":"setParameters","parameters":[{"name":"a.b","value":[1,"x"]}],"id":"1"})",
      R"({"op":"advertise","channels":[{"id":1,"topic":"/a/b","encoding":"json","schemaName":""}]})"};
  const char* from_outside = std::getenv("RTMSIM_STUDIO_MUTATIONS");
  const long count = from_outside != nullptr ? std::atol(from_outside) : 20000;
  std::mt19937 random(7);
  const studio::ActContext context;
  long understood = 0;
  for (long i = 0; i < count; ++i) {
    std::string text = seeds[random() % seeds.size()];
    for (auto changes = random() % 6; changes > 0; --changes) {
      const auto at = random() % text.size();
      switch (random() % 4) {
        case 0:
          text[at] = static_cast<char>(random());
          break;
        case 1:
          text.insert(at, text.substr(random() % text.size(), random() % 16));
          break;
        case 2:
          text.erase(at, 1 + random() % 8);
          break;
        default:
          text[at] = "{}[]\",:0-9e"[random() % 11];
          break;
      }
      if (text.empty()) text = " ";
    }
    const auto message = studio::parse_message(text);
    if (!message) continue;
    ++understood;
    const auto* request = std::get_if<studio::Request>(&*message);
    const studio::Act* act = request != nullptr ? studio::find_act(request->name) : nullptr;
    if (act != nullptr) (void)act->plan(context, request->args);
    if (request != nullptr) (void)studio::to_text(request->args);
  }
  EXPECT_GT(understood, count / 20);
}

TEST(Arguments, are_named_when_they_are_wrong) {
  const Json args = Json::parse(R"({"t":"a\u0000b","list":[1,"2"],"values":{"k":1},"good":[1,2,3]})", nullptr, false);
  EXPECT_EQ(studio::number_of(args, "absent").error().message, "absent: expected a number");
  EXPECT_FALSE(studio::text_of(args, "t"));
  EXPECT_FALSE(studio::numbers_of(args, "list", 2, 2));
  EXPECT_FALSE(studio::values_of(args, "values"));
}

std::vector<float> poses(std::initializer_list<float> xs) {
  std::vector<float> numbers;
  for (const float x : xs) numbers.insert(numbers.end(), {x, 0, 0, 1, 0, 0, 0});
  return numbers;
}

std::uint32_t count_in(const std::string& frame) {
  std::uint32_t count = 0;
  std::memcpy(&count, frame.data() + 16, sizeof count);
  return count;
}

TEST(PoseBoard, sends_all_links_first_and_then_what_has_moved) {
  studio::PoseBoard board;
  EXPECT_TRUE(board.update(1, std::chrono::seconds(1), poses({1, 2, 3})));
  std::uint64_t seen = 0;
  auto frame = board.frame_since(seen);
  ASSERT_TRUE(frame);
  EXPECT_EQ(count_in(*frame), 3u);
  EXPECT_EQ(frame->size(), 24u + 3 * 24);
  EXPECT_EQ((*frame)[1], 1);
  EXPECT_FALSE(board.frame_since(seen));
  EXPECT_FALSE(board.update(1, std::chrono::seconds(2), poses({1, 2, 3})));
  EXPECT_TRUE(board.update(1, std::chrono::seconds(3), poses({1, 2.5, 3})));
  frame = board.frame_since(seen);
  ASSERT_TRUE(frame);
  EXPECT_EQ(count_in(*frame), 1u);
  std::uint64_t other = 0;
  EXPECT_EQ(count_in(*board.frame_since(other)), 3u);
}

TEST(PoseBoard, a_slow_viewer_gets_each_link_once_as_it_is_now) {
  studio::PoseBoard board;
  std::uint64_t seen = 0;
  (void)board.update(1, {}, poses({0, 0}));
  (void)board.frame_since(seen);
  for (int i = 1; i < 50; ++i) (void)board.update(1, {}, poses({static_cast<float>(i), 0}));
  const auto frame = board.frame_since(seen);
  ASSERT_TRUE(frame);
  EXPECT_EQ(count_in(*frame), 1u);
  float x = 0;
  std::memcpy(&x, frame->data() + 28, sizeof x);
  EXPECT_EQ(x, 49.0F);
}

TEST(PoseBoard, a_new_scene_is_sent_whole_and_numbers_that_are_none_do_no_harm) {
  studio::PoseBoard board;
  std::uint64_t seen = 0;
  (void)board.update(1, {}, poses({0, 0}));
  (void)board.frame_since(seen);
  (void)board.update(2, {}, poses({std::nanf(""), 1e30F, 3}));
  EXPECT_EQ(count_in(*board.frame_since(seen)), 3u);
}

TEST(PoseBoard, creeping_links_are_sent_when_they_have_come_far_enough) {
  studio::PoseBoard board;
  std::uint64_t seen = 0;
  (void)board.update(1, {}, poses({0}));
  (void)board.frame_since(seen);
  int sent = 0;
  for (int i = 1; i <= 100; ++i) {
    (void)board.update(1, {}, poses({static_cast<float>(i) * 2e-5F}));
    if (board.frame_since(seen)) ++sent;
  }
  EXPECT_GT(sent, 10);
  EXPECT_LT(sent, 30);
}

TEST(Foxglove, message_data_has_the_layout_of_the_protocol) {
  const std::string payload = "abc";
  const auto frame = studio::message_data(0x01020304, std::chrono::nanoseconds(0x0102030405), payload);
  EXPECT_EQ(frame, std::string("\x01\x04\x03\x02\x01\x05\x04\x03\x02\x01\0\0\0abc", 16));
}

TEST(MemberAt, follows_members_and_indices) {
  const Json value = Json::parse(R"({"a":{"b":[1,{"c":2}]},"d":[3]})");
  EXPECT_EQ(studio::member_at(value, "a.b[1].c"), 2);
  EXPECT_EQ(studio::member_at(value, "d[0]"), 3);
  for (const char* path : {"x", "a.b[2]", "a.b[-1]", "a.b[", "a..b", "d[0].x", ".", "[0]", "d[99999999999999999999]"})
    EXPECT_TRUE(studio::member_at(value, path).is_null()) << path;
}

TEST(SignalBook, names_signals_as_recordings_do) {
  studio::SignalBook book;
  EXPECT_TRUE(book.take_world(Json::parse(R"({"ifaces":[{"type":"laser","name":"robot::laser","model":"robot"}]})")));
  const Json system = Json::parse(R"({"components":[
    {"path":"/n/a.host_cxt/C0.rtc","instance":"C0","ports":[{"name":"out","kind":"out","data_type":"T"},{"name":"in","kind":"in"}]},
    {"path":"/n/b.host_cxt/C0.rtc","instance":"C0","ports":[{"name":"out","kind":"out","data_type":"T"}]}]})");
  EXPECT_TRUE(book.take_system(system));
  EXPECT_FALSE(book.take_system(system));
  EXPECT_EQ(book.source_of("/sim/laser/robot/laser"), "laser:robot::laser");
  EXPECT_EQ(book.source_of("/C0/out"), "/n/a.host_cxt/C0.rtc:out");
  EXPECT_EQ(book.source_of("/n/b.host_cxt/C0.rtc:out"), "/n/b.host_cxt/C0.rtc:out");
  EXPECT_EQ(book.event()["signals"].size(), 3u);
}

TEST(Acts, of_a_simulator_say_what_one_would_type) {
  const studio::ActContext context{.server_id = 7};
  const auto command = [&](const char* name, const char* args) {
    const auto plan = studio::find_act(name)->plan(context, Json::parse(args));
    return plan ? plan->command : "error: " + plan.error().message;
  };
  EXPECT_EQ(command("run", "{}"), "simctl -s 7 run");
  EXPECT_EQ(command("step", R"({"steps":5,"paced":true})"), "simctl -s 7 step 5 --paced");
  EXPECT_EQ(command("step", R"({"steps":0})"), "error: steps: expected 1 to 1e9");
  EXPECT_EQ(command("set_pose", R"({"model":"a b","planar":[1,2,0.5]})"), "simctl -s 7 pose 'a b' 1 2 0.5");
  EXPECT_EQ(command("set_pose", R"({"model":"a","pose":[1,2,3,1,0,0,0]})"), "simctl -s 7 pose a 1 2 3 0 0 0");
  EXPECT_EQ(command("set_pose", R"({"model":"a","pose":[1,2,3,0.6,0.8,0,0]})"), "simctl -s 7 pose a 1 2 3 1.8545904360032248 0 0");
  EXPECT_EQ(command("push", R"({"name":"r","force":[1,0,0],"seconds":2})"), "simctl -s 7 wrench r 1 0 0 --for 2");
  EXPECT_EQ(command("spawn", R"({"model":"../../etc"})"), "error: model \"../../etc\": expected the name of a model on the model path");
  EXPECT_EQ(command("spawn", R"({"model":"/tmp/x.sdf"})"), "error: model \"/tmp/x.sdf\": expected the name of a model on the model path");
}

TEST(Acts, of_a_picture_say_which_view) {
  const auto command = [&](const char* args) {
    const auto plan = studio::find_act("screenshot")->plan({.server_id = 7}, Json::parse(args));
    return plan ? plan->command : "error: " + plan.error().message;
  };
  EXPECT_EQ(command(R"({"pose":[1,2,3,1,0,0,0],"span":1.2,"collisions":true})"),
            "simctl -s 7 screenshot world.png --size 800x600 --from '1 2 3 0 0 0' --span 1.2 --show collisions");
  EXPECT_EQ(command(R"({"pose":[1,2,0,1,0,0,0],"span":9,"top":true,"width":300,"height":200})"),
            "simctl -s 7 screenshot world.png --size 300x200 --top --at '1 2' --span 9");
  EXPECT_EQ(command(R"({"pose":[1,2,0,1,0,0,0],"width":5000})"), "error: width, height: expected 1 to 4096");
}

TEST(Acts, of_components_say_what_one_would_type) {
  const studio::ActContext context{.name_server = "127.0.0.1:2809", .server_id = 7};
  const auto command = [&](const char* name, const char* args) {
    const auto plan = studio::find_act(name)->plan(context, Json::parse(args));
    return plan ? plan->command : "error: " + plan.error().message;
  };
  const std::string rtse = "rtse --ns 127.0.0.1:2809 ";
  EXPECT_EQ(command("join_time", R"({"path":"/a.rtc","phase":2,"rate":50})"), rtse + "join /a.rtc -s 7 -p 2 -r 50");
  EXPECT_EQ(command("join_time", R"({"path":"/a.rtc","phase":15,"turn":3})"), rtse + "join /a.rtc -s 7 -p 15 --turn 3");
  EXPECT_EQ(command("join_time", R"({"path":"/a.rtc","turn":10000})"), "error: turn: expected a whole number from 0 to 9999");
  EXPECT_EQ(command("load_module", R"({"manager":"/m.mgr","file":"A.so","init":"AInit"})"), rtse + "mgr load A.so AInit -m /m.mgr");
  EXPECT_EQ(command("load_module", R"({"manager":"/m.mgr","file":"A.so","init":"-x"})"),
            "error: file \"A.so\": expected the name of a module, and perhaps that of its function");
  EXPECT_EQ(command("set_configuration", R"({"path":"/a.rtc","set":"default","values":{"gain":"9"},"force":true})"),
            rtse + "conf /a.rtc set gain 9 -s default --force");
  EXPECT_EQ(command("join_time", R"({"path":"/a.rtc","phase":1.5})"), "error: phase: expected a whole number from 0 to 15");
  EXPECT_EQ(command("leave_time", R"({"path":"/a.rtc"})"), rtse + "leave /a.rtc");
  EXPECT_EQ(command("disconnect_all", R"({"path":"/a.rtc:in"})"), rtse + "dis /a.rtc:in");
  EXPECT_EQ(command("inject", R"({"port":"/a.rtc:in","value":"{\"data\":1}"})"), rtse + "inject /a.rtc:in '{\"data\":1}'");
  EXPECT_EQ(command("inject", R"({"port":"/a.rtc:in","value":"--count=0"})"), "error: value: expected JSON, or RTC.TYPE({time}, ...)");
  EXPECT_EQ(command("unload_module", R"({"manager":"/m.mgr","file":"A.so"})"), rtse + "mgr unload A.so -m /m.mgr");
}

// Names come from worlds and peers; what is copied is pasted into a terminal.
TEST(Acts, no_name_becomes_a_command_of_the_terminal_or_an_option) {
  const auto command = [&](const char* name, const Json& args) {
    const auto plan = studio::find_act(name)->plan({.name_server = "localhost"}, args);
    return plan ? plan->command : "error: " + plan.error().message;
  };
  const std::string end_of_paste = "x\x1b[201~\nid\n";
  EXPECT_EQ(command("delete_model", {{"model", end_of_paste}}), "simctl delete $'x\\x1b[201~\\x0aid\\x0a'");
  EXPECT_EQ(command("set_pose", {{"model", "--help"}, {"planar", {1, -2, 0}}}), "simctl pose -- --help 1 -2 0");
  EXPECT_EQ(command("set_pose", {{"model", "a"}, {"planar", {1, -2, 0}}}), "simctl pose a 1 -2 0");
  EXPECT_EQ(command("push", {{"name", "-x"}, {"force", {1, 0, 0}}, {"seconds", 2}}), "simctl wrench --for 2 -- -x 1 0 0");
  EXPECT_EQ(command("activate", {{"path", "-e"}, {"context", 2}}), "rtse act -e 2 -- -e");
  EXPECT_EQ(command("connect", {{"ports", {"-a", "b"}}, {"name", "-n"}, {"properties", {{"-k", "\xc2\x9b"}}}}),
            "rtse con -n-n $'-p-k=\\xc2\\x9b' -- -a b");
  EXPECT_EQ(command("set_configuration", {{"path", "/a.rtc"}, {"set", "s"}, {"values", {{"--force", "-1"}}}}),
            "rtse conf -s s -- /a.rtc set --force -1");
}

Json marker(const char* model, const char* frame, int type = 11) {
  const Json corner{{"x", 1}, {"y", 0.00001}, {"z", 0}};
  return {{"ns", model},
          {"type", type},
          {"header", {{"frame_id", frame}}},
          {"points", Json::array({corner, corner, corner})},
          {"color", {{"r", 1}, {"g", 0}, {"b", 0}, {"a", 1}}}};
}
Json markers(Json::array_t list) { return {{"markers", std::move(list)}}; }

TEST(LateModels, are_those_that_the_scene_does_not_have_and_those_that_have_gone) {
  studio::RecordedScene scene;
  scene.version = 3;
  scene.models = Json::array({{{"name", "box"}}, {{"name", "robot"}}, {{"name", "shapeless"}}});
  studio::LateModels late;
  const Json first = markers({marker("", "", 0), marker("box", "box::l"), marker("robot", "robot::l")});
  late.begin(first);
  late.take(first, scene);
  EXPECT_EQ(late.event(scene), Json::parse(R"({"op":"late","version":3,"models":[],"gone":[]})"));
  late.take(markers({marker("robot", "robot::l"), marker("new", "new::b"), marker("new", "new::a"), marker("new", "new::b")}), scene);
  const auto event = late.event(scene);
  EXPECT_EQ(event["gone"], Json::array({"box"}));
  EXPECT_EQ(late.frames(), (std::vector<std::string>{"new::a", "new::b"}));
  ASSERT_EQ(event["models"].size(), 1u);
  EXPECT_EQ(event["models"][0]["links"][1]["parts"].size(), 2u);
  EXPECT_EQ(event["models"][0]["links"][0]["parts"][0]["points"], Json::array({1, 0, 0, 1, 0, 0, 1, 0, 0}));
  late.take(first, scene);
  EXPECT_TRUE(late.frames().empty());
}

TEST(SessionHub, only_what_is_in_the_folder_is_opened) {
  namespace fs = std::filesystem;
  std::string top = (fs::temp_directory_path() / "hall-XXXXXX").string();
  ASSERT_NE(mkdtemp(top.data()), nullptr);
  const fs::path folder = fs::path(top) / "mine", other = fs::path(top) / "other.mcap";
  fs::create_directories(folder / "runs");
  for (const auto& file : {folder / "a.mcap", folder / "runs/b.mcap", folder / "c.txt", other}) std::ofstream(file) << "x";
  fs::create_symlink(other, folder / "link.mcap");
  std::set<std::string> names;
  for (const auto& one : studio::files_in(folder, ".mcap")) names.insert(one.at("file").get<std::string>());
  EXPECT_EQ(names, (std::set<std::string>{"a.mcap", "link.mcap", "runs/b.mcap"}));
  for (const std::string& name : {std::string("a.mcap"), std::string("runs/../a.mcap"), (folder / "runs/b.mcap").string()})
    EXPECT_TRUE(studio::file_in(folder, "recording", name).ok()) << name;
  for (const std::string name : {"../other.mcap", "link.mcap", "runs", "", "/etc/passwd", "d.mcap"})
    EXPECT_FALSE(studio::file_in(folder, "recording", name).ok()) << name;
  fs::remove_all(top);
}

TEST(ConnectionGraph, names_who_publishes_a_topic_and_who_receives_it) {
  const auto system = studio::Json::parse(R"({"components":[{"path":"/h/A0.rtc","instance":"A0"},{"path":"/h/B0.rtc","instance":"B0"}],
    "connections":[{"ports":["/h/A0.rtc:out","/h/B0.rtc:in"]}]})");
  const auto signals = studio::Json::parse(R"({"signals":[{"topic":"/A0/out","kind":"port","component":"/h/A0.rtc"},
    {"topic":"/sim/laser/x","kind":"iface"},{"topic":"/C0/out","kind":"port","component":"/h/C0.rtc"}]})");
  const auto graph = studio::connection_graph(system, signals);
  EXPECT_EQ(graph["publishedTopics"].dump(), R"([{"name":"/A0/out","publisherIds":["A0"]}])");
  EXPECT_EQ(graph["subscribedTopics"].dump(), R"([{"name":"/A0/out","subscriberIds":["B0"]}])");
  const auto nobody = studio::connection_graph({}, {});
  EXPECT_EQ(studio::Json::parse(studio::graph_update(graph, nobody))["removedTopics"].dump(), R"(["/A0/out"])");
  const auto cut = studio::connection_graph({{"components", system["components"]}}, signals);
  EXPECT_EQ(studio::Json::parse(studio::graph_update(graph, cut))["subscribedTopics"].dump(), R"([{"name":"/A0/out","subscriberIds":[]}])");
}

}  // namespace
