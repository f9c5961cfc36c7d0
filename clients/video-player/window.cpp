#include "window.h"

#include <SDL.h>
#include <SDL_syswm.h>
#include <X11/Xlib.h>
#include <base/guarded.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <functional>
#include <future>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace video {

// What a window's owner and the thread of the display tell each other.
struct Window::Shared {
  struct State {
    std::shared_ptr<const Picture> picture;  // to be shown; empty: nothing new
    std::string title;                       // the same
    Events events;
  };
  base::Guarded<State, base::Rank::buffer> state;
};

// A window as SDL knows it. The thread of the display only.
class Window::Pane {
 public:
  static base::Result<std::unique_ptr<Pane>> open(std::shared_ptr<Shared> shared, const std::string& title) {
    std::unique_ptr<Pane> pane(new Pane(std::move(shared)));
    pane->window_ = SDL_CreateWindow(title.c_str(), SDL_WINDOWPOS_UNDEFINED, SDL_WINDOWPOS_UNDEFINED, 640, 480, SDL_WINDOW_RESIZABLE);
    if (!pane->window_) return base::Error{std::string("the window cannot be made: ") + SDL_GetError()};
    pane->renderer_ = SDL_CreateRenderer(pane->window_, -1, SDL_RENDERER_SOFTWARE);
    if (!pane->renderer_) return base::Error{std::string("the window cannot be drawn to: ") + SDL_GetError()};
    pane->draw();
    return pane;
  }
  ~Pane() {
    if (texture_) SDL_DestroyTexture(texture_);
    if (renderer_) SDL_DestroyRenderer(renderer_);
    if (window_) SDL_DestroyWindow(window_);
  }
  Pane(const Pane&) = delete;
  Pane& operator=(const Pane&) = delete;

  const Shared* shared() const { return shared_.get(); }
  bool has(std::uint32_t id) const { return SDL_GetWindowID(window_) == id; }
  // Null when it is not X11.
  Display* display() const {
    SDL_SysWMinfo info;
    SDL_VERSION(&info.version);
    return SDL_GetWindowWMInfo(window_, &info) == SDL_TRUE && info.subsystem == SDL_SYSWM_X11 ? info.info.x11.display : nullptr;
  }
  void lose() const { shared_->state.lock()->events.lost = true; }

  void take(const SDL_Event& event) {
    auto state = shared_->state.lock();
    if (event.type == SDL_WINDOWEVENT) {
      if (event.window.event == SDL_WINDOWEVENT_CLOSE) state->events.close = true;
      if (event.window.event == SDL_WINDOWEVENT_EXPOSED || event.window.event == SDL_WINDOWEVENT_SIZE_CHANGED) is_stale_ = true;
    }
    if (event.type != SDL_KEYDOWN || event.key.repeat != 0) return;
    const auto key = event.key.keysym.sym;
    if (key == SDLK_SPACE) state->events.toggle_pause = !state->events.toggle_pause;
    if (key == SDLK_s) state->events.save = true;
    if (key == SDLK_q || key == SDLK_ESCAPE) state->events.close = true;
  }

  void refresh() {
    std::shared_ptr<const Picture> picture;
    std::string title;
    {
      auto state = shared_->state.lock();
      picture = std::exchange(state->picture, nullptr);
      title = std::exchange(state->title, {});
    }
    if (!title.empty()) SDL_SetWindowTitle(window_, title.c_str());
    if (picture) put(*picture);
    if (picture || is_stale_) draw();
  }

 private:
  explicit Pane(std::shared_ptr<Shared> shared) : shared_(std::move(shared)) {}

