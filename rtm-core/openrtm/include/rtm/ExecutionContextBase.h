// Base class of execution contexts: membership, life cycle, rate, profile, and the three stages of a cycle. It has no thread: a derived
// class calls invokeWorkerPreDo, Do and PostDo (or invokeWorker) from its own, one at a time. Everything else may be called from any
// thread. A derived class is also a servant of RTC::ExecutionContextService and answers its operations with the functions here.
#pragma once

#include <coil/Properties.h>
#include <coil/Time.h>
#include <rtm/ExecutionContextWorker.h>
#include <rtm/RTObjectStateMachine.h>
#include <rtm/SystemLogger.h>
#include <rtm/idl/RTCSkel.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

namespace RTC {

class RTObject_impl;

class ExecutionContextBase {
 public:
  explicit ExecutionContextBase(const std::string& name = "");
  virtual ~ExecutionContextBase();
  ExecutionContextBase(const ExecutionContextBase&) = delete;
  ExecutionContextBase& operator=(const ExecutionContextBase&) = delete;

  // Takes rate, sync_transition, transition_timeout and their relatives from the options; wrong values are logged and left.
  virtual void init(coil::Properties& props);
  // Makes the component an owner of this context.
  virtual RTC::ReturnCode_t bindComponent(RTC::RTObject_impl* rtc);

  // False from the moment on that stop() begins, so that loops of authors end with it.
  CORBA::Boolean isRunning() const;
  // onStartup (onShutdown) of every member is called on the calling thread. stop() waits for a callback that runs; when that does not
  // return within the option callback_timeout [s] the answer is RTC_ERROR, a log line names it, and the context runs on when it does
  // return.
  RTC::ReturnCode_t start();
  RTC::ReturnCode_t stop();
  static constexpr std::chrono::seconds default_callback_timeout{5};
  // [Hz]
  CORBA::Double getRate() const;
  std::chrono::nanoseconds getPeriod() const;
  RTC::ReturnCode_t setRate(CORBA::Double rate);

  RTC::ReturnCode_t addComponent(RTC::LightweightRTObject_ptr comp);
  // The component is not called any more after return. A callback of it that outlasts callback_timeout still runs; a log line names it.
  RTC::ReturnCode_t removeComponent(RTC::LightweightRTObject_ptr comp);
  // Wait for the transition unless sync_transition is off or the caller is the stepping thread.
  RTC::ReturnCode_t activateComponent(RTC::LightweightRTObject_ptr comp);
  RTC::ReturnCode_t deactivateComponent(RTC::LightweightRTObject_ptr comp);
  RTC::ReturnCode_t resetComponent(RTC::LightweightRTObject_ptr comp);
  RTC::LifeCycleState getComponentState(RTC::LightweightRTObject_ptr comp) const;
  static const char* getStateString(RTC::LifeCycleState state);

  bool isAllCurrentState(RTC::LifeCycleState state) const;
  bool isAllNextState(RTC::LifeCycleState state) const;
  bool isOneOfCurrentState(RTC::LifeCycleState state) const;
  bool isOneOfNextState(RTC::LifeCycleState state) const;

  RTC::ExecutionKind getKind() const;
  const char* getKindString() const;
  static const char* getKindString(RTC::ExecutionKind kind);
  // The caller owns the profile.
  RTC::ExecutionContextProfile* getProfile();
  std::vector<RTC::LightweightRTObject_var> getComponents() const;
  // The same as a sequence, which loops of authors step through. For one thread at a time; good until the next call.
  const RTC::RTCList& getComponentList() const;

  void setObjRef(RTC::ExecutionContextService_ptr ref);
  // A new reference.
  RTC::ExecutionContextService_ptr getObjRef() const;
  RTC::ReturnCode_t setKind(RTC::ExecutionKind kind);
  // Nil when there is none.
  RTC::RTObject_ptr getOwner() const;
  RTC::ReturnCode_t setOwner(RTC::LightweightRTObject_ptr comp);
  void setProperties(const coil::Properties& props);
  coil::Properties getProperties() const;
  std::string getName() const;
  std::string getTypeName() const;

