// RTC::PreFsmActionListener and RTC::PostFsmActionListener, for sources that include the header of that name.
#pragma once

#include <rtm/ComponentActionListener.h>
