/* Layout of the shared memory of an iface (a simulated device), byte for byte. docs/shared-memory.md has it as tables. C11 and C++; plain
 * data only.
 *
 * A segment `/dev/shm/rtmsim-<uid>-<server>.<type>.<iface name>` starts with a rtmsim_header, which has the offset and size of each area.
 * Numbers are little endian. Areas start at multiples of 64. Units: m, rad, s, kg, N; times are int64 nanoseconds. Axes: x forward, y left,
 * z up. Angles are positive counter-clockwise. Quaternions are (w, x, y, z). "Server" is the simulator that owns the segment.
 *
 * Words marked [atomic] are written while other processes read them. Access them only with atomic operations of their width. */
#ifndef RTMSIM_LAYOUT_H
#define RTMSIM_LAYOUT_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define RTMSIM_MAGIC "RTMSIM\r\n" /* 8 bytes, without the final zero */
#define RTMSIM_LAYOUT_VERSION 2u
#define RTMSIM_AREAS 8
#define RTMSIM_NAME_SIZE 224 /* iface names have at most 200 characters */
#define RTMSIM_HOLDS 4       /* frames that one client can hold at a time */
#define RTMSIM_PARTS 12
#define RTMSIM_TICK_WORDS 4
#define RTMSIM_TEXT_PIECE 16384 /* longer texts of requests and replies are sent in several parts */

/* Iface types. iface_types.h has the name of each type in segment names, and its fields. */
enum {
  RTMSIM_SIMULATION = 1,
  RTMSIM_LASER = 2,
  RTMSIM_SONAR = 3,
  RTMSIM_POSITION2D = 4,
  RTMSIM_POSITION3D = 5,
  RTMSIM_CAMERA = 6,
  RTMSIM_DEPTH = 7,
  RTMSIM_POINTS = 8,
  RTMSIM_IMU = 9,
  RTMSIM_GPS = 10,
  RTMSIM_BUMPER = 11,
  RTMSIM_TRUTH = 12,
  RTMSIM_FORCE_TORQUE = 13,
  RTMSIM_ALTIMETER = 14,
  RTMSIM_MAGNETOMETER = 15,
  RTMSIM_AIR_PRESSURE = 16,
  RTMSIM_JOINTS = 17,
  RTMSIM_LOGICAL_CAMERA = 20,
  RTMSIM_BOXES = 21,
  RTMSIM_FIDUCIAL = 22,
  RTMSIM_BATTERY = 27,
  RTMSIM_DVL = 28,
  RTMSIM_AIR_SPEED = 29,
  RTMSIM_INS = 30,
  RTMSIM_RFID = 31,
  RTMSIM_WIRELESS = 32,
  RTMSIM_WHEELS = 33,
  RTMSIM_LOCALIZATION = 34,
};

/* Areas of a segment, by index into rtmsim_header.areas. An area that the iface does not have is all zero. */
enum {
  RTMSIM_AREA_INFO = 0,        /* constants of the iface: rtmsim_<type>_info, and what follows it */
  RTMSIM_AREA_CELLS = 1,       /* latest samples: count cells of stride bytes, each a lock word [atomic, 8 bytes] and the sample; lock is
                                                        2 n + 1 while sample n is written, 2 n + 2 when it is complete */
  RTMSIM_AREA_FRAMES = 2,      /* ring of frames: count slots of stride bytes, each rtmsim_frame and the data */
  RTMSIM_AREA_LEASES = 3,      /* count rtmsim_lease */
  RTMSIM_AREA_CONTROL = 4,     /* one rtmsim_control (simulation only) */
  RTMSIM_AREA_REQUESTS = 5,    /* count request slots (simulation only): rtmsim_request_slot, request text, reply text */
  RTMSIM_AREA_PARTICIPANTS = 6 /* count rtmsim_participant (simulation only) */
};

enum { RTMSIM_STATE_LIVE = 1, RTMSIM_STATE_CLOSED = 2 };

/* Identifies a process. A pid can be reused, so the start time (field 22 of /proc/<pid>/stat) and the pid namespace are stored with it. */
typedef struct {
  int32_t pid;
  uint32_t pid_namespace; /* inode of /proc/self/ns/pid */
  uint64_t start_time;    /* [clock ticks since boot] */
} rtmsim_process;

typedef struct {
  uint64_t offset; /* from the start of the segment; 0 = the iface has no such area */
  uint64_t size;   /* [bytes] of the whole area */
  uint32_t stride; /* [bytes] from one element to the next */
  uint32_t count;  /* elements */
} rtmsim_area;

/* The start of every segment. Fields before `state` do not change while the segment exists. */
typedef struct {
  char magic[8];
  uint32_t layout_version;
  uint32_t type;
  uint64_t total_size;
  uint64_t generation; /* increases each time an iface of this name is made */
  rtmsim_process server;
  uint8_t boot_id[16]; /* boot id of the system that the server runs in */
  uint32_t server_id;
  uint32_t uid;
  char type_name[24];
  char name[RTMSIM_NAME_SIZE - 4];
  uint32_t command_values; /* doubles behind the command of each lease */
  rtmsim_area areas[RTMSIM_AREAS];
  uint32_t state;          /* [atomic] RTMSIM_STATE_* ; closed: no more samples, open the name again */
  uint32_t lease_epoch;    /* [atomic] changes when a lease is acquired or released */
  int64_t heartbeat_ns;    /* [atomic] CLOCK_MONOTONIC of the server's last heartbeat: about ten times a second, or once a second
                              while time is paused */
  uint64_t command_latest; /* [atomic] (number of commands << 16) | index of the lease whose command is the latest; 0 = none yet */
  uint8_t reserved0[40];
  uint64_t sequence;    /* [atomic] sequence number of the latest sample or frame, 0 = none yet; sample n is in cell n % count */
  uint64_t latest_slot; /* [atomic] frames: (sequence << 8) | slot of the latest frame */
  uint32_t wake_word;   /* [atomic] futex: low half of sequence, and changed when the iface closes */
  uint32_t waiting;     /* [atomic] 2 wake_word + 1 from a reader that is about to sleep; the writer wakes all and sets 0 if that is old */
  uint64_t dropped;     /* [atomic] frames that found no free slot */
  uint8_t reserved1[416];
} rtmsim_header;

