// The execution contexts of a component: its own, made from properties, and those it takes part in.
#include <coil/stringutil.h>
#include <rtm/ECFactory.h>
#include "component/component_impl.h"
#include "component/local_component.h"

#include <algorithm>

#include "base/text.h"
#include "component/runtime_access.h"
#include "corba/members/remote_participant.h"
#include "corba/orb/orb.h"
#include "corba/orb/principal.h"

namespace RTC {

namespace {

constexpr std::size_t max_own_contexts = 64;  // each may be a thread

struct Wanted {
  std::string type;
  std::string name;
};

// "Type(name), Type2(name2)"; a name may be missing.
std::vector<Wanted> parse_contexts(const std::string& text) {
  std::vector<Wanted> list;
  for (const std::string& part : base::split_list(text)) {
    const auto open = part.find('(');
    const auto close = part.rfind(')');
    if (open == std::string::npos)
      list.push_back({part, ""});
    else if (close != std::string::npos && close > open)
      list.push_back({std::string(base::trim(part.substr(0, open))), std::string(base::trim(part.substr(open + 1, close - open - 1)))});
  }
  return list;
}

// Asks the object itself when its reference does not say; one that does not answer gets the benefit of the doubt.
bool is_context(ExecutionContext_ptr context) {
  if (CORBA::is_nil(context)) return false;
  try {
    const ExecutionContextService_var service = ExecutionContextService::_narrow(context);
    return !CORBA::is_nil(service);
  } catch (const CORBA::Exception&) {
    return true;
  }
}

// Contexts that have a name are one for all components of the process that ask for that type and name.
class NamedContexts {
 public:
  static NamedContexts& instance() {
    static NamedContexts contexts;
    return contexts;
  }
  // Finds or makes; a found one has one more owner.
  template <class Make>
  ExecutionContextBase* get(const std::string& type, const std::string& name, Make make) {
    {
      auto entries = entries_.lock();
      for (Entry& entry : *entries)
        if (entry.type == type && entry.name == name) return ++entry.owners, entry.context;
    }
    ExecutionContextBase* made = make();
    if (made && !name.empty()) entries_.lock()->push_back({type, name, made, 1});
    return made;
  }
  // True when nobody owns it any more.
  bool release(ExecutionContextBase* context) {
    auto entries = entries_.lock();
    const auto it = std::find_if(entries->begin(), entries->end(), [&](const Entry& entry) { return entry.context == context; });
    if (it == entries->end()) return true;
    if (--it->owners > 0) return false;
    entries->erase(it);
    return true;
  }

