// rtmsim._core: what rtmsim is built on. Its classes are wrapped by those of rtmsim/*.py, which have the documentation for users.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cstring>

#include "python/src/arguments.h"
#include "python/src/device.h"
#include "shm/control.h"

namespace python {
namespace {

// What Python gives, checked by the functions of arguments.h.
using Given = const py::object&;

Simulator::Seconds timeout_of(Given timeout) { return seconds("timeout", timeout); }

py::tuple values_of(const shm::Reply& reply, std::size_t count) {
  py::tuple values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = reply.values[i];
  return values;
}

void three(const char* what, Given from, double (&to)[3]) { std::ranges::copy(numbers(what, from, {3}), to); }

// x y z qw qx qy qz, or what pose_of() of shm/control.h takes.
shm::Pose pose_from(const std::vector<double>& v) {
  if (v.size() == 7) return {v[0], v[1], v[2], v[3], v[4], v[5], v[6]};
  auto pose = shm::pose_of(v);
  if (!pose)
    throw Error("pose: expected 3 numbers (x y yaw), 4 (x y z yaw), 6 (x y z roll pitch yaw) or 7 (x y z qw qx qy qz), got " +
                std::to_string(v.size()));
  return *pose;
}

std::string spawn(Simulator& s, Given what, Given name, Given pose, Given timeout) {
  shm::SpawnRequest request = value_of(shm::spawn_request(path("source", what), s.is_shared()));
  request.name = text("name", name);
  request.has_pose = !pose.is_none();
  if (request.has_pose) request.pose = pose_from(numbers("pose", pose));
  return s.ask(request, timeout_of(timeout)).message;
}

std::string listed(Simulator& s, Given timeout) { return s.ask(shm::ListRequest{}, timeout_of(timeout)).text; }

py::array screenshot(Simulator& s, Given view, Given width, Given height, Given follow, Given pose, Given span, Given scans,
                     Given timeout) {
  using View = shm::ScreenshotRequest::View;
  constexpr std::int64_t largest = 1 << 20;  // the simulator says what it can
  const std::string named = text("view", view);
  shm::ScreenshotRequest request;
  request.view = named == "top"      ? View::top
                 : named == "follow" ? View::follow
                 : named == "from"   ? View::from
                 : named == "camera" ? View::camera
                                     : View::whole;
  request.width = static_cast<std::uint32_t>(whole("width", width, 1, largest));
  request.height = static_cast<std::uint32_t>(whole("height", height, 1, largest));
  request.follow = text(named == "camera" ? "camera" : "follow", follow);
  request.span = number(named == "top" ? "span" : "fov", span);
  request.with_scans = flag("scans", scans);
  request.as_pixels = true;
  if (!pose.is_none()) request.pose = pose_from(numbers("pose", pose));
  const std::string pixels = s.ask(request, timeout_of(timeout)).text;
  py::array_t<std::uint8_t> image(std::vector<py::ssize_t>{request.height, request.width, 3});
  if (pixels.size() != static_cast<std::size_t>(image.nbytes())) throw Error("screenshot: this simulator does not send pixels");
  std::memcpy(image.mutable_data(), pixels.data(), pixels.size());
  return image;
}

shm::WrenchRequest wrench(const std::string& name, Given duration, Given stays) {
  return {name, {}, {}, flag("persistent", stays) ? shm::WrenchRequest::until_the_next : seconds("duration", duration).count()};
}

void add_requests(py::class_<Simulator>& type) {
  const auto text_of = [&](const char* name, const char* argument, auto make) {
    type.def(name, [=](Simulator& s, Given what, Given timeout) { return s.ask(make(text(argument, what)), timeout_of(timeout)).text; });
  };
  text_of("tree", "model", [](const std::string& model) { return shm::TreeRequest{model}; });
  text_of("contacts", "model", [](const std::string& model) { return shm::ContactsRequest{model}; });
  text_of("faults", "iface", [](const std::string& iface) { return shm::FaultsRequest{iface}; });
  type.def("list", &listed)
      .def("hash", [](Simulator& s, Given timeout) { return s.ask(shm::StatsRequest{}, timeout_of(timeout)).hash; })
      .def("pause", [](Simulator& s, Given timeout) { s.ask(shm::PauseRequest{}, timeout_of(timeout)); })
      .def("run", [](Simulator& s, Given timeout) { s.ask(shm::RunRequest{}, timeout_of(timeout)); })
      .def("reset",
           [](Simulator& s, bool poses_only, Given given, Given timeout) {
             s.ask(shm::ResetRequest{poses_only, given.is_none() ? std::nullopt : std::optional(seed(given))}, timeout_of(timeout));
           })
      .def("set_rtf",
           [](Simulator& s, Given factor, Given timeout) { s.ask(shm::SetRtfRequest{number("rtf", factor)}, timeout_of(timeout)); })
      .def("pose", [](Simulator& s, Given name,
                      Given timeout) { return values_of(s.ask(shm::GetPoseRequest{text("name", name)}, timeout_of(timeout)), 7); })
      .def("set_pose",
           [](Simulator& s, Given model, Given pose, Given timeout) {
             const auto values = numbers("pose", pose);
             s.ask(shm::SetPoseRequest{text("model", model), pose_from(values), values.size() == 3}, timeout_of(timeout));
           })
      .def("velocity", [](Simulator& s, Given name,
                          Given timeout) { return values_of(s.ask(shm::GetVelocityRequest{text("name", name)}, timeout_of(timeout)), 6); })
      .def("set_velocity",
           [](Simulator& s, Given model, Given linear, Given angular, Given timeout) {
             shm::SetVelocityRequest request{text("model", model), {}, {}};
             three("linear", linear, request.linear);
             three("angular", angular, request.angular);
             s.ask(request, timeout_of(timeout));
           })
      .def("push",
           [](Simulator& s, Given name, Given force, Given torque, Given duration, Given stays, Given timeout) {
             shm::WrenchRequest request = wrench(text("name", name), duration, stays);
             three("force", force, request.force);
             three("torque", torque, request.torque);
             s.ask(request, timeout_of(timeout));
           })
      .def("push_joint",
           [](Simulator& s, Given model, Given joint, Given effort, Given duration, Given stays, Given timeout) {
             shm::WrenchRequest request = wrench(text("model", model) + "::" + text("joint", joint), duration, stays);
             request.force[0] = number("effort", effort);
             request.is_joint = true;
             s.ask(request, timeout_of(timeout));
           })
      .def("spawn", &spawn)
      .def("delete", [](Simulator& s, Given model, Given timeout) { s.ask(shm::DeleteRequest{text("model", model)}, timeout_of(timeout)); })
      .def("fault",
           [](Simulator& s, Given iface, Given kind, Given amount, Given duration, Given timeout) {
             shm::FaultRequest request{text("iface", iface), text("kind", kind), std::nullopt, seconds("duration", duration).count()};
             if (!amount.is_none()) request.amount = number("amount", amount);
             s.ask(request, timeout_of(timeout));
           })
      .def("end_faults",
           [](Simulator& s, Given iface, Given kind, Given timeout) {
             return s.ask(shm::EndFaultsRequest{text("iface", iface), text("kind", kind)}, timeout_of(timeout)).count;
           })
      .def("reset_odometry",
           [](Simulator& s, const std::string& iface, Given x, Given y, Given a, Given timeout) {
             s.ask(shm::ResetOdometryRequest{iface, number("x", x), number("y", y), number("a", a), false, {}}, timeout_of(timeout));
           })
      .def("write_tag",
           [](Simulator& s, Given iface, Given id, Given data, Given timeout) {
             s.ask(shm::WriteTagRequest{text("iface", iface), text("id", id), text("data", data)}, timeout_of(timeout));
           })
      .def("set_motors",
           [](Simulator& s, const std::string& iface, Given on, Given timeout) {
             s.ask(shm::SetMotorsRequest{iface, flag("on", on)}, timeout_of(timeout));
           })
      .def("screenshot", &screenshot);
}

void add_device(py::module_& module) {
  constexpr double usual = 30.0;
  const auto patient = py::arg("timeout") = usual;
  py::class_<Device>(module, "Device")
      .def(py::init(
               [](Simulator& s, Given type, Given name) { return std::make_unique<Device>(s, text("type", type), text("name", name)); }),
           py::keep_alive<1, 2>())
      .def_property_readonly("name", &Device::name)
      .def_property_readonly("type", &Device::type)
      .def_property_readonly("sequence", &Device::sequence)
      .def_property_readonly("is_commander", &Device::is_commanding)
      .def("info", &Device::info)
      .def(
          "read", [](Device& d, Given timeout) { return d.read(timeout_of(timeout)); }, patient)
      .def(
          "value", [](Device& d, Given field, Given timeout) { return d.value(text("field", field), timeout_of(timeout)); },
          py::arg("field"), patient)
      .def(
          "array", [](Device& d, Given timeout) { return d.array(timeout_of(timeout)); }, patient)
      .def(
          "wait",
          [](Device& d, Given than, Given timeout) { return d.wait(static_cast<std::uint64_t>(whole("than", than)), timeout_of(timeout)); },
          py::arg("than"), patient)
      .def(
          "command",
          [](Device& d, Given kind, Given values, Given duration) {
            constexpr std::int64_t largest = std::numeric_limits<std::uint32_t>::max();
            d.command(static_cast<shm::CommandKind>(whole("kind", kind, 0, largest)), numbers("values", values),
                      seconds("duration", duration));
          },
          py::arg("kind"), py::arg("values"), py::arg("duration") = 0.0)
      .def(
          "velocity",
          [](Device& d, Given vx, Given vy, Given va, Given duration) {
            d.velocity(number("vx", vx), number("vy", vy), number("va", va), seconds("duration", duration));
          },
          py::arg("vx"), py::arg("vy") = 0.0, py::arg("va") = 0.0, py::arg("duration") = 0.0)
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
  simulator
      .def(py::init([](Given id) {
        return std::make_unique<Simulator>(
            static_cast<std::uint32_t>(whole("server_id", id, 0, std::numeric_limits<std::uint32_t>::max())));
      }))
      .def("on_death", &Simulator::on_death)
      .def("begin_steps", [](Simulator& s, Given count) { s.begin_steps(whole("steps", count, 1)); })
      .def("end_steps", [](Simulator& s, Given timeout) { return s.end_steps(timeout_of(timeout)); })
      .def("step", [](Simulator& s, Given count, Given timeout) { return s.step(whole("steps", count, 1), timeout_of(timeout)); })
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
  module.def("number", [](const std::string& what, Given value) { return number(what.c_str(), value); })
      .def("seconds", [](const std::string& what, Given value) { return seconds(what.c_str(), value).count(); })
      .def("whole", [](const std::string& what, Given value, std::int64_t lowest) { return whole(what.c_str(), value, lowest); })
      .def("numbers", [](const std::string& what, Given value, std::size_t count) { return numbers(what.c_str(), value, {count}); })
      .def("text", [](const std::string& what, Given value) { return text(what.c_str(), value); })
      .def("seed", [](Given value) { return seed(value); })
      .def("path",
           [](const std::string& what, Given value) {
             const std::string found = path(what.c_str(), value);
             return py::reinterpret_steal<py::str>(PyUnicode_DecodeFSDefaultAndSize(found.data(), static_cast<py::ssize_t>(found.size())));
           })
      .def("shown", [](Given value) { return shown(value); });
}