/* The lease of a client of an iface. A client acquires a free lease by changing owner from 0, and releases it by storing 0. The server
 * releases the leases of dead processes. */
enum { RTMSIM_LEASE_SUBSCRIBER = 1 }; /* flag: the sensor works as long as one lease has it */

/* The command of a client. header.command_values doubles follow it; values that the client does not set are 0. Velocity: position2d vx vy
 * va; position3d vx vy vz wx wy wz (body frame). Pose: position2d x y a; position3d x y z roll pitch yaw. Car: for a position2d drive whose
 * info has a wheel base: speed [m/s] and steering angle [rad] of a wheel in the middle between the steered ones. Joints: for each joint of
 * the iface mode, value, velocity, effort (RTMSIM_JOINT_*); mode 0 leaves the joint to the client that commands it now. A joints iface
 * follows the commands of all its clients, each for its own joints. Charge: battery 1 (the charger is connected) or 0. */
typedef struct {
  uint64_t sequence;   /* counts the commands of this lease */
  int64_t sim_time_ns; /* simulated time at which the client wrote the command, or 0; with RTMSIM_COMMAND_TIMED: duration [simulated ns] */
  uint32_t kind;       /* RTMSIM_COMMAND_* */
  uint32_t flags;      /* RTMSIM_COMMAND_TIMED, or 0 */
} rtmsim_command;

/* Flag: the command ends sim_time_ns after the start of the first step that follows it. Then the robot stops as if the client had
 * disconnected. */
enum { RTMSIM_COMMAND_TIMED = 1 };

enum {
  RTMSIM_COMMAND_STOP = 0,
  RTMSIM_COMMAND_VELOCITY = 1,
  RTMSIM_COMMAND_POSE = 2,
  RTMSIM_COMMAND_JOINTS = 3,
  RTMSIM_COMMAND_CAR = 4,
  RTMSIM_COMMAND_CHARGE = 5
};

typedef struct {
  uint64_t owner;               /* [atomic] (pid << 32) | a number unique in that process; 0 = free */
  uint64_t start_time;          /* [atomic] of the owner; 0 = not written yet */
  uint32_t pid_namespace;       /* [atomic] */
  uint32_t flags;               /* [atomic] */
  char name[40];                /* of the program, for display */
  uint32_t holds[RTMSIM_HOLDS]; /* [atomic] slot + 1 of each frame held; the writer leaves these slots alone */
  uint8_t reserved[48];
  uint64_t command_lock;  /* [atomic] odd while the owner writes the command */
  rtmsim_command command; /* [atomic words], like the values that follow; the stride of the area is the size of a lease */
} rtmsim_lease;

/* ---- samples: each starts with a stamp ---- */

typedef struct {
  uint64_t sequence;    /* 1, 2, 3, ... */
  int64_t sim_time_ns;  /* simulated time that the values belong to */
  int64_t wall_time_ns; /* Unix time of publication */
  uint32_t valid;       /* 0: the device has no valid values (yet); do not use them */
  uint32_t resets;      /* resets of the world so far; simulated time starts again with each */
} rtmsim_stamp;

typedef struct {
  double x, y, z;        /* [m] */
  double qw, qx, qy, qz; /* unit quaternion */
} rtmsim_pose;

typedef struct {
  char name[16];
  uint64_t calls;
  int64_t total_ns; /* wall time since the start of the server */
  int64_t max_ns;
} rtmsim_part;

typedef struct {
  int64_t step_ns; /* length of a physics step */
  uint64_t seed;   /* [atomic] the one constant that changes: with RTMSIM_REQUEST_RESET */
  uint32_t lockstep;
  uint32_t wait_for; /* participants that must join before time starts */
  char world[128];   /* name in the file */
  char file[512];
  char version[32]; /* of the server */
} rtmsim_simulation_info;

/* The clock. Published after each step and after each change of its fields. stamp.sim_time_ns is the simulated time. */
typedef struct {
  rtmsim_stamp stamp;
  uint64_t steps;      /* since the last reset */
  uint64_t state_hash; /* of the world at hash_steps; 0 = never computed */
  uint64_t hash_steps;
  uint32_t paused;
  uint32_t waiting_for; /* participants still missing before time starts */
  double rtf_wanted;    /* 0 = as fast as possible */
  double rtf_reached;   /* over the last second or so */
  double load;          /* fraction of wall-clock time with work, over the same interval [0..1] */
  uint32_t models, bodies, joints, contacts;
  uint32_t ifaces, active_sensors, participants, part_count;
  rtmsim_part parts[RTMSIM_PARTS];
} rtmsim_simulation_sample;

typedef struct {
  uint32_t beams;  /* of one layer; beam i has the direction min_angle + i * angle_step: counter-clockwise, from right to left */
  uint32_t layers; /* from the lowest to the highest; 1 for a planar scanner */
  double min_angle, max_angle, angle_step; /* [rad] */
  double min_vertical, max_vertical;       /* [rad], 0 for a planar scanner */
  double min_range, max_range, range_step; /* [m]; range_step = resolution */
  double rate;                             /* scans per simulated second */
  double noise;                            /* standard deviation [m] */
  rtmsim_pose pose;                        /* of the scanner on its model */
  char model[128];                         /* scoped name of that model */
} rtmsim_laser_info;

/* A scan; `count` = beams * layers float ranges [m] follow, then as many float intensities. Beam by beam, layer by layer.
 * A range is +infinity if the beam hits nothing, -infinity if the object is nearer than min_range. */
