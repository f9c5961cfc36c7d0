// A component that works the service port of RTCSimulation when it is activated, with everything that the service can do; it goes to the
// error state at the first answer that is not as expected, which its log names. The world holds a model "robot".
#include <rtm/CorbaConsumer.h>
#include <rtm/CorbaPort.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/Manager.h>
#include <rtm/idl/SimulationServiceSkel.h>

#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

class SimulationProbe : public RTC::DataFlowComponentBase {
 public:
  explicit SimulationProbe(RTC::Manager* manager) : RTC::DataFlowComponentBase(manager), port_("simulation") {}

  RTC::ReturnCode_t onInitialize() override {
    port_.registerConsumer("simulation", "rtmsim::SimulationService", simulation_);
    addPort(port_);
    return RTC::RTC_OK;
  }

  RTC::ReturnCode_t onActivated(RTC::UniqueId) override {
    try {
      const bool fine = time() && poses() && models() && refusals();
      return fine ? RTC::RTC_OK : RTC::RTC_ERROR;
    } catch (const rtmsim::Failed& e) {
      RTC_ERROR(("refused: %s", e.reason.in()));
    } catch (const CORBA::Exception& e) {
      RTC_ERROR(("no answer: %s", e._name()));
    }
    return RTC::RTC_ERROR;
  }

 private:
  bool expect(const char* what, double got, double wanted) {
    if (std::abs(got - wanted) < 1e-6) return true;
    RTC_ERROR(("%s: got %g, expected %g", what, got, wanted));
    return false;
  }

  bool time() {
    simulation_->pause();
    const auto before = simulation_->now();
    simulation_->step(10);
    const auto step = (simulation_->now() - before) / 10;
    if (!(step > 0)) return expect("time of ten steps", step, 0.001);
    simulation_->step(5);
    if (!expect("time after five more", simulation_->now(), before + 15 * step)) return false;
    simulation_->reset();
    return expect("time after a reset", simulation_->now(), 0);
  }

  bool poses() {
    simulation_->set_pose("robot", {1, -2, 0.5, 0.1, -0.2, 1.5});
    const auto pose = simulation_->get_pose("robot");
    return expect("x", pose.x, 1) && expect("y", pose.y, -2) && expect("z", pose.z, 0.5) && expect("roll", pose.roll, 0.1) &&
           expect("pitch", pose.pitch, -0.2) && expect("yaw", pose.yaw, 1.5);
  }

  bool models() {
    const CORBA::String_var name = simulation_->spawn(
        "<sdf version='1.9'><model name='crate'><link name='l'><collision name='c'><geometry><box><size>.1 .1 .1</size></box></geometry>"
        "</collision></link></model></sdf>",
        "parcel", {4, 4, 1, 0, 0, 0});
    const bool is_there = expect("y of what was spawned", simulation_->get_pose(name).y, 4);
    // While time stands still: it falls, and moves as it is pushed.
    simulation_->push(name, {0, 2, 0, 0, 0, 0}, 0.1);
    simulation_->step(100);
    const bool is_pushed = simulation_->get_pose(name).y > 4 + 1e-5;
    if (!is_pushed) return expect("whether it was pushed", is_pushed, 1);
    if (!refuses("a joint that is not there", [&] { simulation_->push_joint(name, "hinge", 1, 0); })) return false;
    simulation_->remove(name);
    return is_there && refuses("a pose of what was removed", [&] { simulation_->get_pose(name); });
  }

  bool refusals() {
    return refuses("a model that is not there", [&] { simulation_->remove("nobody"); }) &&
           refuses("a pose that is no number",
                   [&] {
                     simulation_->set_pose("robot", {NAN, 0, 0, 0, 0, 0});
                   }) &&
           refuses("a model that is no SDF", [&] { simulation_->spawn("<sdf", "x", {}); }) && is_confined();
  }

  // A file of the simulator's user that is not in its model path.
  bool is_confined() {
    const auto file = std::filesystem::temp_directory_path() / ("rtmsim-probe-" + std::to_string(getpid()) + ".sdf");
    std::ofstream(file) << "<sdf version='1.9'><model name='outside'><link name='l'/></model></sdf>";
    const bool is_refused = refuses("a file outside of the model path", [&] { simulation_->spawn(file.c_str(), "", {}); });
    std::filesystem::remove(file);
    return is_refused;
  }

  template <class Call>
  bool refuses(const char* what, Call call) {
    try {
      call();
    } catch (const rtmsim::Failed& e) {
      if (*e.reason.in()) return true;
    }
    RTC_ERROR(("%s was not refused", what));
    return false;
  }

  RTC::CorbaPort port_;
  RTC::CorbaConsumer<rtmsim::SimulationService> simulation_;
};

// clang-format off
static const char* const simulationprobe_spec[] = {
    "implementation_id", "SimulationProbe",
    "type_name", "SimulationProbe",
    "description", "Tries the service of RTCSimulation",
    "version", "1.0.0",
    "vendor", "rtm-sim",
    "category", "test",
    "activity_type", "PERIODIC",
    "kind", "DataFlowComponent",
    "max_instance", "0",
    "language", "C++",
    "lang_type", "compile",
    "exec_cxt.periodic.rate", "10",
    ""};
// clang-format on

extern "C" {
DLL_EXPORT void SimulationProbeInit(RTC::Manager* manager) {
  coil::Properties profile(simulationprobe_spec);
  manager->registerFactory(profile, RTC::Create<SimulationProbe>, RTC::Delete<SimulationProbe>);
}
}
