#include "base/base64.h"

#include <gtest/gtest.h>

#include <string>

namespace {

TEST(Base64, the_vectors_of_rfc_4648) {
  const std::pair<std::string, std::string> vectors[] = {
      {"", ""}, {"f", "Zg=="}, {"fo", "Zm8="}, {"foo", "Zm9v"}, {"foob", "Zm9vYg=="}, {"fooba", "Zm9vYmE="}, {"foobar", "Zm9vYmFy"}};
  for (const auto& [bytes, text] : vectors) {
    EXPECT_EQ(base::to_base64(bytes), text);
    EXPECT_EQ(base::from_base64(text), bytes);
  }
}

TEST(Base64, every_byte_comes_back) {
  std::string bytes;
  for (int i = 0; i < 256; ++i) bytes += static_cast<char>(i);
  for (std::size_t cut = 0; cut < 4; ++cut) {
    const auto part = bytes.substr(cut);
    EXPECT_EQ(base::from_base64(base::to_base64(part)), part);
  }
}

TEST(Base64, decoding_ends_at_a_character_outside_the_alphabet) {
  EXPECT_EQ(base::from_base64("Zm9v!Zm9v"), "foo");
  EXPECT_EQ(base::from_base64("*"), "");
}

}  // namespace