typedef struct {
  rtmsim_stamp stamp;
  rtmsim_pose pose; /* true pose of the scanner in the world at the stamp */
  uint32_t count;
  uint32_t sweep_ns; /* for a rotating scanner: the first beam of each layer is this much older than the stamp, the last has the time of the
                        stamp, the others are evenly between; each range is in the frame of its own time. 0: all at the stamp */
} rtmsim_laser_sample;

/* `count` poses of the transducers on the model (rtmsim_pose) follow. */
typedef struct {
  uint32_t count;
  uint32_t reserved;
  double min_range, max_range; /* [m] */
  double cone;                 /* full opening angle [rad] */
  double rate, noise;
  rtmsim_pose pose;
  char model[128];
} rtmsim_sonar_info;

/* `count` float ranges [m] follow (padded to 8 bytes), with the infinities of a laser scan. */
typedef struct {
  rtmsim_stamp stamp;
  uint32_t count;
  uint32_t reserved;
} rtmsim_sonar_sample;

enum { RTMSIM_DRIVE_DIFFERENTIAL = 1, RTMSIM_DRIVE_SKID = 2, RTMSIM_DRIVE_HOLONOMIC = 3, RTMSIM_DRIVE_CAR = 4 };

typedef struct {
  uint32_t drive; /* RTMSIM_DRIVE_* */
  uint32_t reserved;
  rtmsim_pose pose;               /* of the robot's centre in the model's frame */
  double size[3];                 /* length, width, height [m] */
  double max_speed, max_yaw_rate; /* 0 = unlimited */
  double max_acceleration, max_yaw_acceleration;
  double wheel_separation, wheel_radius;
  double rate;
  char model[128];
  double wheel_base;         /* from the steered wheels to the reference axle of commands; 0: not steered, or an older simulator [m] */
  double max_steering_angle; /* of a wheel in the middle between the steered ones [rad] */
} rtmsim_position2d_info;

typedef struct {
  rtmsim_stamp stamp;
  double odometry[3];      /* x y a from the encoders, since the last reset of the odometry; a is in (-pi, pi] */
  double velocity[3];      /* vx vy va from the encoders, robot frame */
  rtmsim_pose true_pose;   /* in the world */
  double true_velocity[3]; /* vx vy va in the robot frame */
  double command[3];       /* vx vy va that the drive follows at this time */
  uint32_t stalled;        /* commanded to move, but it does not */
  uint32_t motors_enabled;
  uint32_t commanded; /* a running client commands it */
  uint32_t reserved;
} rtmsim_position2d_sample;

typedef struct {
  uint32_t drive;
  uint32_t reserved;
  rtmsim_pose pose;
  double size[3];
  double max_speed, max_yaw_rate;
  double rate;
  char model[128];
} rtmsim_position3d_info;

typedef struct {
  rtmsim_stamp stamp;
  rtmsim_pose odometry;
  double velocity[6]; /* linear x y z, angular x y z, body frame */
  rtmsim_pose true_pose;
  double true_velocity[6];
  double command[6];
  uint32_t stalled;
  uint32_t motors_enabled;
  uint32_t commanded;
  uint32_t reserved;
} rtmsim_position3d_sample;

enum {
  RTMSIM_FORMAT_RGB8 = 1,                   /* r g b, a byte each */
  RTMSIM_FORMAT_MONO8 = 2,                  /* luminance, a byte */
  RTMSIM_FORMAT_DEPTH_FLOAT = 3,            /* metres along the optical axis; +infinity: nothing */
  RTMSIM_FORMAT_POINTS_FLOAT = 4,           /* x y z [m] in the sensor's frame, three floats per point; NaN: no point */
  RTMSIM_FORMAT_POINTS_INTENSITY_FLOAT = 5, /* x y z and intensity, four floats per point */
  RTMSIM_FORMAT_BGR8 = 6,                   /* b g r, a byte each */
  RTMSIM_FORMAT_RGBA8 = 7,                  /* r g b 255 */
  RTMSIM_FORMAT_BGRA8 = 8,                  /* b g r 255 */
  RTMSIM_FORMAT_MONO16 = 9,                 /* luminance 0..65535, two bytes, the low one first */
  RTMSIM_FORMAT_BAYER_RGGB8 = 10,           /* a byte per pixel: even rows r g r g ..., odd rows g b g b ... */
  RTMSIM_FORMAT_BAYER_BGGR8 = 11,           /* even rows b g b g ..., odd rows g r g r ... */
  RTMSIM_FORMAT_BAYER_GBRG8 = 12,           /* even rows g b g b ..., odd rows r g r g ... */
  RTMSIM_FORMAT_BAYER_GRBG8 = 13,           /* even rows g r g r ..., odd rows b g b g ... */
  RTMSIM_FORMAT_LABELS = 14,    /* three bytes. Semantic: the label three times. Instances: number of the object with this label, from 1,
                                   high byte and low byte, then the label. 0: no labelled object */
  RTMSIM_FORMAT_THERMAL16 = 15, /* temperature in units of the frame, two bytes, the low one first */
  RTMSIM_FORMAT_THERMAL8 = 16   /* temperature in units of the frame, a byte */
};

/* Of camera, depth and points. Rows from top to bottom, pixels from left to right; a cloud without image order has height 1. */
typedef struct {
  uint32_t width, height;     /* [pixel] */
  uint32_t format;            /* RTMSIM_FORMAT_* */
  uint32_t stride;            /* bytes from one row to the next */
  uint64_t frame_size;        /* bytes of a full frame */
  double hfov;                /* horizontal field of view [rad] */
  double near_clip, far_clip; /* [m] */
  double fx, fy, cx, cy;      /* pinhole model [pixel] */
  double distortion[5];       /* k1 k2 p1 p2 k3 */
  double rate, noise;
  rtmsim_pose pose; /* on the model; the camera looks along its x axis, y is left, z is up */
  char model[128];
} rtmsim_camera_info;

