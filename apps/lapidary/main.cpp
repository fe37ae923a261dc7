// SPDX-License-Identifier: MIT
//
// lapidary: renders scenes, checks them, and tells what it knows.
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <string_view>

#include "apps/lapidary/command_line.h"
#include "apps/lapidary/commands.h"

namespace lapidary {

namespace {

struct Command {
    std::string_view name;
    ExitCode (*run)(const Words&);
};

constexpr Command commands[] = {{"render", render_command}, {"check", check_command},     {"plugins", plugins_command},
                                {"help", help_command},     {"compare", compare_command}, {"converge", converge_command}};

// A first word that is no command's name belongs to `render`.
ExitCode dispatch(Words words) {
    for (const Command& command : commands)
        if (!words.empty() && words.front() == command.name) return command.run({words.begin() + 1, words.end()});
    return render_command(words);
}

ExitCode run(int argc, char** argv) {
    try {
        return dispatch({argv + (argc > 0 ? 1 : 0), argv + argc});
    } catch (const UsageError& error) {
        std::fprintf(stderr, "lapidary: %s\n", error.what());
        return ExitCode::usage;
    } catch (const OutputError& error) {
        std::fprintf(stderr, "lapidary: error: %s\n", error.what());
        return ExitCode::output;
    } catch (const std::bad_alloc&) {
        std::fputs("lapidary: error: there is not enough memory; try a smaller --resolution\n", stderr);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "lapidary: error: %s\n", error.what());
    } catch (...) {
        std::fputs("lapidary: error: something was thrown that is not an exception\n", stderr);
    }
    return ExitCode::failure;
}

}  // namespace

}  // namespace lapidary

int main(int argc, char** argv) {
    // A full disk or a closed pipe is an error of the write, not the program's end.
    std::signal(SIGXFSZ, SIG_IGN);
    std::signal(SIGPIPE, SIG_IGN);
    const int code = static_cast<int>(lapidary::run(argc, argv));
    if (code != static_cast<int>(lapidary::ExitCode::interrupted)) return code;
    // Who stopped it does not wait until some hundred libraries have said goodbye.
    std::fflush(nullptr);
    _exit(code);
}
