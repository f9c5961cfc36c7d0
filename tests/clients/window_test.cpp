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
  const auto none = Window::open("player");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().message, "there is no display");
  setenv("SDL_VIDEODRIVER", "nonsense", 1);
  const auto wrong = Window::open("player");
  ASSERT_FALSE(wrong);
  EXPECT_NE(wrong.error().message.find("the display cannot be used"), std::string::npos) << wrong.error().message;
  setenv("SDL_VIDEODRIVER", "dummy", 1);
  EXPECT_TRUE(Window::open("player")) << "a failure leaves nothing behind";
}

TEST_F(Windows, keys_reach_the_window_that_has_them) {
  auto first = Window::open("first"), second = Window::open("second");
  ASSERT_TRUE(first && second);
  press(SDLK_SPACE, 2);
  EXPECT_TRUE(awaited(**second).toggle_pause);
  press(SDLK_s, 1);
  EXPECT_TRUE(awaited(**first).save);
  for (const auto key : {SDLK_q, SDLK_ESCAPE}) {
    press(key, 2);
    EXPECT_TRUE(awaited(**second).close);
  }
  const auto left = (*first)->events();
  EXPECT_FALSE(left.toggle_pause || left.close);
}

TEST_F(Windows, pictures_of_any_size_follow_each_other_from_many_threads) {
  std::vector<std::jthread> owners;
  for (int owner = 0; owner < 4; ++owner) {
    owners.emplace_back([owner] {
      for (int round = 0; round < 5; ++round) {
        auto window = Window::open("player" + std::to_string(owner));
        ASSERT_TRUE(window) << window.error().message;
        for (int i = 1; i < 40; ++i) {
          (*window)->show(picture(1 + 7 * (i % 11), 1 + 5 * (i % 7)));
          (*window)->set_title(std::to_string(i));
          EXPECT_EQ((*window)->events().problem, "");
        }
      }
    });
  }
}

}  // namespace
}  // namespace video
