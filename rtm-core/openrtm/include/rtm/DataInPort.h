// Kept for its name: all of it is in InPort.h.
#pragma once
#include "rtm/InPort.h"
