#include <algorithm>
#include <condition_variable>
#include <map>
#include <thread>

#include "base/guarded.h"
#include "base/log.h"
#include "base/text.h"
#include "corba/orb/naming.h"
#include "corba/orb/orb.h"

namespace corba {
namespace {

using std::chrono::steady_clock;
constexpr base::Rank rank = base::Rank::peers;
constexpr const char* log_name = "naming";

struct Entry {
  CosNaming::Name name;
  CORBA::Object_var object;
  bool wanted = true;    // false: to be taken out
  bool settled = false;  // nothing to do until the next look
  bool bound = false;    // it has been ours before
  bool warned = false;   // somebody else has the name, and that has been said
  bool yields = false;   // that is theirs, and nothing to be said
};

bool is_alive(CORBA::Object_ptr object, std::chrono::milliseconds timeout) {
  try {
    set_call_timeout(object, timeout);
    return !CORBA::is_nil(object) && !object->_non_existent();
  } catch (const CORBA::TIMEOUT&) {
    return true;  // hung, but there
  } catch (const CORBA::TRANSIENT& e) {
    return e.minor() == omni::TRANSIENT_CallTimedout;
  } catch (const CORBA::Exception&) {
    return false;
  }
}

}  // namespace

// One naming service and the thread that talks to it.
class Bindings::Server {
 public:
  Server(CORBA::ORB_ptr orb, std::string address, const BindingsSettings& settings)
      : orb_(CORBA::ORB::_duplicate(orb)), address_(std::move(address)), settings_(settings) {
    state_.lock()->reachable = true;  // until the contrary is known
    thread_ = std::thread([this] { run(); });
  }

  ~Server() {
    state_.lock()->stopping = true;
    changed_.notify_all();
    thread_.join();
  }

  const std::string& address() const { return address_; }

  void bind(const std::string& key, const CosNaming::Name& name, CORBA::Object_ptr object, bool yields) {
    auto state = state_.lock();
    Entry& entry = state->entries[key] = Entry{name, CORBA::Object::_duplicate(object)};
    entry.yields = yields;
    changed_.notify_all();
  }

  void unbind(const std::string& key) {
    auto state = state_.lock();
    const auto at = state->entries.find(key);
    if (at == state->entries.end()) return;
    at->second.wanted = false;
    at->second.settled = false;
    changed_.notify_all();
  }

  void unbind_all() {
    auto state = state_.lock();
    for (auto& [key, entry] : state->entries) {
      entry.wanted = false;
      entry.settled = false;
    }
    state->remove_contexts = true;
    state->look_now = true;  // a service that did not answer at the last look is tried once more
    changed_.notify_all();
  }

  void refresh() {
    state_.lock()->look_now = true;
    changed_.notify_all();
  }

  // Until there is nothing to do, the service turns out not to answer, or the time is over. The end waits for its last try, too.
  void wait_until_settled(steady_clock::time_point deadline, bool is_end) {
    auto state = state_.lock();
    state.wait_until(changed_, deadline, [&] {
      const bool tries = state->look_now || state->working;
      return (!state->reachable && !(is_end && tries)) || (!has_work(*state) && !state->working);
    });
  }

 private:
  struct State {
    std::map<std::string, Entry> entries;
    bool reachable = false;
    bool working = false;
    bool look_now = false;
    bool remove_contexts = false;
    bool stopping = false;
  };

  static bool has_work(const State& state) {
    return state.remove_contexts ||
           std::any_of(state.entries.begin(), state.entries.end(), [](const auto& e) { return !e.second.settled; });
  }

