// SPDX-License-Identifier: MIT
#include "apps/lapidary/replace_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "apps/lapidary/command_line.h"
#include "apps/lapidary/interruption.h"

namespace lapidary {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& file, const std::string& reason) {
    throw OutputError(fmt::format("'{}' cannot be written: {}; choose another place with -o", file.string(), reason));
}

fs::path folder_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : fs::path("."); }

// Where the bytes end up: a link stays, and what it points to, there or not, is replaced.
fs::path follow_links(fs::path file) {
    constexpr int most_links = 40;  // as many as the system follows
    std::error_code error;
    for (int i = 0; i < most_links && fs::is_symlink(file, error); ++i) file = folder_of(file) / fs::read_symlink(file, error);
    return file;
}

bool is_special(const fs::path& file) {
    std::error_code error;
    const fs::file_status status = fs::status(file, error);
    return fs::exists(status) && !fs::is_regular_file(status);
}

// Removes the unfinished file unless it was renamed.
class Unfinished {
public:
    explicit Unfinished(fs::path file) : file_(std::move(file)) { Interruption::guard(file_); }
    ~Unfinished() {
        std::error_code ignored;
        fs::remove(file_, ignored);
        Interruption::release();
    }
    Unfinished(const Unfinished&) = delete;
    Unfinished& operator=(const Unfinished&) = delete;

    const fs::path& file() const { return file_; }

private:
    fs::path file_;
};

}  // namespace

void require_writable(const fs::path& file) {
    std::error_code error;
    if (fs::is_directory(file, error)) fail(file, "it is a folder");
    if (is_special(file)) return;
    const fs::path folder = folder_of(follow_links(file));
    if (!fs::exists(folder, error)) fail(file, fmt::format("there is no folder '{}'", folder.string()));
    if (!fs::is_directory(folder, error)) fail(file, fmt::format("'{}' is not a folder", folder.string()));
    if (access(folder.c_str(), W_OK | X_OK) != 0)
        fail(file, fmt::format("nothing may be written into '{}': {}", folder.string(), std::strerror(errno)));
}

void replace_file(const fs::path& file, const std::function<void(const fs::path&)>& write) {
    try {
        if (is_special(file)) return write(file);
        const fs::path place = follow_links(file);
        const Unfinished unfinished(folder_of(place) / fmt::format(".{}.{}.part", place.filename().string(), getpid()));
        write(unfinished.file());
        fs::rename(unfinished.file(), place);
    } catch (const fs::filesystem_error& error) {
        fail(file, error.code().message());
    } catch (const std::exception& error) {
        fail(file, error.what());
    }
}

}  // namespace lapidary
