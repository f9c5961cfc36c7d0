// Finds the code that ended a worker.
#include "fuzz/worker.h"

#include <gtest/gtest.h>

namespace {

TEST(FuzzWorker, the_first_frame_is_the_first_one_outside_of_the_libraries_that_report) {
  const std::string report =
      "==1==ERROR: AddressSanitizer: ABRT on unknown address 0x000000006b0b (pc 0x7f17 bp 0x7f17 sp 0x7f17 T1)\n"
      "    #0 0x7f171b8a8eec  (/lib/x86_64-linux-gnu/libc.so.6+0x8aeec)\n"
      "    #1 0x7f171b844471  (/lib/x86_64-linux-gnu/libc.so.6+0x26471) (BuildId: 79005c16)\n"
      "    #2 0x7f171cbc19b4  (/lib/x86_64-linux-gnu/libassimp.so.5+0x1c19b4) (BuildId: 2f5fa1a6)\n"
      "    #3 0x55e0db228c65  (/build/bin/asset_campaign+0xafbc65)\n";
  EXPECT_EQ(fuzz::first_frame(report), "libassimp.so.5+0x1c19b4");
  EXPECT_EQ(fuzz::first_frame("AddressSanitizer:DEADLYSIGNAL\n"), "");
}

}  // namespace
