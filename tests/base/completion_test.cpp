#include "base/completion.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "base/command_line.h"

namespace base {
namespace {

std::vector<std::string> texts(const Completion& completion) {
  std::vector<std::string> all;
  for (const auto& offer : completion.offers) all.push_back(offer.text);
  return all;
}

// A program with two commands.
struct Program {
  Program() {
    app.without_help();
    app.add_flag("--json")->description("print JSON");
    app.add_option("-s,--server", server);
    auto* list = app.add_subcommand("list", "list all");
    list->without_help();
    list->add_option("PATH", paths)->expected(0, 2);
    list->add_option("--state", state)->check(one_of({"on", "off"}));
    list->add_option("FILE", file);
    app.add_subcommand("load", "load one")->without_help();
    auto* save = app.add_subcommand("save", "save one");
    save->without_help();
    save->add_option("--output", file)->required();
  }
  Command app;
  std::string server, state, file;
  std::vector<std::string> paths;
};

// The line that a program prints for arguments that it does not take.
std::string refusal(std::vector<std::string> words) {
  Program program;
  words.insert(words.begin(), "tool");
  std::vector<const char*> arguments;
  for (const auto& word : words) arguments.push_back(word.c_str());
  testing::internal::CaptureStderr();
  const auto code = parse_command_line(program.app, "tool", static_cast<int>(arguments.size()), arguments.data());
  EXPECT_EQ(code, 2);
  return testing::internal::GetCapturedStderr();
}

TEST(CommandLine, names_the_argument_that_is_not_known_and_the_option_that_is_near_it) {
  EXPECT_EQ(refusal({"list", "--sate", "on"}), "tool: unknown option \"--sate\"; did you mean --state?; see tool --help\n");
  EXPECT_EQ(refusal({"list", "--sate=on"}), "tool: unknown option \"--sate\"; did you mean --state?; see tool --help\n");
  EXPECT_EQ(refusal({"list", "--jsn", "--frobnicate"}), "tool: unknown option \"--jsn\"; did you mean --json?; see tool --help\n");
  EXPECT_EQ(refusal({"load", "--state", "on"}), "tool: unknown option \"--state\"; see tool --help\n") << "an option of another command";
  EXPECT_EQ(refusal({"save"}), "tool: --output is required; see tool --help\n");
  EXPECT_EQ(refusal({"save", "--outptu", "f"}), "tool: unknown option \"--outptu\"; did you mean --output?; see tool --help\n");
  EXPECT_EQ(refusal({"load", "-q"}), "tool: unknown option \"-q\"; see tool --help\n");
  EXPECT_EQ(refusal({"load", "it"}), "tool: unexpected argument \"it\"; see tool --help\n");
}

TEST(Completion, offers_commands_and_options_where_they_can_stand) {
  const Program program;
  EXPECT_EQ(texts(complete(program.app, {"l"})), (std::vector<std::string>{"list", "load"}));
  EXPECT_EQ(texts(complete(program.app, {"--j"})), std::vector<std::string>{"--json"});
  EXPECT_EQ(texts(complete(program.app, {"-s", "list", "li"})), std::vector<std::string>{"list"}) << "the value of an option is no command";
  EXPECT_EQ(texts(complete(program.app, {"list", "--"})), (std::vector<std::string>{"--state", "--json", "--server"}));
}

TEST(Completion, offers_the_fixed_words_of_an_option) {
  const Program program;
  EXPECT_EQ(texts(complete(program.app, {"list", "--state", ""})), (std::vector<std::string>{"on", "off"}));
  EXPECT_EQ(texts(complete(program.app, {"list", "--state=of"})), std::vector<std::string>{"--state=off"});
}

TEST(Completion, asks_the_program_for_each_positional_and_offers_files_otherwise) {
  const Program program;
  const Offers offers = [](const std::string& value, const std::vector<std::string>& before,
                           const std::string&) -> std::optional<std::vector<Offer>> {
    if (value != "PATH") return std::nullopt;
    return std::vector<Offer>{{"robot", std::to_string(before.size())}, {"rubble"}};
  };
  const auto second = complete(program.app, {"list", "a", "ro"}, offers);
  ASSERT_EQ(texts(second), std::vector<std::string>{"robot"});
  EXPECT_EQ(second.offers[0].description, "2") << "all words before are told";
  const auto third = complete(program.app, {"list", "a", "b", ""}, offers);
  EXPECT_TRUE(third.offers.empty());
  EXPECT_TRUE(third.files);
}

// What bash has on its line when the only candidate was taken, as the words that it would run.
std::string taken_by_bash(const std::string& candidate) {
  std::string folder = testing::TempDir() + "completion_XXXXXX";
  if (::mkdtemp(folder.data()) == nullptr) return "no folder";
  std::ofstream(folder + "/candidate") << candidate << "\tdescription\n";
  std::ofstream(folder + "/script") << completion_script("tool", "bash") << "cd '" << folder << "'\n"
                                    << "tool() { cat candidate; }\n"
                                    << "COMP_WORDS=(tool z) COMP_LINE='tool z' COMP_POINT=6 COMP_WORDBREAKS=$' \\t\\n\"\\'><=;|&(:'\n"
                                    << "_tool_completion\neval \"printf '<%s>' ${COMPREPLY[0]}\"\n";
  std::string words;
  if (FILE* pipe = ::popen(("bash " + folder + "/script 2>&1").c_str(), "r")) {
    for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) words += static_cast<char>(c);
    ::pclose(pipe);
  }
  std::filesystem::remove_all(folder);
  return words;
}

TEST(Completion, names_with_shell_characters_become_one_word_in_bash) {
  for (const char* name :
       {"zero", "z$(id -u)", "z`id`", "z;id;", "z|id", "z two", "z'", "z\"", "z\\", "z&", "z>out", "z\x1b]0;t\x07", "z~$HOME*", "z::laser"})
    EXPECT_EQ(taken_by_bash(name), "<" + std::string(name) + ">");
}

TEST(Completion, knows_the_word_that_is_no_command) {
  const Program program;
  const auto unknown = unknown_command(program.app, {"--json", "-s", "list", "lost", "x"});
  ASSERT_TRUE(unknown);
  EXPECT_EQ(unknown->word, "lost");
  EXPECT_TRUE(std::ranges::find(unknown->known, "list") != unknown->known.end());
  EXPECT_FALSE(unknown_command(program.app, {"-s", "7", "list", "lost"}));
  EXPECT_FALSE(unknown_command(program.app, {"--json"}));
}

}  // namespace
}  // namespace base
