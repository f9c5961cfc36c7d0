#include "clock_generator.h"

#include <base/text.h>
#include <rtm/Callers.h>
#include <rtm/CorbaNaming.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "specification.h"

// clang-format off
static const char* const clockgenerator_spec[] = {
    "implementation_id", "ClockGenerator",
    "type_name", "ClockGenerator",
    "description", "The clock of OpenHRP for execution contexts that are ticked from outside",
    "version", "1.0.0",
    "vendor", "rtm-sim",
    "category", "simulation",
    "activity_type", "EVENTDRIVEN",
    "kind", "DataFlowComponent",
    "max_instance", "1",
    "language", "C++",
    "lang_type", "compile",
    "execution_contexts", "none",
    "conf.default.server_id", "0",
    "conf.__constraints__.server_id", "0<=x<=9999",
    "conf.default.phase", "1",
    "conf.__constraints__.phase", "0<=x<=15",
    ""};
// clang-format on

namespace {

constexpr const char* usual_name = "ClockGenerator";
constexpr unsigned long asking_limit = 1000;      // [ms]
constexpr double shortest = 1e-6, longest = 1e6;  // period [s]
constexpr std::size_t max_jobs = 1000, max_subscriptions = 1000;

// A name becomes part of the argument that a component is made by.
bool is_plain(std::string_view name) {
  return !name.empty() && name.size() <= 200 && std::ranges::all_of(name, [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' || c == '.';
  });
}

std::string owner_of(OpenRTM::ExtTrigExecutionContextService_ptr context) {
  try {
    RTC::ExecutionContextProfile_var profile = context->get_profile();
    if (CORBA::is_nil(profile->owner)) return "";
    omniORB::setClientCallTimeout(profile->owner, asking_limit);
    RTC::ComponentProfile_var owner = profile->owner->get_component_profile();
    return is_plain(owner->instance_name.in()) ? owner->instance_name.in() : "";
  } catch (const CORBA::Exception&) {
    return "";  // a name of ours does as well
  }
}

}  // namespace

class ClockGenerator::Service : public POA_OpenHRP::ClockGenerator {
 public:
  explicit Service(::ClockGenerator& component) : component_(component) {}
  void subscribe(Context context, CORBA::Double period) override {
    if (CORBA::is_nil(context) || !(period >= shortest && period <= longest)) throw CORBA::BAD_PARAM();
    if (!RTC::mayKeep(context)) throw CORBA::NO_PERMISSION();
    post(context, [period](::ClockGenerator& component, Context one) { component.subscribe(one, period); });
  }
  void unsubscribe(Context context) override {
    if (CORBA::is_nil(context)) throw CORBA::BAD_PARAM();
    post(context, [](::ClockGenerator& component, Context one) { component.unsubscribe(one); });
  }

 private:
  template <class Job>
  void post(Context context, Job job) {
    const OpenRTM::ExtTrigExecutionContextService_var kept = OpenRTM::ExtTrigExecutionContextService::_duplicate(context);
    if (!component_.post([this, kept, job] { job(component_, kept.in()); })) throw CORBA::NO_RESOURCES();
  }
  ::ClockGenerator& component_;
};

ClockGenerator::ClockGenerator(RTC::Manager* manager) : RTC::DataFlowComponentBase(manager) {}

RTC::ReturnCode_t ClockGenerator::onInitialize() {
  bindParameter("server_id", server_id_, std::to_string(iface::default_server()).c_str());
  bindParameter("phase", phase_, "1");
  m_configsets.update("default");
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  auto* service = new Service(*this);
  servant_ = service;
  reference_ = service->_this();
  bind();
  return RTC::RTC_OK;
}

RTC::ReturnCode_t ClockGenerator::onFinalize() {
  unbind();
  if (servant_.in() != nullptr) {
    PortableServer::POA_var poa = servant_->_default_POA();
    PortableServer::ObjectId_var id = poa->reference_to_id(reference_);
    poa->deactivate_object(id);
  }
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
  return RTC::RTC_OK;
}

