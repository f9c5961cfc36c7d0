// Windows on SDL's display without a screen: the ones of a process share a thread, and any thread may use them.
#include "window.h"

#include <SDL.h>
#include <gtest/gtest.h>

#include <chrono>
#include <thread>
#include <vector>

#include "support/process.h"

namespace video {
namespace {

struct Windows : testing::Test {
  Windows() { setenv("SDL_VIDEODRIVER", "dummy", 1); }
};

std::shared_ptr<const Picture> picture(int width, int height) {
  auto made = std::make_shared<Picture>();
  made->width = width;
  made->height = height;
  made->rgb.assign(static_cast<std::size_t>(3 * width * height), 100);
  return made;
}

// The first events of the window that are any.
Events awaited(Window& window) {
  const auto end = std::chrono::steady_clock::now() + support::watchdog;
  while (std::chrono::steady_clock::now() < end) {
    const auto events = window.events();
    if (events.toggle_pause || events.save || events.close || !events.problem.empty()) return events;
    std::this_thread::yield();
  }
  ADD_FAILURE() << "no event";
  return {};
}

void press(SDL_Keycode key, std::uint32_t window) {
  SDL_Event event{};
  event.type = SDL_KEYDOWN;
  event.key.windowID = window;
  event.key.keysym.sym = key;
  SDL_PushEvent(&event);
}

TEST_F(Windows, without_a_display_says_so) {
  unsetenv("SDL_VIDEODRIVER");
  unsetenv("DISPLAY");
  unsetenv("WAYLAND_DISPLAY");
  std::string problem;
  EXPECT_FALSE(Window::open("player", problem));
  EXPECT_EQ(problem, "there is no display");
  setenv("SDL_VIDEODRIVER", "nonsense", 1);
  EXPECT_FALSE(Window::open("player", problem));
  EXPECT_NE(problem.find("the display cannot be used"), std::string::npos) << problem;
  setenv("SDL_VIDEODRIVER", "dummy", 1);
  EXPECT_TRUE(Window::open("player", problem)) << "a failure leaves nothing behind";
}

TEST_F(Windows, keys_reach_the_window_that_has_them) {
  std::string problem;
  auto first = Window::open("first", problem), second = Window::open("second", problem);
  ASSERT_TRUE(first && second) << problem;
  press(SDLK_SPACE, 2);
  EXPECT_TRUE(awaited(*second).toggle_pause);
  press(SDLK_s, 1);
  EXPECT_TRUE(awaited(*first).save);
  for (const auto key : {SDLK_q, SDLK_ESCAPE}) {
    press(key, 2);
    EXPECT_TRUE(awaited(*second).close);
  }
  const auto left = first->events();
  EXPECT_FALSE(left.toggle_pause || left.close);
}

TEST_F(Windows, pictures_of_any_size_follow_each_other_from_many_threads) {
  std::vector<std::jthread> owners;
  for (int owner = 0; owner < 4; ++owner) {
    owners.emplace_back([owner] {
      for (int round = 0; round < 5; ++round) {
        std::string problem;
        auto window = Window::open("player" + std::to_string(owner), problem);
        ASSERT_TRUE(window) << problem;
        for (int i = 1; i < 40; ++i) {
          window->show(picture(1 + 7 * (i % 11), 1 + 5 * (i % 7)));
          window->set_title(std::to_string(i));
          EXPECT_EQ(window->events().problem, "");
        }
      }
    });
  }
}

}  // namespace
}  // namespace video
