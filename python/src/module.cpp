// rtmsim._core: what rtmsim is built on. Its classes are wrapped by those of rtmsim/*.py, which have the documentation for users.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cstring>

#include "python/src/device.h"
#include "shm/control.h"

namespace python {
namespace {

using Seconds = Simulator::Seconds;

Seconds seconds(double value) {
  if (!(value >= 0)) throw Error("a time must not be negative, got " + std::to_string(value));
  return Seconds(std::min(value, 1e9));
}

py::tuple values_of(const shm::Reply& reply, std::size_t count) {
  py::tuple values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = reply.values[i];
  return values;
}

void three(const std::vector<double>& from, double (&to)[3], const char* what) {
  if (from.size() != 3) throw Error(std::string(what) + ": expected 3 numbers, got " + std::to_string(from.size()));
  std::copy(from.begin(), from.end(), to);
}

// x y z qw qx qy qz, or what pose_of() of shm/control.h takes.
shm::Pose pose_from(const std::vector<double>& v) {
  if (v.size() == 7) return {v[0], v[1], v[2], v[3], v[4], v[5], v[6]};
  auto pose = shm::pose_of(v);
  if (!pose)
    throw Error("pose: expected 3 numbers (x y yaw), 4 (x y z yaw), 6 (x y z roll pitch yaw) or 7 (x y z qw qx qy qz), got " +
                std::to_string(v.size()));
  return *pose;
}

std::string spawn(Simulator& s, const std::string& what, const std::string& name, const std::optional<std::vector<double>>& pose,
                  double timeout) {
  shm::SpawnRequest request = value_of(shm::spawn_request(what, s.is_shared()));
  request.name = name;
  request.has_pose = pose.has_value();
  if (pose) request.pose = pose_from(*pose);
  return s.ask(request, seconds(timeout)).message;
}

py::array screenshot(Simulator& s, const std::string& view, std::uint32_t width, std::uint32_t height, const std::string& follow,
                     const std::vector<double>& pose, double span, bool scans, double timeout) {
  using View = shm::ScreenshotRequest::View;
  shm::ScreenshotRequest request;
  request.view = view == "top"      ? View::top
                 : view == "follow" ? View::follow
                 : view == "from"   ? View::from
                 : view == "camera" ? View::camera
                                    : View::whole;
  request.width = width;
  request.height = height;
  request.follow = follow;
  request.span = span;
  request.with_scans = scans;
  request.as_pixels = true;
  if (!pose.empty()) request.pose = pose_from(pose);
  const std::string pixels = s.ask(request, seconds(timeout)).text;
  py::array_t<std::uint8_t> image(std::vector<py::ssize_t>{height, width, 3});
  if (pixels.size() != static_cast<std::size_t>(image.nbytes())) throw Error("screenshot: this simulator does not send pixels");
  std::memcpy(image.mutable_data(), pixels.data(), pixels.size());
  return image;
}

void add_requests(py::class_<Simulator>& type) {
  const auto text_of = [](const char* name, auto make, py::class_<Simulator>& to) {
    to.def(name, [make](Simulator& s, const std::string& what, double timeout) { return s.ask(make(what), seconds(timeout)).text; });
  };
  text_of(
      "list", [](const std::string&) { return shm::ListRequest{}; }, type);
  text_of(
      "tree", [](const std::string& model) { return shm::TreeRequest{model}; }, type);
  text_of(
      "models", [](const std::string&) { return shm::ModelsRequest{}; }, type);
  text_of(
      "contacts", [](const std::string& model) { return shm::ContactsRequest{model}; }, type);
  text_of(
      "faults", [](const std::string& iface) { return shm::FaultsRequest{iface}; }, type);
  text_of(
      "statistics", [](const std::string&) { return shm::StatsRequest{}; }, type);
  type.def("hash", [](Simulator& s, double timeout) { return s.ask(shm::StatsRequest{}, seconds(timeout)).hash; })
      .def("pause", [](Simulator& s, double timeout) { s.ask(shm::PauseRequest{}, seconds(timeout)); })
      .def("run", [](Simulator& s, double timeout) { s.ask(shm::RunRequest{}, seconds(timeout)); })
      .def("reset",
           [](Simulator& s, bool poses_only, std::optional<std::uint64_t> seed, double timeout) {
             s.ask(shm::ResetRequest{poses_only, seed}, seconds(timeout));
           })
      .def("set_rtf", [](Simulator& s, double factor, double timeout) { s.ask(shm::SetRtfRequest{factor}, seconds(timeout)); })
      .def("pose", [](Simulator& s, const std::string& name,
                      double timeout) { return values_of(s.ask(shm::GetPoseRequest{name}, seconds(timeout)), 7); })
      .def("set_pose",
           [](Simulator& s, const std::string& model, const std::vector<double>& pose, double timeout) {
             s.ask(shm::SetPoseRequest{model, pose_from(pose), pose.size() == 3}, seconds(timeout));
           })
      .def("velocity", [](Simulator& s, const std::string& name,
                          double timeout) { return values_of(s.ask(shm::GetVelocityRequest{name}, seconds(timeout)), 6); })
      .def("set_velocity",
           [](Simulator& s, const std::string& model, const std::vector<double>& linear, const std::vector<double>& angular,
              double timeout) {
             shm::SetVelocityRequest request{model, {}, {}};
             three(linear, request.linear, "linear");
             three(angular, request.angular, "angular");
             s.ask(request, seconds(timeout));
           })
      .def("push",
           [](Simulator& s, const std::string& name, const std::vector<double>& force, const std::vector<double>& torque, double duration,
              bool stays, double timeout) {
             shm::WrenchRequest request{name, {}, {}, stays ? shm::WrenchRequest::until_the_next : duration};
             three(force, request.force, "force");
             three(torque, request.torque, "torque");
             s.ask(request, seconds(timeout));
           })
      .def("push_joint",
           [](Simulator& s, const std::string& name, double effort, double duration, bool stays, double timeout) {
             s.ask(shm::WrenchRequest{name, {effort}, {}, stays ? shm::WrenchRequest::until_the_next : duration, true}, seconds(timeout));
           })
      .def("spawn", &spawn)
      .def("delete", [](Simulator& s, const std::string& model, double timeout) { s.ask(shm::DeleteRequest{model}, seconds(timeout)); })
      .def("fault",
           [](Simulator& s, const std::string& iface, const std::string& kind, std::optional<double> amount, double duration,
              double timeout) {
             s.ask(shm::FaultRequest{iface, kind, amount, duration}, seconds(timeout));
           })
      .def("end_faults",
           [](Simulator& s, const std::string& iface, const std::string& kind, double timeout) {
             return s.ask(shm::EndFaultsRequest{iface, kind}, seconds(timeout)).count;
           })
      .def("reset_odometry",
           [](Simulator& s, const std::string& iface, const std::vector<double>& pose, double timeout) {
             if (pose.size() == 3) {
               s.ask(shm::ResetOdometryRequest{iface, pose[0], pose[1], pose[2], false, {}}, seconds(timeout));
             } else {
               s.ask(shm::ResetOdometryRequest{iface, 0, 0, 0, true, pose_from(pose)}, seconds(timeout));
             }
           })
      .def("set_motors",
           [](Simulator& s, const std::string& iface, bool on, double timeout) {
             s.ask(shm::SetMotorsRequest{iface, on}, seconds(timeout));
           })
      .def("screenshot", &screenshot);
}

void add_device(py::module_& module) {
  py::class_<Device>(module, "Device")
      .def(py::init<Simulator&, const std::string&, const std::string&>(), py::keep_alive<1, 2>())
      .def_property_readonly("name", &Device::name)
      .def_property_readonly("type", &Device::type)
      .def_property_readonly("sequence", &Device::sequence)
      .def_property_readonly("is_commander", &Device::is_commander)
      .def("info", &Device::info)
      .def("read", [](Device& d, double timeout) { return d.read(seconds(timeout)); })
      .def("value", [](Device& d, const std::string& field, double timeout) { return d.value(field, seconds(timeout)); })
      .def("array", [](Device& d, double timeout) { return d.array(seconds(timeout)); })
      .def("wait", [](Device& d, std::uint64_t than, double timeout) { return d.wait(than, seconds(timeout)); })
      .def("command", [](Device& d, std::uint32_t kind, const std::vector<double>& values,
                         double duration) { d.command(static_cast<shm::CommandKind>(kind), values, seconds(duration)); })
      .def("velocity", [](Device& d, double a, double b, double c, double duration) { d.velocity(a, b, c, seconds(duration)); })
      .def("close", &Device::close);
}

}  // namespace
}  // namespace python

