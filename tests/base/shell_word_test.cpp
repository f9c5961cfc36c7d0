#include "base/shell_word.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <random>

namespace base {
namespace {

// What a shell makes of the words of a line.
std::vector<std::string> read_by(const std::string& shell, const std::string& line) {
  std::string script = testing::TempDir() + "shell_word_XXXXXX";
  const int file = mkstemp(script.data());
  if (file >= 0) ::close(file);
  std::ofstream(script) << (shell == "bash" ? "set -o history -o histexpand\n" : "") << "printf '%s\\0' " << line << '\n';
  std::vector<std::string> words;
  if (FILE* pipe = ::popen((shell + " " + script + " 2>&1").c_str(), "r")) {
    std::string word;
    for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) {
      if (c != 0) {
        word += static_cast<char>(c);
        continue;
      }
      words.push_back(std::move(word));
      word.clear();
    }
    if (!word.empty()) words.push_back("no end: " + word);
    ::pclose(pipe);
  }
  std::remove(script.c_str());
  return words;
}

bool is_printable_ascii(const std::string& text) {
  return std::ranges::all_of(text, [](char c) { return c >= ' ' && c <= '~'; });
}

std::vector<std::string> hostile_words() {
  std::vector<std::string> words{"",
                                 "plain",
                                 "it's",
                                 "'",
                                 "\\",
                                 "$(touch /tmp/x)",
                                 "`id`",
                                 "a b;c&d|e>f<g",
                                 "!!",
                                 "!$ it's",
                                 "\x1b[201~\nid\n",
                                 "\x1b[200~",
                                 "new\nline",
                                 "\r\t\b\x7f",
                                 "\x01"
                                 "ff",
                                 "=ls",
                                 "%1",
                                 "~root",
                                 "{a,b}",
                                 "*?[a]",
                                 "-rf",
                                 "--",
                                 "#no comment",
                                 "$HOME",
                                 "\"",
                                 "\\x41",
                                 "\\'!\n",
                                 "caf\xc3\xa9",
                                 "\xe6\x97\xa5\xe6\x9c\xac",
                                 "\xe2\x80\xae"
                                 "gpj.exe",
                                 "\xc2\x9b"
                                 "31m",
                                 "\xff\xfe"};
  for (int c = 1; c < 256; ++c) words.push_back(std::string("a") + static_cast<char>(c) + "0");
  const unsigned seed = std::random_device{}();
  std::printf("seed %u\n", seed);
  std::mt19937 dice(seed);
  for (int n = 0; n < 300; ++n) {
    std::string word;
    for (unsigned k = dice() % 20; k > 0; --k) word += static_cast<char>(1 + dice() % 255);
    words.push_back(word);
  }
  return words;
}

TEST(ShellWord, is_read_back_by_bash_and_holds_printable_ascii_only) {
  const auto words = hostile_words();
  const auto line = shell_line(words);
  EXPECT_TRUE(is_printable_ascii(line)) << line;
  EXPECT_EQ(read_by("bash", line), words);
}

TEST(ShellWord, is_read_back_by_zsh_where_there_is_one) {
  if (std::system("zsh -c true >/dev/null 2>&1") != 0) GTEST_SKIP() << "no zsh";
  const auto words = hostile_words();
  EXPECT_EQ(read_by("zsh -f", shell_line(words)), words);
}

TEST(ScriptWord, is_read_back_by_the_plain_shell) {
  const auto words = hostile_words();
  std::string line;
  for (const auto& word : words) line += script_word(word) + " ";
  EXPECT_EQ(read_by("sh", line), words);
}

TEST(ShellWord, stays_readable_where_no_shell_minds) {
  EXPECT_EQ(shell_line({"rtse", "conf", "it's", "", "a b;$(x)", "/h:2809/a.rtc"}), "rtse conf 'it'\\''s' '' 'a b;$(x)' /h:2809/a.rtc");
  EXPECT_EQ(shell_word("a\n1"), "$'a\\x0a1'");
  EXPECT_EQ(shell_word(std::string("a\0b", 3)), "$'ab'");
}

using Words = std::vector<std::string>;

TEST(CommandWords, no_operand_is_read_as_an_option) {
  EXPECT_EQ(command_words({"simctl", "pose"}, {"box", "-1", "2", "-0.5"}), (Words{"simctl", "pose", "box", "-1", "2", "-0.5"}));
  EXPECT_EQ(command_words({"rtse", "cat"}, {"a"}, {"-e", "1"}), (Words{"rtse", "cat", "a", "-e", "1"}));
  EXPECT_EQ(command_words({"rtse", "cat"}, {"--help", "-1"}, {"-e", "1"}), (Words{"rtse", "cat", "-e", "1", "--", "--help", "-1"}));
  EXPECT_EQ(command_words({"rtm-studio"}, {"-"}), (Words{"rtm-studio", "--", "-"}));
}

TEST(CommandWords, no_value_is_read_as_an_option) {
  EXPECT_EQ(option_words("-n", "name"), (Words{"-n", "name"}));
  EXPECT_EQ(option_words("-n", "-name"), (Words{"-n-name"}));
  EXPECT_EQ(option_words("--name", "--x"), (Words{"--name=--x"}));
}

}  // namespace
}  // namespace base
