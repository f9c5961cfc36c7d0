// A small component that drives a robot by its laser, in twenty-one ways that are wrong and as many twins that are right: what `rtse hunt`
// must find, and must leave alone. The property `kind` chooses which, `faulty` (YES, NO) which twin.
#include <rtm/idl/ExtendedDataTypesSkel.h>
#include <rtm/idl/InterfaceDataTypesSkel.h>

#include <rtm/DataFlowComponentBase.h>
#include <rtm/DataInPort.h>
#include <rtm/DataOutPort.h>
#include <rtm/Manager.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

// clang-format off
static const char* const huntsubject_spec[] = {
    "implementation_id", "HuntSubject",
    "type_name", "HuntSubject",
    "description", "Small components with and without faults",
    "version", "1.0.0",
    "vendor", "rtm-sim",
    "category", "tests",
    "activity_type", "PERIODIC",
    "kind", "DataFlowComponent",
    "max_instance", "0",
    "language", "C++",
    "lang_type", "compile",
    "exec_cxt.sim_time.phase", "1",
    "conf.default.speed", "0.3",
    "conf.__type__.speed", "double",
    ""};
// clang-format on

namespace {

constexpr double fastest = 0.3;   // [m/s]
constexpr double far_away = 5.6;  // [m]
constexpr double infinity = std::numeric_limits<double>::infinity();

double seconds(const RTC::Time& time) { return static_cast<double>(time.sec) + 1e-9 * static_cast<double>(time.nsec); }

}  // namespace

class HuntSubject : public RTC::DataFlowComponentBase {
 public:
  explicit HuntSubject(RTC::Manager* manager)
      : RTC::DataFlowComponentBase(manager), range_in_("range", range_), velocity_out_("velocity", velocity_) {}

  RTC::ReturnCode_t onInitialize() override {
    addInPort("range", range_in_);
    addOutPort("velocity", velocity_out_);
    bindParameter("speed", speed_, "0.3");
    kind_ = m_properties["kind"];
    is_faulty_ = m_properties["faulty"] == "YES";
    return RTC::RTC_OK;
  }

  RTC::ReturnCode_t onActivated(RTC::UniqueId) override {
    if (is("speed_doubles_when_activated_again")) factor_ = activations_ > 0 ? 2 : 1;
    if (is("speed_doubles_in_the_third_activation")) factor_ = activations_ > 1 ? 2 : 1;
    ++activations_;
    scans_ = 0;
    ticks_without_scan_ = 0;
    last_.clear();
    last_time_ = -1;
    integral_ = 0;
    return RTC::RTC_OK;
  }

  RTC::ReturnCode_t onDeactivated(RTC::UniqueId) override {
    if (is("exception_when_deactivated") && scans_ > 0) throw std::runtime_error("nothing to close");
    send(0, 0);
    return RTC::RTC_OK;
  }

  RTC::ReturnCode_t onExecute(RTC::UniqueId) override {
    if (range_in_.isNew()) {
      range_in_.read();
      ticks_without_scan_ = 0;
      const auto code = take_scan();
      last_time_ = seconds(range_.tm);
      last_.assign(range_.ranges.get_buffer(), range_.ranges.get_buffer() + range_.ranges.length());
      ++scans_;
      return code;
    }
    return wait();
  }

 private:
  // Whether this is the faulty twin of that kind.
  bool is(const char* kind) const { return is_faulty_ && kind_ == kind; }

  void send(double forward, double turn) {
    velocity_.tm = range_.tm;
    velocity_.data.vx = forward;
    velocity_.data.vy = 0;
    velocity_.data.va = turn;
    velocity_out_.write();
  }

  // No scan in this tick.
  RTC::ReturnCode_t wait() {
    ++ticks_without_scan_;
    if (is("first_scan_is_taken_for_granted") && scans_ == 0 && ticks_without_scan_ > 3) static_cast<void>(last_.at(0));
    if (is("error_without_scan") && ticks_without_scan_ > 5) return RTC::RTC_ERROR;
    if (is("drives_on_without_scan")) return RTC::RTC_OK;
    if (is("speeds_up_without_scan")) {
      send(0.1 * ticks_without_scan_, 0);
      return RTC::RTC_OK;
    }
    if (ticks_without_scan_ > 5) send(0, 0);
    return RTC::RTC_OK;
  }