 private:
  struct Entry {
    std::string type, name;
    ExecutionContextBase* context;
    int owners;
  };
  base::Guarded<std::vector<Entry>, base::Rank::objects> entries_;
};

std::chrono::nanoseconds left_until(std::chrono::steady_clock::time_point deadline) {
  return std::max<std::chrono::nanoseconds>(deadline - std::chrono::steady_clock::now(), std::chrono::nanoseconds(0));
}

// Contexts whose owners are gone, but not the callback that one of their threads is in.
base::Guarded<std::vector<ExecutionContextBase*>, base::Rank::objects>& left_contexts() {
  static base::Guarded<std::vector<ExecutionContextBase*>, base::Rank::objects> contexts;
  return contexts;
}

// What the context asks of others on the way (detach_context) is its own affair; these calls end in time.
void leaveRemoteContext(ExecutionContext_ptr reference, RTObject_ptr self, const LastCalls& calls) {
  const ExecutionContext_var context = corba::copy_as<ExecutionContext>(reference, calls.timeout());
  const LifeCycleState state = context->get_component_state(self);
  corba::set_call_timeout(context, calls.timeout());
  switch (state) {
    case ACTIVE_STATE:
      context->deactivate_component(self);
      break;
    case ERROR_STATE:
      context->reset_component(self);
      break;
    default:
      break;
  }
  corba::set_call_timeout(context, calls.timeout());
  context->remove_component(self);
}

bool is_same(ExecutionContext_ptr a, ExecutionContext_ptr b) { return !CORBA::is_nil(a) && !CORBA::is_nil(b) && a->_is_equivalent(b); }

}  // namespace

// exec_cxt.*, then exec_cxt.periodic.*, ec.<type>.* and ec.<name>.*; the last word counts.
coil::Properties RTObject_impl::contextOptions(const std::string& type, const std::string& name) const {
  const auto turn = impl_->properties_turn.take();
  coil::Properties options;
  options["sync_transition"] = "YES";
  options["transition_timeout"] = "0.5";
  if (const coil::Properties* all = m_properties.findNode("exec_cxt"))
    for (const std::string& key : all->propertyNames())
      if (!key.starts_with("periodic.")) options[key] = all->getProperty(key);
  options["type"] = type;
  options["rate"] = "1000";
  options["name"] = name;
  for (const std::string& path : {std::string("exec_cxt.periodic"), "ec." + type, "ec." + name}) {
    const coil::Properties* node = path == "ec." ? nullptr : m_properties.findNode(path);
    if (!node) continue;
    for (const std::string& key : node->propertyNames())
      if (key != "type" && key != "name") options[key] = node->getProperty(key);
  }
  return options;
}

ReturnCode_t RTObject_impl::createContexts() {
  registerBuiltinExecutionContexts(m_pManager);
  if (const std::string text = property("exec_cxt.callback_timeout"); !text.empty()) {
    const auto number = base::parse_number(text);
    if (number && *number >= 0 && *number < 1e6)
      impl_->shared.lock()->callback_timeout = std::chrono::nanoseconds(static_cast<std::int64_t>(*number * 1e9));
    else
      RTC_WARN(("exec_cxt.callback_timeout must be a number of seconds, got %s", base::in_quotes(text).c_str()));
  }
  const std::string list = property("execution_contexts");
  std::vector<Wanted> wanted;
  if (list.empty())
    wanted.push_back({property("exec_cxt.periodic.type", "PeriodicExecutionContext"), ""});
  else if (!base::equal_ignoring_case(base::trim(list), "none"))
    wanted = parse_contexts(list);
  if (wanted.size() > max_own_contexts) {
    RTC_ERROR(("execution_contexts names %zu contexts, expected at most %zu", wanted.size(), max_own_contexts));
    return RTC_ERROR;
  }
  for (const Wanted& one : wanted) {
    coil::Properties options = contextOptions(one.type, one.name);
    ExecutionContextBase* context = NamedContexts::instance().get(one.type, one.name, [&]() -> ExecutionContextBase* {
      ExecutionContextBase* made = ExecutionContextFactory::instance().createObject(one.type);
      if (made) made->init(options);
      return made;
    });
    if (!context) {
      RTC_ERROR(("no execution context of type %s; a module that has it is loaded by manager.modules.preload",
                 base::in_quotes(one.type).c_str()));
      return RTC_ERROR;
    }
    impl_->shared.lock()->contexts.push_back(context);
    if (const ReturnCode_t code = context->bindComponent(this); code != RTC_OK) {
      RTC_ERROR(("execution context of type %s does not take the component", base::in_quotes(one.type).c_str()));
      return code;
    }
  }
  return RTC_OK;
}

std::chrono::nanoseconds RTObject_impl::callbackTimeout() const { return impl_->shared.lock()->callback_timeout; }

// The contexts of this process in which the component is or may be.
std::vector<std::shared_ptr<ExecutionContextBase>> RTObject_impl::localContexts() const {
  std::vector<std::shared_ptr<ExecutionContextBase>> contexts;
  std::vector<ExecutionContext_var> references;
  {
    auto data = impl_->shared.lock();
    references = data->own;
    references.insert(references.end(), data->foreign.begin(), data->foreign.end());
  }
  for (const ExecutionContext_var& reference : references)
    if (auto context = findLocalContext(reference)) contexts.push_back(std::move(context));
  return contexts;
}

void RTObject_impl::askToRest() {
  const RTObject_var self = getObjRef();
  for (const auto& context : localContexts()) RuntimeAccess::ask_to_rest(*context, self);
}

void RTObject_impl::comeToRest(std::chrono::steady_clock::time_point deadline) {
  const RTObject_var self = getObjRef();
  for (const auto& context : localContexts()) RuntimeAccess::calm(*context, self, deadline);
  waitForCallbacks(deadline);
}

void RTObject_impl::leaveContexts(std::chrono::steady_clock::time_point deadline) {
  askToRest();
  comeToRest(deadline);
  const RTObject_var self = getObjRef();
  const std::vector<ExecutionContext_var> foreign = impl_->shared.lock()->foreign;
  const LastCalls calls(deadline);
  for (const ExecutionContext_var& reference : foreign) {
    if (CORBA::is_nil(reference)) continue;
    if (const auto context = findLocalContext(reference)) {
      RuntimeAccess::remove(*context, self, deadline);
      continue;
    }
    if (calls.are_over()) continue;
    try {
      leaveRemoteContext(reference, self, calls);
    } catch (const CORBA::Exception& exception) {
      RTC_DEBUG(("a context of another process does not answer: %s", corba::to_text(exception).c_str()));
    }
  }
}

// Own contexts end with their last owner. May be called again.
void RTObject_impl::finalizeContexts() { finalizeContexts(std::chrono::steady_clock::now() + callbackTimeout()); }

void RTObject_impl::finalizeContexts(std::chrono::steady_clock::time_point deadline) {
  std::vector<ExecutionContextBase*> contexts;
  contexts.swap(impl_->shared.lock()->contexts);
  // A thread cannot be taken out of a callback that does not return, so what it works on must stay; but nobody calls it any more.
  const bool is_held = isHeldByCallback();
  for (ExecutionContextBase* context : contexts) {
    const bool is_last = NamedContexts::instance().release(context);
    if (is_held || !is_last) RuntimeAccess::unbind(*context, this, is_held ? std::chrono::nanoseconds(0) : left_until(deadline));
    if (!is_last) continue;
    const bool has_failed = RuntimeAccess::stop_by(*context, deadline) == RTC_ERROR;
    const bool is_quiet = !has_failed && RuntimeAccess::wait_for_quiet(*context, left_until(deadline));
    RuntimeAccess::unbind(*context, this, std::chrono::nanoseconds(0));
    RuntimeAccess::dismiss_members(*context);
    if (is_quiet)
      destroyExecutionContext(context);
    else
      left_contexts().lock()->push_back(context);
  }
  {
    auto data = impl_->shared.lock();
    data->own.clear();
    data->foreign.clear();
    data->elsewhere.clear();
  }
  chooseClock();
}

// The clock of the first own context; of the latest one that the component takes part in, if there is one.
void RTObject_impl::chooseClock() {
  ExecutionContext_var chosen;
  {
    auto data = impl_->shared.lock();
    if (!data->own.empty()) chosen = data->own.front();
    for (const ExecutionContext_var& context : data->foreign)
      if (!CORBA::is_nil(context)) chosen = context;
  }
  const auto context = CORBA::is_nil(chosen) ? nullptr : findLocalContext(chosen);
  impl_->clock->follow(context ? RuntimeAccess::shared_clock(*context) : nullptr);
}

bool RTObject_impl::destroyLeftContexts() {
  if (isInsideCallback()) return false;  // perhaps on the thread of one of them
  std::vector<ExecutionContextBase*> contexts;
  contexts.swap(*left_contexts().lock());
  std::erase_if(contexts, [](ExecutionContextBase* context) {
    if (!RuntimeAccess::wait_for_quiet(*context, std::chrono::nanoseconds(0))) return false;
    context->stop();
    destroyExecutionContext(context);
    return true;
  });
  auto all = left_contexts().lock();
  all->insert(all->end(), contexts.begin(), contexts.end());
  return all->empty();
}

CORBA::Boolean RTObject_impl::is_alive(ExecutionContext_ptr exec_context) { return get_context_handle(exec_context) >= 0; }

ExecutionContext_ptr RTObject_impl::get_context(ExecutionContextHandle_t exec_handle) { return getExecutionContext(exec_handle); }

ExecutionContext_ptr RTObject_impl::getExecutionContext(RTC::UniqueId ec_id) {
  auto data = impl_->shared.lock();
  const bool is_foreign = ec_id >= foreign_offset;
  const auto& list = is_foreign ? data->foreign : data->own;
  const auto index = static_cast<std::size_t>(is_foreign ? ec_id - foreign_offset : ec_id);
  if (ec_id < 0 || index >= list.size()) return ExecutionContext::_nil();
  return ExecutionContext::_duplicate(list[index]);
}

ExecutionContextList* RTObject_impl::get_owned_contexts() {
  ExecutionContextList_var list = new ExecutionContextList();
  auto data = impl_->shared.lock();
  for (const ExecutionContext_var& context : data->own) {
    const CORBA::ULong n = list->length();
    list->length(n + 1);
    list[n] = ExecutionContext::_duplicate(context);
  }
  return list._retn();
}

ExecutionContextList* RTObject_impl::get_participating_contexts() {
  ExecutionContextList_var list = new ExecutionContextList();
  auto data = impl_->shared.lock();
  for (const ExecutionContext_var& context : data->foreign) {
    if (CORBA::is_nil(context)) continue;
    const CORBA::ULong n = list->length();
    list->length(n + 1);
    list[n] = ExecutionContext::_duplicate(context);
  }
  return list._retn();
}

ExecutionContextHandle_t RTObject_impl::get_context_handle(ExecutionContext_ptr cxt) {
  auto data = impl_->shared.lock();
  for (std::size_t i = 0; i < data->own.size(); ++i)
    if (is_same(data->own[i], cxt)) return static_cast<ExecutionContextHandle_t>(i);
  for (std::size_t i = 0; i < data->foreign.size(); ++i)
    if (is_same(data->foreign[i], cxt)) return static_cast<ExecutionContextHandle_t>(i) + foreign_offset;
  return -1;
}

UniqueId RTObject_impl::bindContext(ExecutionContext_ptr exec_context) {
  if (CORBA::is_nil(exec_context)) return -1;
  UniqueId id = 0;
  {
    auto data = impl_->shared.lock();
    id = static_cast<UniqueId>(data->own.size());
    if (id >= foreign_offset) return -1;
    data->own.push_back(ExecutionContext::_duplicate(exec_context));
  }
  chooseClock();
  m_actionListeners.ecaction_[EC_ATTACHED].notify(id);
  return id;
}

ExecutionContextHandle_t RTObject_impl::attach_context(ExecutionContext_ptr exec_context) {
  if (OutsideCall::is_mine(*this) && !mayBeChangedByCaller("attach_context")) return -1;
  if (!is_context(exec_context) || !corba::may_keep(exec_context)) return -1;
  // The same one again keeps its handle; it is told like the first time, because the context has just added the component.
  ExecutionContextHandle_t id = get_context_handle(exec_context);
  if (id < foreign_offset) {
    const bool is_elsewhere = findLocalContext(exec_context) == nullptr;
    auto data = impl_->shared.lock();
    auto& list = data->foreign;
    auto free = std::find_if(list.begin(), list.end(), [](const ExecutionContext_var& context) { return CORBA::is_nil(context); });
    const bool is_full = free == list.end() && list.size() >= max_memberships;
    if (free == list.end() && !is_full) free = list.insert(list.end(), ExecutionContext_var());
    if (!is_full) {
      *free = ExecutionContext::_duplicate(exec_context);
      id = static_cast<ExecutionContextHandle_t>(free - list.begin()) + foreign_offset;
      if (is_elsewhere) data->elsewhere[id] = false;
    } else {
      id = -1;
    }
  }
  if (id < 0) {
    rt::log_rejection(
        rtclog, Logger::RTL_ERROR,
        "a further execution context is rejected: the component participates in " + std::to_string(max_memberships) + ", the maximum");
    return -1;
  }
  chooseClock();
  m_actionListeners.ecaction_[EC_ATTACHED].notify(id);
  return id;
}

ReturnCode_t RTObject_impl::detach_context(ExecutionContextHandle_t exec_handle) {
  if (OutsideCall::is_mine(*this) && !mayBeChangedByCaller("detach_context")) return RTC_ERROR;
  {
    auto data = impl_->shared.lock();
    if (exec_handle < foreign_offset) return BAD_PARAMETER;
    const auto index = static_cast<std::size_t>(exec_handle - foreign_offset);
    if (index >= data->foreign.size() || CORBA::is_nil(data->foreign[index])) return BAD_PARAMETER;
    data->foreign[index] = ExecutionContext::_nil();
    data->elsewhere.erase(exec_handle);
  }
  chooseClock();
  m_actionListeners.ecaction_[EC_DETACHED].notify(exec_handle);
  return RTC_OK;
}

double RTObject_impl::getExecutionRate(RTC::UniqueId ec_id) {
  ExecutionContext_var context = getExecutionContext(ec_id);
  try {
    return CORBA::is_nil(context) ? 0.0 : context->get_rate();
  } catch (const CORBA::Exception& exception) {
    RTC_ERROR(("execution context %d does not answer: %s", static_cast<int>(ec_id), corba::to_text(exception).c_str()));
    return 0.0;
  }
}

namespace {

template <class Call>
ReturnCode_t ask_context(ExecutionContext_ptr context, Call call) {
  if (CORBA::is_nil(context)) return BAD_PARAMETER;
  try {
    return call();
  } catch (const CORBA::Exception&) {
    return RTC_ERROR;
  }
}

}  // namespace

ReturnCode_t RTObject_impl::setExecutionRate(RTC::UniqueId ec_id, double rate) {
  ExecutionContext_var context = getExecutionContext(ec_id);
  return ask_context(context, [&] { return context->set_rate(rate); });
}

bool RTObject_impl::isOwnExecutionContext(RTC::UniqueId ec_id) { return ec_id >= 0 && ec_id < foreign_offset; }

ReturnCode_t RTObject_impl::activate(RTC::UniqueId ec_id) {
  ExecutionContext_var context = getExecutionContext(ec_id);
  RTObject_var self = getObjRef();
  return ask_context(context, [&] { return context->activate_component(self); });
}

ReturnCode_t RTObject_impl::deactivate(RTC::UniqueId ec_id) {
  ExecutionContext_var context = getExecutionContext(ec_id);
  RTObject_var self = getObjRef();
  return ask_context(context, [&] { return context->deactivate_component(self); });
}

ReturnCode_t RTObject_impl::reset(RTC::UniqueId ec_id) {
  ExecutionContext_var context = getExecutionContext(ec_id);
  RTObject_var self = getObjRef();
  return ask_context(context, [&] { return context->reset_component(self); });
}

std::vector<ExecutionContextBase*> RTObject_impl::getOwnContexts() const { return impl_->shared.lock()->contexts; }

}  // namespace RTC
