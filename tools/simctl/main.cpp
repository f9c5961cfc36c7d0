// simctl: shows and controls a running simulation. See --help.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>

#include "base/command_line.h"
#include "base/name_list.h"
#include "base/output_name.h"
#include "base/terminal.h"
#include "base/text.h"
#include "shm/control.h"
#include "shm/fault_kinds.h"
#include "simctl/offers.h"
#include "simctl/simctl.h"

namespace {

using simctl::Control;
using Work = std::function<void(Control&)>;

template <class T>
std::shared_ptr<T> option_value(T value = {}) {
  return std::make_shared<T>(std::move(value));
}

void add_simple(base::Command& app, Work& work, const char* name, const char* help, Work what) {
  app.add_subcommand(name, help)->callback([&work, what] { work = what; });
}

void add_looks(base::Command& app, Work& work) {
  auto* list = app.add_subcommand("list", "List the ifaces of the simulator");
  auto all = option_value(false);
  list->add_flag("-a,--all", *all, "List the ifaces of all simulators");
  list->callback([&work, all] { work = [all](Control& c) { simctl::list(c, *all); }; });

  const auto with_name = [&](const char* command, const char* help, void (*function)(Control&, const std::string&)) {
    auto* sub = app.add_subcommand(command, help);
    auto name = option_value<std::string>();
    sub->add_option("IFACE", *name, "NAME, or TYPE:NAME")->required();
    sub->callback([&work, name, function] { work = [name, function](Control& c) { function(c, *name); }; });
  };
  with_name("info", "Show the constants of an iface", simctl::info);
  with_name("dump", "Show the layout of an iface's shared memory", simctl::dump);

  auto* echo = app.add_subcommand("echo", "Print the samples of an iface; draw scans on a terminal");
  auto name = option_value<std::string>();
  auto count = option_value(0);
  echo->add_option("IFACE", *name, "NAME, or TYPE:NAME")->required();
  echo->add_option("-n,--count", *count, "Stop after N samples (default: until interrupted)")->check(base::number_between(0, 1e9));
  echo->callback([&work, name, count] { work = [name, count](Control& c) { simctl::echo(c, *name, *count); }; });

  add_simple(app, work, "stats", "Show time, real-time factor, state hash and use of processor time", simctl::stats);
  add_simple(app, work, "participants", "List the participants of the lock step", simctl::participants);

  auto* tree = app.add_subcommand("tree", "Show models, links, joints and sensors");
  auto model = option_value<std::string>();
  tree->add_option("MODEL", *model, "Show this model only");
  tree->callback([&work, model] { work = [model](Control& c) { simctl::tree(c, *model); }; });

  auto* wait = app.add_subcommand("wait", "Wait until the simulator runs");
  auto wait_names = option_value<std::vector<std::string>>();
  auto timeout = option_value(30.0);
  wait->add_option("IFACE", *wait_names, "Wait for these ifaces, too: NAME, or TYPE:NAME");
  wait->add_option("--timeout", *timeout, "Timeout [s]")->capture_default_str()->check(base::number_between(0.0, 1e6));
  wait->callback([&work, wait_names, timeout] { work = [=](Control& c) { simctl::wait(c, *wait_names, *timeout); }; });

  add_simple(app, work, "models", "List the models of the model path, which spawn accepts as model://NAME", simctl::models);

  auto* clean = app.add_subcommand("clean", "Remove shared memory left by crashed simulators; with -s: of this simulator only");
  clean->callback([&app, &work] {
    const bool is_named = app.option("--server-id")->count() > 0;
    work = [is_named](Control& c) { simctl::clean(c, is_named); };
  });
}

void add_control(base::Command& app, Work& work) {
  add_simple(app, work, "pause", "Stop simulated time", [](Control& c) { c.ask(shm::PauseRequest{}); });
  add_simple(app, work, "run", "Continue simulated time", [](Control& c) { c.ask(shm::RunRequest{}); });
  auto* reset = app.add_subcommand("reset", "Reset the world and the clock");
  auto poses_only = option_value(false);
  auto* poses = reset->add_flag("--poses", *poses_only, "Reset the poses and velocities of all models only; time continues");
  auto seed = option_value<std::optional<std::uint64_t>>();
  reset->add_option("--seed", *seed, "New seed of all sensor noise (default: unchanged)")
      ->excludes(poses)
      ->check([](const std::string& text) {
        return text.starts_with("-") ? "expected a whole number that is not negative, got " + text : std::string();
      });
  reset->callback([&work, poses_only, seed] { work = [poses_only, seed](Control& c) { c.ask(shm::ResetRequest{*poses_only, *seed}); }; });

  auto* rtf = app.add_subcommand("rtf", "Set the real-time factor");
  auto factor = option_value(1.0);
  rtf->add_option("FACTOR", *factor, "Simulated seconds per wall-clock second; 0: as fast as possible")
      ->required()
      ->check(base::number_between(0.0, 1e6));
  rtf->callback([&work, factor] { work = [factor](Control& c) { c.ask(shm::SetRtfRequest{*factor}); }; });

  auto* step = app.add_subcommand("step", "Run N physics steps, then pause; returns when they are done");
  auto steps = option_value<std::int64_t>(1);
  step->add_option("N", *steps, "Number of steps")->check(base::integer_between(1, 1000000000))->capture_default_str();
  auto* paced = step->add_flag("--paced")->description("Keep the simulator's real-time factor (default: as fast as possible)");
  step->callback([&work, steps, paced] { work = [steps, paced](Control& c) { simctl::step(c, *steps, paced->count() > 0); }; });

  auto* pose = app.add_subcommand("pose", "Show or set the pose of a model: pose MODEL [X Y [Z] YAW]");
  auto model = option_value<std::string>();
  auto values = option_value<std::vector<double>>();
  pose->add_option("MODEL", *model, "Model, or MODEL::LINK to show")->required();
  pose->add_option("NUMBERS", *values, "X Y YAW, X Y Z YAW, or X Y Z ROLL PITCH YAW [m, rad]")->expected(0, 6);
  pose->callback([&work, model, values] {
    if (values->size() == 1 || values->size() == 2 || values->size() == 5)
      base::reject_command_line("pose", "expected X Y YAW, X Y Z YAW or X Y Z ROLL PITCH YAW");
    work = [model, values](Control& c) { simctl::pose(c, *model, *values); };
  });

  auto* velocity = app.add_subcommand(
      "velocity",
      "Drive a robot while this command runs: velocity IFACE VX VY VA; show or set the velocity of a model: velocity MODEL [VX VY VA]");
  auto robot = option_value<std::string>();
  auto speeds = option_value<std::vector<double>>();
  auto seconds = option_value(0.0);
  velocity->add_option("IFACE", *robot, "position2d or position3d iface, or model (MODEL::LINK to show)")->required();
  velocity
      ->add_option("NUMBERS", *speeds,
                   "VX VY VA [m/s, rad/s]; position3d: VX VY VZ YAWRATE; model: VX VY VA or VX VY VZ WX WY WZ in the world")
      ->expected(0, 6);
  velocity->add_option("--for", *seconds, "Duration [simulated s] (default: until interrupted)")->check(base::number_between(0.0, 1e9));
  velocity->callback([&work, robot, speeds, seconds] {
    if (const auto n = speeds->size(); n == 1 || n == 2 || n == 5)
      base::reject_command_line("velocity", "expected 3, 4 or 6 numbers, got " + std::to_string(n));
    work = [=](Control& c) {
      if (simctl::is_position_iface(c.server_id(), *robot)) return simctl::velocity(c, *robot, *speeds, *seconds);
      if (*seconds > 0)
        return c.reject("velocity " + base::in_quotes(*robot) + ": is no position2d or position3d iface, --for goes with these");
      simctl::model_velocity(c, *robot, *speeds);
    };
  });

  auto* joints = app.add_subcommand("joints", "Show the joints of a model, or move them: joints MODEL [JOINT=VALUE ...]");
  auto joint_options = option_value<simctl::JointOptions>();
  joints->add_option("MODEL", joint_options->model, "Model with joints that no drive turns")->required();
  joints->add_option("JOINT", joint_options->settings,
                     "JOINT=VALUE [rad, m; rad/s, m/s; N m, N], all=VALUE; JOINT or all with free and brake");
  joints->add_option("--mode", joint_options->mode, "Meaning of VALUE: position, velocity or effort; or free, brake")
      ->check(base::one_of({"position", "velocity", "effort", "free", "brake"}))
      ->capture_default_str();
  joints->add_flag("--compensate", joint_options->is_compensated, "Add the effort that gravity needs");
  joints
      ->add_option("--for", joint_options->seconds,
                   "Duration [simulated s] (default: until the positions are reached, else until interrupted)")
      ->check(base::number_between(0.0, 1e9));
  joints->callback([&work, joint_options] { work = [joint_options](Control& c) { simctl::joints(c, *joint_options); }; });

  auto* wrench = app.add_subcommand("wrench", "Push a model: wrench MODEL FX FY FZ [TX TY TZ]");
  auto pushed = option_value<std::string>();
  auto forces = option_value<std::vector<double>>();
  auto duration = option_value(0.0);
  wrench->add_option("MODEL", *pushed, "Model or MODEL::LINK; the force acts at its centre of mass")->required();
  wrench->add_option("NUMBERS", *forces, "FX FY FZ [N], TX TY TZ [N m], in the world; with --joint: one, N m or N")->expected(0, 6);
  auto pushed_joint = option_value<std::string>();
  wrench->add_option("--joint", *pushed_joint, "Push this joint of MODEL, beside what its motor does");
  auto* for_time =
      wrench->add_option("--for", *duration, "Duration [simulated s] (default: one step)")->check(base::number_between(0.0, 1e6));
  auto* stays = wrench->add_flag("--persistent")->description("Push until --clear, another --persistent or a reset")->excludes(for_time);
  auto* clear =
      wrench->add_flag("--clear")->description("End the persistent wrenches of the link or joint")->excludes(for_time)->excludes(stays);
  wrench->callback([&work, pushed, pushed_joint, forces, duration, stays, clear] {
    const bool is_joint = !pushed_joint->empty();
    if (clear->count() > 0 && !forces->empty()) base::reject_command_line("wrench", "--clear takes no numbers");
    if (clear->count() > 0) forces->assign(is_joint ? 1 : 3, 0);
    if (clear->count() > 0 || stays->count() > 0) *duration = shm::WrenchRequest::until_the_next;
    const bool is_right = is_joint ? forces->size() == 1 : forces->size() == 3 || forces->size() == 6;
    if (!is_right)
      base::reject_command_line("wrench", std::string("expected ") + (is_joint ? "one number" : "FX FY FZ or FX FY FZ TX TY TZ") +
                                              ", got " + std::to_string(forces->size()) + " numbers");
    work = [=](Control& c) { simctl::wrench(c, {*pushed, *pushed_joint}, *forces, *duration); };
  });

  auto* odometry = app.add_subcommand("odometry", "Set the odometry of a robot: odometry IFACE [X Y A]");
  auto counted = option_value<std::string>();
  auto origin = option_value<std::vector<double>>();
  odometry->add_option("IFACE", *counted, "position2d or position3d iface")->required();
  odometry->add_option("NUMBERS", *origin, "X Y A [m, rad] (default: 0 0 0)")->expected(0, 3);
  odometry->callback([&work, counted, origin] {
    if (origin->size() == 1 || origin->size() == 2) base::reject_command_line("odometry", "expected X Y A or nothing");
    work = [=](Control& c) { simctl::reset_odometry(c, *counted, *origin); };
  });

  auto* motors = app.add_subcommand("motors", "Switch the motors of a robot on or off: motors IFACE on|off");
  auto driven = option_value<std::string>();
  auto how = option_value<std::string>();
  motors->add_option("IFACE", *driven, "position2d or position3d iface")->required();
  motors->add_option("HOW", *how, "on or off")->required()->check(base::one_of({"on", "off"}));
  motors->callback([&work, driven, how] { work = [=](Control& c) { c.ask(shm::SetMotorsRequest{*driven, *how == "on"}); }; });

  auto* tag =
      app.add_subcommand("tag", "Write the data of an RFID tag that a reader has in its reach, until a reset; echo IFACE shows them");
  auto written = option_value<shm::WriteTagRequest>();
  tag->add_option("IFACE", written->iface, "rfid iface: the reader")->required();
  tag->add_option("TAG", written->id, "ID of the tag")->required();
  tag->add_option("DATA", written->data, "New data: at most 127 bytes, without line breaks")->required();
  tag->callback([&work, written] { work = [written](Control& c) { c.ask(*written); }; });

  auto* attach = app.add_subcommand("attach", "Attach what a gripper or a detachable joint holds; without NAME show all: attach [NAME]");
  auto held = option_value<std::string>();
  attach->add_option("NAME", *held, "MODEL::GRIPPER, or MODEL::CHILD_MODEL of a detachable joint");
  attach->callback([&work, held] { work = [=](Control& c) { simctl::attach(c, *held, true); }; });

  auto* detach = app.add_subcommand("detach", "Detach what a gripper or a detachable joint holds");
  auto released = option_value<std::string>();
  detach->add_option("NAME", *released, "MODEL::GRIPPER, or MODEL::CHILD_MODEL of a detachable joint")->required();
  detach->callback([&work, released] { work = [=](Control& c) { simctl::attach(c, *released, false); }; });

  auto* spawn = app.add_subcommand("spawn", "Add a model");
  auto options = option_value<simctl::SpawnOptions>();
  spawn->add_option("FILE", options->file, "SDF file, model folder, model://NAME, deleted://NAME (a deleted model as it was), or SDF text")
      ->required();
  spawn->add_option("--name", options->name, "Name of the model (default: the name in the file, with a number if it is taken)");
  spawn->add_option("--pose", options->pose, "X Y YAW, X Y Z YAW, or X Y Z ROLL PITCH YAW [m, rad], as separate words or one")
      ->expected(1, 6)
      ->delimiter(' ');
  spawn->add_option("--for", options->list, "NAME=LIST: a model for each value, with {NAME} in FILE and --name filled in: robot=r0..r99")
      ->type_name("NAME=LIST")
      ->check([](const std::string& text) {
        const auto list = base::NameList::parse(text);
        return list ? std::string() : list.error().message.substr(std::string_view("--for ").size());
      });
  spawn->add_option("--spacing", options->spacing, "With --for: distance of the models in a square grid from --pose on [m]")
      ->capture_default_str()
      ->check(base::number_between(0.0, 1e6))
      ->needs("--for");
  spawn->add_option("--joint", options->joints, "Start a joint at a position: JOINT=POSITION [rad, m]; can be repeated")->take_all();
  spawn->add_option("--gains", options->gains,
                    "Take the gains of joint controllers from a YAML file of ros_control or ros2_control, before those of the model");
  spawn->callback([&work, options] {
    if (const auto n = options->pose.size(); n == 1 || n == 2 || n == 5 || n > 6) {
      base::reject_command_line("--pose",
                                "expected X Y YAW, X Y Z YAW or X Y Z ROLL PITCH YAW [m, rad], got " + std::to_string(n) + " numbers");
    }
    work = [options](Control& c) { simctl::spawn(c, *options); };
  });

  auto* remove = app.add_subcommand("delete", "Delete a model");
  auto gone = option_value<std::string>();
  remove->add_option("MODEL", *gone)->required();
  remove->callback([&work, gone] { work = [gone](Control& c) { c.ask(shm::DeleteRequest{*gone}); }; });

  auto* drop = app.add_subcommand("drop", "Remove a hanging participant from the lock step");
  auto participant = option_value<std::string>();
  drop->add_option("NAME", *participant, "Name of the participant, as listed by 'participants'")->required();
  drop->callback([&work, participant] { work = [participant](Control& c) { c.ask(shm::DropParticipantRequest{*participant}); }; });

  auto* contacts = app.add_subcommand("contacts", "List the models that a model touches");
  auto touched = option_value<std::string>();
  contacts->add_option("MODEL", *touched)->required();
  contacts->callback([&work, touched] { work = [touched](Control& c) { simctl::contacts(c, *touched); }; });
}

std::string meanings_of_faults() {
  std::string text;
  for (const auto& row : shm::fault_rows) {
    text += (text.empty() ? "" : "; ") + std::string(row.name) + ": " + std::string(row.meaning);
    if (row.amount) text += " (" + base::format_number(*row.amount) + ")";
  }
  return text;
}

void add_fault(base::Command& app, Work& work) {
  auto* fault = app.add_subcommand(
      "fault", "Inject a fault into a sensor, drive or joint, list active faults, or end them: fault [IFACE [KIND [AMOUNT]]] [--end]");
  auto options = option_value<simctl::FaultOptions>();
  auto amount = option_value<std::string>();
  std::vector<std::string> kinds;
  for (const auto& row : shm::fault_rows) kinds.emplace_back(row.name);
  fault->add_option("IFACE", options->iface, "Iface of a sensor, drive or joints, or IFACE::JOINT");
  fault->add_option("KIND", options->kind, meanings_of_faults())->check(base::one_of(std::move(kinds)));
  fault->add_option("AMOUNT", *amount, "Strength of the fault (default: the number in brackets)");
  auto* seconds = fault->add_option("--for", options->seconds, "Duration [simulated s] (default: until --end or reset)")
                      ->check(base::number_between(1e-9, 1e9));
  auto* end = fault->add_flag("--end", options->ends, "End the faults of this IFACE and KIND (default: all)");
  end->excludes(seconds);
  fault->callback([&work, options, amount] {
    if (!amount->empty()) {
      options->amount = base::parse_number(*amount);
      if (!options->amount) base::reject_command_line("AMOUNT", "expected a number, got " + base::in_quotes(*amount));
      if (options->ends) base::reject_command_line("--end", "takes no AMOUNT");
    }
    if (options->seconds > 0 && options->kind.empty()) base::reject_command_line("--for", "goes with IFACE KIND");
    if (!options->kind.empty()) {
      const auto row = shm::check_fault(options->kind, options->amount);
      if (!row) base::reject_command_line("AMOUNT", row.error().message);
      if (options->amount && !(*row)->amount)
        base::reject_command_line("AMOUNT", "fault " + base::in_quotes(options->kind) + " takes no AMOUNT");
    }
    work = [options](Control& c) { simctl::fault(c, *options); };
  });
}

void reject_unless_finite(const std::string& option, const std::vector<double>& numbers) {
  if (!std::all_of(numbers.begin(), numbers.end(), [](double v) { return std::isfinite(v); }))
    base::reject_command_line(option, "expected finite numbers");
}

void add_map(base::Command& app, Work& work) {
  auto* map = app.add_subcommand("map", "Write an occupancy map of the world: FILE.png and FILE.yaml, as map_server reads them");
  auto options = option_value<simctl::MapOptions>();
  map->add_option("FILE", options->file, "PNG file; the YAML file is written beside it")->required()->check([](const std::string& file) {
    return base::to_lower(std::filesystem::path(file).extension().string()) == ".png"
               ? std::string()
               : "maps are PNG; expected a name that ends in .png, got " + base::in_quotes(file);
  });
  map->add_option("--resolution", options->resolution, "Side of a cell [m]")->check(base::number_between(1e-3, 100))->capture_default_str();
  auto* heights =
      map->add_option("--heights", options->heights, "A cell is occupied by what is between LOW and HIGH [m] (default: 0.05 0.5)")
          ->expected(1, 2)
          ->delimiter(' ');
  auto* area = map->add_option("--area", options->area, "XMIN YMIN XMAX YMAX [m] (default: where something is occupied, and 0.5 m around)")
                   ->expected(1, 4)
                   ->delimiter(' ');
  map->add_flag("--all", options->with_movable, "Include models that can move (default: static models only)");
  map->callback([&work, options, heights, area] {
    reject_unless_finite("--heights", options->heights);
    reject_unless_finite("--area", options->area);
    if (heights->count() > 0 && (options->heights.size() != 2 || options->heights[0] >= options->heights[1]))
      base::reject_command_line("--heights", "expected LOW HIGH [m], the lower one first");
    if (area->count() > 0 && (options->area.size() != 4 || options->area[0] >= options->area[2] || options->area[1] >= options->area[3]))
      base::reject_command_line("--area", "expected XMIN YMIN XMAX YMAX [m], the lower left corner first");
    work = [options](Control& c) { simctl::map(c, *options); };
  });
}

void add_pictures(base::Command& app, Work& work) {
  auto* screenshot = app.add_subcommand("screenshot", "Save an image of the world (PNG)");
  auto options = option_value<simctl::ScreenshotOptions>();
  screenshot->add_option("FILE", options->file, "PNG file")->required()->check([](const std::string& file) {
    return shm::picture_name_problem(file);
  });
  auto* from = screenshot->add_option("--from", options->from, "Pose of the camera, X Y Z ROLL PITCH YAW [m, rad], as six words or one")
                   ->expected(1, 6)
                   ->delimiter(' ');
  auto* follow = screenshot->add_option("--follow", options->follow, "View from behind this model");
  auto* top = screenshot->add_flag("--top", options->from_top, "View from above");
  auto* camera = screenshot->add_option("--camera", options->camera, "View of this camera of the world");
  for (auto* one : {from, follow, top, camera}) {
    for (auto* other : {from, follow, top, camera}) {
      if (one != other) one->excludes(other);
    }
  }
  screenshot->add_option("--size", options->size, "Size, WIDTHxHEIGHT [pixels]")->capture_default_str();
  screenshot->add_flag("--scans", options->with_scans, "Also draw laser scans, trails and names");
  screenshot->add_option("--show")
      ->description("Shapes to draw: visuals or collisions (default visuals)")
      ->check(base::one_of({"visuals", "collisions"}))
      ->each([options](const std::string& what) { options->with_collisions = what == "collisions"; });
  auto* span = screenshot->add_option("--span", options->span, "Width of the view [m] (--top), or field of view [rad] (--from, --follow)")
                   ->check(base::number_between(1e-3, 1e6));
  span->excludes(camera);
  auto* at = screenshot->add_option("--at", options->at, "With --top and --span: centre of the view, X Y [m] (default: 0 0)")
                 ->expected(1, 2)
                 ->delimiter(' ');
  screenshot->callback([&work, options, from, top, follow, span, at] {
    if (span->count() > 0 && from->count() + top->count() + follow->count() == 0)
      base::reject_command_line("--span", "goes with --top, --from or --follow");
    if (at->count() > 0 && (top->count() == 0 || span->count() == 0)) base::reject_command_line("--at", "goes with --top and --span");
    reject_unless_finite("--from", options->from);
    reject_unless_finite("--at", options->at);
    if (at->count() > 0 && options->at.size() != 2)
      base::reject_command_line("--at", "expected 2 numbers, X Y [m], got " + std::to_string(options->at.size()));
    if (!simctl::parse_size(options->size)) base::reject_command_line("--size", "expected WIDTHxHEIGHT, each from 1 to 8192");
    if (from->count() > 0 && options->from.size() != 6) {
      base::reject_command_line("--from", "expected 6 numbers, X Y Z ROLL PITCH YAW [m, rad], got " + std::to_string(options->from.size()));
    }
    work = [options](Control& c) { simctl::screenshot(c, *options); };
  });

  auto* exported = app.add_subcommand("export", "Write the world as glTF 2.0 binary: models, links, lights, sensors");
  auto world_file = option_value<std::string>();
  auto show = option_value<std::string>("visuals");
  exported->add_option("FILE", *world_file, "Output file, ends in .glb")->required()->check([](const std::string& file) {
    return base::to_lower(std::filesystem::path(file).extension().string()) == ".glb"
               ? std::string()
               : "worlds are glTF binaries; expected a name that ends in .glb, got " + base::in_quotes(file);
  });
  exported->add_option("--show", *show, "Shapes to export: visuals or collisions")
      ->check(base::one_of({"visuals", "collisions"}))
      ->capture_default_str();
  exported->callback([&work, world_file, show] {
    work = [world_file, show](Control& c) { simctl::export_world(c, *world_file, *show == "collisions"); };
  });

  add_map(app, work);

  auto* record = app.add_subcommand("record", "Record a camera as video (.mp4) or as PNG files in a folder");
  auto camera_name = option_value<std::string>();
  auto target = option_value<std::string>();
  auto frames = option_value(0);
  auto seconds = option_value(0.0);
  record->add_option("CAMERA", *camera_name, "Iface of a camera")->required();
  record->add_option("TARGET", *target, "Output: FILE.mp4, or a folder for PNG files")->required()->check(base::output_name());
  record->add_option("-n,--count", *frames, "Stop after N frames (default: until interrupted)")->check(base::number_between(0, 1e9));
  record->add_option("--for", *seconds, "Stop after this time [simulated s] (default: until interrupted)")
      ->check(base::number_between(0.0, 1e9));
  record->callback([&work, camera_name, target, frames, seconds] {
    work = [=](Control& c) { simctl::record(c, *camera_name, *target, *frames, *seconds); };
  });
}

}  // namespace

