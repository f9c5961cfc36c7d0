#include "window.h"

#include <SDL.h>
#include <SDL_syswm.h>
#include <X11/Xlib.h>
#include <coil/Guard.h>
#include <coil/Mutex.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace video {

using Guard = coil::Guard<coil::Mutex>;

// What a window's owner and the thread of the display tell each other. With its mutex.
struct Window::Shared {
  coil::Mutex mutex;
  std::shared_ptr<const Picture> picture;  // to be shown; empty: nothing new
  std::string title;                       // the same
  Events events;
};

// A window as SDL knows it. The thread of the display only.
class Window::Pane {
 public:
  static std::unique_ptr<Pane> open(std::shared_ptr<Shared> shared, const std::string& title, std::string& problem) {
    std::unique_ptr<Pane> pane(new Pane(std::move(shared)));
    pane->window_ = SDL_CreateWindow(title.c_str(), SDL_WINDOWPOS_UNDEFINED, SDL_WINDOWPOS_UNDEFINED, 640, 480, SDL_WINDOW_RESIZABLE);
    if (pane->window_) pane->renderer_ = SDL_CreateRenderer(pane->window_, -1, SDL_RENDERER_SOFTWARE);
    if (!pane->renderer_) {
      problem = std::string(pane->window_ ? "the window cannot be drawn to: " : "the window cannot be made: ") + SDL_GetError();
      return nullptr;
    }
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
  void lose() const {
    const Guard guard(shared_->mutex);
    shared_->events.lost = true;
  }

  void take(const SDL_Event& event) {
    const Guard guard(shared_->mutex);
    Events& events = shared_->events;
    if (event.type == SDL_WINDOWEVENT) {
      if (event.window.event == SDL_WINDOWEVENT_CLOSE) events.close = true;
      if (event.window.event == SDL_WINDOWEVENT_EXPOSED || event.window.event == SDL_WINDOWEVENT_SIZE_CHANGED) is_stale_ = true;
    }
    if (event.type != SDL_KEYDOWN || event.key.repeat != 0) return;
    const auto key = event.key.keysym.sym;
    if (key == SDLK_SPACE) events.toggle_pause = !events.toggle_pause;
    if (key == SDLK_s) events.save = true;
    if (key == SDLK_q || key == SDLK_ESCAPE) events.close = true;
  }

  void refresh() {
    std::shared_ptr<const Picture> picture;
    std::string title;
    {
      const Guard guard(shared_->mutex);
      picture = std::exchange(shared_->picture, nullptr);
      title = std::exchange(shared_->title, {});
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
    const Guard guard(shared_->mutex);
    shared_->events.problem = "picture of " + std::to_string(width_) + "x" + std::to_string(height_) + " " + what + ": " + SDL_GetError();
  }

  std::shared_ptr<Shared> shared_;
  SDL_Window* window_ = nullptr;
  SDL_Renderer* renderer_ = nullptr;
  SDL_Texture* texture_ = nullptr;
  int width_ = 0, height_ = 0;
  bool is_stale_ = false;  // what is on the display
};

// The thread of the display. One per process, as SDL is; it starts with the first window and lives to the end of the process.
//
// When the X server dies Xlib wants to end the process. Its handler for that does not return: the thread stays where it is for ever, and
// whoever waits for it is told. Nobody but the thread touches the display, so nobody else can meet its end. An X server that is stopped
// holds the thread up, but nobody else for longer than a while; what was asked of it is done when the server goes on.
class Window::Screen : public std::enable_shared_from_this<Screen> {
 public:
  static Screen& one() {
    struct Life {
      ~Life() { screen->end(); }
      std::shared_ptr<Screen> screen = std::make_shared<Screen>();  // a thread that is held up keeps it, too
    };
    static Life life;
    return *life.screen;
  }

  Screen() = default;
  ~Screen() { ::close(bell_); }
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  // What failed; empty: nothing. So for everything below that returns a string.
  std::string open(const std::shared_ptr<Shared>& shared, const std::string& title) {
    const Guard mine(turnstile_);
    if (!thread_.joinable()) thread_ = std::thread([self = shared_from_this()] { self->run(); });
    const auto not_opened = std::make_shared<std::string>();
    auto problem = run_there([this, shared, title, not_opened] { *not_opened = open_pane(shared, title); });
    if (problem.empty()) return *not_opened;
    (void)give([this, shared] { close_pane(shared.get()); });  // it may come to be after all
    return problem;
  }
  std::string close(const std::shared_ptr<Shared>& shared) {
    const Guard mine(turnstile_);
    return run_there([this, shared] { close_pane(shared.get()); });
  }
  // Any thread.
  void wake() const {
    const std::uint64_t one = 1;
    if (::write(bell_, &one, sizeof one) < 0) return;  // it rings already
  }

 private:
  static constexpr std::chrono::milliseconds longest_answer{1500};  // within the 2 s that the runtime grants a callback at its end
  static constexpr std::chrono::seconds answer_when_held_up{1};

  // The process ends, perhaps with windows open.
  void end() {
    if (!thread_.joinable()) return;
    const auto problem = run_there([this] {
      is_ending_ = true;
      panes_.clear();
      leave();
    });
    if (problem.empty()) return thread_.join();
    thread_.detach();
  }
  // The number of the work that the thread is to do when it comes to it.
  std::uint64_t give(std::function<void()> work) {
    const Guard guard(mutex_);
    tasks_.push_back(std::move(work));
    wake();
    return ++tasks_given_;
  }
  // An error when the display has gone: the work is never finished. And when it does not answer in time: the work is done when it does.
  std::string run_there(std::function<void()> work) {
    const auto number = give(std::move(work));
    std::unique_lock<coil::Mutex> lock(mutex_);
    const auto is_answered = [&] { return tasks_done_ >= number || is_lost_; };
    const bool is_held_up = tasks_done_ < tasks_missed_;
    if (!changed_.wait_for(lock, is_held_up ? answer_when_held_up : longest_answer, is_answered)) {
      tasks_missed_ = number;
      return "the display does not answer";
    }
    return tasks_done_ < number ? "the display of this process is lost" : "";
  }

  static std::string enter() {
    SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");  // the manager ends the process, not the window
    SDL_SetHint(SDL_HINT_VIDEO_ALLOW_SCREENSAVER, "1");
    // Pictures go to the X server as they are. GL would hang at the end of a process that has lost its display.
    SDL_SetHint(SDL_HINT_FRAMEBUFFER_ACCELERATION, "0");
    // Without this SDL would rather draw where nobody can see it than fail. The variable SDL_VIDEODRIVER still wins.
    SDL_SetHint(SDL_HINT_VIDEODRIVER, "x11,wayland");
    return SDL_InitSubSystem(SDL_INIT_VIDEO) == 0 ? std::string() : std::string("the display cannot be used: ") + SDL_GetError();
  }
  void leave() {
    if (SDL_WasInit(SDL_INIT_VIDEO) == 0) return;
    SDL_QuitSubSystem(SDL_INIT_VIDEO);
    display_ = nullptr;
  }
  std::string open_pane(const std::shared_ptr<Shared>& shared, const std::string& title) {
    std::string problem = panes_.empty() ? enter() : std::string();
    if (!problem.empty()) return problem;
    if (auto pane = Pane::open(shared, title, problem)) {
      watch(*pane);
      panes_.push_back(std::move(pane));
      return {};
    }
    if (panes_.empty()) leave();
    return problem;
  }
  void close_pane(const Shared* shared) {
    std::erase_if(panes_, [&](const auto& pane) { return pane->shared() == shared; });
    if (panes_.empty()) leave();
  }

  void run() {
    while (!is_ending_) {
      const bool was_busy = take_events();
      for (const auto& task : take_tasks()) {
        task();
        const Guard guard(mutex_);
        ++tasks_done_;
        changed_.notify_all();
      }
      for (auto& pane : panes_) pane->refresh();
      // Drawing may have brought events along, which no longer wait in the connection.
      if (!was_busy && !is_ending_ && !take_events()) sleep();
    }
  }
  std::vector<std::function<void()>> take_tasks() {
    const Guard guard(mutex_);
    return std::exchange(tasks_, {});
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
    if (panes_.empty()) return false;
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

  static inline thread_local Screen* of_this_thread_ = nullptr;

  // From the first window on the display is known.
  void watch(const Pane& pane) {
    if (display_ != nullptr) return;
    display_ = pane.display();
    // Of all connections: SDL has a second one, and Xlib's own handler ends the process before it asks that of a single connection.
    if (display_ == nullptr) return;
    of_this_thread_ = this;
    XSetIOErrorHandler([](Display*) -> int { of_this_thread_->lose(); });
  }
  [[noreturn]] void lose() {
    for (const auto& pane : panes_) {
      if (pane) pane->lose();  // one that is being closed is gone already
    }
    {
      const Guard guard(mutex_);
      is_lost_ = true;
    }
    changed_.notify_all();
    while (true) ::poll(nullptr, 0, -1);
  }

  const int bell_ = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  coil::Mutex turnstile_;  // one opening or closing at a time, which waits for the display meanwhile
  std::thread thread_;
  coil::Mutex mutex_;  // of what follows
  std::condition_variable_any changed_;
  std::vector<std::function<void()>> tasks_;
  std::uint64_t tasks_given_ = 0, tasks_done_ = 0;
  std::uint64_t tasks_missed_ = 0;  // the last one whose wait has ended
  bool is_lost_ = false;
  std::vector<std::unique_ptr<Pane>> panes_;  // the thread's, like what follows
  Display* display_ = nullptr;                // of X11; SDL's
  bool is_ending_ = false;
};

Window::Window(std::shared_ptr<Shared> shared) : shared_(std::move(shared)) {}
Window::~Window() { (void)close(); }

std::unique_ptr<Window> Window::open(const std::string& title, std::string& problem) {
  const auto has = [](const char* name) { return std::getenv(name) != nullptr && *std::getenv(name) != '\0'; };
  auto shared = std::make_shared<Shared>();
  const bool has_display = has("DISPLAY") || has("WAYLAND_DISPLAY") || has("SDL_VIDEODRIVER");
  problem = has_display ? Screen::one().open(shared, title) : "there is no display";
  return problem.empty() ? std::unique_ptr<Window>(new Window(std::move(shared))) : nullptr;
}

std::string Window::close() {
  const auto shared = std::exchange(shared_, nullptr);
  return shared ? Screen::one().close(shared) : std::string();
}

void Window::show(std::shared_ptr<const Picture> picture) {
  {
    const Guard guard(shared_->mutex);
    shared_->picture.swap(picture);  // the one before ends without the lock
  }
  Screen::one().wake();
}

void Window::set_title(const std::string& title) {
  {
    const Guard guard(shared_->mutex);
    shared_->title = title;
  }
  Screen::one().wake();
}

Events Window::events() {
  const Guard guard(shared_->mutex);
  return std::exchange(shared_->events, {});
}

}  // namespace video
