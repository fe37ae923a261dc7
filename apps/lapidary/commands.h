// SPDX-License-Identifier: MIT
//
// The program's commands. Each takes the words after its name and returns the exit status; what it throws is reported
// by the caller.
#pragma once

#include <string>
#include <vector>

#include "apps/lapidary/exit_code.h"

namespace lapidary {

using Words = std::vector<std::string>;

ExitCode render_command(const Words& words);
ExitCode check_command(const Words& words);
ExitCode plugins_command(const Words& words);
ExitCode help_command(const Words& words);
ExitCode compare_command(const Words& words);
ExitCode converge_command(const Words& words);

}  // namespace lapidary
