// Images from a peer, made ready to be shown: any image must become a picture of its size or a refusal. Mutates good images; prints its
// seed.
//   picture_fuzz [--runs N] [--seed N]
#include <turbojpeg.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "picture.h"
#include "support/usage.h"

namespace {

struct Image {
  unsigned width, height, bits;
  std::string format;
  std::vector<unsigned char> octets;
};

std::vector<Image> make_seeds() {
  std::vector<Image> seeds;
  for (const auto& [format, bits] : {std::pair{"RGB8", 24U},
                                     {"BGR8", 24U},
                                     {"RGBA8", 32U},
                                     {"BGRA8", 32U},
                                     {"MONO8", 8U},
                                     {"MONO16", 16U},
                                     {"BAYER_RGGB8", 8U},
                                     {"BAYER_GRBG8", 8U},
                                     {"DEPTH32F", 32U},
                                     {"", 24U},
                                     {"bitmap", 0U}})
    seeds.push_back({16, 12, bits, format, std::vector<unsigned char>(std::size_t{16 * 12} * (bits == 0 ? 24 : bits) / 8, 100)});
  std::vector<unsigned char> pixels(16 * 12 * 3);
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<unsigned char>(i);
  void* encoder = tjInitCompress();
  unsigned char* jpeg = nullptr;
  unsigned long size = 0;
  tjCompress2(encoder, pixels.data(), 16, 0, 12, TJPF_RGB, &jpeg, &size, TJSAMP_420, 80, 0);
  seeds.push_back({16, 12, 24, "JPEG", std::vector<unsigned char>(jpeg, jpeg + size)});
  tjFree(jpeg);
  tjDestroy(encoder);
  return seeds;
}

void mutate(Image& image, std::mt19937& random) {
  const auto below = [&](std::size_t end) { return random() % end; };
  for (std::size_t i = below(4) + 1; i > 0; --i) {
    switch (below(7)) {
      case 0:
        if (!image.octets.empty()) image.octets[below(image.octets.size())] = static_cast<unsigned char>(random());
        break;
      case 1:
        image.octets.resize(below(image.octets.size() + 1));
        break;
      case 2:
        image.octets.insert(image.octets.end(), below(64), static_cast<unsigned char>(random()));
        break;
      case 3:
        image.width = below(2) == 0 ? static_cast<unsigned>(below(40)) : static_cast<unsigned>(below(65536));
        break;
      case 4:
        image.height = below(2) == 0 ? static_cast<unsigned>(below(40)) : static_cast<unsigned>(below(65536));
        break;
      case 5:
        image.bits = static_cast<unsigned>(below(65));
        break;
      default:
        if (!image.format.empty()) image.format[below(image.format.size())] = static_cast<char>(random());
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  ::test::answer_help(argc, argv, "picture_fuzz [--runs N] [--seed N]\nReads damaged images of cameras; it must not crash or hang.");
  unsigned long runs = 20000;
  unsigned seed = std::random_device()();
  for (int i = 1; i + 1 < argc; i += 2) {
    if (std::strcmp(argv[i], "--runs") == 0) runs = std::strtoul(argv[i + 1], nullptr, 10);
    if (std::strcmp(argv[i], "--seed") == 0) seed = static_cast<unsigned>(std::strtoul(argv[i + 1], nullptr, 10));
  }
  std::printf("seed %u\n", seed);
  std::mt19937 random(seed);
  const auto seeds = make_seeds();
  unsigned long pictures = 0;
  for (unsigned long run = 0; run < runs; ++run) {
    Image image = seeds[random() % seeds.size()];
    if (run >= seeds.size()) mutate(image, random);
    RTC::CameraImage sent;
    sent.width = static_cast<CORBA::UShort>(image.width);
    sent.height = static_cast<CORBA::UShort>(image.height);
    sent.bpp = static_cast<CORBA::UShort>(image.bits);
    sent.format = CORBA::string_dup(image.format.c_str());
    // A buffer of its own size, so that a sanitizer sees every octet too far.
    sent.pixels.length(static_cast<CORBA::ULong>(image.octets.size()));
    for (CORBA::ULong i = 0; i < image.octets.size(); ++i) sent.pixels[i] = image.octets[i];
    std::string problem;
    const auto picture = video::to_picture(sent, problem);
    if (picture) {
      ++pictures;
      const auto count = static_cast<std::size_t>(picture->width) * static_cast<std::size_t>(picture->height);
      if (count == 0 || picture->rgb.size() != 3 * count) return std::fprintf(stderr, "run %lu: a picture of no size\n", run), 1;
    } else if (problem.empty() || problem.size() > 400) {
      return std::fprintf(stderr, "run %lu: refused with \"%s\"\n", run, problem.c_str()), 1;
    }
  }
  std::printf("%lu of %lu images became pictures\n", pictures, runs);
  return pictures > 0 ? 0 : 1;
}
