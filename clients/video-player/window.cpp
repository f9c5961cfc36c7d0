#include "window.h"

#include <SDL.h>

#include <cstdlib>

namespace video {

struct Window::Impl {
  SDL_Window* window = nullptr;
  SDL_Renderer* renderer = nullptr;
  SDL_Texture* texture = nullptr;
  int width = 0;
  int height = 0;

  ~Impl() {
    if (texture) SDL_DestroyTexture(texture);
    if (renderer) SDL_DestroyRenderer(renderer);
    if (window) SDL_DestroyWindow(window);
    SDL_QuitSubSystem(SDL_INIT_VIDEO);
  }
};

Window::Window() : impl_(std::make_unique<Impl>()) {}
Window::~Window() = default;

base::Result<std::unique_ptr<Window>> Window::open(const std::string& title) {
  if (!std::getenv("DISPLAY") && !std::getenv("WAYLAND_DISPLAY") && !std::getenv("SDL_VIDEODRIVER"))
    return base::Error{"there is no display"};
  SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");  // the manager ends the process, not the window
  if (SDL_InitSubSystem(SDL_INIT_VIDEO) != 0) return base::Error{std::string("the display cannot be used: ") + SDL_GetError()};
  std::unique_ptr<Window> window(new Window);
  auto& impl = *window->impl_;
  impl.window = SDL_CreateWindow(title.c_str(), SDL_WINDOWPOS_UNDEFINED, SDL_WINDOWPOS_UNDEFINED, 640, 480, SDL_WINDOW_RESIZABLE);
  if (!impl.window) return base::Error{std::string("the window cannot be made: ") + SDL_GetError()};
  impl.renderer = SDL_CreateRenderer(impl.window, -1, SDL_RENDERER_SOFTWARE);
  if (!impl.renderer) return base::Error{std::string("the window cannot be drawn to: ") + SDL_GetError()};
  return window;
}

void Window::show(const Picture& picture) {
  auto& impl = *impl_;
  if (picture.width != impl.width || picture.height != impl.height || !impl.texture) {
    if (impl.texture) SDL_DestroyTexture(impl.texture);
    impl.texture = SDL_CreateTexture(impl.renderer, SDL_PIXELFORMAT_RGB24, SDL_TEXTUREACCESS_STREAMING, picture.width, picture.height);
    impl.width = picture.width;
    impl.height = picture.height;
    SDL_SetWindowSize(impl.window, picture.width, picture.height);
    SDL_RenderSetLogicalSize(impl.renderer, picture.width, picture.height);
  }
  if (!impl.texture) return;
  SDL_UpdateTexture(impl.texture, nullptr, picture.rgb.data(), 3 * picture.width);
  SDL_RenderClear(impl.renderer);
  SDL_RenderCopy(impl.renderer, impl.texture, nullptr, nullptr);
  SDL_RenderPresent(impl.renderer);
}

void Window::set_title(const std::string& title) { SDL_SetWindowTitle(impl_->window, title.c_str()); }

Events Window::events() {
  Events events;
  SDL_Event event;
  while (SDL_PollEvent(&event) != 0) {
    if (event.type == SDL_QUIT) events.close = true;
    if (event.type != SDL_KEYDOWN) continue;
    if (event.key.keysym.sym == SDLK_SPACE) events.toggle_pause = true;
    if (event.key.keysym.sym == SDLK_s) events.save = true;
    if (event.key.keysym.sym == SDLK_q) events.close = true;
  }
  return events;
}

}  // namespace video
