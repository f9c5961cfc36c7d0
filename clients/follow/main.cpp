// follow: a client of Player that drives a robot after another one. See --help.
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <numbers>
#include <optional>

#include "base/command_line.h"
#include "base/log.h"
#include "base/text.h"
#include "leader_tracker.h"
#include "player_connection.h"
#include "protocol/payloads.h"
#include "steering.h"

namespace {

using follow::PlayerConnection;

struct Options {
  std::string host = "127.0.0.1";
  std::uint16_t port = 6666;
  std::uint16_t drive = 0, laser = 0;
  std::string key;
  double wait = 10;     // [s] for a server that is not there yet
  double duration = 0;  // [s], simulated; 0: without end
  follow::SteeringSettings steering;
};

volatile sig_atomic_t is_told_to_end = 0;

void say(const std::string& text) { std::cout << text << std::endl; }

std::string metres(double value) { return fmt::format("{:.2f} m", value); }

// Drives one robot as long as its connection lasts.
class Follower {
 public:
  Follower(PlayerConnection connection, const Options& options) : connection_(std::move(connection)), options_(options) {
    tracker_settings_.max_speed = options.steering.max_speed;
    tracker_ = follow::LeaderTracker(tracker_settings_);
  }

  base::Result<void> run() {
    if (auto good = prepare(); !good) return good;
    if (auto good = connection_.ask_for_data(); !good) return good;
    while (is_told_to_end == 0 && !is_over_) {
      auto data = connection_.read(std::chrono::milliseconds(200));
      if (!data) return data.error();
      if (data->empty()) continue;
      if (auto good = connection_.ask_for_data(); !good) return good;
      if (auto good = take(*data); !good) return good;
    }
    return drive({});
  }

 private:
  player::Address drive_address() const { return {player::Interface::position2d, options_.drive}; }
  player::Address laser_address() const { return {player::Interface::laser, options_.laser}; }

  base::Result<void> prepare() {
    constexpr std::uint8_t get_geometry = 1, motor_power = 2;
    for (const auto& device : {drive_address(), laser_address()}) {
      if (auto good = connection_.subscribe(device); !good) return good;
    }
    // Drives without such a switch reject it and drive nevertheless.
    static_cast<void>(connection_.request(drive_address(), motor_power, player::encode_u32(1)));
    const auto geometry = connection_.request(laser_address(), get_geometry);
    if (!geometry) return geometry.error();
    player::XdrReader in(*geometry);
    const player::Pose3d mount = player::take_pose3d(in);
    if (!in.good()) return base::Error{player::to_text(laser_address()) + " does not report where it is mounted"};
    mount_ = {mount.x, mount.y, mount.yaw};
    return {};
  }

  base::Result<void> take(const std::vector<player::Message>& data) {
    for (const player::Message& message : data) {
      if (message.header.address != drive_address() || message.header.subtype != 1) continue;
      if (const auto state = player::decode_position2d_state(message.payload)) odometry_ = {state->pose.x, state->pose.y, state->pose.a};
    }
    for (const player::Message& message : data) {
      if (message.header.address != laser_address() || message.header.subtype != 1) continue;
      const auto scan = player::decode_laser_scan(message.payload);
      if (!scan) return base::Error{player::to_text(laser_address()) + " sends a scan that can't be read"};
      if (auto good = steer(*scan, message.header.timestamp); !good) return good;
    }
    return {};
  }

  base::Result<void> steer(const player::LaserScan& scan, double time) {
    constexpr double lost_timeout = 0.8;  // [s] without the leader before the robot stops
    if (!began_) began_ = time;
    is_over_ = options_.duration > 0 && time - *began_ >= options_.duration;
    const follow::Scan beams{scan.min_angle, scan.resolution, scan.max_range, scan.ranges};
    const auto leader = tracker_.update(beams, mount_, odometry_, time);
    if (leader) {
      if (!is_following_)
        say(fmt::format("leader at {}, {:.0f} degrees", metres(leader->distance),
                        std::round(leader->bearing * 180 / std::numbers::pi) + 0.0));
      is_following_ = true;
      const auto around = follow::around(beams, *leader, options_.steering);
      return drive(around ? *around : follow::towards(*leader, options_.steering));
    }
    if (is_following_ && tracker_.unseen(time).value_or(lost_timeout) < lost_timeout) return {};  // the last command stays
    if (is_following_) say("leader lost");
    is_following_ = false;
    return drive({});
  }