 protected:
  // Called by the functions above at the moments their names say; a code other than RTC_OK ends the operation with it.
  virtual RTC::ReturnCode_t onStarting() { return RTC::RTC_OK; }
  virtual RTC::ReturnCode_t onStarted() { return RTC::RTC_OK; }
  virtual RTC::ReturnCode_t onStopping() { return RTC::RTC_OK; }
  virtual RTC::ReturnCode_t onStopped() { return RTC::RTC_OK; }
  // May return another rate.
  virtual double onGetRate(double rate) const { return rate; }
  virtual double onSettingRate(double rate) { return rate; }
  virtual RTC::ReturnCode_t onSetRate(double) { return RTC::RTC_OK; }
  virtual RTC::ReturnCode_t onAddingComponent(RTC::LightweightRTObject_ptr) { return RTC::RTC_OK; }
  virtual RTC::ReturnCode_t onAddedComponent(RTC::LightweightRTObject_ptr) { return RTC::RTC_OK; }
  virtual RTC::ReturnCode_t onRemovingComponent(RTC::LightweightRTObject_ptr) { return RTC::RTC_OK; }
  virtual RTC::ReturnCode_t onRemovedComponent(RTC::LightweightRTObject_ptr) { return RTC::RTC_OK; }
  virtual RTC::ReturnCode_t onActivating(RTC::LightweightRTObject_ptr) { return RTC::RTC_OK; }
  // The waiting ones are called once before the caller waits: a context that sleeps must see to it that a cycle begins.
  virtual RTC::ReturnCode_t onWaitingActivated(RTC_impl::RTObjectStateMachine*, long int) { return RTC::RTC_OK; }
  virtual RTC::ReturnCode_t onActivated(RTC_impl::RTObjectStateMachine*, long int) { return RTC::RTC_OK; }
  virtual RTC::ReturnCode_t onDeactivating(RTC::LightweightRTObject_ptr) { return RTC::RTC_OK; }
  virtual RTC::ReturnCode_t onWaitingDeactivated(RTC_impl::RTObjectStateMachine*, long int) { return RTC::RTC_OK; }
  virtual RTC::ReturnCode_t onDeactivated(RTC_impl::RTObjectStateMachine*, long int) { return RTC::RTC_OK; }
  virtual RTC::ReturnCode_t onResetting(RTC::LightweightRTObject_ptr) { return RTC::RTC_OK; }
  virtual RTC::ReturnCode_t onWaitingReset(RTC_impl::RTObjectStateMachine*, long int) { return RTC::RTC_OK; }
  virtual RTC::ReturnCode_t onReset(RTC_impl::RTObjectStateMachine*, long int) { return RTC::RTC_OK; }
  virtual RTC::LifeCycleState onGetComponentState(RTC::LifeCycleState state) const { return state; }
  virtual RTC::ExecutionKind onGetKind(RTC::ExecutionKind kind) const { return kind; }
  virtual RTC::ExecutionContextProfile* onGetProfile(RTC::ExecutionContextProfile*& profile) { return profile; }
  // A member asks for a transition, the rate has changed, or a periodic context is to stop; for contexts whose thread may sleep longer than
  // a period. Called without a lock.
  virtual void onWakeUp() {}

  // One cycle: transitions, onExecute (onError), onStateUpdate. Nothing happens while the context is stopped.
  void invokeWorker();
  void invokeWorkerPreDo(std::size_t lane = 0);
  void invokeWorkerDo(std::size_t lane = 0);
  void invokeWorkerPostDo(std::size_t lane = 0);
  // In which lane (core/execution_context.h) a component that joins is to run.
  virtual std::size_t laneOf(const std::string& /*instance_name*/) const { return 0; }
  // Cycles that should have been and were not, for the statistics of the profile.
  void countMissedCycles(std::uint64_t cycles);
  bool isSteppingThread() const;
  // For onStopping, before the thread is joined: waits for the callback that runs, as long as stop() may. False, and a log line, when it
  // does not return.
  bool waitForCallbacks();
  // A log line names the component whose callback runs and what follows from that. Later waits for this call fail at once.
  void complainAboutCallback(const char* consequence);
  // How long a member of another process may take for a callback before it counts as lost: option member_timeout [s], default 1.
  // Without end one that hangs holds up the context; one that is dead does not, and a log line names who has taken more than a second.
  static constexpr std::chrono::nanoseconds without_end = std::chrono::nanoseconds::max();
  void setMemberTimeout(std::chrono::nanoseconds timeout);
  // Of each member, in the order of getComponents(): as getComponentState() for all at once.
  std::vector<RTC::LifeCycleState> getComponentStates() const;

  mutable Logger rtclog;
  RTC_impl::ExecutionContextWorker m_worker{*this};
  // Whether those who ask for a transition wait until it is made; init() sets them from the options sync_activation and its relatives.
  std::atomic<bool> m_syncActivation{true}, m_syncDeactivation{true}, m_syncReset{true};

 private:
  friend class RuntimeAccess;
  struct Impl;
  class Joining;
  class Changing;
  struct Transition;
  RTC::ReturnCode_t make(const Transition& transition, RTC::LightweightRTObject_ptr comp);
  // Ends the membership of an owner: after return the context does not call it any more, but a callback that outlasts `timeout` still
  // runs. Returns how many owners are left.
  std::size_t unbindComponent(RTC::RTObject_impl* rtc, std::chrono::nanoseconds timeout = default_callback_timeout);
  // Ends all memberships at once, without waiting for callbacks: for a context that ends.
  void dismissMembers();
  // stop() with another deadline.
  RTC::ReturnCode_t stopBy(std::chrono::steady_clock::time_point deadline);
  // How long whoever ends something waits for callbacks of components: option callback_timeout [s].
  std::chrono::nanoseconds callbackTimeout() const;
  RTC::ReturnCode_t removeComponent(RTC::LightweightRTObject_ptr comp, std::chrono::steady_clock::time_point deadline);
  // Brings a member to rest before it leaves: deactivates it when it is active, resets it when it is in error; waits for that whatever
  // sync_transition says, but not for a callback that has outlasted a wait before.
  void calmComponent(RTC::LightweightRTObject_ptr comp, std::chrono::steady_clock::time_point deadline);
  // Asks for the same and returns at once; contexts without a thread do nothing.
  void askToRest(RTC::LightweightRTObject_ptr comp);
  // Waits until no callback of a member runs on another thread; false on time-out.
  bool waitForQuiet(std::chrono::nanoseconds timeout);
  std::chrono::nanoseconds callbackTimeLeft() const;
  std::unique_ptr<Impl> impl_;
};

// Takes a context out of its object adapter and gives up its servant; calls that still run end first.
void destroyExecutionContext(ExecutionContextBase* context);

}  // namespace RTC