/* Header of a slot of the frame ring; the data follow directly. */
typedef struct {
  uint64_t lock;                          /* [atomic] sequence number of the frame in the slot; 0 while it is empty or written */
  rtmsim_stamp stamp;                     /* stamp.sequence == lock */
  rtmsim_pose pose;                       /* true pose of the sensor in the world at the stamp */
  uint32_t width, height, format, stride; /* as in the info */
  uint64_t size;                          /* bytes of data that follow */
  double unit;                            /* of thermal images: [K]; else 0 */
} rtmsim_frame;

typedef struct {
  double rate;
  double angular_velocity_noise, acceleration_noise; /* standard deviations */
  rtmsim_pose pose;
  char model[128];
} rtmsim_imu_info;

typedef struct {
  rtmsim_stamp stamp;
  double orientation[4];      /* w x y z, of the sensor in the world or in the frame that its <orientation_reference_frame> names;
                                 1 0 0 0 when <enable_orientation> is false */
  double angular_velocity[3]; /* [rad/s], sensor frame */
  double acceleration[3];     /* specific force [m/s^2], sensor frame: at rest it is minus gravity */
} rtmsim_imu_sample;

typedef struct {
  double rate;
  double position_noise, altitude_noise, velocity_noise;
  double latitude, longitude, altitude; /* of the world's origin [degree, degree, m] */
  double heading;                       /* of the world's x axis, counter-clockwise from east [rad] */
  rtmsim_pose pose;
  char model[128];
} rtmsim_gps_info;

typedef struct {
  rtmsim_stamp stamp;
  double latitude, longitude; /* [degree] WGS 84; all other angles are in rad */
  double altitude;            /* [m] */
  double velocity[3];         /* east, north, up [m/s] */
} rtmsim_gps_sample;

typedef struct {
  uint32_t capacity; /* contacts that fit into a sample */
  uint32_t reserved;
  double rate;
  rtmsim_pose pose;
  char model[128];
  rtmsim_pose middle; /* of the box around the collisions of the bumper, along the axes of their link; in the frame of the model */
  double size[3];     /* of that box [m]; 0 without collisions */
  double radius;      /* of a sphere, or of an upright cylinder, if that is the only collision; else 0 [m] */
} rtmsim_bumper_info;

typedef struct {
  double position[3], normal[3]; /* world frame; the normal points to the bumper's body */
  double force[3];               /* on the bumper's body [N] */
  double depth;                  /* [m] */
  char other[112];               /* scoped name of the collision that it touches */
} rtmsim_contact;

/* `capacity` contacts (rtmsim_contact) follow, `count` of them are filled. */
typedef struct {
  rtmsim_stamp stamp;
  uint32_t count;
  uint32_t total; /* number of contacts; above count if not all of them fit */
} rtmsim_bumper_sample;

/* Of force_torque, altimeter, magnetometer and air_pressure. */
typedef struct {
  double rate;
  double noise[2];  /* standard deviations: force and torque; height and climb; field; pressure */
  double reference; /* altimeter: height of the sensor at the start; air_pressure: altitude of the world's origin [m]; others 0 */
  rtmsim_pose pose;
  char model[128];
  char joint[128]; /* force_torque: the joint that is measured; empty for others */
} rtmsim_meter_info;

/* What the child of the joint puts on its parent, or the other way round, as the sensor says; about the sensor's place, along the axes of
 * the child, the parent or the sensor, as it says. */
typedef struct {
  rtmsim_stamp stamp;
  double force[3];  /* [N] */
  double torque[3]; /* [N m] */
} rtmsim_force_torque_sample;

typedef struct {
  rtmsim_stamp stamp;
  double height; /* above the place at the start [m] */
  double climb;  /* upwards [m/s] */
} rtmsim_altimeter_sample;

typedef struct {
  rtmsim_stamp stamp;
  double field[3]; /* of the earth, sensor frame [T] */
} rtmsim_magnetometer_sample;

typedef struct {
  rtmsim_stamp stamp;
  double pressure; /* of the standard atmosphere above the world's sea level [Pa] */
} rtmsim_air_pressure_sample;

typedef struct {
  char model[128];
} rtmsim_truth_info;

typedef struct {
  rtmsim_stamp stamp;
  rtmsim_pose pose;
  double velocity[6]; /* linear x y z, angular x y z, world frame */
} rtmsim_truth_sample;

/* A camera that sees models without drawing them: those whose origin is in its frustum, whatever is before them. */
typedef struct {
  uint32_t capacity; /* most models of a sample */
  uint32_t reserved;
  double near_clip, far_clip; /* [m] along the x axis */
  double hfov;                /* horizontal field of view [rad] */
  double aspect_ratio;        /* width by height of the frustum */
  double rate;
  rtmsim_pose pose; /* on the model; it looks along its x axis, y is left, z is up */
  char model[128];
} rtmsim_logical_camera_info;

typedef struct {
  char name[128];   /* scoped: arm::hand */
  rtmsim_pose pose; /* in the camera */
} rtmsim_seen_model;

/* `capacity` models (rtmsim_seen_model) follow, `count` of them are filled, in the order of the world. */
typedef struct {
  rtmsim_stamp stamp;
  rtmsim_pose pose; /* of the camera in the world */
  uint32_t count;
  uint32_t total; /* number of models; above count if not all of them fit */
} rtmsim_logical_camera_sample;

/* Kinds of bounding boxes of a camera. */
enum {
  RTMSIM_BOX_VISIBLE = 1, /* the visible part of an object, in the image */
  RTMSIM_BOX_FULL = 2,    /* the whole object, projected into the image and cut at its edges */
  RTMSIM_BOX_ORIENTED = 3 /* the whole object, in space, along its own axes */
};

/* The boxes of a bounding box camera. Its images are in the camera iface of the same name. */
typedef struct {
  uint32_t kind;          /* RTMSIM_BOX_* */
  uint32_t capacity;      /* maximum number of boxes of a sample */
  uint32_t width, height; /* of the image [pixel] */
  double rate;
  rtmsim_pose pose;
  char model[128];
} rtmsim_boxes_info;