  void put(const Picture& picture) {
    if (picture.width != width_ || picture.height != height_ || !texture_) fit(picture.width, picture.height);
    if (!texture_) return fail("cannot be shown");
    if (SDL_UpdateTexture(texture_, nullptr, picture.rgb.data(), 3 * picture.width) != 0) fail("cannot be shown");
  }
  void fit(int width, int height) {
    if (texture_) SDL_DestroyTexture(texture_);
    texture_ = SDL_CreateTexture(renderer_, SDL_PIXELFORMAT_RGB24, SDL_TEXTUREACCESS_STREAMING, width, height);
    width_ = width;
    height_ = height;
    SDL_Rect screen{0, 0, width, height};
    SDL_GetDisplayUsableBounds(std::max(SDL_GetWindowDisplayIndex(window_), 0), &screen);
    const double shrink = std::min({1.0, static_cast<double>(screen.w) / width, static_cast<double>(screen.h) / height});
    SDL_SetWindowSize(window_, std::max(1, static_cast<int>(width * shrink)), std::max(1, static_cast<int>(height * shrink)));
    SDL_RenderSetLogicalSize(renderer_, width, height);
  }
  void draw() {
    SDL_SetRenderDrawColor(renderer_, 0, 0, 0, 255);
    SDL_RenderClear(renderer_);
    if (texture_) SDL_RenderCopy(renderer_, texture_, nullptr, nullptr);
    SDL_RenderPresent(renderer_);
    is_stale_ = false;
  }
  void fail(const std::string& what) {
    shared_->state.lock()->events.problem =
        "picture of " + std::to_string(width_) + "x" + std::to_string(height_) + " " + what + ": " + SDL_GetError();
  }

  std::shared_ptr<Shared> shared_;
  SDL_Window* window_ = nullptr;
  SDL_Renderer* renderer_ = nullptr;
  SDL_Texture* texture_ = nullptr;
  int width_ = 0, height_ = 0;
  bool is_stale_ = false;  // what is on the display
};

// The thread of the display. One per process, as SDL is.
//
// When the X server dies Xlib wants to end the process. Its handler for that does not return: the thread stays where it is for ever, and
// whoever waits for it is told. Nobody but the thread touches the display, so nobody else can meet its end.
class Window::Screen {
 public:
  static Screen& one() {
    static Screen screen;
    return screen;
  }

  ~Screen() {
    if (panes_open_ > 0) end();  // the process ends with its windows open
  }

  base::Result<void> open(const std::shared_ptr<Shared>& shared, const std::string& title) {
    const std::scoped_lock lock(turnstile_);
    if (state_.lock()->is_lost) return lost();
    if (panes_open_ == 0) {
      if (auto started = start(); !started) return started;
    }
    base::Result<void> opened;
    const bool is_there = run_there([&] {
      auto pane = Pane::open(shared, title);
      if (!pane) {
        opened = pane.error();
        return;
      }
      watch(**pane);
      panes_.push_back(std::move(*pane));
    });
    if (!is_there) opened = lost();
    if (opened) ++panes_open_;
    if (panes_open_ == 0) end();
    return opened;
  }
  void close(const Shared* shared) {
    const std::scoped_lock lock(turnstile_);
    run_there([&] { std::erase_if(panes_, [&](const auto& pane) { return pane->shared() == shared; }); });
    if (--panes_open_ == 0) end();
  }
  // Any thread.
  void wake() const {
    const std::uint64_t one = 1;
    if (::write(bell_, &one, sizeof one) < 0) return;  // it rings already
  }

 private:
  struct State {
    std::vector<std::function<void()>> tasks;
    std::uint64_t tasks_given = 0, tasks_done = 0;
    bool is_lost = false;
  };

  static base::Error lost() { return base::Error{"the display of this process has gone"}; }

  base::Result<void> start() {
    std::promise<base::Result<void>> started;
    is_ending_ = false;
    display_ = nullptr;
    thread_ = std::jthread([&] { run(started); });
    auto result = started.get_future().get();
    if (!result) thread_.join();
    return result;
  }
  void end() {
    if (run_there([this] { is_ending_ = true; })) return thread_.join();
    if (thread_.joinable()) thread_.detach();
    for (auto& pane : panes_) (void)pane.release();  // there is nothing left that they could give back
    panes_.clear();
  }
  // False when the display has gone; then the work has not been finished and never will be.
  bool run_there(const std::function<void()>& work) {
    std::uint64_t number = 0;
    {
      auto state = state_.lock();
      if (state->is_lost) return false;
      state->tasks.push_back(work);
      number = ++state->tasks_given;
    }
    wake();
    auto state = state_.lock();
    while (!state.wait_for(changed_, std::chrono::hours(1), [&] { return state->tasks_done >= number || state->is_lost; })) {
    }
    return state->tasks_done >= number;
  }