void ClockGenerator::bind() {
  for (const auto& server : base::split_list(RTC::Manager::instance().configValue("corba.nameservers"))) {
    try {
      RTC::CorbaNaming naming(RTC::Manager::instance().getORB(), server.c_str());
      naming.rebindByString(usual_name, reference_);
    } catch (const CORBA::Exception& exception) {
      RTC_WARN(("name server %s: cannot bind %s: %s", base::in_quotes(server).c_str(), usual_name, exception._name()));
    }
  }
}

void ClockGenerator::unbind() {
  for (const auto& server : base::split_list(RTC::Manager::instance().configValue("corba.nameservers"))) {
    try {
      RTC::CorbaNaming naming(RTC::Manager::instance().getORB(), server.c_str());
      CORBA::Object_var bound = naming.resolve(usual_name);
      if (bound->_is_equivalent(reference_)) naming.unbind(usual_name);
    } catch (const CORBA::Exception& exception) {
      RTC_DEBUG(("name server %s: cannot unbind %s: %s", base::in_quotes(server).c_str(), usual_name, exception._name()));
    }
  }
}

bool ClockGenerator::post(std::function<void()> job) {
  {
    auto jobs = jobs_.lock();
    if (jobs->size() >= max_jobs) return false;
    jobs->push_back(std::move(job));
  }
  posted_.notify_one();
  return true;
}

void ClockGenerator::run(const std::stop_token& stop) {
  while (true) {
    std::function<void()> job;
    {
      auto jobs = jobs_.lock();
      if (!jobs.wait(posted_, stop, [&] { return !jobs->empty(); })) return;
      job = std::move(jobs->front());
      jobs->pop_front();
    }
    try {
      job();
    } catch (const CORBA::Exception& exception) {
      RTC_WARN(("a context that subscribes or unsubscribes: %s", exception._name()));
    } catch (const std::exception& exception) {
      RTC_WARN(("a context that subscribes or unsubscribes: %s", exception.what()));
    } catch (...) {
      RTC_WARN(("a context that subscribes or unsubscribes: an unknown exception"));
    }
  }
}

void ClockGenerator::subscribe(Context context, double period) {
  unsubscribe(context);
  if (subscriptions_.size() >= max_subscriptions) {
    RTC_ERROR(("a context that subscribes: there are %s subscriptions already", std::to_string(max_subscriptions).c_str()));
    return;
  }
  auto& manager = RTC::Manager::instance();
  const CORBA::String_var reference = manager.getORB()->object_to_string(context);
  omniORB::setClientCallTimeout(context, asking_limit);
  const std::string number = std::to_string(++made_);
  auto name = owner_of(context);
  if (name.empty()) name = std::string("context") + number;
  RTC::RTObject_impl* made =
      manager.createComponent("SimTimeProxy?instance_name=" + name + "_clock" + number +
                              "&exec_cxt.periodic.type=SimTimeContext&exec_cxt.periodic.rate=" + base::format_number(1 / period) +
                              "&exec_cxt.sync_transition=NO&exec_cxt.sim_time.phase=" + std::to_string(phase_) +
                              "&exec_cxt.sim_time.server_id=" + std::to_string(server_id_) + "&exec_cxt.sim_time.participant=" + name +
                              "&conf.default.ticks=" + reference.in());
  if (made == nullptr) {
    RTC_ERROR(("context of %s: cannot be ticked, no SimTimeProxy could be made", name.c_str()));
    return;
  }
  RTC_INFO(("context of %s: ticked every %s s of simulated time", name.c_str(), base::format_number(period).c_str()));
  made->activate(0);
  subscriptions_.push_back({OpenRTM::ExtTrigExecutionContextService::_duplicate(context), made->getObjRef()});
}

void ClockGenerator::unsubscribe(Context context) {
  for (auto it = subscriptions_.begin(); it != subscriptions_.end(); ++it) {
    if (!it->context->_is_equivalent(context)) continue;
    const RTC::RTObject_var proxy = it->proxy;
    subscriptions_.erase(it);
    proxy->exit();
    return;
  }
}

extern "C" {
void ClockGeneratorInit(RTC::Manager* manager) {
  coil::Properties profile = iface::specification(clockgenerator_spec);
  manager->registerFactory(profile, RTC::Create<ClockGenerator>, RTC::Delete<ClockGenerator>);
}
}
