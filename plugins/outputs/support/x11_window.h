// SPDX-License-Identifier: MIT
//
// A window of the X Window System that is taken away: destroyed by another program, its connection cut by xkill, by the
// end of an ssh session or of the server. Xlib would end the program, and with it the render.
#pragma once

#include <atomic>

union SDL_Event;
struct SDL_Window;

namespace lapidary {

// From now on a request that fails is without consequence. SDL puts back at its end what it found at its beginning: to be
// called before that, too.
void survive_x11_errors();

// When the connection to the window's display breaks, `lost` becomes true, and every request fails. Does nothing for a window
// of another system.
void survive_the_end_of_x11(SDL_Window* window, std::atomic<bool>& lost);

// Whether the event tells that this window was destroyed from outside.
bool is_destruction(const SDL_Event& event, SDL_Window* window);

}  // namespace lapidary