int main(int argc, char** argv) {
  base::Command app{"simctl: show and control a running simulator"};
  base::add_standard_options(app, "simctl", RTMSIM_VERSION);
  app.require_subcommand(1);
  app.fallthrough();
  std::uint32_t server_id = 0;
  bool json = false;
  app.add_option("-s,--server-id", server_id, "Simulator ID")
      ->check(base::integer_between(0, 9999))
      ->envname("RTMSIM_SERVER_ID")
      ->capture_default_str();
  app.add_flag("--json", json, "Print JSON");
  Work work;
  add_looks(app, work);
  add_control(app, work);
  add_fault(app, work);
  add_pictures(app, work);
  app.group_subcommands("Look", {"list", "info", "dump", "echo", "stats", "participants", "tree", "models", "contacts", "wait"})
      ->group_subcommands("Time", {"pause", "run", "step", "rtf", "reset", "drop"})
      ->group_subcommands("Robots and models", {"pose", "velocity", "joints", "wrench", "odometry", "motors", "fault", "tag", "attach",
                                                "detach", "spawn", "delete"})
      ->group_subcommands("Record", {"screenshot", "record", "export", "map"})
      ->group_subcommands("Clean up", {"clean"});
  const base::TerminalGuard output(std::cout, STDOUT_FILENO), errors(std::cerr, STDERR_FILENO);  // a world names what it likes
  if (const auto end = base::parse_command_line(app, "simctl", argc, argv, simctl::offers)) return *end;
  Control server(server_id, json);
  work(server);
  return server.exit_code();
}
