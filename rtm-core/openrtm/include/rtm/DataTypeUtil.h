// Kept for its name: what is known about data types at run time.
#pragma once

#include "rtm/Typename.h"
