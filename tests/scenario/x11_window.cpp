// What a person at a screen does and sees, for tests: x11_window TITLE COMMAND. TITLE: how the window's title begins.
//   shot OUT.ppm   the window's pixels          title   its whole title          size    width and height
//   key NAME       press and release a key      resize W H                       close   as its button does
// Exit code 3: there is no such window.
#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <X11/extensions/XTest.h>
#include <X11/keysym.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string>

#include "support/usage.h"

namespace {

std::string title_of(Display* display, Window window) {
  char* name = nullptr;
  if (XFetchName(display, window, &name) == 0 || name == nullptr) return {};
  const std::string title = name;
  XFree(name);
  return title;
}

std::optional<Window> find(Display* display, Window above, const std::string& begin) {
  Window root = 0, parent = 0, *children = nullptr;
  unsigned int count = 0;
  if (XQueryTree(display, above, &root, &parent, &children, &count) == 0) return std::nullopt;
  std::optional<Window> found;
  for (unsigned int i = 0; i < count && !found; ++i) {
    XWindowAttributes attributes;
    const bool is_shown = XGetWindowAttributes(display, children[i], &attributes) != 0 && attributes.map_state == IsViewable;
    if (is_shown && title_of(display, children[i]).starts_with(begin)) found = children[i];
    if (!found) found = find(display, children[i], begin);
  }
  if (children) XFree(children);
  return found;
}

int shot(Display* display, Window window, const char* path) {
  XWindowAttributes size;
  XGetWindowAttributes(display, window, &size);
  XImage* image =
      XGetImage(display, window, 0, 0, static_cast<unsigned>(size.width), static_cast<unsigned>(size.height), AllPlanes, ZPixmap);
  std::FILE* file = image ? std::fopen(path, "wb") : nullptr;
  if (!file) return 1;
  std::fprintf(file, "P6\n%d %d\n255\n", size.width, size.height);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const unsigned long pixel = XGetPixel(image, x, y);
      for (const int shift : {16, 8, 0}) std::fputc(static_cast<int>((pixel >> shift) & 0xff), file);
    }
  }
  std::fclose(file);
  XDestroyImage(image);
  return 0;
}

int press(Display* display, Window window, const char* name) {
  const KeySym symbol = XStringToKeysym(name);
  const KeyCode code = symbol == NoSymbol ? static_cast<KeyCode>(0) : XKeysymToKeycode(display, symbol);
  if (code == 0) return 1;
  XSetInputFocus(display, window, RevertToParent, CurrentTime);
  XSync(display, False);
  XTestFakeKeyEvent(display, code, True, CurrentTime);
  XTestFakeKeyEvent(display, code, False, CurrentTime);
  XSync(display, False);
  return 0;
}

int close(Display* display, Window window) {
  XEvent event{};
  event.xclient.type = ClientMessage;
  event.xclient.window = window;
  event.xclient.message_type = XInternAtom(display, "WM_PROTOCOLS", False);
  event.xclient.format = 32;
  event.xclient.data.l[0] = static_cast<long>(XInternAtom(display, "WM_DELETE_WINDOW", False));
  XSendEvent(display, window, False, NoEventMask, &event);
  XSync(display, False);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  ::test::answer_help(argc, argv, "x11_window TITLE shot FILE|key NAME|close|title|size\nOperates a window for the tests of VideoPlayer.");
  if (argc < 3) return 2;
  Display* display = XOpenDisplay(nullptr);
  if (!display) return 1;
  // A window may go between two calls: no reason to die.
  XSetErrorHandler([](Display*, XErrorEvent*) { return 0; });
  const auto window = find(display, DefaultRootWindow(display), argv[1]);
  if (!window) return 3;
  const std::string command = argv[2];
  int code = 2;
  if (command == "shot" && argc == 4) code = shot(display, *window, argv[3]);
  if (command == "key" && argc == 4) code = press(display, *window, argv[3]);
  if (command == "close") code = close(display, *window);
  if (command == "title") code = std::puts(title_of(display, *window).c_str()) < 0;
  if (command == "size") {
    XWindowAttributes size;
    code = XGetWindowAttributes(display, *window, &size) == 0;
    std::printf("%d %d\n", size.width, size.height);
  }
  if (command == "resize" && argc == 5) {
    code = XResizeWindow(display, *window, static_cast<unsigned>(std::atoi(argv[3])), static_cast<unsigned>(std::atoi(argv[4]))) == 0;
    XSync(display, False);
  }
  XCloseDisplay(display);
  return code;
}
