// SPDX-License-Identifier: MIT
#include "loaders/scene/files.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <memory>
#include <system_error>

namespace lapidary::scene_language {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t largest_file = std::size_t{1} << 30;

std::string cannot_read(const fs::path& file, std::string_view why) {
    return fmt::format("cannot read '{}': {}", file.string(), why);
}

}  // namespace

std::string without_byte_order_mark(std::string text) {
    if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
    return text;
}

// Pipes are read like files. Devices are refused, for some of them never end.
FileText read_file(const fs::path& file) {
    std::error_code error;
    const fs::file_status status = fs::status(file, error);
    if (status.type() == fs::file_type::not_found) return {{}, cannot_read(file, "there is no such file")};
    if (error) return {{}, cannot_read(file, error.message())};
    if (fs::is_directory(status)) return {{}, cannot_read(file, "it is a folder")};
    if (!fs::is_regular_file(status) && !fs::is_fifo(status)) return {{}, cannot_read(file, "it is no ordinary file")};

    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "rb"),
                                                                 [](std::FILE* f) { return std::fclose(f); });
    if (!stream) return {{}, cannot_read(file, std::generic_category().message(errno))};

    std::string text;
    if (const auto size = fs::file_size(file, error); !error && size <= largest_file) text.reserve(size + 1);
    char buffer[1 << 16];
    while (const std::size_t count = std::fread(buffer, 1, sizeof buffer, stream.get())) {
        if (text.size() + count > largest_file) return {{}, cannot_read(file, "it is larger than 1 GiB")};
        text.append(buffer, count);
    }
    if (std::ferror(stream.get())) return {{}, cannot_read(file, std::generic_category().message(errno))};
    return {without_byte_order_mark(std::move(text)), {}};
}

FoundFile find_include(std::string_view name, const fs::path& including_file, const std::vector<fs::path>& include_path) {
    FoundFile result;
    const auto try_folder = [&](const fs::path& folder) {
        const fs::path file = (folder / name).lexically_normal();
        std::error_code error;
        if (fs::exists(file, error))
            result.file = file;
        else
            result.tried.push_back(file);
        return !result.file.empty();
    };

    if (try_folder(including_file.parent_path()) || fs::path(name).is_absolute()) return result;
    for (const fs::path& folder : include_path)
        if (try_folder(folder)) return result;
    return result;
}

std::vector<std::string> neighbours(const std::vector<fs::path>& tried) {
    constexpr std::size_t most = 1000;
    std::vector<std::string> names;
    for (const fs::path& file : tried) {
        std::error_code error;
        const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
        for (fs::directory_iterator entry(folder, error), end; !error && entry != end && names.size() < most;
             entry.increment(error))
            names.push_back(entry->path().filename().string());
    }
    return names;
}

fs::path identity_of(const fs::path& file) {
    std::error_code error;
    fs::path identity = fs::weakly_canonical(file, error);
    return error ? file : identity;
}

}  // namespace lapidary::scene_language