  void run() {
    pthread_setname_np(pthread_self(), "rtm-naming");
    const bool looks = settings_.interval.count() > 0;
    auto next_look = steady_clock::now() + settings_.interval;
    for (;;) {
      std::map<std::string, Entry> work;
      bool remove_contexts = false;
      {
        auto state = state_.lock();
        const auto wakes = [&] { return state->stopping || state->look_now || (has_work(*state) && state->reachable); };
        if (looks) {
          state.wait_until(changed_, next_look, wakes);
        } else {
          state.wait_until(changed_, steady_clock::now() + std::chrono::hours(24), wakes);
        }
        if (state->stopping) return;
        const auto now = steady_clock::now();
        const bool look = state->look_now || (looks && now >= next_look);
        if (looks && now >= next_look) next_look = now + settings_.interval;
        state->look_now = false;
        for (const auto& [key, entry] : state->entries) {
          if (look || !entry.settled) work.emplace(key, entry);
        }
        remove_contexts = std::exchange(state->remove_contexts, false);
        state->working = true;
      }
      // The first call after a restart of the service fails because it goes into the old connection: that alone says nothing.
      bool reachable = false;
      for (int attempt = 0; attempt < 2 && !reachable; ++attempt) {
        const bool is_last = attempt == 1;
        reachable = connect(is_last) && do_work(work, remove_contexts, is_last);
      }
      finish(work, reachable);
    }
  }

  bool connect(bool is_last) {
    if (!CORBA::is_nil(root_)) return true;
    auto found = root_context(orb_, address_, settings_.call_timeout);
    if (found) {
      root_ = *found;
      state_.lock()->reachable = true;  // from here on names are bound: who takes them back waits for that
      if (complained_) base::log(base::Level::info, log_name, "name server {} responds again", address_);
      complained_ = false;
      return true;
    }
    if (is_last) complain(found.error().message);
    return false;
  }

  void complain(const std::string& what) {
    if (!complained_) base::log_text(base::Level::warn, log_name, what + (settings_.interval.count() > 0 ? "; will try again" : ""));
    complained_ = true;
  }

  // False when the service has stopped answering.
  bool do_work(std::map<std::string, Entry>& work, bool remove_contexts, bool is_last) {
    try {
      for (auto& [key, entry] : work) {
        if (state_.lock()->stopping) return true;
        try {
          entry.wanted ? bind_entry(key, entry) : unbind_entry(entry);
        } catch (const CORBA::UserException& e) {
          base::log(base::Level::warn, log_name, "{}: {} {} failed: {}", address_, entry.wanted ? "binding" : "unbinding",
                    base::in_quotes(key), e._name());
        }
        entry.settled = true;
      }
      if (remove_contexts) remove_empty_contexts();
      return true;
    } catch (const CORBA::Exception& e) {
      if (is_last) complain("name server " + address_ + ": stopped answering: " + to_text(e));
      root_ = CosNaming::NamingContext::_nil();
      return false;
    }
  }

  void finish(const std::map<std::string, Entry>& work, bool reachable) {
    auto state = state_.lock();
    for (const auto& [key, done] : work) {
      const auto at = state->entries.find(key);
      // Changed meanwhile: it is still to be done.
      if (at == state->entries.end() || at->second.wanted != done.wanted || at->second.object.in() != done.object.in()) continue;
      if (!done.wanted && done.settled) {
        state->entries.erase(at);
      } else {
        at->second.settled = done.settled && reachable;
        at->second.warned = done.warned;
        at->second.bound = done.bound;
      }
    }
    if (!reachable) {
      for (auto& [key, entry] : state->entries) entry.settled = false;  // it may come back without its data
    }
    state->reachable = reachable;
    state->working = false;
    changed_.notify_all();
  }

  CORBA::Object_ptr current(const CosNaming::Name& name) {
    try {
      return root_->resolve(name);
    } catch (const CosNaming::NamingContext::NotFound&) {
      return CORBA::Object::_nil();
    } catch (const CosNaming::NamingContext::CannotProceed&) {
      return CORBA::Object::_nil();
    } catch (const CORBA::OBJECT_NOT_EXIST&) {  // a context in the way is dead
      return CORBA::Object::_nil();
    }
  }

  CORBA::Object_ptr presented(const Entry& entry) const {
    return settings_.present ? settings_.present(entry.object, address_) : CORBA::Object::_duplicate(entry.object);
  }