  base::Result<void> drive(const follow::Velocity& velocity) {
    return connection_.command(drive_address(), 1, player::encode(player::Velocity2d{{velocity.forward, 0, velocity.turn}, true}));
  }

  PlayerConnection connection_;
  const Options& options_;
  follow::TrackerSettings tracker_settings_;
  follow::LeaderTracker tracker_;
  follow::Pose mount_, odometry_;
  std::optional<double> began_;
  bool is_following_ = false, is_over_ = false;
};

int run(const Options& options) {
  using Clock = std::chrono::steady_clock;
  const auto wait_ends = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options.wait));
  bool was_there = false;
  std::string complaint;
  while (is_told_to_end == 0) {
    std::optional<base::Error> error;
    const auto socket = PlayerConnection::connect(options.host, options.port);
    const bool may_come = !socket && !was_there && Clock::now() < wait_ends;
    if (!socket) {
      error = socket.error();
    } else if (auto connection = PlayerConnection::open(*socket, options.host, options.port, options.key)) {
      if (!was_there) say("connected to " + options.host + ":" + std::to_string(options.port));
      was_there = true;
      const auto done = Follower(std::move(*connection), options).run();
      if (done) return 0;
      error = done.error();
    } else {
      error = connection.error();
    }
    if (is_told_to_end != 0) return 0;
    if (!was_there && !may_come) {
      std::cerr << "follow: " << error->message << '\n';
      return 1;
    }
    if (may_come) {
      if (error->message != complaint) say(fmt::format("waiting for up to {} s: {}", base::format_number(options.wait), error->message));
      complaint = error->message;
      ::usleep(100'000);
      continue;
    }
    // The server may come back, and the robot has been stopped meanwhile.
    if (error->message != complaint) base::log(base::Level::warn, "follow", "{}; trying again", error->message);
    complaint = error->message;
    ::usleep(500'000);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  base::Command app{
      "follow: a client of Player that drives a robot after another one\nThe leader is the thing of fitting width nearest ahead when it "
      "starts; from then on it is "
      "known by where it was before."};
  base::add_standard_options(app, "follow", RTMSIM_VERSION);
  Options options;
  app.add_option("--host", options.host, "Host of player-gateway, or of another Player server")->capture_default_str();
  app.add_option("-p,--port", options.port, "Port of this robot")->check(base::integer_between(1, 65535))->capture_default_str();
  app.add_option("--position2d", options.drive, "Index of the drive")->check(base::integer_between(0, 65535))->capture_default_str();
  app.add_option("--laser", options.laser, "Index of the scanner")->check(base::integer_between(0, 65535))->capture_default_str();
  app.add_option("--distance", options.steering.distance, "Distance to the leader [m]")
      ->check(base::number_between(0.4, 10))
      ->capture_default_str();
  app.add_option("--max-speed", options.steering.max_speed, "Maximum speed [m/s]")
      ->check(base::number_between(0, 10))
      ->capture_default_str();
  app.add_option("--wait", options.wait, "Timeout for the connection [s]")->check(base::number_between(0, 1e6))->capture_default_str();
  app.add_option("--auth", options.key, "Key of the server (player-gateway --auth)")->envname("RTMSIM_PLAYER_AUTH");
  app.add_option("--duration", options.duration, "Stop after N seconds of the server's time; 0: never")
      ->check(base::number_between(0, 1e9))
      ->capture_default_str();
  if (const auto end = base::parse_command_line(app, "follow", argc, argv)) return *end;
  struct sigaction action {};
  action.sa_handler = [](int) { is_told_to_end = 1; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  return run(options);
}
