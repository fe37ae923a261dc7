// SPDX-License-Identifier: MIT
#include "x11_window.h"

#include <SDL.h>
#include <SDL_syswm.h>
#include <X11/Xlib.h>

namespace lapidary {

namespace {

// Display and number of a window; nothing where it is none of X.
bool find(SDL_Window* window, SDL_SysWMinfo& info) {
    SDL_VERSION(&info.version);
    return SDL_GetWindowWMInfo(window, &info) && info.subsystem == SDL_SYSWM_X11;
}

}  // namespace

void survive_x11_errors() {
    XSetErrorHandler([](Display*, XErrorEvent*) { return 0; });
}

void survive_the_end_of_x11(SDL_Window* window, std::atomic<bool>& lost) {
    SDL_SysWMinfo info;
    if (!find(window, info)) return;
    XSetIOErrorHandler([](Display*) { return 0; });  // the one that is there complains on the terminal
    const auto tell = [](Display*, void* flag) { *static_cast<std::atomic<bool>*>(flag) = true; };
    XSetIOErrorExitHandler(info.info.x11.display, tell, &lost);
    // For the event of the destruction.
    SDL_EventState(SDL_SYSWMEVENT, SDL_ENABLE);
}

bool is_destruction(const SDL_Event& event, SDL_Window* window) {
    SDL_SysWMinfo info;
    if (event.type != SDL_SYSWMEVENT || !event.syswm.msg || event.syswm.msg->subsystem != SDL_SYSWM_X11) return false;
    const XEvent& x11_event = event.syswm.msg->msg.x11.event;
    return x11_event.type == DestroyNotify && find(window, info) && x11_event.xdestroywindow.window == info.info.x11.window;
}

}  // namespace lapidary