/* The box around a visible object with a label. The Label plugin sets the label of a model or visual. */
typedef struct {
  uint32_t label;            /* 1..255 */
  uint32_t pixels;           /* number of pixels of the object */
  double center[2], size[2]; /* [pixel] from the left and the top; 0 of oriented boxes */
  rtmsim_pose pose;          /* of the middle of an oriented box in the camera */
  double extent[3];          /* length, width, height of an oriented box [m] */
  char name[128];            /* scoped name of the model or visual with the label */
} rtmsim_box;

/* `capacity` boxes (rtmsim_box) follow, `count` of them are filled. The stamp is that of the image. */
typedef struct {
  rtmsim_stamp stamp;
  uint32_t count;
  uint32_t total; /* number of boxes; above count if not all of them fit */
} rtmsim_boxes_sample;

typedef struct {
  uint32_t capacity; /* maximum number of marks of a sample */
  uint32_t reserved;
  double min_range, max_range; /* [m] */
  double view_angle;           /* full, centred on the x axis, in the plane of x and y [rad] */
  double noise[2];             /* standard deviations of positions [m] and angles [rad] */
  double rate;
  rtmsim_pose pose; /* on the model */
  char model[128];
} rtmsim_fiducial_info;

typedef struct {
  uint32_t id;
  uint32_t reserved;
  rtmsim_pose pose; /* of the middle of the mark in the detector: its x axis points out of the mark, z is its up */
  double size[3];   /* thickness, width, height [m] */
  char model[128];  /* the model with the mark */
} rtmsim_mark;

/* `capacity` marks (rtmsim_mark) follow, `count` of them are filled. */
typedef struct {
  rtmsim_stamp stamp;
  rtmsim_pose pose; /* of the detector in the world */
  uint32_t count;
  uint32_t total; /* number of marks; above count if not all of them fit */
} rtmsim_fiducial_sample;

/* Modes of a joint. In commands they give the meaning of `value`. A position command feeds its velocity and effort forward. The effort of
 * a velocity command is the maximum effort; 0: that of the joint. */
enum {
  RTMSIM_JOINT_NONE = 0,     /* no client has commanded it */
  RTMSIM_JOINT_POSITION = 1, /* value: target [rad or m]. With a velocity, the target moves at it until the next command, for at most 50 ms.
                                Without one, the joint moves to the target at its maximum velocity */
  RTMSIM_JOINT_VELOCITY = 2, /* value: [rad/s or m/s] */
  RTMSIM_JOINT_EFFORT = 3,   /* value: [N m or N] */
  RTMSIM_JOINT_FREE = 4,
  RTMSIM_JOINT_BRAKE = 5,
  RTMSIM_JOINT_DISABLED = 6,     /* only in samples: the joint left the range of numbers; until a reset */
  RTMSIM_JOINT_COMPENSATED = 256 /* added to the mode of a command: gravity is compensated, for any gains */
};
enum { RTMSIM_JOINT_IDLE = 0, RTMSIM_JOINT_MOVING = 1, RTMSIM_JOINT_BRAKED = 2, RTMSIM_JOINT_STALLED = 3 };
enum { RTMSIM_JOINT_TURNS = 1, RTMSIM_JOINT_SLIDES = 2 };
#define RTMSIM_JOINT_VALUES 4 /* of a command, for each joint */

/* `count` joints (rtmsim_joint) follow. */
typedef struct {
  uint32_t count;
  uint32_t reserved;
  double rate;
  char model[128];
} rtmsim_joints_info;

typedef struct {
  char name[96];        /* as in the file, scoped */
  char link[96];        /* the link that it moves */
  char gains_from[96];  /* source of p, i and d */
  uint32_t id;          /* index into this list, and into the lists of samples and commands */
  uint32_t kind;        /* RTMSIM_JOINT_TURNS or RTMSIM_JOINT_SLIDES */
  uint32_t parent;      /* 1 + id of the joint that carries it; 0: the model's base */
  uint32_t compensated; /* gravity is compensated in position and velocity control */
  double lower, upper;  /* limits [rad or m]; infinite without */
  double max_velocity, max_effort;
  double rest;    /* position at the start */
  double p, i, d; /* gains: effort for each unit of the position, of its integral, of the velocity */
  double axis[3]; /* in the joint's frame */
  rtmsim_pose
      pose; /* of the joint's frame at position 0, in the frame of the parent joint or of the model; it is that of the link's motion */
} rtmsim_joint;

typedef struct {
  double position, velocity; /* [rad or m]; whole turns count where the joint has limits */
  double effort;             /* of the motor or brake in the last step [N m or N] */
  double target;             /* in the unit of the mode */
  uint32_t mode;             /* RTMSIM_JOINT_* */
  uint32_t status;
} rtmsim_joint_state;

/* `count` states (rtmsim_joint_state) follow. */
typedef struct {
  rtmsim_stamp stamp;
  uint32_t count;
  uint32_t commanded; /* number of joints that a running client commands */
} rtmsim_joints_sample;

enum {
  RTMSIM_BATTERY_IDLE = 0,   /* no load has taken power yet */
  RTMSIM_BATTERY_DRAINS = 1, /* its load takes power */
  RTMSIM_BATTERY_CHARGES = 2,
  RTMSIM_BATTERY_FULL = 3,  /* the charger is connected and has stopped */
  RTMSIM_BATTERY_EMPTY = 4, /* the motors of its model have no power */
};

/* Open-circuit voltage = constant + linear (1 - charge / capacity). */
typedef struct {
  double rate;
  double capacity, initial_charge; /* [Ah] */
  double constant, linear;         /* [V] */
  double resistance;               /* [ohm] */
  double smoothing;                /* time constant of the current [s] */
  double load;                     /* of all consumers, while it drains [W] */
  double charging_time;            /* from empty to full [h]; 0: it cannot be charged */
  char name[64];
  char model[128];
} rtmsim_battery_info;

