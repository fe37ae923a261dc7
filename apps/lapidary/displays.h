// SPDX-License-Identifier: MIT
//
// The outputs that show the picture while it grows: a window where there is a display, the terminal where it was asked
// for. Without display everything goes on as without window.
#pragma once

#include <vector>

#include "apps/lapidary/picture_files.h"

namespace lapidary {

struct DisplayChoice {
    bool no_window = false;    // -w
    bool full_screen = false;  // -f
    bool terminal = false;     // --preview
};

// Adds what the choice and the environment ask for, and takes away the scene's windows where none is wanted.
void choose_displays(std::vector<PictureFile>& pictures, Registry& registry, const DisplayChoice& choice, Messages& messages);

}  // namespace lapidary