  RTC::ReturnCode_t take_scan() {
    const std::size_t count = range_.ranges.length();
    double nearest = far_away, left = far_away, right = far_away, sum = 0;
    std::size_t seen = 0;
    for (std::size_t i = 0; i < count; ++i) {
      // A scan on a port ends at its longest range: nothing was seen there.
      const double got = range_.ranges[static_cast<CORBA::ULong>(i)];
      const double range = got < range_.config.maxRange ? got : infinity;
      if (is("infinite_ranges_are_added")) sum += std::isinf(range) ? infinity - infinity : range;
      if (!std::isfinite(range) || range < 0) continue;
      ++seen;
      sum += range;
      nearest = std::min(nearest, range);
      (i < count / 2 ? right : left) = std::min(i < count / 2 ? right : left, range);
    }
    double forward = std::clamp(0.4 * (nearest - 0.4), -0.1, std::min(speed_, fastest)) * factor_;
    double turn = std::clamp(left - right, -0.7, 0.7);
    if (const auto code = harm(forward, turn, nearest, sum, seen); code != RTC::RTC_OK) return code;
    send(forward, turn);
    return RTC::RTC_OK;
  }

  // What the faulty twins do to a good command.
  RTC::ReturnCode_t harm(double& forward, double& turn, double nearest, double sum, std::size_t seen) {
    const double dt = last_time_ < 0 ? 0.1 : seconds(range_.tm) - last_time_;
    if (is("infinite_ranges_are_added")) turn += 0 * sum;
    if (is("mean_of_no_ranges") && seen < range_.ranges.length() / 4) turn = std::nan("");
    if (is("divides_by_time_between_scans")) turn += 0 * ((nearest - 1) / dt);
    if (is("time_runs_backwards") && dt < 0) throw std::runtime_error("a scan of the past");
    if (is("gap_in_time") && dt > 0.35) return RTC::RTC_ERROR;
    if (is("integral_without_limit")) forward += (integral_ += std::max(0.0, dt - 0.1)) * 0.5;
    if (is("same_scan_twice") && is_same()) turn = std::nan("");
    if (is("root_of_short_range")) forward = std::min(0.3 * std::sqrt(nearest - 0.25), forward);  // NaN stays NaN
    if (is("index_from_range") && seen > 0) static_cast<void>(table().at(static_cast<std::size_t>(nearest / 3 * 8)));
    if (is("gives_up_when_blind") && seen == 0) return RTC::RTC_ERROR;
    if (is("no_limit_of_speed")) forward = 0.08 * (nearest - 0.4) * (nearest > 2.5 ? 3 : 1);
    if (is("turns_into_obstacles") && nearest < 0.8) forward = 0.2, turn = -turn;
    if (is("old_scan_is_as_good") && !last_.empty()) forward = 0.25, turn = 0;
    if (is("noise_is_obstacle") && nearest < 0.05) throw std::runtime_error("inside of an obstacle");
    return RTC::RTC_OK;
  }

  bool is_same() const {
    if (last_.size() != range_.ranges.length() || last_.empty()) return false;
    return std::equal(last_.begin(), last_.end(), range_.ranges.get_buffer());
  }

  static const std::vector<double>& table() {
    static const std::vector<double> speeds(8, 0.1);
    return speeds;
  }

  RTC::RangeData range_;
  RTC::InPort<RTC::RangeData> range_in_;
  RTC::TimedVelocity2D velocity_;
  RTC::OutPort<RTC::TimedVelocity2D> velocity_out_;
  double speed_ = fastest;
  std::string kind_;
  bool is_faulty_ = false;
  double factor_ = 1, last_time_ = -1, integral_ = 0;
  int activations_ = 0, scans_ = 0, ticks_without_scan_ = 0;
  std::vector<double> last_;
};

extern "C" {
DLL_EXPORT void HuntSubjectInit(RTC::Manager* manager) {
  coil::Properties profile(huntsubject_spec);
  manager->registerFactory(profile, RTC::Create<HuntSubject>, RTC::Delete<HuntSubject>);
}
}