typedef struct {
  rtmsim_stamp stamp;
  double voltage;    /* [V] */
  double current;    /* out of the battery; negative while it charges [A] */
  double charge;     /* [Ah] */
  double level;      /* charge / capacity, 0 to 1 */
  double power;      /* power of the load [W] */
  uint32_t state;    /* RTMSIM_BATTERY_* */
  uint32_t is_empty; /* 1: the motors of its model have no power */
} rtmsim_battery_sample;

/* `count` beams (rtmsim_dvl_beam) follow. */
typedef struct {
  uint32_t count;
  uint32_t reserved;
  double rate, noise;          /* standard deviation of the speed along a beam [m/s] */
  double min_range, max_range; /* [m] */
  rtmsim_pose pose;            /* on the model; the beams look down, along -z */
  rtmsim_pose reference;       /* frame of the velocity, in the frame of the sensor */
  char model[128];
} rtmsim_dvl_info;

typedef struct {
  double axis[3];  /* unit vector in the frame of the sensor */
  double aperture; /* full opening angle of its cone [rad] */
} rtmsim_dvl_beam;

/* `count` echoes (rtmsim_dvl_echo) follow. */
typedef struct {
  rtmsim_stamp stamp;
  double velocity[3];    /* of the sensor against the bottom, in the reference frame [m/s]; 0 while it is not known */
  double covariance[9];  /* of the velocity, by rows */
  double range;          /* of the nearest echo [m]; +infinity: none */
  uint32_t count;        /* beams */
  uint32_t locked;       /* beams with an echo */
  uint32_t has_velocity; /* at least three beams have an echo */
  uint32_t reserved;
} rtmsim_dvl_sample;

typedef struct {
  double range; /* [m]; +infinity: no echo */
  double speed; /* of the sensor along the beam [m/s]; 0 without an echo */
} rtmsim_dvl_echo;

/* The info is rtmsim_meter_info: noise of the pressure; altitude of the world's origin. */
typedef struct {
  rtmsim_stamp stamp;
  double pressure;    /* of the air that meets the sensor along x; negative from behind [Pa] */
  double temperature; /* [K] */
} rtmsim_air_speed_sample;

typedef struct {
  double rate;
  double position_noise, altitude_noise; /* standard deviations [m] */
  double velocity_noise;                 /* [m/s] */
  double heading_noise;                  /* [rad] */
  rtmsim_pose pose;
  char model[128];
} rtmsim_ins_info;

typedef struct {
  rtmsim_stamp stamp;
  double latitude, longitude; /* WGS 84 [degree] */
  double altitude;            /* above the ellipsoid [m] */
  double height;              /* above the world's origin [m] */
  double velocity[3];         /* east, north, up [m/s] */
  double orientation[3];      /* roll, pitch, yaw [rad]; yaw 0 is east */
} rtmsim_ins_sample;

typedef struct {
  uint32_t capacity;
  uint32_t needs_sight; /* 1: an object between reader and tag hides the tag */
  double rate;
  double range; /* [m] */
  double angle; /* full opening angle of the reading cone, about x [rad] */
  rtmsim_pose pose;
  char model[128];
} rtmsim_rfid_info;

typedef struct {
  char id[64];
  char data[128];
} rtmsim_rfid_tag;

/* `capacity` tags (rtmsim_rfid_tag) follow, `count` of them are filled: the nearest first. */
typedef struct {
  rtmsim_stamp stamp;
  uint32_t count;
  uint32_t total; /* tags in reach */
} rtmsim_rfid_sample;

typedef struct {
  uint32_t capacity;
  uint32_t reserved;
  double rate;
  double gain;                         /* of the antenna [dBi] */
  double sensitivity;                  /* weaker transmitters are not received [dBm] */
  double min_frequency, max_frequency; /* [MHz] */
  rtmsim_pose pose;
  char model[128];
} rtmsim_wireless_info;

typedef struct {
  char essid[64];
  char transmitter[128]; /* model::sensor */
  double frequency;      /* [MHz] */
  double level;          /* received power [dBm] */
  uint32_t is_blocked;   /* an object is between the antennas */
  uint32_t reserved;
} rtmsim_radio;

/* `capacity` transmitters (rtmsim_radio) follow, `count` of them are filled: the strongest first. */
typedef struct {
  rtmsim_stamp stamp;
  uint32_t count;
  uint32_t total; /* transmitters that are received */
} rtmsim_wireless_sample;

/* `count` wheels (rtmsim_wheel) follow. */
typedef struct {
  uint32_t count;
  uint32_t reserved;
  double rate;
  double ticks; /* per revolution of a wheel */
  char model[128];
} rtmsim_wheels_info;

typedef struct {
  char joint[96];
  double radius; /* [m]; 0: the wheel is not round */
} rtmsim_wheel;

/* `count` states (rtmsim_wheel_state) follow. */
typedef struct {
  rtmsim_stamp stamp;
  uint32_t count;
  uint32_t reserved;
} rtmsim_wheels_sample;

typedef struct {
  double ticks; /* whole; since the start */
  double angle; /* of these ticks [rad] */
  double speed; /* of the wheel [rad/s] */
} rtmsim_wheel_state;

typedef struct {
  uint32_t capacity;
  uint32_t reserved;
  double rate;
  double position_noise, heading_noise; /* standard deviations [m], [rad] */
  char model[128];
} rtmsim_localization_info;

typedef struct {
  double pose[3];       /* x y a in the world */
  double covariance[6]; /* xx, xy, xa, yy, ya, aa */
  double weight;        /* the weights of a sample sum to 1 */
} rtmsim_hypothesis;

/* `capacity` hypotheses (rtmsim_hypothesis) follow, `count` of them are filled: the best first. */
typedef struct {
  rtmsim_stamp stamp;
  uint32_t count;
  uint32_t reserved;
} rtmsim_localization_sample;

