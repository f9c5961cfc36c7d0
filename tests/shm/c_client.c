/* A client in C11: the header must compile as C and the functions must do. Called by c_header_test.cpp; returns the line that failed. */
#include <string.h>

#include "shm/rtmsim_iface.h"

_Static_assert(sizeof(rtmsim_header) == 1024, "layout");
_Static_assert(sizeof(rtmsim_laser_sample) == 96, "layout");

static int count_names(void* context, uint32_t server, const char* type, const char* name) {
  (void)server;
  if (strcmp(type, "laser") == 0 && strcmp(name, "robot::laser") == 0) ++*(int*)context;
  return 0;
}

#define CHECK(condition) \
  if (!(condition)) return __LINE__

int run_c_client(uint32_t server) {
  int lasers = 0;
  CHECK(rtmsim_list(server, count_names, &lasers) >= 3 && lasers == 1);

  CHECK(rtmsim_open(server, RTMSIM_LASER, "nothing") == NULL);
  CHECK(strstr(rtmsim_last_error(), "there is robot::laser") != NULL);
  CHECK(rtmsim_open(server, 99, "nothing") == NULL);
  CHECK(strcmp(rtmsim_type_name(RTMSIM_AIR_PRESSURE), "air_pressure") == 0 && rtmsim_type_name(99) == NULL && rtmsim_type_name(0) == NULL);
  CHECK(rtmsim_type("imu") == RTMSIM_IMU && rtmsim_type("nothing") == 0 && rtmsim_type(NULL) == 0);

  rtmsim_iface* laser = rtmsim_open(server, RTMSIM_LASER, "robot::laser");
  CHECK(laser != NULL);
  size_t size = 0;
  const rtmsim_laser_info* info = rtmsim_info(laser, &size);
  CHECK(size >= sizeof *info && info->beams == 181);
  CHECK(rtmsim_subscribe(laser) == 0);
  CHECK(rtmsim_wait(laser, 0, 60000000000) == RTMSIM_WAIT_FRESH);
  const rtmsim_laser_sample* scan = rtmsim_read(laser, &size);
  CHECK(scan != NULL && size >= sizeof *scan + 181 * 2 * sizeof(float));
  CHECK(scan->count == 181 && ((const float*)(scan + 1))[7] == 3.5F);
  CHECK(rtmsim_wait(laser, rtmsim_sequence(laser), 0) == RTMSIM_WAIT_TIMED_OUT);
  CHECK(rtmsim_is_live(laser) == 1 && rtmsim_reopen(laser) == 0);
  rtmsim_unsubscribe(laser);
  rtmsim_close(laser);
  rtmsim_close(NULL);

  rtmsim_iface* camera = rtmsim_open(server, RTMSIM_CAMERA, "eye");
  CHECK(camera != NULL && rtmsim_subscribe(camera) == 0);
  const rtmsim_frame* head = NULL;
  const void* data = NULL;
  rtmsim_held* frame = rtmsim_hold(camera, &head, &data);
  CHECK(frame != NULL && head->width == 32 && head->size == 256 && ((const unsigned char*)data)[255] == 42);
  rtmsim_release(frame);
  rtmsim_close(camera);

  rtmsim_iface* base = rtmsim_open(server, RTMSIM_POSITION2D, "base");
  const double velocity[3] = {0.25, 0, -0.5};
  CHECK(base != NULL && rtmsim_command_iface(base, RTMSIM_COMMAND_VELOCITY, velocity, 3) == 0);
  CHECK(rtmsim_command_iface(base, RTMSIM_COMMAND_VELOCITY, velocity, 4) == -1);

  rtmsim_requester* requester = rtmsim_open_requester(server);
  CHECK(requester != NULL);
  rtmsim_request_body body;
  rtmsim_reply_body reply;
  const char* text = NULL;
  memset(&body, 0, sizeof body);
  body.count = 5;
  CHECK(rtmsim_request(requester, RTMSIM_REQUEST_STEP, &body, NULL, 0, &reply, &text, 60000000000) == RTMSIM_STATUS_OK);
  CHECK(reply.steps == 5 && strcmp(text, "done") == 0);
  body.count = -1;
  CHECK(rtmsim_request(requester, RTMSIM_REQUEST_STEP, &body, NULL, 0, &reply, NULL, 60000000000) == RTMSIM_STATUS_BAD_REQUEST);
  CHECK(strstr(reply.message, "steps must be") != NULL);
  rtmsim_close_requester(requester);
  rtmsim_close(base);
  return 0;
}
