// The constant description of a world: plain values that physics, rays, render and devices are built from. Every name is resolved, every
// pose is relative to what its name says, every file is an absolute path that existed when the world was loaded, every number is finite and
// within its bounds (the loader rejects or corrects other values, with a line each). Lengths in m, angles in rad, masses in kg, times in s,
// unless a comment says otherwise. Values: any thread may read a shared one.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "world/model_path.h"
#include "world/plugin_def.h"
#include "world/sensor_def.h"

namespace sim {

inline constexpr double infinite = std::numeric_limits<double>::infinity();

// Components 0..1.
struct Color {
  float r = 1, g = 1, b = 1, a = 1;
  bool operator==(const Color&) const = default;
};

// --- shapes

struct BoxShape {
  Eigen::Vector3d size{1, 1, 1};
};
struct SphereShape {
  double radius = 1;
};
// Along z, centred.
struct CylinderShape {
  double radius = 1;
  double length = 1;
};
// Along z, centred; `length` is that of the cylindrical part.
struct CapsuleShape {
  double radius = 1;
  double length = 1;
};
// Along z, centred, the tip above.
struct ConeShape {
  double radius = 0.5;
  double length = 1;
};
struct EllipsoidShape {
  Eigen::Vector3d radii{1, 1, 1};
};
// Infinite for collisions; `size` is what is drawn. The normal is a unit vector.
struct PlaneShape {
  Eigen::Vector3d normal{0, 0, 1};
  Eigen::Vector2d size{1, 1};
};
struct MeshShape {
  std::string path;
  std::string submesh;  // empty: all of them
  bool center_submesh = false;
  Eigen::Vector3d scale{1, 1, 1};  // no component is zero; may mirror
  std::uint64_t version = 0;       // of the file; 0: as it is when it is read first
};
struct HeightmapTexture {
  double size = 10;
  std::string diffuse;  // path or empty
  std::string normal;
};
struct HeightmapShape {
  std::string path;  // grey image (png, jpg, ...) or elevation file; the middle of the map stands at `position`
  Eigen::Vector3d size{1, 1, 1};
  Eigen::Vector3d position{0, 0, 0};
  int sampling = 1;
  std::vector<HeightmapTexture> textures;
  std::vector<std::pair<double, double>> blends;  // minimum height, fade distance; one less than textures
};
// A prism: closed outlines in the x-y plane (the outer one first; the others are holes by the even-odd rule), from z = 0 to `height`.
struct PolylineShape {
  std::vector<std::vector<Eigen::Vector2d>> outlines;
  double height = 1;
};
using GeometryDef = std::variant<BoxShape, SphereShape, CylinderShape, CapsuleShape, EllipsoidShape, PlaneShape, MeshShape, HeightmapShape,
                                 PolylineShape, ConeShape>;

// Word for messages: "box", "mesh", ...
std::string_view kind_of(const GeometryDef& geometry);

// Volume [m^3] and principal moments about the middle for a density of 1 [m^5].
struct SolidProperties {
  double volume = 0;
  Eigen::Vector3d moments{0, 0, 0};
};
// Empty for shapes without a volume that is known here (planes, meshes, height maps, polylines).
std::optional<SolidProperties> solid_properties(const GeometryDef& geometry);

// --- links

struct SurfaceDef {
  double mu = 1;                                      // along friction_direction (or the first tangent); infinite allowed
  double mu2 = 1;                                     // across it
  std::optional<Eigen::Vector3d> friction_direction;  // in the collision's frame, or in that of friction_link
  std::string friction_link;                          // of the model, whose frame the direction turns with; empty: the collision
  double slip1 = 0, slip2 = 0;
  double torsional_mu = 0;
  double restitution = 0;
  double bounce_threshold = 100000;  // [m/s]
  std::optional<double> kp;          // contact stiffness [N/m]; empty: the solver's own erp/cfm
  std::optional<double> kd;          // contact damping [N s/m]
  double max_vel = 0.01;             // correction speed [m/s]
  double min_depth = 0;
  double soft_cfm = 0, soft_erp = 0.2;
  bool collide_without_contact = false;  // reported to contact sensors, no force
  std::uint16_t collide_bitmask = 0xffff;
  std::uint16_t category_bitmask = 0xffff;
};

struct CollisionDef {
  std::string name;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // in the link
  GeometryDef geometry = BoxShape{};
  SurfaceDef surface;
  double laser_retro = 0;
};

// Fully resolved: scripts and built-in Gazebo colours are already colours and texture paths.
// In place of the path of a mesh, height map or picture that was not found, and of which a line has told: pictures show a stand-in.
inline constexpr const char* missing_file = "missing:";
// In place of the path of a picture that Gazebo brings along: this, then its colour as #rrggbb.
inline constexpr const char* color_file = "color:";

struct MaterialDef {
  Color ambient{0.7F, 0.7F, 0.7F, 1};
  Color diffuse{0.7F, 0.7F, 0.7F, 1};
  Color specular{0, 0, 0, 1};
  Color emissive{0, 0, 0, 1};
  float shininess = 0;
  std::string texture;                  // colour (albedo) image, path or empty; modulates diffuse
  bool has_alpha_texture = true;        // the alpha of the texture counts
  std::string normal_map;               // path or empty
  std::string emissive_map;             // path or empty
  Eigen::Vector2d texture_scale{1, 1};  // how often the image repeats along u and v
  bool has_pbr = false;
  float metalness = 0, roughness = 0.5F;  // meaningful when has_pbr
  bool lighting = true;
  bool double_sided = false;
  std::string script;  // name it came from, for messages ("Gazebo/Grey"); empty when none
};

// How warm something is: one temperature, or a picture whose black is the lowest and white the highest one.
struct HeatDef {
  double lowest = 288.15, highest = 288.15;  // [K]
  std::string signature;                     // path of the picture or empty
};

struct VisualDef {
  std::string name;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // in the link
  GeometryDef geometry = BoxShape{};
  std::optional<MaterialDef> material;  // empty: the mesh's own, or MaterialDef{} for the other shapes
  double transparency = 0;              // 0..1
  bool cast_shadows = true;
  double laser_retro = 0;
  std::uint32_t visibility_flags = 0xffffffff;
  std::uint8_t label = 0;       // of segmentation; 0: none
  std::string labelled;         // who has the label, in the model: a nested model, link::visual, or empty for the model
  std::optional<HeatDef> heat;  // empty: as warm as the air
};

struct LightDef {
  enum class Kind { point, directional, spot };
  std::string name;
  Kind kind = Kind::point;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // in the world, or in the link that carries it
  Eigen::Vector3d direction{0, 0, -1};                     // in the light's frame; unit
  Color diffuse, specular{0.1F, 0.1F, 0.1F, 1};
  double intensity = 1;
  double range = 10;
  double constant_attenuation = 1, linear_attenuation = 1, quadratic_attenuation = 0;
  double inner_angle = 0, outer_angle = 0, falloff = 0;  // spot
  bool cast_shadows = false;
  bool is_on = true;
};

struct LinkDef {
  std::string name;                                        // unique in its model; links of nested models carry their scope: "arm::hand"
  std::string scope;                                       // nested model it stands in, as in PluginDef
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // in the model, at the start
  std::optional<Eigen::Isometry3d> start_pose;             // in the model, where a saved state has moved it away from `pose`
  Eigen::Vector3d start_linear{0, 0, 0}, start_angular{0, 0, 0};  // velocity at the start, in the world
  double mass = 1;                                                // positive
  Eigen::Vector3d center_of_mass{0, 0, 0};                        // in the link
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Identity();          // about the centre of mass, along the link's axes; positive definite
  // Of the fluid that goes along, positive; about the centre of mass, along the link's axes: linear, then angular.
  std::optional<Eigen::Matrix<double, 6, 6>> added_mass;
  bool gravity = true;
  bool kinematic = false;
  bool self_collide = false;
  bool enable_wind = false;
  double linear_damping = 0, angular_damping = 0;  // velocity decay
  std::vector<CollisionDef> collisions;
  std::vector<VisualDef> visuals;
  std::vector<SensorDef> sensors;
  std::vector<LightDef> lights;
};

// --- models

struct AxisDef {
  Eigen::Vector3d xyz{0, 0, 1};                // unit, in the joint's frame at the start
  double lower = -infinite, upper = infinite;  // rad or m
  double effort = infinite;                    // N m or N; largest the drive may use
  double velocity = infinite;                  // rad/s or m/s
  double damping = 0;                          // N m s/rad or N s/m
  double initial_position = 0;                 // rad or m; the places of the links are those for 0
  double friction = 0;                         // N m or N
  double rotor_inertia = 0;                    // kg m^2 or kg: of the motor, as the joint feels it through its gear
  double spring_reference = 0, spring_stiffness = 0;
  std::optional<double> limit_stiffness, limit_dissipation;  // soft stops
};

// A joint that follows another one: position = multiplier * (position of the leader - reference) + offset.
struct MimicDef {
  std::string leader;  // a joint's name in the model
  double multiplier = 1, offset = 0, reference = 0;
};

struct JointDef {
  enum class Kind { fixed, revolute, continuous, prismatic, ball, universal, revolute2, screw, gearbox };
  std::string name;  // unique in its model; scoped like link names
  std::string scope;
  Kind kind = Kind::fixed;
  std::string parent;  // a link's name in the model; empty: the world
  std::string child;   // a link's name in the model; empty: the world
  Eigen::Isometry3d pose_in_child =
      Eigen::Isometry3d::Identity();  // joint frame in the child link (in the world when child is empty: see pose_in_model)
  Eigen::Isometry3d pose_in_model = Eigen::Isometry3d::Identity();  // the same frame in the model, at the start
  std::optional<MimicDef> mimic;                                    // of a joint with one axis, which the leader has as well
  std::vector<AxisDef> axes;  // revolute, continuous, prismatic, screw: 1; universal, revolute2, gearbox: 2; fixed, ball: 0
  double thread_pitch = 0;    // screw: metres of travel along the axis per turn, right-handed positive
  double gearbox_ratio = 1;
  std::string gearbox_reference;                                                       // a link's name in the model
  std::optional<double> cfm, erp, suspension_cfm, suspension_erp, stop_cfm, stop_erp;  // of <physics><ode>
  bool provide_feedback = false;
  std::vector<SensorDef> sensors;  // force_torque; the pose is in the joint's frame
};
std::string_view to_text(JointDef::Kind kind);

// A <gripper>: which links hold something, and how long they must touch it before it is fixed to the palm, where that is asked for. All
// links exist.
struct GripperDef {
  std::string name;                  // in nested models with their scope: "arm::hand"
  std::string palm;                  // that what is held is fixed to; the first finger where the file names none
  std::vector<std::string> fingers;  // never empty; may have the palm among them
  int attach_checks = 20;            // in a row with contacts
  int detach_checks = 40;            // in a row without
  int contacts = 2;                  // fewest of a check that counts
  bool attaches = false;             // from the start on, without a request
};

// Gains of a controller from a file beside the model.
struct GainsDef {
  std::string joint;
  double p = 0, i = 0, d = 0;                   // effort for each unit of position, its integral, velocity
  double i_low = -infinite, i_high = infinite;  // of the integral's effort
  bool is_named = false;                        // the user has named the file: before all others
  std::string source;                           // "file:line"
};

// A nested model's frame. It moves with its first link.
struct NestedDef {
  std::string name;                                        // scoped: "arm::hand"
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // in the link
  std::uint32_t link = 0;                                  // index into ModelDef::links
};

// A wheel that slips by its speed, as the plugin WheelSlip says: in each direction by compliance * rim speed / force for each newton.
struct WheelSlipDef {
  std::string link;                      // of the model; a joint turns it
  double lateral = 0, longitudinal = 0;  // compliances
  double normal_force = 0;               // [N]; positive
  double radius = 0;                     // [m]; positive
};

// A top-level model with all its nested ones folded in: their links, joints, sensors and plugins carry a scope.
struct ModelDef {
  std::string name;                                        // unique in the world
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // in the world
  bool is_static = false;
  bool self_collide = false;
  bool allow_auto_disable = true;
  bool enable_wind = false;
  std::string canonical_link;  // a link's name; never empty when there are links
  std::vector<LinkDef> links;
  std::vector<JointDef> joints;
  std::vector<PluginDef> plugins;
  std::vector<GripperDef> grippers;
  std::vector<GainsDef> gains;
  std::vector<WheelSlipDef> slips;
  std::vector<NestedDef> nested;  // those with links, from the outermost in the order of the file
  std::string source;             // "file:line" where the model comes from

