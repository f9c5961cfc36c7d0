/* Ifaces of the simulator for C and whoever can call C. C11. Layouts of infos and samples: rtmsim_layout.h. Link librtmsim_iface.
 *
 * A handle belongs to one thread at a time. Functions that return int give 0 for success and -1 for failure; then rtmsim_last_error() says
 * why, in one line, for the calling thread. Time-outs are in nanoseconds; 0 just looks. */
#ifndef RTMSIM_IFACE_H
#define RTMSIM_IFACE_H

#include <stddef.h>

#include "shm/rtmsim_layout.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct rtmsim_iface rtmsim_iface;         /* a client of one iface */
typedef struct rtmsim_requester rtmsim_requester; /* a client's line to the simulation */

/* Valid until the next call of this thread that fails. Never null. */
const char* rtmsim_last_error(void);

/* Calls `each` for every iface of the living servers (server < 0) or of one; stops when it returns non-zero. Returns how often it was
 * called. The texts are valid during the call only. */
int rtmsim_list(int64_t server, int (*each)(void* context, uint32_t server, const char* type, const char* name), void* context);

/* "laser" of RTMSIM_LASER and so on; null for a number that is no type. Never goes away. */
const char* rtmsim_type_name(uint32_t type);
/* RTMSIM_LASER of "laser" and so on; 0 for a name that is no type's. */
uint32_t rtmsim_type(const char* name);

/* Null when there is no such iface; the error names what there is. type: RTMSIM_LASER, ... */
rtmsim_iface* rtmsim_open(uint32_t server, uint32_t type, const char* name);
/* Unsubscribes; a robot that this handle commanded stops. Null is fine. */
void rtmsim_close(rtmsim_iface* iface);

/* The constants: rtmsim_<type>_info and what follows. Valid as long as the handle. */
const void* rtmsim_info(const rtmsim_iface* iface, size_t* size);

int rtmsim_subscribe(rtmsim_iface* iface);
void rtmsim_unsubscribe(rtmsim_iface* iface);

/* The latest sample (rtmsim_<type>_sample and what follows), valid until the next read or wait; null when there is none yet. No system
 * call. */
const void* rtmsim_read(rtmsim_iface* iface, size_t* size);

enum { RTMSIM_WAIT_FRESH = 0, RTMSIM_WAIT_TIMED_OUT = 1, RTMSIM_WAIT_CLOSED = 2 };
/* Waits for a sample or frame with a sequence number above `than`. CLOSED: the server has ended; see rtmsim_reopen. */
int rtmsim_wait(rtmsim_iface* iface, uint64_t than, int64_t timeout);
/* Number of the latest sample or frame, 0 = none. */
uint64_t rtmsim_sequence(const rtmsim_iface* iface);

/* Holds the latest frame, which stays as it is until rtmsim_release; at most RTMSIM_HOLDS at a time, subscribers only. Null when there is
 * none. *data are head->size bytes. */
typedef struct rtmsim_held rtmsim_held;
rtmsim_held* rtmsim_hold(rtmsim_iface* iface, const rtmsim_frame** head, const void** data);
void rtmsim_release(rtmsim_held* held);

/* kind: RTMSIM_COMMAND_*; finite values, at most as many as the header of the iface says (command_values); missing ones are 0. */
int rtmsim_command_iface(rtmsim_iface* iface, uint32_t kind, const double* values, size_t count);

/* 1 while the server lives and the iface is its. */
int rtmsim_is_live(const rtmsim_iface* iface);
/* Attaches to the iface that has the name now, keeps the subscription. */
int rtmsim_reopen(rtmsim_iface* iface);

rtmsim_requester* rtmsim_open_requester(uint32_t server);
void rtmsim_close_requester(rtmsim_requester* requester);
/* Asks and waits. `text` may be null. Returns RTMSIM_STATUS_* of the reply, or -1 when there was none; then reply is not touched.
 * *reply_text (may be a null pointer) is valid until the next request. */
int rtmsim_request(rtmsim_requester* requester, uint32_t kind, const rtmsim_request_body* body, const char* text, size_t text_length,
                   rtmsim_reply_body* reply, const char** reply_text, int64_t timeout);

#ifdef __cplusplus
}
#endif
#endif
