// A window that shows pictures, by SDL2. All calls from the thread that opened it.
#pragma once

#include <base/result.h>

#include <memory>
#include <string>

#include "picture.h"

namespace video {

struct Events {
  bool toggle_pause = false;  // space
  bool save = false;          // s
  bool close = false;         // the window's button, or q
};

class Window {
 public:
  // Fails when there is no display.
  static base::Result<std::unique_ptr<Window>> open(const std::string& title);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  // Fits the picture into the window; the first one, and each of another size, sets the window's size.
  void show(const Picture& picture);
  void set_title(const std::string& title);
  Events events();

 private:
  Window();
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace video