/* ---- simulation: requests ---- */

/* Requests of a client, with their use of the body. Other fields are 0. */
enum {
  RTMSIM_REQUEST_PAUSE = 1,
  RTMSIM_REQUEST_RUN = 2,
  RTMSIM_REQUEST_STEP = 3,     /* count = steps (1..1e9); pauses; answered when they are done; flags 1 = at the real-time factor */
  RTMSIM_REQUEST_RESET = 4,    /* world and time as at the start; keeps paused or running; flags 1: poses only, time goes on; flags bit 1:
                                  count = new seed of all noise */
  RTMSIM_REQUEST_GET_POSE = 5, /* name = model or model::link; reply values 0..6 = pose x y z qw qx qy qz in the world */
  RTMSIM_REQUEST_SET_POSE =
      6, /* name = model; values 0..6 = pose; velocities become 0. flags 1: values 0 1 2 = x y yaw, height and tilt kept */
  RTMSIM_REQUEST_GET_VELOCITY = 7, /* name = model or link; reply values 0..5 = linear, angular, world frame */
  RTMSIM_REQUEST_SET_VELOCITY = 8, /* name = model; values 0..5; the whole model moves as one body */
  RTMSIM_REQUEST_WRENCH = 9,  /* name = model or link; values 0..5 = force, torque, world frame at the centre of mass; 6 = [s], 0: one step,
                                 -1: until the next -1. flags 1: name = MODEL::JOINT; values 0 = its effort [N m or N] */
  RTMSIM_REQUEST_LIST = 10,   /* reply text: JSON, see docs/shared-memory.md */
  RTMSIM_REQUEST_TREE = 11,   /* name = model or empty for all; reply text: JSON tree of models, links, joints, sensors; flags 1: bounds */
  RTMSIM_REQUEST_SPAWN = 12,  /* text = SDF, or flags bit 0: text = path of an SDF file or model folder (of a
                                 shared server: inside its model path); name = new name or empty; flags bit 1: values 0..6 = pose; bit 2:
                                 nothing outside of the model path is opened. Reply message = name given */
  RTMSIM_REQUEST_DELETE = 13, /* name = model */
  RTMSIM_REQUEST_SCREENSHOT = 14, /* text = absolute path of the PNG, or empty: the PNG is the text of the reply (a shared server writes no
                                     files; RTMSIM_VIEW_PIXELS: width x height x 3 bytes, red, green, blue, rows from the top
                                     down); width, height; flags RTMSIM_VIEW_*; name = model to follow; values 0..6 = pose of the
                                     camera, 7 = hfov or metres across for top views */
  RTMSIM_REQUEST_STATS = 15,      /* reply text: JSON; reply values 0 = reached real-time factor; hash = state hash, computed now */
  RTMSIM_REQUEST_RESET_ODOMETRY = 16,   /* name = position iface; values 0..2 = new x y a (position3d: 0..6 = pose with flags 1) */
  RTMSIM_REQUEST_SET_MOTORS = 17,       /* name = position iface; count = 1 on, 0 off */
  RTMSIM_REQUEST_SET_RTF = 18,          /* values 0 = real-time factor, 0 = as fast as possible */
  RTMSIM_REQUEST_CONTACTS = 19,         /* name = model; reply count = its contacts since the last such request; text: JSON */
  RTMSIM_REQUEST_DROP_PARTICIPANT = 20, /* name = participant */
  RTMSIM_REQUEST_EXPORT = 21, /* flags 1 = shapes that collide; reply text: the world as glTF 2.0 binary (render/gltf.h); reply count = its
                                 links, values 0 = version of the scene, a new one after models were added or deleted */
  RTMSIM_REQUEST_POSES = 22,  /* reply count = links, values 0 = version of the scene; text: count x 7 floats x y z qw qx qy qz in the
                                 world, in the order of an export; then values 1 x 4: two positions, two velocities of each joint of TREE */
  RTMSIM_REQUEST_FAULT = 23,  /* inject a fault into a sensor, drive or joint from now on. name = iface, or IFACE::JOINT; text = kind (see
                                 simctl fault --help); flags 1: values 0 = amount, else the usual one; values 1 = simulated seconds, 0 =
                                 until it is ended. It replaces an active fault of the same kind */
  RTMSIM_REQUEST_END_FAULTS = 24, /* name = iface or empty for all; text = kind or empty for all; reply count = faults that have ended */
  RTMSIM_REQUEST_FAULTS = 25,     /* name = iface or empty for all; reply text: JSON, those that are on or still to come */
  RTMSIM_REQUEST_MODELS = 26,     /* reply text: JSON, the models of the model path, which SPAWN takes as model://NAME */
  RTMSIM_REQUEST_WRITE_TAG = 29,  /* name = rfid iface; text = id of a tag in its reach, line break, its new data; until a reset */
  RTMSIM_REQUEST_SHOW = 28,       /* while time is paused: subscribed sensors publish the current state; later samples do not change */
  RTMSIM_REQUEST_POSE_LOG = 27    /* the first one starts the pose log (shm/pose_log.h). count = first byte wanted; earlier ones are
                                     deleted. text = joints MODEL::JOINT, a line each, whose positions are in the log from now on (empty:
                                     as before). Reply count = end of the log [bytes]; text = bytes of it, at most 8 MiB */
};

/* Views of a screenshot. Without TOP and FOLLOW the pose of the camera is in values. Without a pose the camera shows the whole world. */
enum {
  RTMSIM_VIEW_TOP = 1,
  RTMSIM_VIEW_FOLLOW = 2,
  RTMSIM_VIEW_FROM = 4,
  RTMSIM_VIEW_SCANS = 8,
  RTMSIM_VIEW_CAMERA = 16,
  RTMSIM_VIEW_COLLISIONS = 32,
  RTMSIM_VIEW_PIXELS = 64
};

