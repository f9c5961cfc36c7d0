// The commands of simctl, and their common state. One thread at a time.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/result.h"
#include "shm/client.h"
#include "shm/requests.h"
#include "shm/world_map.h"

namespace simctl {

// Prints errors as "simctl: ..." and remembers that there was one.
class Control {
 public:
  Control(std::uint32_t server_id, bool json) : server_id_(server_id), json_(json) {}
  std::uint32_t server_id() const { return server_id_; }
  bool json() const { return json_; }

  // The server's reply; nothing when it rejected or does not answer, which is printed. `command`: what the message calls the request.
  std::optional<shm::Reply> ask(const shm::Request& request, std::chrono::seconds limit = std::chrono::seconds(10),
                                const std::string& command = {});
  // By NAME or TYPE:NAME; nothing when there is none, or several types have the name and none is the preferred one, which is printed.
  std::optional<shm::Iface> open(const std::string& name, std::optional<shm::IfaceType> preferred = {});
  std::optional<shm::Iface> open(shm::IfaceType type, const std::string& name);
  void fail(const std::string& message);
  // The same of what the user has asked for: the exit code is that of a wrong command line.
  void reject(const std::string& message);
  int exit_code() const { return is_rejected_ ? 2 : failed_ ? 1 : 0; }
  void print(const nlohmann::ordered_json& value) const;

 private:
  std::uint32_t server_id_;
  bool json_;
  bool failed_ = false, is_rejected_ = false;
};

// ---- control ----
void step(Control& control, std::int64_t steps, bool is_paced);
void pose(Control& control, const std::string& model, const std::vector<double>& values);
// Drives for so long [s] and stops, or until it is interrupted when `seconds` is 0: a robot obeys only as long as its commander lives.
void velocity(Control& control, const std::string& iface, const std::vector<double>& values, double seconds);
bool is_position_iface(std::uint32_t server_id, const std::string& name);
// Shows that of a model or MODEL::LINK when there are no numbers; VX VY VA or all six set it, in the world [m/s, rad/s].
void model_velocity(Control& control, const std::string& model, const std::vector<double>& values);
struct Pushed {
  std::string name;   // MODEL or MODEL::LINK
  std::string joint;  // of MODEL; empty: the link
};
// Three numbers of force [N] or six with torque [N m], in the world, or one of a joint [N m or N], for so long [s]; 0: one step. Returns
// when that is over, and at once where time stands still.
void wrench(Control& control, const Pushed& what, const std::vector<double>& values, double seconds);
// To X Y A, or to 0 when there are no numbers.
void reset_odometry(Control& control, const std::string& iface, const std::vector<double>& values);
struct JointOptions {
  std::string model;
  std::vector<std::string> settings;  // JOINT=VALUE, or JOINT for modes without a value; "all" stands for every joint
  std::string mode = "position";      // velocity, effort, free, brake
  double seconds = 0;                 // simulated; 0: until the positions are reached, for other modes until interrupted
  bool is_compensated = false;        // the effort that gravity needs is added
};
// Shows the joints when there are no settings. A joint brakes when this command ends.
void joints(Control& control, const JointOptions& options);
struct SpawnOptions {
  std::string file, name, gains;    // gains: a file
  std::vector<double> pose;         // of the first, if there are several
  std::vector<std::string> joints;  // JOINT=POSITION
  std::string list;                 // "robot=r0..r9": a model for each value, with {robot} in file and name filled in; empty: one model
  double spacing = 2;               // of several, in a square grid [m]
};
void spawn(Control& control, const SpawnOptions& options);
// Attaches or detaches what a gripper or a detachable joint holds; without a name shows all of them.
void attach(Control& control, const std::string& name, bool is_on);
struct ScreenshotOptions {
  std::string file, follow, camera, size = "1200x900";
  std::vector<double> from, at;  // at: x, y [m] of what is in the middle from above
  bool from_top = false, with_scans = false, with_collisions = false;
  double span = 0;
};
// "WIDTHxHEIGHT", each from 1 to 8192.
std::optional<std::pair<std::uint32_t, std::uint32_t>> parse_size(const std::string& text);
void screenshot(Control& control, const ScreenshotOptions& options);
// The world as glTF 2.0 binary.
void export_world(Control& control, const std::string& file, bool with_collisions);
struct MapOptions : shm::MapOptions {
  std::string file;  // PNG; the YAML file is beside it
};
// The occupancy map of the world, as map_server reads it.
void map(Control& control, const MapOptions& options);
void contacts(Control& control, const std::string& model);
struct FaultOptions {
  std::string iface, kind;  // see shm/fault_kinds.h
  std::optional<double> amount;
  double seconds = 0;  // simulated; 0: until it is ended
  bool ends = false;   // those of the iface, and of the kind; without, all
};
// Shows the faults that are on, of the iface or all, when there is no kind.
void fault(Control& control, const FaultOptions& options);

// ---- look inside ----
void list(Control& control, bool all_servers);
void info(Control& control, const std::string& name);
void echo(Control& control, const std::string& name, int count);
void stats(Control& control);
void participants(Control& control);
void tree(Control& control, const std::string& model);
// Until the simulator answers and has these ifaces, each NAME or TYPE:NAME; fails after `seconds` [s of wall-clock time], or when
// interrupted.
void wait(Control& control, const std::vector<std::string>& ifaces, double seconds);
void models(Control& control);
void dump(Control& control, const std::string& name);
void clean(Control& control, bool is_of_one_server);
// PNG frames into a folder, or an mp4 when ffmpeg is installed.
void record(Control& control, const std::string& camera, const std::string& target, int frames, double seconds);

// Time of the server stands still, or waits for participants.
bool is_paused(std::uint32_t server_id);

// True once SIGINT or SIGTERM came.
bool is_interrupted();
void catch_interrupts();

// A scan seen from above, for a terminal: the scanner at the bottom in the middle looking up.
std::string polar_plot(const shm::LaserInfo& info, std::span<const float> ranges, int columns, int rows);

}  // namespace simctl
