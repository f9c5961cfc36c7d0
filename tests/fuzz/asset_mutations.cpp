#include "fuzz/asset_mutations.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>

namespace fuzz {
namespace {

using Below = std::function<std::size_t(std::size_t)>;

const std::vector<std::string> words{"nan",
                                     "inf",
                                     "-1",
                                     "0",
                                     "1e38",
                                     "1e-38",
                                     "4294967295",
                                     "2147483647",
                                     "-2147483648",
                                     "65536",
                                     "99999999",
                                     "<",
                                     "/>",
                                     "\"",
                                     "{",
                                     "}",
                                     "[",
                                     "]",
                                     "\n",
                                     " ",
                                     "#",
                                     "//",
                                     "\xff",
                                     "property list uchar int x",
                                     "element face 1000000",
                                     "<p>x</p>",
                                     "url=\"#n\"",
                                     "count=\"7\"",
                                     "1 2 3"};

std::string mutate(std::string text, const std::string& other, const Below& below) {
  const bool is_gentle = below(2) == 0;  // numbers alone, so that more than the first line of the file is read
  for (std::size_t changes = 1 + below(below(3) == 0 ? 5 : 2); changes > 0 && !text.empty(); --changes) {
    const std::size_t at = below(text.size());
    const std::size_t length = std::min(text.size() - at, below(below(4) == 0 ? 200 : 12) + 1);
    switch (is_gentle ? 6 + below(2) : below(9)) {
      case 0:
        text[at] = static_cast<char>(below(256));
        break;
      case 1:
        text.erase(at, length);
        break;
      case 2:
        text.insert(at, words[below(words.size())]);
        break;
      case 3:
        text.replace(at, length, words[below(words.size())]);
        break;
      case 4:
        text.insert(below(text.size()), text.substr(at, length));
        break;
      case 5:
        text.resize(at);
        break;
      case 6: {  // another number
        const std::size_t digit = text.find_first_of("0123456789", at);
        if (digit != std::string::npos) text.replace(digit, text.find_first_not_of("0123456789.e-", digit) - digit, words[below(11)]);
        break;
      }
      case 7: {  // four bytes, as binary formats count with
        const std::uint32_t values[] = {0, 1, 0xff, 0xffff, 0x7fffffff, 0x80000000, 0xffffffff, 0x10000, 0x7f800000, 0x7fc00000};
        const std::uint32_t value = values[below(std::size(values))];
        for (std::size_t i = 0; i < 4 && at + i < text.size(); ++i) text[at + i] = static_cast<char>(value >> (8 * i));
        break;
      }
      default:
        if (!other.empty()) text.insert(at, other.substr(below(other.size()), length));
    }
  }
  return text;
}

}  // namespace

std::vector<Seed> seeds_of(std::vector<std::filesystem::path> files) {
  std::erase_if(files, [](const std::filesystem::path& file) { return file.extension() == ".mtl" || file.extension() == ".py"; });
  std::sort(files.begin(), files.end());
  std::vector<Seed> seeds;
  for (const std::filesystem::path& file : files) {
    std::ifstream stream(file, std::ios::binary);
    seeds.push_back({file, {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()}});
  }
  return seeds;
}

std::string mutation(const std::vector<Seed>& seeds, std::size_t which, unsigned seed, long number) {
  std::seed_seq numbers{static_cast<long>(seed), static_cast<long>(which), number};
  std::mt19937 random(numbers);
  const Below below = [&](std::size_t n) { return n == 0 ? std::size_t{0} : std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
  return mutate(seeds[which].content, seeds[below(seeds.size())].content, below);
}

}  // namespace fuzz