enum {
  RTMSIM_STATUS_OK = 0,
  RTMSIM_STATUS_FAILED = 1,      /* valid, but it failed */
  RTMSIM_STATUS_BAD_REQUEST = 2, /* unknown kind, bad number, bad name */
  RTMSIM_STATUS_NOT_FOUND = 3,   /* no object has this name */
  RTMSIM_STATUS_UNSUPPORTED = 4  /* this server does not support it */
};

typedef struct {
  int64_t count;
  double values[16];
  uint32_t width, height, flags, reserved;
  char name[256];
} rtmsim_request_body;

typedef struct {
  int64_t sim_time_ns; /* when it was done */
  uint64_t steps;
  uint64_t hash;
  int64_t count;
  double values[16];
  char message[256]; /* what went wrong, or a note */
} rtmsim_reply_body;

/* state of a request slot */
enum {
  RTMSIM_SLOT_IDLE = 0,     /* the client may ask */
  RTMSIM_SLOT_ASKED = 1,    /* the client has written; the server may read */
  RTMSIM_SLOT_REPLYING = 2, /* the server writes */
  RTMSIM_SLOT_REPLIED = 3   /* the server has written; the client may read */
};

/* One client's slot; RTMSIM_TEXT_PIECE bytes for the text of the request follow, then as many for the reply's. */
typedef struct {
  uint64_t owner;         /* [atomic] as in a lease */
  uint64_t start_time;    /* [atomic] */
  uint32_t pid_namespace; /* [atomic] */
  uint32_t state;         /* [atomic] futex; RTMSIM_SLOT_* */
  uint64_t id;            /* chosen by the client, never 0, different for each request; the reply has it in reply_id */
  uint32_t kind;
  uint32_t text_length; /* bytes of text in this part, at most RTMSIM_TEXT_PIECE */
  uint32_t more;        /* 1: the text continues in another part of the same id */
  uint32_t status;      /* of the reply, RTMSIM_STATUS_* */
  uint64_t reply_id;
  uint32_t reply_length;
  uint32_t reply_more; /* 1: ask again with the same id to get the next part */
  rtmsim_request_body body;
  rtmsim_reply_body reply;
  uint8_t reserved[136];
} rtmsim_request_slot;

/* ---- simulation: lock step (states and rights: shm/lockstep.h) ---- */

typedef struct {
  uint32_t attention;         /* [atomic] futex: clients add 1 when they ask for something or join */
  uint32_t attention_waiting; /* [atomic] 2 attention + 1 before the server sleeps; a client that reads it wakes the server, and sets 0 if
                                 the value is old */
  uint32_t participant_epoch; /* [atomic] changes when a participant joins or leaves */
  uint32_t reserved0[13];
  int32_t pending;         /* [atomic] participants that have not finished the tick */
  uint32_t server_word;    /* [atomic] futex: the server sleeps on it during a tick */
  uint32_t server_waiting; /* [atomic] */
  uint32_t reserved1[13];
  uint32_t tick_words[RTMSIM_TICK_WORDS]; /* [atomic] futexes: the participant in slot i sleeps on tick_words[i / 32 % 4] with bit i % 32 */
  uint64_t moment; /* [atomic] phase counter: counts starts and ends of phases, odd while a phase runs; 0 without lock step */
  uint32_t reserved2[10];
} rtmsim_control;

enum {
  RTMSIM_PARTICIPANT_FREE = 0,
  RTMSIM_PARTICIPANT_JOINING = 1, /* set by the participant */
  RTMSIM_PARTICIPANT_ACTIVE = 2,  /* set by the server */
  RTMSIM_PARTICIPANT_LEAVING = 3, /* set by the participant */
  RTMSIM_PARTICIPANT_DROPPED = 4  /* set by the server: exited, or its timeout expired */
};

typedef struct {
  /* written by the participant before it requests to join */
  uint64_t owner;         /* [atomic] as in a lease */
  uint64_t start_time;    /* [atomic] */
  uint32_t pid_namespace; /* [atomic] */
  uint32_t phase;
  int64_t period_ns; /* [atomic] may change at any time; valid from the next tick on */
  char name[64];
  uint32_t state;    /* [atomic] RTMSIM_PARTICIPANT_* */
  uint32_t error;    /* why the server rejected or dropped it: RTMSIM_DROPPED_* */
  uint32_t turn;     /* call order within the phase: higher ones begin when lower ones have finished; written before it requests to join */
  uint32_t observes; /* [atomic] 1: an observer, 2: a tool that the server waits for (shm/lockstep.h). May change at any time; valid from
                        the next tick on */
  uint8_t reserved0[16];
  /* written by the server */
  uint32_t go;     /* [atomic] number of the tick to execute; 0 = none yet */
  uint32_t resets; /* [atomic] of the world */
  int64_t now_ns;  /* [atomic] simulated time of that tick */
  int64_t due_ns;  /* [atomic] when it was due; now_ns - due_ns is less than a step */
  uint64_t steps;  /* [atomic] physics steps since the reset */
  uint64_t missed; /* [atomic] ticks skipped because the one before was not finished (free running only) */
  uint8_t reserved1[24];
  /* written by the participant */
  uint32_t done;     /* [atomic] number of the tick it has finished */
  uint32_t sleeping; /* [atomic] 1 before it sleeps on its tick word; 2: the server wakes it early, its tick follows at once */
  uint64_t ticks;    /* [atomic] finished */
  int64_t total_ns;  /* [atomic] wall-clock time of all of them */
  int64_t max_ns;    /* [atomic] */
  uint8_t reserved2[32];
} rtmsim_participant;

enum { RTMSIM_DROPPED_DEAD = 1, RTMSIM_DROPPED_HUNG = 2, RTMSIM_DROPPED_REFUSED = 3, RTMSIM_DROPPED_ASKED = 4 };

#ifdef __cplusplus
}
#endif
#endif
