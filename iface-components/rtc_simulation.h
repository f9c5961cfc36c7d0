// RTCSimulation: the simulation as a component. Activate runs it, deactivate pauses it, reset (from the error state) resets it; the OutPort
// `time` (RTC::TimedDouble) carries simulated time [s], and the service port `simulation` provides rtmsim::SimulationService.
// Configuration: server_id. Models are spawned from texts and from what is in the simulator's model path; from any file when rtc.conf sets
// manager.remote_rights to everything. It belongs into an ordinary context: one of simulated time stands still while the simulation is
// paused.
#pragma once

#include <rtm/idl/BasicDataTypeSkel.h>
#include <rtm/idl/SimulationServiceSkel.h>

#include <rtm/CorbaPort.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/DataOutPort.h>
#include <rtm/Manager.h>

#include <atomic>

#include "async_requests.h"
#include "iface_link.h"
#include "line_limit.h"

// Calls from any thread, each with a line of its own to the simulator.
class SimulationServiceImpl : public virtual POA_rtmsim::SimulationService, public virtual PortableServer::RefCountServantBase {
 public:
  void set_server(int server_id) { server_id_.store(server_id, std::memory_order_relaxed); }
  // Callers may have models spawned from any file that the simulator may read, not only from those of its model path.
  void open_all_files() { opens_all_files_ = true; }

  void run() override;
  void pause() override;
  void step(CORBA::ULong steps) override;
  void reset() override;
  CORBA::Double now() override;
  rtmsim::Pose get_pose(const char* model) override;
  void set_pose(const char* model, const rtmsim::Pose& target) override;
  char* spawn(const char* sdf, const char* name, const rtmsim::Pose& target) override;
  void remove(const char* model) override;
  void push(const char* name, const rtmsim::Wrench& pushed, CORBA::Double seconds) override;
  void push_joint(const char* model, const char* joint, CORBA::Double effort, CORBA::Double seconds) override;

 private:
  std::atomic<int> server_id_{0};
  bool opens_all_files_ = false;  // from before the first call
};

class RTCSimulation : public RTC::DataFlowComponentBase {
 public:
  explicit RTCSimulation(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;
  RTC::ReturnCode_t onActivated(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onDeactivated(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onExecute(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onReset(RTC::UniqueId ec_id) override;

 private:
  RTC::ReturnCode_t attach();
  RTC::ReturnCode_t ask(const shm::Request& request);

  int server_id_ = 0;
  iface::IfaceLink link_;
  iface::AsyncRequests async_requests_;
  iface::LineLimit limit_;  // of lines about a simulator that is not there
  RTC::TimedDouble time_;
  RTC::OutPort<RTC::TimedDouble> time_out_;
  RTC::CorbaPort simulation_port_;
  SimulationServiceImpl service_;
};

extern "C" {
DLL_EXPORT void RTCSimulationInit(RTC::Manager* manager);
}
