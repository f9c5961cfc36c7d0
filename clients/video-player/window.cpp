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

  base::Result<void> open(const std::shared_ptr<Shared>& shared, const std::string& title) {
    const auto mine = turnstile_.take();
    if (!thread_.joinable()) thread_ = std::thread([self = shared_from_this()] { self->run(); });
    const auto opened = std::make_shared<base::Result<void>>();
    const auto answer = run_there([this, shared, title, opened] { *opened = open_pane(shared, title); });
    if (answer) return *opened;
    (void)give([this, shared] { close_pane(shared.get()); });  // it may come to be after all
    return answer;
  }
  base::Result<void> close(const std::shared_ptr<Shared>& shared) {
    const auto mine = turnstile_.take();
    return run_there([this, shared] { close_pane(shared.get()); });
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
    std::uint64_t tasks_missed = 0;  // the last one that nobody waits for any more
    bool is_lost = false;
  };

  static constexpr std::chrono::milliseconds longest_answer{1500};  // within the 2 s that the runtime grants a callback at its end
  static constexpr std::chrono::seconds answer_when_held_up{1};

  // The process ends, perhaps with windows open.
  void end() {
    if (!thread_.joinable()) return;
    const auto ended = run_there([this] {
      is_ending_ = true;
      panes_.clear();
      leave();
    });
    if (ended) return thread_.join();
    thread_.detach();
  }
  // The number of the work that the thread is to do when it comes to it.
  std::uint64_t give(std::function<void()> work) {
    auto state = state_.lock();
    state->tasks.push_back(std::move(work));
    wake();
    return ++state->tasks_given;
  }
  // An error when the display has gone: the work is never finished. And when it does not answer in time: the work is done when it does.
  base::Result<void> run_there(std::function<void()> work) {
    const auto number = give(std::move(work));
    auto state = state_.lock();
    const auto is_answered = [&] { return state->tasks_done >= number || state->is_lost; };
    const bool is_held_up = state->tasks_done < state->tasks_missed;
    if (!state.wait_for(changed_, is_held_up ? answer_when_held_up : longest_answer, is_answered)) {
      state->tasks_missed = number;
      return base::Error{"the display does not answer"};
    }
    if (state->tasks_done < number) return base::Error{"the display of this process is lost"};
    return {};
  }

  static base::Result<void> enter() {
    SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");  // the manager ends the process, not the window
    SDL_SetHint(SDL_HINT_VIDEO_ALLOW_SCREENSAVER, "1");
    // Pictures go to the X server as they are. GL would hang at the end of a process that has lost its display.
    SDL_SetHint(SDL_HINT_FRAMEBUFFER_ACCELERATION, "0");
    // Without this SDL would rather draw where nobody can see it than fail. The variable SDL_VIDEODRIVER still wins.
    SDL_SetHint(SDL_HINT_VIDEODRIVER, "x11,wayland");
    if (SDL_InitSubSystem(SDL_INIT_VIDEO) != 0) return base::Error{std::string("the display cannot be used: ") + SDL_GetError()};
    return {};
  }
  void leave() {
    if (SDL_WasInit(SDL_INIT_VIDEO) == 0) return;
    SDL_QuitSubSystem(SDL_INIT_VIDEO);
    display_ = nullptr;
  }
  base::Result<void> open_pane(const std::shared_ptr<Shared>& shared, const std::string& title) {
    if (panes_.empty()) {
      if (auto entered = enter(); !entered) return entered;
    }
    auto pane = Pane::open(shared, title);
    if (pane) {
      watch(**pane);
      panes_.push_back(std::move(*pane));
      return {};
    }
    if (panes_.empty()) leave();
    return pane.error();
  }
  void close_pane(const Shared* shared) {
    std::erase_if(panes_, [&](const auto& pane) { return pane->shared() == shared; });
    if (panes_.empty()) leave();
  }

  void run() {
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
    state_.lock()->is_lost = true;
    changed_.notify_all();
    while (true) ::poll(nullptr, 0, -1);
  }

  const int bell_ = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  base::Turn<> turnstile_;  // whoever opens or closes goes through here, one at a time, and waits for the display meanwhile
  std::thread thread_;
  base::Guarded<State, base::Rank::buffer> state_;
  std::condition_variable changed_;
  std::vector<std::unique_ptr<Pane>> panes_;  // the thread's, like what follows
  Display* display_ = nullptr;                // of X11; SDL's
  bool is_ending_ = false;
};

Window::Window(std::shared_ptr<Shared> shared) : shared_(std::move(shared)) {}
Window::~Window() { (void)close(); }

base::Result<std::unique_ptr<Window>> Window::open(const std::string& title) {
  const auto has = [](const char* name) { return std::getenv(name) != nullptr && *std::getenv(name) != '\0'; };
  if (!has("DISPLAY") && !has("WAYLAND_DISPLAY") && !has("SDL_VIDEODRIVER")) return base::Error{"there is no display"};
  auto shared = std::make_shared<Shared>();
  if (auto opened = Screen::one().open(shared, title); !opened) return opened.error();
  return std::unique_ptr<Window>(new Window(std::move(shared)));
}

base::Result<void> Window::close() {
  const auto shared = std::exchange(shared_, nullptr);
  return shared ? Screen::one().close(shared) : base::Result<void>{};
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
