// SPDX-License-Identifier: MIT
//
// Opens shared libraries at run time: plugins, and modules of the program itself that only some runs need. What was
// opened stays open until exit, so that no pointer into it can dangle.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "kernel/export.h"

namespace lapidary {

// The address of an exported symbol of a library. Opens the library at first use, with all its references resolved and
// its symbols kept from others. Throws std::runtime_error with the reason as half a sentence, without the library's
// path: "it exports no 'lapidary_plugin'". Thread-safe.
LAPIDARY_API void* open_symbol(const std::filesystem::path& library, const char* symbol);

// A module of the program: <prefix>/lib/lapidary/modules/<name>.so, beside the kernel's own library. Throws
// std::runtime_error with a sentence.
LAPIDARY_API void* open_module(const char* name, const char* symbol);

// By name, in the order of the alphabet.
struct Modules {
    std::vector<std::string> opened, passed_over;
};
// All that are there, as things are now.
LAPIDARY_API Modules modules();

}  // namespace lapidary
