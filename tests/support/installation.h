// SPDX-License-Identifier: MIT
//
// The program as a user has it: installed from the build tree, then moved, so that no path of the build can help.
#pragma once

#include <filesystem>
#include <string>

#include "support/catch.h"
#include "support/run.h"
#include "support/temporary_folder.h"

namespace lapidary {

class Installation {
public:
    Installation() {
        const std::filesystem::path first = folder_.path() / "first";
        const RunResult installed = run("cmake --install " + quoted(LAPIDARY_BUILD_FOLDER) + " --prefix " + quoted(first));
        INFO(installed.output);
        REQUIRE(installed.exit_code == 0);
        std::filesystem::rename(first, prefix());
    }

    std::filesystem::path prefix() const { return folder_.path() / "prefix"; }
    std::string program() const { return quoted(prefix() / "bin" / "lapidary"); }

    // Configures a project that finds the installed package, and builds one target of it.
    RunResult build(const std::filesystem::path& source, const std::filesystem::path& binary, const std::string& target) const {
        return run("cmake -G Ninja -S " + quoted(source) + " -B " + quoted(binary) + " -DCMAKE_PREFIX_PATH=" + quoted(prefix()) +
                   " -DCMAKE_CXX_COMPILER=" + quoted(LAPIDARY_CXX) + " && cmake --build " + quoted(binary) + " --target " +
                   target);
    }

private:
    TemporaryFolder folder_;
};

}  // namespace lapidary