PYBIND11_MODULE(_core, module) {
  using namespace python;
  py::options options;
  options.disable_function_signatures();
  auto& error = py::register_exception<Error>(module, "Error", PyExc_RuntimeError);
  const auto bases = [&](PyObject* other) { return py::make_tuple(py::handle(error), py::handle(other)); };
  py::register_exception<NotFound>(module, "NotFound", bases(PyExc_LookupError));
  py::register_exception<TimedOut>(module, "TimedOut", bases(PyExc_TimeoutError));
  py::register_exception<ServerDied>(module, "ServerDied", bases(PyExc_ConnectionError));

  py::class_<Simulator> simulator(module, "Simulator");
  simulator.def(py::init<std::uint32_t>())
      .def("on_death", &Simulator::on_death)
      .def("begin_steps", &Simulator::begin_steps)
      .def("end_steps", [](Simulator& s, double timeout) { return s.end_steps(seconds(timeout)); })
      .def("step", [](Simulator& s, std::int64_t count, double timeout) { return s.step(count, seconds(timeout)); })
      .def_property_readonly("time", &Simulator::time)
      .def_property_readonly("steps", &Simulator::steps)
      .def_property_readonly("is_paused", &Simulator::is_paused)
      .def_property_readonly("is_alive", &Simulator::is_alive)
      .def_property_readonly("seed", &Simulator::seed)
      .def_property_readonly("step_size", &Simulator::step_size)
      .def_property_readonly("world", &Simulator::world)
      .def_property_readonly("world_file", &Simulator::world_file)
      .def_property_readonly("server_id", &Simulator::server_id)
      .def_property_readonly("pid", &Simulator::pid)
      .def("close", &Simulator::close);
  add_requests(simulator);
  add_device(module);
}