  const LinkDef* link(std::string_view link_name) const;     // null when absent
  const JointDef* joint(std::string_view joint_name) const;  // null when absent
};

// --- actors

struct WaypointDef {
  double time = 0;                                         // since the start of the trajectory; ascending
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // in the world
};
struct TrajectoryDef {
  int id = 0;
  std::string animation;  // name of the AnimationDef that plays meanwhile
  double tension = 0;     // 0: smooth, 1: straight
  std::vector<WaypointDef> waypoints;
};
struct AnimationDef {
  std::string name;
  std::string path;
  double scale = 1;
  bool interpolate_x = false;
};
// Something that follows its way points whatever is in its way: no mass, no collisions.
struct ActorDef {
  std::string name;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // in the world, before the trajectory starts
  std::string skin;                                        // mesh path or empty
  double skin_scale = 1;
  std::vector<VisualDef> visuals;  // those of its links, in the actor's frame
  std::vector<AnimationDef> animations;
  std::vector<TrajectoryDef> trajectories;
  bool loop = true;
  bool auto_start = true;
  double delay_start = 0;
  std::uint8_t label = 0;  // as of visuals
  std::vector<PluginDef> plugins;
  std::string source;
};

// --- the world

// What the plugin Buoyancy of gz-sim fills the world with.
struct FluidDef {
  double density = 1000;                           // below all changes [kg/m^3]
  std::vector<std::pair<double, double>> changes;  // from this height [m] on up that density [kg/m^3]; ascending
  std::vector<std::string> models;                 // that it carries; empty: all
};

struct PhysicsDef {
  enum class Solver { automatic, exact, iterative };  // automatic: nothing asked for; exact: "world"; iterative: "quick"
  double step = 0.001;                                // [s]
  double real_time_factor = 1;                        // 0: as fast as possible
  Eigen::Vector3d gravity{0, 0, -9.8};
  Eigen::Vector3d magnetic_field{5.5645e-6, 22.8758e-6, -42.3884e-6};  // [T]
  Eigen::Vector3d wind{0, 0, 0};                                       // [m/s]
  Solver solver = Solver::automatic;
  int iterations = 50;
  double sor = 1.3;
  std::optional<double> cfm, erp;
  double contact_max_correcting_vel = 100;
  double contact_surface_layer = 0.001;
  int max_contacts = 20;  // per pair of collisions
  std::optional<FluidDef> fluid;
  double atmosphere_temperature = 288.15, atmosphere_pressure = 101325;  // [K], [Pa] at sea level
};

struct FogDef {
  std::string type = "linear";  // linear, exponential, quadratic
  Color color;
  double start = 1, end = 100, density = 1;
};
struct SkyDef {
  double time = 10, sunrise = 6, sunset = 20;  // [h]
};
struct SceneDef {
  Color ambient{0.4F, 0.4F, 0.4F, 1};
  Color background{0.7F, 0.7F, 0.7F, 1};
  bool shadows = true;
  bool grid = true;
  std::optional<SkyDef> sky;
  std::optional<FogDef> fog;
};

struct SphericalDef {
  double latitude = 0, longitude = 0;  // [deg]
  double elevation = 0;
  double heading = 0;  // [rad] of the world's x axis, counter-clockwise from east
};

struct WorldDef {
  std::string name = "default";
  PhysicsDef physics;
  SceneDef scene;
  SphericalDef spherical;
  std::vector<LightDef> lights;
  std::vector<ModelDef> models;
  std::vector<ActorDef> actors;
  std::vector<PluginDef> plugins;
  std::optional<Eigen::Isometry3d> gui_camera;  // where the author's window looked from
  ModelPath model_path;                         // for what mesh files refer to
  std::size_t missing_parts = 0;                // models and files that are not found or left out, each with a line of the loader

  const ModelDef* model(std::string_view model_name) const;  // null when absent
};

// Half of the length, width and height of a box, sphere, cylinder, capsule, cone or ellipsoid; zeros for other shapes, whose files are not
// read for it.
Eigen::Vector3d half_size_of(const GeometryDef& geometry);
// The box along the axes in which the model's collisions are (its visuals, if it has no collision), with the model at this pose.
Eigen::AlignedBox3d box_of(const ModelDef& model, const Eigen::Isometry3d& pose);

// --- complaints

// One line for a person about something in a world's files.
struct Finding {
  enum class Severity {
    note,     // taken in another way than written ("ellipsoid is approximated"), nothing lost
    warning,  // repaired or ignored without a loss for the simulation
    dropped,  // an object or element is missing from the world because of this
  };
  Severity severity = Severity::warning;
  std::string file;
  int line = 0;  // 0: unknown
  std::string message;

  // "file:line: message"
  std::string text() const;
};

}  // namespace sim
