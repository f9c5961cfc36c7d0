// A window that shows images, by SDL2. SDL requires every call from the thread that opened the display, and has one queue of events for the
// whole process. So the windows of a process share a thread of their own. Any thread may open, use and close a window, several at the same
// time. Only open, close and the destructor wait for the display, for at most one and a half seconds.
//
// An X server that exits blocks that thread forever instead of ending the process: Xlib's handler must not return into SDL, which cannot
// leave a dead display. A stopped X server gets one and a half seconds for each answer. Then the thread is abandoned, and the component
// continues.
#pragma once

#include <memory>
#include <string>

#include "picture.h"

namespace video {

// What happened since the last look.
struct Events {
  bool toggle_pause = false;  // space
  bool save = false;          // s
  bool close = false;         // the window's button, q or escape
  bool lost = false;          // the display has gone, and the window with it
  std::string problem;        // a picture that could not be shown: why
};

class Window {
 public:
  // Null, and `problem` says why, when there is no display, or when it does not answer. After one has gone the process gets no other: SDL
  // cannot leave it.
  static std::unique_ptr<Window> open(const std::string& title, std::string& problem);
  // Once; then the window must not be used any more. Returns what failed, or nothing: the display may not answer (an X server that is
  // stopped); the window goes away as soon as it does.
  std::string close();
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  // Soon; a picture that comes before the last one was drawn takes its place. Fits the picture into the window; the first one, and each of
  // another size, sets the window's size as far as the display allows.
  void show(std::shared_ptr<const Picture> picture);
  void set_title(const std::string& title);
  Events events();

 private:
  struct Shared;
  class Pane;
  class Screen;
  explicit Window(std::shared_ptr<Shared> shared);
  std::shared_ptr<Shared> shared_;
};

}  // namespace video
