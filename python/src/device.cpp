#include "python/src/device.h"

#include <unistd.h>

#include <algorithm>
#include <new>

#include "base/suggestion.h"
#include "base/text.h"

namespace python {
namespace {

using namespace std::chrono_literals;

std::chrono::nanoseconds nanoseconds_of(Simulator::Seconds time) { return std::chrono::duration_cast<std::chrono::nanoseconds>(time); }

shm::IfaceType type_of(const std::string& name) {
  const auto type = shm::parse_type(name);
  if (type) return *type;
  std::vector<std::string> known;
  for (const auto& row : shm::iface_types) known.emplace_back(row.name);
  throw NotFound("no type of iface " + base::in_quotes(name) + "; expected one of " + base::join(known, ", "));
}

}  // namespace

Device::Device(Simulator& simulator, const std::string& type, const std::string& name)
    : simulator_(simulator), type_(type_of(type)), name_(name), owner_(getpid()) {
  auto opened = shm::Iface::open(simulator.server_id(), type_, name);
  if (!opened) {
    simulator.check_alive();
    throw NotFound(opened.error().message);
  }
  iface_.emplace(std::move(*opened));
  check(iface_->subscribe());
}

Device::~Device() { close(); }

void Device::close() {
  if (!iface_) return;
  // The lease is the parent's; a child forgets it without a word to the simulator.
  if (getpid() != owner_) static_cast<void>(new shm::Iface(std::move(*iface_)));
  iface_.reset();
}

shm::Iface& Device::iface() {
  if (!iface_) throw Error(name_ + ": is closed");
  if (is_waiting_) throw Error(name_ + ": another thread waits for it; use one World per thread");
  if (getpid() != owner_) throw Error(name_ + ": belongs to the parent process; make a World after the fork");
  if (iface_->status() == shm::Status::live) return *iface_;
  simulator_.check_alive();
  if (const auto again = iface_->reopen(); !again) throw NotFound(again.error().message);
  return *iface_;
}

// A tenth of a second at most.
shm::Wait Device::wait_without_gil(std::uint64_t than, std::chrono::nanoseconds timeout) {
  shm::Iface& own = iface();
  is_waiting_ = true;
  const auto outcome = [&] {
    py::gil_scoped_release release;
    return own.wait(than, std::min<std::chrono::nanoseconds>(timeout, 100ms));
  }();
  is_waiting_ = false;
  return outcome;
}

void Device::wait_for_first(Simulator::Seconds timeout) {
  shm::Iface& own = iface();
  const auto deadline = std::chrono::steady_clock::now() + nanoseconds_of(timeout);
  while (own.sequence() == 0) {
    const auto left = nanoseconds_of(deadline - std::chrono::steady_clock::now());
    if (left.count() <= 0) {
      throw TimedOut(name_ + ": has no sample after " + base::format_number(timeout.count()) + " s; make a step, and see simctl fault");
    }
    const auto outcome = wait_without_gil(0, left);
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (outcome == shm::Wait::closed) iface();
  }
}

bool Device::wait(std::uint64_t than, Simulator::Seconds timeout) {
  const auto deadline = std::chrono::steady_clock::now() + nanoseconds_of(timeout);
  while (true) {
    shm::Iface& own = iface();
    if (own.sequence() > than) return true;
    const auto left = nanoseconds_of(deadline - std::chrono::steady_clock::now());
    if (left.count() <= 0) return false;
    static_cast<void>(wait_without_gil(than, left));
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }
}

shm::Iface& Device::fresh(Simulator::Seconds timeout) {
  shm::Iface& own = iface();
  simulator_.show_changes(timeout);
  if (own.read()) return own;
  wait_for_first(timeout);
  if (!own.read()) throw Error(name_ + ": the simulator writes faster than its samples can be read");
  return own;
}

shm::HeldFrame Device::frame(Simulator::Seconds timeout) {
  simulator_.show_changes(timeout);
  auto held = iface().hold();
  if (!held) {
    wait_for_first(timeout);
    held = iface().hold();
  }
  if (!held) throw Error(name_ + ": the simulator writes faster than its frames can be read");
  return std::move(*held);
}

py::dict Device::info() { return info_of(iface()); }

py::dict Device::read(Simulator::Seconds timeout) {
  if (!shm::has_frames(type_)) return sample_of(fresh(timeout));
  const shm::HeldFrame held = frame(timeout);
  py::dict values;
  for (const auto& field : shm::row_of(type_).sample) {
    if (field.kind != shm::Field::Kind::stamp) values[py::str(std::string(field.name))] = value_of(field, &held.head());
  }
  stamp_into(values, held.head().stamp);
  values["image"] = image_of(held);
  return values;
}

py::object Device::value(const std::string& name, Simulator::Seconds timeout) {
  const auto& row = shm::row_of(type_);
  const auto field = std::ranges::find(row.sample, name, &shm::Field::name);
  if (field == row.sample.end() || shm::has_frames(type_)) {
    std::vector<std::string> known;
    for (const auto& one : row.sample) known.emplace_back(one.name);
    throw NotFound(name_ + ": has no field " + base::in_quotes(name) + "; it has " + base::join(known, ", "));
  }
  const shm::Iface& own = fresh(timeout);
  if (field->kind == shm::Field::Kind::followers) return followers_of(row.sample_tail, own.sample_followers(field->count), own.filled());
  return value_of(*field, own.sample_data().data());
}

py::array Device::array(Simulator::Seconds timeout) {
  if (shm::has_frames(type_)) return image_of(frame(timeout));
  if (type_ != shm::IfaceType::laser && type_ != shm::IfaceType::sonar) {
    throw Error(name_ + ": is no array; read it as a whole, or one of its fields");
  }
  const shm::Iface& own = fresh(timeout);
  const auto* ranges = reinterpret_cast<const float*>(own.sample_followers(0));
  const auto count = static_cast<py::ssize_t>(own.filled());
  if (type_ == shm::IfaceType::laser) {
    const auto layers = static_cast<py::ssize_t>(own.info<shm::LaserInfo>().layers);
    if (layers > 1) return py::array_t<float>(std::vector<py::ssize_t>{layers, count / layers}, ranges);
  }
  return py::array_t<float>(count, ranges);
}

std::uint64_t Device::sequence() { return iface().sequence(); }

void Device::command(shm::CommandKind kind, const std::vector<double>& values, Simulator::Seconds duration) {
  check(iface().command(kind, values, nanoseconds_of(duration)));
}

void Device::velocity(double a, double b, double c, Simulator::Seconds duration) {
  const double values[] = {a, b, c};
  check(iface().command(shm::CommandKind::velocity, values, nanoseconds_of(duration)));
}

bool Device::is_commanding() { return iface().is_commanding(); }

}  // namespace python
