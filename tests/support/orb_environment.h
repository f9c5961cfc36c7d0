// The ORB of a test program: started before the first test, on loopback, gone after the last. Include it in one file of the program.
#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "corba/orb/orb.h"

namespace support {

class OrbEnvironment final : public testing::Environment {
 public:
  void SetUp() override {
    auto started = corba::Orb::start({.endpoints = {}, .arguments = {}});
    ASSERT_TRUE(started) << started.error().message;
    orb_ = std::move(started).value();
    orb_->activate();
  }
  void TearDown() override { orb_.reset(); }

 private:
  std::unique_ptr<corba::Orb> orb_;
};

inline testing::Environment* const orb_environment = testing::AddGlobalTestEnvironment(new OrbEnvironment);

}  // namespace support