  void bind_entry(const std::string& key, Entry& entry) {
    const bool is_first = !entry.bound;
    CORBA::Object_var ours = presented(entry);
    CORBA::Object_var there = current(entry.name);
    if (!CORBA::is_nil(there) && there->_is_equivalent(ours) && !settings_.always_rebind) {
      entry.bound = true;
      return;
    }
    if (!CORBA::is_nil(there) && !there->_is_equivalent(ours) && is_alive(there, settings_.call_timeout)) {
      if (entry.yields) return;
      if (!entry.warned) {
        base::log(base::Level::warn, log_name, "{}: {} belongs to another living object; {}", address_, base::in_quotes(key),
                  is_first ? "it is ours now" : "it is left alone");
      }
      entry.warned = true;
      if (!is_first) return;
    }
    rebind_recursive(root_, entry.name, ours, &contexts_);
    entry.bound = true;
  }

  void unbind_entry(const Entry& entry) {
    CORBA::Object_var ours = presented(entry);
    CORBA::Object_var there = current(entry.name);
    if (CORBA::is_nil(there) || !there->_is_equivalent(ours)) return;
    root_->unbind(entry.name);
  }

  // Of those we have made; the deepest first.
  void remove_empty_contexts() {
    for (auto at = contexts_.rbegin(); at != contexts_.rend(); ++at) {
      try {
        CORBA::Object_var object = root_->resolve(*at);
        CosNaming::NamingContext_var context = CosNaming::NamingContext::_narrow(object);
        if (CORBA::is_nil(context)) continue;
        context->destroy();
        root_->unbind(*at);
      } catch (const CORBA::UserException&) {  // not empty, or gone already
      }
    }
    contexts_.clear();
  }

  CORBA::ORB_var orb_;
  const std::string address_;
  const BindingsSettings settings_;
  base::Guarded<State, rank> state_;
  std::condition_variable changed_;
  // The thread's own:
  CosNaming::NamingContext_var root_;
  std::vector<CosNaming::Name> contexts_;
  bool complained_ = false;
  std::thread thread_;
};

struct Bindings::Impl {
  CORBA::ORB_var orb;
  BindingsSettings settings;
  base::Guarded<std::vector<std::shared_ptr<Server>>, base::Rank::manager> servers;
  struct Bound {
    CosNaming::Name name;
    CORBA::Object_var object;
    bool yields = false;
  };
  base::Guarded<std::map<std::string, Bound>, base::Rank::component> entries;

  void wait_until_settled(bool is_end = false) const {
    const auto deadline = steady_clock::now() + 2 * settings.call_timeout;
    for (const auto& server : servers.snapshot()) server->wait_until_settled(deadline, is_end);
  }
};

Bindings::Bindings(CORBA::ORB_ptr orb, const BindingsSettings& settings) : impl_(std::make_unique<Impl>()) {
  impl_->orb = CORBA::ORB::_duplicate(orb);
  impl_->settings = settings;
}

Bindings::~Bindings() = default;

void Bindings::add_server(const std::string& address) {
  auto server = std::make_shared<Server>(impl_->orb, address, impl_->settings);
  for (const auto& [key, entry] : impl_->entries.snapshot()) server->bind(key, entry.name, entry.object, entry.yields);
  impl_->servers.lock()->push_back(std::move(server));
}

std::vector<std::string> Bindings::servers() const {
  std::vector<std::string> result;
  for (const auto& server : impl_->servers.snapshot()) result.push_back(server->address());
  return result;
}

void Bindings::bind(const std::string& name, CORBA::Object_ptr object, bool yields) {
  const auto parsed = parse_name(name);
  if (!parsed) {
    base::log_text(base::Level::error, log_name, parsed.error().message);
    return;
  }
  (*impl_->entries.lock())[name] = {*parsed, CORBA::Object::_duplicate(object), yields};
  for (const auto& server : impl_->servers.snapshot()) server->bind(name, *parsed, object, yields);
  impl_->wait_until_settled();
}

void Bindings::unbind(const std::string& name) {
  if (impl_->entries.lock()->erase(name) == 0) return;
  for (const auto& server : impl_->servers.snapshot()) server->unbind(name);
  impl_->wait_until_settled();
}

void Bindings::unbind_all() {
  impl_->entries.lock()->clear();
  for (const auto& server : impl_->servers.snapshot()) server->unbind_all();
  impl_->wait_until_settled(true);
}

void Bindings::refresh() {
  for (const auto& server : impl_->servers.snapshot()) server->refresh();
}

}  // namespace corba
