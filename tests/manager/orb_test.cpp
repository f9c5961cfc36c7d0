#include "corba/orb/orb.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "base/guarded.h"
#include "corba/orb/call_timeout.h"
#include "corba/orb/naming.h"
#include "support/naming_service.h"

namespace corba {
namespace {

using namespace std::chrono_literals;

std::unique_ptr<Orb> started(OrbSettings settings = {}) {
  auto orb = Orb::start(settings);
  EXPECT_TRUE(orb.ok()) << (orb.ok() ? "" : orb.error().message);
  if (!orb) return nullptr;
  (*orb)->activate();
  return std::move(*orb);
}

// An object without any operations of its own, for names and references.
class Thing : public PortableServer::ServantBase {
 public:
  const char* _mostDerivedRepoId() override { return "IDL:test/Thing:1.0"; }
  void* _ptrToInterface(const char*) override { return nullptr; }
};

CORBA::Object_var make_object(Orb& orb) {
  PortableServer::ServantBase_var servant = new Thing;
  const PortableServer::ObjectId_var id = orb.root_poa()->activate_object(servant.in());
  return orb.root_poa()->id_to_reference(id);
}

// Sends the bytes and waits for the connection to be closed or the time to be over.
void send_bytes(int port, const std::string& bytes) {
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  ASSERT_EQ(connect(socket, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  [[maybe_unused]] auto sent = send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  close(socket);
}

TEST(Orb, listens_on_loopback_only_and_publishes_a_unix_socket) {
  const int port = support::free_port();
  auto orb = started({.endpoints = {":" + std::to_string(port)}});
  ASSERT_TRUE(orb);
  EXPECT_TRUE(support::is_listening(port));
  CORBA::Object_var object = make_object(*orb);
  CORBA::String_var ior = orb->orb()->object_to_string(object);
  std::string bytes;
  for (std::size_t i = 4; i + 1 < std::string_view(ior).size(); i += 2) {
    bytes += static_cast<char>(std::stoi(std::string(std::string_view(ior).substr(i, 2)), nullptr, 16));
  }
  EXPECT_NE(bytes.find("127.0.0.1"), std::string::npos);
  EXPECT_NE(bytes.find("/socket"), std::string::npos);
}

TEST(Orb, an_end_point_in_use_is_one_line) {
  const int port = support::free_port();
  auto first = started({.endpoints = {":" + std::to_string(port)}});
  first.reset();
  support::NamingService occupant;
  const auto second = Orb::start({.endpoints = {occupant.address()}});
  ASSERT_FALSE(second.ok());
  EXPECT_EQ(second.error().message.find('\n'), std::string::npos);
  EXPECT_NE(second.error().message.find(occupant.address()), std::string::npos) << second.error().message;
}

// The words are ours: an ORB says EADDRNOTAVAIL in its own way.
TEST(Orb, an_end_point_that_cannot_be_says_why_in_one_line) {
  const support::NamingService occupant;
  const std::string taken = occupant.address(), port = taken.substr(taken.rfind(':') + 1);
  for (const auto& [endpoint, why] : std::initializer_list<std::pair<std::string, std::string>>{
           {taken, "port " + port + " is taken by another process"},
           {"192.0.2.1:0", "no network interface of this machine has the address 192.0.2.1"},
           {"[2001:db8::1]:0", "no network interface of this machine has the address 2001:db8::1"},
           {"no-such-host.invalid:0", "host \"no-such-host.invalid\" is not known"},
           {"giop:smoke:127.0.0.1:0", "expected giop:tcp:HOST:PORT, giop:ssl:HOST:PORT or giop:unix:FILE"}}) {
    const auto refused = Orb::start({.endpoints = {endpoint}});
    ASSERT_FALSE(refused) << endpoint;
    const std::string& line = refused.error().message;
    EXPECT_NE(line.find(why), std::string::npos) << line;
    EXPECT_EQ(line.find("omniORB"), std::string::npos) << line;
    EXPECT_EQ(line.find('\n'), std::string::npos) << line;
  }
}

TEST(Orb, nonsense_settings_are_refused) {
  EXPECT_FALSE(Orb::start({.endpoints = {"host:port"}}).ok());
  const auto nonsense = Orb::start({.endpoints = {"nonsense:::"}});
  ASSERT_FALSE(nonsense.ok());
  EXPECT_NE(nonsense.error().message.find("expected host:port"), std::string::npos) << nonsense.error().message;
  EXPECT_FALSE(Orb::start({.endpoints = {":70000"}}).ok());
  EXPECT_FALSE(Orb::start({.arguments = {"-ORBnoSuchThing", "1"}}).ok());
}

TEST(Orb, can_be_started_again_and_again) {
  for (int i = 0; i < 5; ++i) {
    auto orb = started();
    ASSERT_TRUE(orb);
    CORBA::Object_var object = make_object(*orb);
    EXPECT_FALSE(object->_non_existent());
  }
}

TEST(Orb, the_private_folder_goes_with_the_orb) {
  support::TemporaryFolder runtime;
  setenv("XDG_RUNTIME_DIR", runtime.path().c_str(), 1);
  auto orb = started();
  EXPECT_FALSE(std::filesystem::is_empty(runtime.path()));
  for (const auto& entry : std::filesystem::directory_iterator(runtime.path())) {
    struct stat status {};
    stat(entry.path().c_str(), &status);
    EXPECT_EQ(status.st_mode & 0777, 0700u);
  }
  orb.reset();
  EXPECT_TRUE(std::filesystem::is_empty(runtime.path()));
}

TEST(Orb, folders_of_dead_processes_are_removed) {
  support::TemporaryFolder runtime;
  setenv("XDG_RUNTIME_DIR", runtime.path().c_str(), 1);
  const auto stale = runtime.path() / "rtmsim-orb-stale1";
  std::filesystem::create_directory(stale);
  std::ofstream(stale / "lock").put('x');
  auto orb = started();
  EXPECT_FALSE(std::filesystem::exists(stale));
}

TEST(Orb, garbage_on_the_port_closes_that_connection_only) {
  const int port = support::free_port();
  auto orb = started({.endpoints = {":" + std::to_string(port)}});
  CORBA::Object_var object = make_object(*orb);
  send_bytes(port, std::string(1 << 16, '\xff'));
  send_bytes(port, "GET / HTTP/1.0\r\n\r\n");
  send_bytes(port, std::string("GIOP\x01\x02\x01\x00\xff\xff\xff\x7f", 12));  // a request of 2 GiB
  send_bytes(port, std::string("GIOP\x01\x02\x01\x00\x10\x00\x00\x00", 12) + std::string(16, '\xee'));
  send_bytes(port, std::string("GIOP\x09\x09\x00\x00\x00\x00\x00\x00", 12));
  send_bytes(port, "");
  EXPECT_FALSE(object->_non_existent());
  orb->publish("thing", object);
  CORBA::Object_var again = orb->orb()->string_to_object(("corbaloc:iiop:127.0.0.1:" + std::to_string(port) + "/thing").c_str());
  EXPECT_FALSE(again->_non_existent());
}

TEST(Orb, published_keys_lead_to_the_object_until_they_are_withdrawn) {
  const int port = support::free_port();
  auto orb = started({.endpoints = {":" + std::to_string(port)}});
  CORBA::Object_var object = make_object(*orb);
  const auto url = "corbaloc:iiop:127.0.0.1:" + std::to_string(port) + "/example.Thing0";
  CORBA::Object_var before = orb->orb()->string_to_object(url.c_str());
  EXPECT_TRUE(before->_non_existent());
  orb->publish("example.Thing0", object);
  orb->publish("example.Thing0", object);
  CORBA::Object_var found = orb->orb()->string_to_object(url.c_str());
  EXPECT_TRUE(found->_is_a("IDL:test/Thing:1.0"));
  orb->withdraw("example.Thing0");
  orb->withdraw("example.Thing0");
  CORBA::Object_var after = orb->orb()->string_to_object(url.c_str());
  EXPECT_TRUE(after->_non_existent());
}

CORBA::Object_var look_up(Orb& orb, const support::NamingService& names, const std::string& text) {
  auto root = root_context(orb.orb(), names.address(), 5s);
  if (!root) return CORBA::Object::_nil();
  try {
    return (*root)->resolve(*parse_name(text));
  } catch (const CORBA::Exception&) {
    return CORBA::Object::_nil();
  }
}

bool appears(Orb& orb, const support::NamingService& names, const std::string& text, CORBA::Object_ptr object) {
  const auto deadline = std::chrono::steady_clock::now() + support::watchdog;
  while (std::chrono::steady_clock::now() < deadline) {
    CORBA::Object_var found = look_up(orb, names, text);
    if (!CORBA::is_nil(found) && found->_is_equivalent(object)) return true;
    std::this_thread::sleep_for(5ms);
  }
  return false;
}

#ifndef NDEBUG
TEST(OrbDeathTest, a_call_to_another_process_while_data_is_held_is_found) {
  support::NamingService names;
  const auto call = [&](bool holds_data) {
    auto orb = started();
    CORBA::Object_var context = orb->orb()->string_to_object(("corbaloc:iiop:" + names.address() + "/NameService").c_str());
    if (context->_non_existent()) std::abort();  // nothing is held: this call succeeds
    base::Guarded<int, base::Rank::queue> data;
    if (!holds_data) std::_Exit(0);
    const auto lock = data.lock();
    static_cast<void>(context->_non_existent());
  };
  EXPECT_EXIT(call(false), testing::ExitedWithCode(0), "");
  EXPECT_DEATH(call(true), "data is held");
}

TEST(OrbDeathTest, a_call_that_is_prepared_while_data_is_held_is_found_also_where_its_object_is_in_this_process) {
  base::Guarded<int, base::Rank::queue> data;
  EXPECT_DEATH(
      {
        const auto lock = data.lock();
        limit_calls(CORBA::Object::_nil(), 1s);
      },
      "data is held");
}
#endif

constexpr const char* name = "my\\.host.host_cxt/sub.cxt/Thing0.rtc";

TEST(Bindings, an_object_is_bound_with_its_contexts_and_leaves_nothing) {
  support::NamingService names;
  auto orb = started();
  CORBA::Object_var object = make_object(*orb);
  {
    Bindings bindings(orb->orb(), {});
    bindings.add_server(names.address());
    bindings.bind(name, object);
    CORBA::Object_var found = look_up(*orb, names, name);
    ASSERT_FALSE(CORBA::is_nil(found));
    EXPECT_TRUE(found->_is_equivalent(object));
    bindings.unbind(name);
    found = look_up(*orb, names, name);
    EXPECT_TRUE(CORBA::is_nil(found));
    bindings.bind(name, object);
    bindings.unbind_all();
  }
  auto root = root_context(orb->orb(), names.address(), 5s);
  CosNaming::BindingList_var list;
  CosNaming::BindingIterator_var more;
  (*root)->list(100, list, more);
  EXPECT_EQ(list->length(), 0u);
}

TEST(Bindings, come_back_after_a_restart_with_or_without_data) {
  support::NamingService names;
  auto orb = started();
  CORBA::Object_var object = make_object(*orb);
  Bindings bindings(orb->orb(), {.interval = 50ms});
  bindings.add_server(names.address());
  bindings.bind(name, object);
  for (const bool forget : {true, false, true}) {
    names.start_again(forget);
    EXPECT_TRUE(appears(*orb, names, name, object)) << forget;
  }
}

TEST(Bindings, wait_for_a_service_that_starts_later) {
  support::NamingService names;
  names.kill();
  auto orb = started();
  CORBA::Object_var object = make_object(*orb);
  Bindings bindings(orb->orb(), {.interval = 50ms});
  bindings.add_server(names.address());
  const auto before = std::chrono::steady_clock::now();
  bindings.bind(name, object);
  EXPECT_LT(std::chrono::steady_clock::now() - before, 10s);
  names.start_again(true);
  EXPECT_TRUE(appears(*orb, names, name, object));
}

TEST(Bindings, a_service_that_hangs_costs_no_more_than_the_time_out) {
  support::NamingService names;
  support::NamingService good;
  names.process().signal(SIGSTOP);
  auto orb = started();
  CORBA::Object_var object = make_object(*orb);
  {
    Bindings bindings(orb->orb(), {.interval = 50ms, .call_timeout = 200ms});
    bindings.add_server(names.address());
    bindings.add_server(good.address());
    bindings.bind(name, object);
    EXPECT_TRUE(appears(*orb, good, name, object));
    names.process().signal(SIGCONT);
    EXPECT_TRUE(appears(*orb, names, name, object));
    names.process().signal(SIGSTOP);
    bindings.unbind_all();
    CORBA::Object_var left = look_up(*orb, good, name);
    EXPECT_TRUE(CORBA::is_nil(left));
  }
  names.process().signal(SIGCONT);
}

TEST(Bindings, dead_entries_are_replaced_and_foreign_ones_are_not_taken_out) {
  support::NamingService names;
  auto orb = started();
  CORBA::Object_var ours = make_object(*orb);
  CORBA::Object_var other = make_object(*orb);
  CORBA::Object_var dead = orb->root_poa()->create_reference("IDL:test/Thing:1.0");
  auto root = root_context(orb->orb(), names.address(), 5s);
  rebind_recursive(root->in(), *parse_name(name), dead);
  Bindings bindings(orb->orb(), {.interval = 20ms});
  bindings.add_server(names.address());
  bindings.bind(name, ours);
  EXPECT_TRUE(appears(*orb, names, name, ours));
  (*root)->rebind(*parse_name(name), other);
  bindings.refresh();
  bindings.unbind(name);
  CORBA::Object_var found = look_up(*orb, names, name);
  ASSERT_FALSE(CORBA::is_nil(found));
  EXPECT_TRUE(found->_is_equivalent(other));
}

TEST(Naming, a_name_of_too_many_components_is_refused) {
  const auto deep = [](int levels) {
    std::string text = "a.k";
    for (int i = 1; i < levels; ++i) text += "/a.k";
    return corba::parse_name(text);
  };
  EXPECT_TRUE(deep(64));
  ASSERT_FALSE(deep(65));
  EXPECT_NE(deep(16'000).error().message.find("has 16000 components, expected at most 64"), std::string::npos)
      << deep(16'000).error().message;
}

TEST(Naming, names_are_found_below_the_root) {
  support::NamingService names;
  auto orb = started();
  CORBA::Object_var object = make_object(*orb);
  auto root = root_context(orb->orb(), names.address(), 5s);
  for (const auto* text : {"a.cxt/b.cxt/X0.rtc", "X0.rtc", "a.cxt/Y0.rtc"}) rebind_recursive(root->in(), *parse_name(text), object);
  const auto found = find_names(root->in(), [](const auto& component) { return std::string_view(component.id) == "X0"; });
  ASSERT_EQ(found.size(), 2u);
}

// Two circles through each of two contexts are 2^20 paths, were they followed.
TEST(Naming, contexts_in_a_circle_are_walked_once) {
  support::NamingService names;
  auto orb = started();
  CORBA::Object_var object = make_object(*orb);
  auto root = root_context(orb->orb(), names.address(), 5s);
  rebind_recursive(root->in(), *parse_name("a.cxt/X0.rtc"), object);
  CORBA::Object_var inner = (*root)->resolve(*parse_name("a.cxt"));
  CosNaming::NamingContext_var a = CosNaming::NamingContext::_narrow(inner);
  for (const auto* text : {"up.cxt", "again.cxt"}) {
    a->bind_context(*parse_name(text), root->in());
    (*root)->bind_context(*parse_name(text), root->in());
  }
  const auto found = find_names(root->in(), [](const auto& component) { return std::string_view(component.id) == "X0"; });
  ASSERT_EQ(found.size(), 1u);
}

}  // namespace
}  // namespace corba
