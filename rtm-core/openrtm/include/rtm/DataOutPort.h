// Kept for its name: all of it is in OutPort.h.
#pragma once
#include "rtm/OutPort.h"