  void run(std::promise<base::Result<void>>& started) {
    SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");  // the manager ends the process, not the window
    SDL_SetHint(SDL_HINT_VIDEO_ALLOW_SCREENSAVER, "1");
    // Pictures go to the X server as they are. GL would hang at the end of a process that has lost its display.
    SDL_SetHint(SDL_HINT_FRAMEBUFFER_ACCELERATION, "0");
    // Without this SDL would rather draw where nobody can see it than fail. The variable SDL_VIDEODRIVER still wins.
    SDL_SetHint(SDL_HINT_VIDEODRIVER, "x11,wayland");
    if (SDL_InitSubSystem(SDL_INIT_VIDEO) != 0)
      return started.set_value(base::Error{std::string("the display cannot be used: ") + SDL_GetError()});
    started.set_value({});
    while (!is_ending_) {
      const bool was_busy = take_events();
      const auto tasks = std::exchange(state_.lock()->tasks, {});
      for (const auto& task : tasks) {
        task();
        ++state_.lock()->tasks_done;
        changed_.notify_all();
      }
      for (auto& pane : panes_) pane->refresh();
      // Drawing may have brought events along, which no longer wait in the connection.
      if (!was_busy && !is_ending_ && !take_events()) sleep();
    }
    SDL_QuitSubSystem(SDL_INIT_VIDEO);
  }
  // Until somebody rings or the display has something to say.
  void sleep() const {
    pollfd wanted[2] = {{bell_, POLLIN, 0}, {display_ != nullptr ? ConnectionNumber(display_) : -1, POLLIN, 0}};
    // Other kinds of display do not show their connection; a key may wait for a moment there.
    const int limit = display_ == nullptr && !panes_.empty() ? 20 : -1;
    if (::poll(wanted, 2, limit) <= 0 || wanted[0].revents == 0) return;
    std::uint64_t rings = 0;
    if (::read(bell_, &rings, sizeof rings) < 0) return;
  }
  bool take_events() {
    SDL_Event event;
    bool is_any = false;
    while (SDL_PollEvent(&event) != 0) handle(event), is_any = true;
    return is_any;
  }
  void handle(const SDL_Event& event) {
    if (event.type != SDL_WINDOWEVENT && event.type != SDL_KEYDOWN) return;
    const auto id = event.type == SDL_WINDOWEVENT ? event.window.windowID : event.key.windowID;
    for (auto& pane : panes_) {
      if (pane->has(id)) pane->take(event);
    }
  }

  // From the first window on the display is known.
  void watch(const Pane& pane) {
    if (display_ != nullptr) return;
    display_ = pane.display();
    // Of all connections: SDL has a second one, and Xlib's own handler ends the process before it asks that of a single connection.
    if (display_ != nullptr) XSetIOErrorHandler([](Display*) -> int { one().lose(); });
  }
  [[noreturn]] void lose() {
    for (const auto& pane : panes_) {
      if (pane) pane->lose();  // one that is being closed is gone already
    }
    state_.lock()->is_lost = true;
    changed_.notify_all();
    while (true) ::poll(nullptr, 0, -1);
  }

  const int bell_ = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  std::mutex turnstile_;  // whoever opens or closes goes through here, one at a time, and waits for the display meanwhile
  int panes_open_ = 0;
  base::Guarded<State, base::Rank::buffer> state_;
  std::condition_variable changed_;
  std::vector<std::unique_ptr<Pane>> panes_;  // the thread's, like what follows
  Display* display_ = nullptr;                // of X11; SDL's
  bool is_ending_ = false;
  std::jthread thread_;
};

Window::Window(std::shared_ptr<Shared> shared) : shared_(std::move(shared)) {}
Window::~Window() { Screen::one().close(shared_.get()); }

base::Result<std::unique_ptr<Window>> Window::open(const std::string& title) {
  const auto has = [](const char* name) { return std::getenv(name) != nullptr && *std::getenv(name) != '\0'; };
  if (!has("DISPLAY") && !has("WAYLAND_DISPLAY") && !has("SDL_VIDEODRIVER")) return base::Error{"there is no display"};
  auto shared = std::make_shared<Shared>();
  if (auto opened = Screen::one().open(shared, title); !opened) return opened.error();
  return std::unique_ptr<Window>(new Window(std::move(shared)));
}

void Window::show(std::shared_ptr<const Picture> picture) {
  shared_->state.lock()->picture = std::move(picture);
  Screen::one().wake();
}

void Window::set_title(const std::string& title) {
  shared_->state.lock()->title = title;
  Screen::one().wake();
}

Events Window::events() { return std::exchange(shared_->state.lock()->events, {}); }

}  // namespace video
