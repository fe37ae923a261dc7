// SPDX-License-Identifier: MIT
//
// What the program's exit status tells.
#pragma once

namespace lapidary {

enum class ExitCode : int {
    success = 0,
    failure = 1,       // anything that has no code of its own
    usage = 2,         // the command line cannot be understood
    scene = 3,         // the scene has errors
    output = 4,        // a picture or log cannot be written
    difference = 5,    // `compare` found more than the tolerance allows, or `converge` more than was asked for
    interrupted = 130  // by a signal, Escape or a closed window; what was done is written
};

}  // namespace lapidary
